//! Faults on the bus of a locomotive that runs, in virtual time: what is found, and after how many
//! cycles. The rows are those of faults that earlier versions of the loop ended as "completed".

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::{Pace as WirePace, Trips};
use firmware_core::supervision::{Action, Signal};
use hil_host::control::Stop;
use hil_host::faults::{Fault, FaultyBus, Injection, inject};

/// Cycle in which a fault begins.
const BEGIN: u64 = 2000;
/// Cycles for which a fault may last.
const LASTS: u64 = 3000;

/// Runs into a fault; what stopped the session, if it was stopped.
fn stop_of(fault: Fault, lasts: u64) -> Option<Stop> {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut bus = FaultyBus::new(&run.rig, NODE, 1);
    let injection = Injection { fault, begin: BEGIN, lasts, until: BEGIN + LASTS };
    inject(&session, &run, &mut bus, &injection).unwrap().stop
}

/// The signal, and the cycles since the fault began.
fn found(fault: Fault) -> Option<(Signal, u64)> {
    let stop = stop_of(fault, LASTS)?;
    assert_eq!(stop.node, Some(1));
    Some((stop.cause.signal, stop.cycle - BEGIN))
}

#[test]
fn without_a_fault_nothing_stops() {
    assert_eq!(stop_of(Fault::Duplicate, 0), None);
}

#[test]
fn four_of_five_measurements_lost_ended_as_completed() {
    let (signal, cycles) = found(Fault::LoseMeasurements { lost: 4, of: 5 }).unwrap();
    assert!(signal == Signal::LostMeasurements && cycles <= 13, "{signal:?} {cycles}");
}

#[test]
fn measurements_that_all_had_a_wrong_crc_were_reported_as_lost() {
    let stop = stop_of(Fault::FlipBits { bits: 1, every: 1 }, LASTS).unwrap();
    // The fifth cycle with it.
    assert_eq!((stop.cause.signal, stop.cycle), (Signal::WrongSeal, BEGIN + 4));
    let text = "rig node 1: measurements with a wrong CRC 5 cycles, limit 5 cycles";
    assert!(stop.to_string().ends_with(text), "{stop}");
}

#[test]
fn a_force_ten_cycles_old_was_believed() {
    let cause = found(Fault::Delay(10));
    assert!(cause.is_some_and(|(_, cycles)| cycles <= 6), "{cause:?}");
}

#[test]
fn a_frozen_and_a_zero_force_ended_as_completed() {
    for force_n in [8000.0, 0.0] {
        let (signal, cycles) = found(Fault::StuckForce(force_n)).unwrap();
        assert!(signal == Signal::StuckForce && cycles < 300, "{force_n}: {signal:?} {cycles}");
    }
}

#[test]
fn a_reversed_force_ended_as_completed() {
    let (signal, cycles) = found(Fault::ScaleForce(-1.0)).unwrap();
    assert!(signal == Signal::Work && cycles < 1000, "{signal:?} {cycles}");
}

#[test]
fn spikes_of_99_kn_ended_as_completed_and_moved_the_vehicle() {
    // One spike is held over; losses of every other cycle end the run.
    let cause = found(Fault::SpikeForce(99e3));
    assert!(cause.is_some_and(|(_, cycles)| cycles < 40), "{cause:?}");
    let (signal, cycles) = found(Fault::StuckForce(99.9e3)).unwrap();
    assert!(matches!(signal, Signal::Force | Signal::ForceRate) && cycles <= 3, "{cycles}");
}

#[test]
fn a_displacement_off_by_a_millimetre_frozen_or_missing_was_never_noticed() {
    let off = found(Fault::OffsetDisplacement(1e-3));
    assert!(
        off.is_some_and(|(signal, cycles)| signal == Signal::Velocity && cycles <= 2),
        "{off:?}"
    );
    let frozen = found(Fault::StuckDisplacement(1e-3));
    assert!(frozen.is_some(), "{frozen:?}");
    let missing = found(Fault::InvalidDisplacement);
    assert_eq!(missing.map(|(signal, _)| signal), Some(Signal::InvalidDisplacement));
    let away = found(Fault::StuckDisplacement(60e-3));
    assert!(away.is_some_and(|(_, cycles)| cycles <= 2), "{away:?}");
}

#[test]
fn an_emergency_stop_and_a_fault_that_the_rig_reports_were_never_read() {
    let stopped = found(Fault::Trips(Trips::EMERGENCY_STOP));
    assert!(stopped.is_some_and(|(signal, n)| signal == Signal::RigTrip && n <= 1), "{stopped:?}");
    let failed = found(Fault::ReportFault);
    assert!(failed.is_some_and(|(signal, n)| signal == Signal::RigFault && n <= 1), "{failed:?}");
}

#[test]
fn a_bus_without_room_twice_in_a_row_ends_the_run() {
    assert_eq!(stop_of(Fault::NoRoom { full: 1, of: 20 }, LASTS), None);
    let stop = stop_of(Fault::NoRoom { full: 2, of: u64::MAX }, LASTS).unwrap();
    assert_eq!((stop.cause.signal, stop.cause.action), (Signal::BusQueue, Action::RampOut));
    assert_eq!(stop.cycle, BEGIN + 1);
}
