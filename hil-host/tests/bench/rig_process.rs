//! A rig served over a bus that plays a script: how it ends and what it reports.

use crate::support::host::Host;
use crate::support::rig::quiet;
use can_protocol::{Frame, Measurement, Pace, Profile, RunState};
use hil_host::bus::{Bus, BusCounters, Sent, WireFrame};
use hil_host::realtime::RealtimeOptions;
use hil_host::rig::RigNode;
use hil_host::rig::process::{Options, RigSummary, serve};
use std::collections::VecDeque;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Gives the rig the scripted frames, and keeps its answers.
#[derive(Default)]
struct Script {
    to_rig: VecDeque<WireFrame>,
    from_rig: Vec<Frame>,
    counters: BusCounters,
}

impl Bus for Script {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.counters.sent += 1;
        self.from_rig.push(frame.clone());
        Sent::Away
    }
    fn receive(&mut self) -> Option<WireFrame> {
        self.to_rig.pop_front()
    }
    fn wait(&mut self, _timeout: Duration) -> bool {
        !self.to_rig.is_empty()
    }
    fn counters(&self) -> BusCounters {
        self.counters
    }
}

const OPTIONS: Options = Options { exit_after_run: true, realtime: RealtimeOptions::NONE };

/// A lock-step run of 50 commands, one of them repeated and one spoilt, and its end.
fn played() -> (Script, RigSummary) {
    let mut host = Host::new(Profile::Classical);
    let mut script = Script::default();
    let mut say = |frame: &Frame| script.to_rig.push_back(WireFrame::from(frame));
    say(&host.sync(Pace::LockStep));
    for cycle in 0..50 {
        let frame = host.run();
        say(&frame);
        if cycle == 20 {
            say(&frame);
        }
    }
    say(&host.state(RunState::Standby));
    script.to_rig.insert(30, WireFrame::new(0x101, false, &[0; 8]).unwrap());
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
    let mut answers = script
        .from_rig
        .iter()
        .filter_map(|frame| Measurement::decode(frame.id(), frame.data()).ok());
    assert_eq!(answers.clone().count(), 51);
    assert_eq!(answers.next_back().map(|last| last.state), Some(RunState::Standby));
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
