//! Faults on the bus of a locomotive that runs, in virtual time: what is found, and after how many
//! cycles. The rows are those of faults that earlier versions of the loop ended as "completed".

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::{
    Fault, FaultCode, Frame, Measurement, MessageId, Pace as WirePace, Pressure, Profile, RunState,
    Seal, Sender, Telemetry, Trips,
};
use firmware_core::supervision::{Action, Signal};
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::clock::Tick;
use hil_host::control::{Buses, Requests, Stop};
use hil_host::faults::Opener;
use hil_host::record::Queues;
use hil_host::rig::RigNode;
use std::collections::VecDeque;
use std::time::Duration;

/// Cycle in which a fault begins.
const BEGIN: u64 = 2000;
/// Cycles for which a fault may last.
const LASTS: u64 = 3000;

/// What a fault makes of a frame of the rig; measurements come with their seal.
type Change = Box<dyn FnMut(u64, WireFrame, Option<Seal>) -> Vec<WireFrame>>;

/// A bus with a fault.
struct Faulty {
    bus: MemoryBus,
    cycle: u64,
    change: Change,
    /// Whether the bus has no room in a cycle.
    is_full: fn(u64) -> bool,
    pending: VecDeque<WireFrame>,
    opener: Opener,
}

impl Bus for Faulty {
    fn send(&mut self, frame: &Frame) -> Sent {
        let is_command = frame.id() == MessageId::Command(Profile::Classical, NODE).raw();
        if is_command {
            self.cycle += 1;
        }
        self.opener.hear(NODE, &WireFrame::from(frame));
        if is_command && self.cycle >= BEGIN && (self.is_full)(self.cycle - BEGIN) {
            return Sent::Dropped;
        }
        self.bus.send(frame)
    }

    fn receive(&mut self) -> Option<WireFrame> {
        loop {
            if let Some(frame) = self.pending.pop_front() {
                return Some(frame);
            }
            let frame = self.bus.receive()?;
            let seal = self.opener.hear(NODE, &frame);
            match self.cycle.checked_sub(BEGIN) {
                Some(since) => self.pending.extend((self.change)(since, frame, seal)),
                None => self.pending.push_back(frame),
            }
        }
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        !self.pending.is_empty() || self.bus.wait(timeout)
    }

    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

/// Runs into a fault; what stopped the session, if it was stopped.
fn stop_of(change: Change, is_full: fn(u64) -> bool) -> Option<Stop> {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let bus = MemoryBus::new(Some(RigNode::new(&run.rig, NODE, Profile::Classical)));
    let (pending, opener) = (VecDeque::new(), Opener::default());
    let mut bus = Faulty { bus, cycle: 0, change, is_full, pending, opener };
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    bus.cycle = 0;
    while state.line.cycle < BEGIN + LASTS && state.stop.is_none() {
        let buses = std::slice::from_mut(&mut bus);
        session.cycle(&mut state, &mut Buses::new(buses, &mut recorder), Tick::default());
    }
    state.stop
}

/// The signal, the cycles since the fault began, and the action.
fn found(
    mut change: impl FnMut(u64, WireFrame) -> Vec<WireFrame> + 'static,
) -> Option<(Signal, u64)> {
    found_sealed(move |since, frame, _| change(since, frame))
}

/// The same of a fault that knows the seal.
fn found_sealed(
    change: impl FnMut(u64, WireFrame, Option<Seal>) -> Vec<WireFrame> + 'static,
) -> Option<(Signal, u64)> {
    let stop = stop_of(Box::new(change), |_| false)?;
    assert_eq!(stop.node, Some(1));
    Some((stop.cause.signal, stop.cycle - BEGIN))
}

/// Changes measurements alone.
fn lies(
    change: impl Fn(u64, &mut Measurement) + 'static,
) -> impl FnMut(u64, WireFrame, Option<Seal>) -> Vec<WireFrame> + 'static {
    move |since, frame, seal| {
        let Some(seal) = seal else { return vec![frame] };
        let opened = Measurement::decode_sealed(frame.id(), frame.data(), seal);
        let mut measurement = opened.unwrap();
        change(since, &mut measurement);
        vec![WireFrame::from(&measurement.encode_sealed(Profile::Classical, seal).0)]
    }
}

fn is_measurement(frame: &WireFrame) -> bool {
    frame.id() == MessageId::Measurement(Profile::Classical, NODE).raw()
}

#[test]
fn without_a_fault_nothing_stops() {
    assert_eq!(found(|_, frame| vec![frame]), None);
}

#[test]
fn four_of_five_measurements_lost_ended_as_completed() {
    let cause = found(
        |since, frame| {
            if is_measurement(&frame) && since % 5 != 0 { vec![] } else { vec![frame] }
        },
    );
    let (signal, cycles) = cause.unwrap();
    assert!(signal == Signal::LostMeasurements && cycles <= 13, "{signal:?} {cycles}");
}

#[test]
fn a_force_ten_cycles_old_was_believed() {
    let mut queue = VecDeque::new();
    let cause = found(move |_, frame| {
        if !is_measurement(&frame) {
            return vec![frame];
        }
        queue.push_back(frame);
        if queue.len() > 10 { queue.pop_front().into_iter().collect() } else { vec![] }
    });
    assert!(cause.is_some_and(|(_, cycles)| cycles <= 6), "{cause:?}");
}

#[test]
fn a_frozen_and_a_zero_force_ended_as_completed() {
    for force_n in [8000.0, 0.0] {
        let cause = found_sealed(lies(move |_, measurement| measurement.force_n = Some(force_n)));
        let (signal, cycles) = cause.unwrap();
        assert!(signal == Signal::StuckForce && cycles < 300, "{force_n}: {signal:?} {cycles}");
    }
}

#[test]
fn a_reversed_force_ended_as_completed() {
    let cause = found_sealed(lies(|_, measurement| {
        measurement.force_n = measurement.force_n.map(|force_n| -force_n);
    }));
    let (signal, cycles) = cause.unwrap();
    assert!(signal == Signal::Work && cycles < 1000, "{signal:?} {cycles}");
}

#[test]
fn spikes_of_99_kn_ended_as_completed_and_moved_the_vehicle() {
    let cause = found_sealed(lies(|since, measurement| {
        if since % 2 == 0 {
            measurement.force_n = Some(99e3);
        }
    }));
    // One spike is held over; losses of every other cycle end the run.
    assert!(cause.is_some_and(|(_, cycles)| cycles < 40), "{cause:?}");
    let constant = found_sealed(lies(|_, measurement| measurement.force_n = Some(99.9e3)));
    let (signal, cycles) = constant.unwrap();
    assert!(matches!(signal, Signal::Force | Signal::ForceRate) && cycles <= 3, "{cycles}");
}

#[test]
fn a_displacement_off_by_a_millimetre_frozen_or_missing_was_never_noticed() {
    let off = found_sealed(lies(|_, measurement| {
        measurement.displacement_m = measurement.displacement_m.map(|x| x + 1e-3);
    }));
    assert!(
        off.is_some_and(|(signal, cycles)| signal == Signal::Velocity && cycles <= 2),
        "{off:?}"
    );
    let frozen = found_sealed(lies(|_, measurement| measurement.displacement_m = Some(1e-3)));
    assert!(frozen.is_some(), "{frozen:?}");
    let missing = found_sealed(lies(|_, measurement| measurement.displacement_m = None));
    assert_eq!(missing.map(|(signal, _)| signal), Some(Signal::InvalidDisplacement));
    let away = found_sealed(lies(|_, measurement| measurement.displacement_m = Some(60e-3)));
    assert!(away.is_some_and(|(_, cycles)| cycles <= 2), "{away:?}");
}

#[test]
fn an_emergency_stop_and_a_fault_that_the_rig_reports_were_never_read() {
    let says = |other: WireFrame| {
        found(move |since, frame| {
            if since == 0 && is_measurement(&frame) {
                vec![frame, other.clone()]
            } else {
                vec![frame]
            }
        })
    };
    let telemetry = Telemetry {
        node: NODE,
        counter: 3,
        state: RunState::Run,
        temperature_degc: None,
        pressure: Pressure::Ready,
        trips: Trips::EMERGENCY_STOP,
    };
    let stopped = says(WireFrame::from(&telemetry.encode().0));
    assert!(stopped.is_some_and(|(signal, n)| signal == Signal::RigTrip && n <= 1), "{stopped:?}");
    let fault = Fault {
        sender: Sender::Rig(NODE),
        counter: 0,
        state: RunState::Run,
        code: FaultCode::PressureLost,
        detail: 0,
    };
    let failed = says(WireFrame::from(&fault.encode().0));
    assert!(failed.is_some_and(|(signal, n)| signal == Signal::RigFault && n <= 1), "{failed:?}");
}

#[test]
fn a_bus_without_room_twice_in_a_row_ends_the_run() {
    let keep = || Box::new(|_, frame, _| vec![frame]);
    assert_eq!(stop_of(keep(), |since| since % 20 == 0), None);
    let stop = stop_of(keep(), |since| since < 2).unwrap();
    assert_eq!((stop.cause.signal, stop.cause.action), (Signal::BusQueue, Action::RampOut));
    assert_eq!(stop.cycle, BEGIN + 1);
}
