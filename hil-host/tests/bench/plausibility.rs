//! What `[plausibility]`, `[readiness]` and `beyond_limits` of a scenario do, and a rig that
//! refuses.

use crate::support::locomotive::{NODE, scenario_with, session};
use can_protocol::arming::{Refusal, Shortfall};
use can_protocol::{
    ArmItem, Fault as Message, FaultCode, Frame, MessageId, Pace as WirePace, Profile, RunState,
    Sender,
};
use firmware_core::supervision::{Action, Signal};
use hil_host::BenchError;
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::control::{NoAnswer, Requests, Stop};
use hil_host::faults::{Fault, FaultyBus, Injection, inject};
use hil_host::rig::RigNode;
use std::time::Duration;

/// Cycle in which a fault begins, and the last one of a session that nothing ends.
const CYCLES: (u64, u64) = (2000, 4000);

/// What stops a scenario with these tables, with a fault in so many cycles.
fn stop_of(tables: &str, fault: Fault, lasts: u64) -> Option<Stop> {
    let run = scenario_with(tables);
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = FaultyBus::new(&run.rig, NODE, 1);
    let (begin, until) = CYCLES;
    let injection = Injection { fault, begin, lasts, until };
    let injected = inject(&session, &run, &mut bus, &injection).unwrap();
    assert_eq!(injected.violation, None);
    injected.stop
}

/// A bus whose rig answers nothing but that it refuses the session.
struct Refusing(u32);

impl Bus for Refusing {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.0 += u32::from(frame.id() == MessageId::Sync.raw());
        Sent::Away
    }
    fn receive(&mut self) -> Option<WireFrame> {
        // Once, as the protocol asks.
        (self.0 == 1).then(|| {
            self.0 += 1;
            let (sender, code) = (Sender::Rig(NODE), FaultCode::ConfigurationMismatch);
            let fault = Message { sender, counter: 0, state: RunState::Init, code, detail: 2 };
            WireFrame::from(&fault.encode().0)
        })
    }
    fn wait(&mut self, _timeout: Duration) -> bool {
        false
    }
    fn counters(&self) -> BusCounters {
        BusCounters::default()
    }
}

#[test]
fn a_rig_that_refuses_the_session_was_reported_as_silent() {
    let run = scenario_with("");
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let (mut bus, requests) = ([Refusing(0)], Requests::armed());
    let met = session.meet(&mut state, &mut bus, Duration::from_secs(10), &requests);
    let Err(NoAnswer::RefusedSync { node: 1, session: refused }) = met else { panic!("{met:?}") };
    assert_eq!((refused.pace, refused.slow_down.get()), (WirePace::Clock, 1));
    // What is printed has its node, its bus and the session.
    let error = met.unwrap_err().on(&"socketcan:can0".parse().unwrap());
    let found = BenchError::RefusedSync { node: 1, bus: "socketcan:can0".into(), session: refused };
    assert_eq!(error.to_string(), found.to_string());
    assert_eq!(
        error.to_string(),
        format!(
            "rig node 1 on socketcan:can0 refuses the session (CONFIGURATION_MISMATCH), expected one that \
             it can follow; found {refused}"
        )
    );
    assert!(refused.to_string().contains("period"), "{refused}");
    assert!(error.is_safe_state() && !error.is_bad_input());
}

#[test]
fn readiness_is_that_of_the_scenario() {
    let refusal = |tables: &str| {
        let run = scenario_with(tables);
        let track = run.track.view();
        let session = session(&run, &track, WirePace::LockStep);
        let mut state = session.start(session.line.start(run.start.state.clone()));
        // The ram stands 10 mm from its middle: 90 mm are left to one end.
        let rig = RigNode::new(&run.rig, NODE, Profile::Classical).with_ram_at(10e-3);
        let (mut bus, requests) = (vec![MemoryBus::new(Some(rig))], Requests::armed());
        session.greet(&mut state, &mut bus, Duration::from_secs(1), &requests).err()
    };
    assert_eq!(refusal(""), None);
    let (item, found, needed) = (ArmItem::StrokeOut, 90_000, 95_000);
    let shortfall = Refusal::ByHost(Shortfall { item, found, needed });
    let refused = NoAnswer::Refused { node: 1, refusal: shortfall };
    assert_eq!(refusal("[readiness]\nstroke_left_m = 0.095\n"), Some(refused));
}

#[test]
fn a_tighter_limit_another_debounce_and_another_action_are_those_of_the_scenario() {
    let wrong = Fault::StuckForce(60e3);
    let usual = stop_of("", wrong, 1000).unwrap();
    assert_eq!((usual.cause.signal, usual.cause.action), (Signal::ForceRate, Action::Stop));
    let table = "[plausibility]\n\
                 force = { limit_n = 50e3, after_cycles = 3, action = \"ramp out\" }\n\
                 force_rate = { limit_n_per_cycle = 1e6 }\n";
    let stop = stop_of(table, wrong, 1000).unwrap();
    assert_eq!((stop.cause.signal, stop.cause.limit), (Signal::Force, 50e3));
    assert_eq!((stop.cause.action, stop.cycle - usual.cycle), (Action::RampOut, 1));
}

#[test]
fn what_is_only_logged_or_held_lets_the_run_go_on() {
    let spikes = Fault::SpikeForce(99e3);
    assert!(stop_of("", spikes, 1000).is_some());
    for action in ["log", "hold"] {
        let table = format!(
            "[plausibility]\nforce = {{ action = \"{action}\" }}\n\
             force_rate = {{ action = \"{action}\" }}\nwork = {{ action = \"log\" }}\n"
        );
        assert_eq!(stop_of(&table, spikes, 40), None, "{action}");
    }
}

#[test]
fn a_command_beyond_its_limits_is_cut_or_stops_by_choice() {
    let (none, lasts) = (Fault::Duplicate, 0);
    let slow = |choice: &str| format!("[motion]\nvelocity_m_per_s = 0.05\n{choice}");
    assert_eq!(stop_of(&slow(""), none, lasts).map(|stop| stop.cause.signal), None);
    let stop = stop_of(&slow("beyond_limits = \"stop\"\n"), none, lasts).unwrap();
    assert_eq!((stop.cause.signal, stop.cause.action), (Signal::CommandLimit, Action::Stop));
    assert_eq!(stop.node, Some(1));
    assert_eq!(stop_of("[motion]\nbeyond_limits = \"stop\"\n", none, lasts), None);
}
