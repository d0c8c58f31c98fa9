//! A rig served over a bus that plays a script: how it ends and what it reports.

use crate::support::host::Host;
use crate::support::rig::quiet;
use can_protocol::arming::{HostArming, HostOutcome, Listener, Quiet};
use can_protocol::{
    ArmMessage, Frame, Measurement, Pace, Profile, RunState, Seal, SessionCode, SessionHistory,
};
use hil_host::bus::{Bus, BusCounters, Sent, WireFrame};
use hil_host::realtime::RealtimeOptions;
use hil_host::rig::RigNode;
use hil_host::rig::process::{Options, RigSummary, serve};
use std::collections::VecDeque;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Arms the rig, gives it the scripted frames, and keeps its answers.
#[derive(Default)]
struct Script {
    to_rig: VecDeque<WireFrame>,
    from_rig: Vec<Frame>,
    counters: BusCounters,
    host: Option<(HostArming, Quiet)>,
    code: Option<SessionCode>,
}

/// A lock-step run of 50 commands, one of them repeated and one spoilt, and its end.
fn run_of(code: SessionCode) -> VecDeque<WireFrame> {
    let mut host = Host { code: Some(code), ..Host::new(Profile::Classical) };
    let mut frames = VecDeque::new();
    for cycle in 0..50 {
        let frame = host.run();
        frames.push_back(WireFrame::from(&frame));
        if cycle == 20 {
            frames.push_back(WireFrame::from(&frame));
        }
    }
    frames.push_back(WireFrame::from(&host.state(RunState::Standby)));
    frames.insert(30, WireFrame::new(0x101, false, &[0; 8]).unwrap());
    frames
}

impl Bus for Script {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.counters.sent += 1;
        self.from_rig.push(frame.clone());
        let Some((exchange, quiet)) = &mut self.host else { return Sent::Away };
        quiet.hear(frame.id(), frame.data());
        if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data()) {
            exchange.receive(&answer);
        }
        if let HostOutcome::Armed(agreement) = exchange.outcome() {
            self.host = None;
            self.code = Some(agreement.code());
            self.to_rig = run_of(agreement.code());
        }
        Sent::Away
    }
    fn receive(&mut self) -> Option<WireFrame> {
        let next = self.to_rig.pop_front();
        if let (None, Some((exchange, quiet))) = (&next, &mut self.host) {
            // A cycle has passed; what the host asks now arrives in the next one.
            quiet.cycle();
            let question = exchange.cycle(quiet).map(|question| question.encode().0);
            self.to_rig.extend(question.iter().map(WireFrame::from));
        }
        next
    }
    fn wait(&mut self, _timeout: Duration) -> bool {
        !self.to_rig.is_empty()
    }
    fn counters(&self) -> BusCounters {
        self.counters
    }
}

const OPTIONS: Options =
    Options { accept_replay: None, exit_after_run: true, realtime: RealtimeOptions::NONE };

/// The script, played.
fn played() -> (Script, RigSummary) {
    let host = Host::new(Profile::Classical);
    let mut script = Script::default();
    let sync = host.sync_message(Pace::LockStep);
    script.to_rig.push_back(WireFrame::from(&sync.encode()));
    let exchange = HostArming::new(host.plan(&sync), SessionHistory::default());
    script.host = Some((exchange, Quiet::new(Listener::Host)));
    let mut rig = RigNode::new(&quiet(), host.node, host.profile);
    let summary = serve(&mut rig, &mut script, &OPTIONS, &AtomicBool::new(false)).unwrap();
    (script, summary)
}

#[test]
fn it_ends_with_the_run_and_reports_every_frame() {
    let (script, summary) = played();
    assert_eq!((summary.state, summary.runs, summary.safe_events), ("STANDBY", 1, 0));
    let frames = summary.frames;
    assert_eq!((frames.received, frames.lost), (51, 0));
    assert_eq!((frames.repeated, frames.crc_errors, frames.wrong_sequence), (1, 1, 0));
    assert!(!summary.is_safe());
    let measurements = script.from_rig.iter().filter(|frame| frame.id() == 0x201);
    let code = script.code.unwrap();
    let answers: Vec<_> = measurements
        .zip(0..)
        .map(|(frame, cycle)| {
            Measurement::decode_sealed(frame.id(), frame.data(), Seal { code, cycle }).unwrap()
        })
        .collect();
    assert_eq!(answers.len(), 51);
    assert_eq!(answers.last().map(|last| last.state), Some(RunState::Standby));
    assert_eq!(summary.sent, script.from_rig.len() as u64);
}

#[test]
fn the_summary_is_json_with_these_keys() {
    let (_, summary) = played();
    let json = serde_json::to_value(&summary).unwrap();
    for key in ["node", "state", "cycles", "skipped", "runs", "safe_events", "frames", "sent"] {
        assert!(!json[key].is_null(), "{key} in {json}");
    }
    let frames = &json["frames"];
    for key in ["received", "lost", "crc_errors", "repeated", "wrong_sequence"] {
        assert!(frames[key].is_u64(), "{key} in {frames}");
    }
}

#[test]
fn a_stop_ends_the_rig_before_any_frame_arrives() {
    let host = Host::new(Profile::Classical);
    let mut rig = RigNode::new(&quiet(), host.node, host.profile);
    let stop = AtomicBool::new(true);
    let summary = serve(&mut rig, &mut Script::default(), &OPTIONS, &stop).unwrap();
    assert_eq!((summary.state, summary.cycles, summary.sent), ("INIT", 0, 0));
}

#[test]
fn required_real_time_that_is_not_granted_is_an_error() {
    let host = Host::new(Profile::Classical);
    let mut rig = RigNode::new(&quiet(), host.node, host.profile);
    let realtime = RealtimeOptions { cpu: Some(1_000_000), require: true, ..RealtimeOptions::NONE };
    let options = Options { realtime, ..OPTIONS };
    let stop = AtomicBool::new(true);
    let refused = serve(&mut rig, &mut Script::default(), &options, &stop).unwrap_err();
    assert!(refused.to_string().contains("--require-realtime"), "{refused}");
    let options = Options { realtime: RealtimeOptions { require: false, ..realtime }, ..options };
    assert!(serve(&mut rig, &mut Script::default(), &options, &stop).is_ok());
}
