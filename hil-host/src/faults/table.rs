//! The faults that have a name, with what is expected of each.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, in_memory, inject, nodes};
use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::End;
use can_protocol::{MeasurementFlags as Flags, RunState, Trips};
use firmware_core::supervision::{Action, Signal};
use scenario::run::Run;

/// What is expected of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Expected {
    /// The run goes on.
    GoesOn,
    /// One of these signals ends it, so many cycles after its beginning at most: in the safe state,
    /// or ramped out where that is what the signal asks for.
    Ends(&'static [Signal], u64),
    /// One of these signals has the rig drop out in the same way, and the vehicle goes on.
    DropsOut(&'static [Signal], u64),
    /// The same, and the run is ramped out: no rig is left.
    RampsOut(&'static [Signal], u64),
}

/// A fault with its expected outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Number in the list of faults.
    pub number: u8,
    /// In words.
    pub what: &'static str,
    /// The fault.
    pub fault: Fault,
    /// Cycles that it lasts.
    pub lasts: u64,
    /// What is expected.
    pub expected: Expected,
}

use Expected::{Ends, GoesOn};
use Signal as S;

const EVER: u64 = u64::MAX;

const fn row(number: u8, what: &'static str, fault: Fault, lasts: u64, expected: Expected) -> Row {
    Row { number, what, fault, lasts, expected }
}

const fn lose(lost: u64, of: u64) -> Fault {
    Fault::LoseMeasurements { lost, of }
}

const fn lose_commands(lost: u64, of: u64) -> Fault {
    Fault::LoseCommands { lost, of }
}

/// Losses at random in one direction.
const fn lose_at_random(measurements: f64, commands: f64) -> Fault {
    Fault::LoseAtRandom { measurements, commands }
}

const fn old(age: usize, every: u64) -> Fault {
    Fault::OldFrame { age, every }
}

const fn flip(bits: u32, every: u64) -> Fault {
    Fault::FlipBits { bits, every }
}

const fn no_room(full: u64, of: u64) -> Fault {
    Fault::NoRoom { full, of }
}

/// A row of a fault that lasts for ever.
const fn for_ever(number: u8, what: &'static str, fault: Fault, expected: Expected) -> Row {
    row(number, what, fault, EVER, expected)
}

const LOST: &[Signal] = &[S::LostMeasurements];
const LOST_EITHER_WAY: &[Signal] = &[S::LostCommands, S::LostMeasurements];
const LOST_OR_OLD: &[Signal] = &[S::LostMeasurements, S::OldMeasurements];
/// Frames that fail their CRC, unless one passes by chance.
const LOST_OR_FOREIGN: &[Signal] = &[S::LostMeasurements, S::WrongSeal, S::SecondSender];
/// The rig may stop first, and say so.
const NO_COMMANDS: &[Signal] =
    &[S::LostCommands, S::LostMeasurements, S::OldMeasurements, S::RigState, S::RigFault];
const OF_FORCE: &[Signal] = &[S::Force, S::ForceRate];
const OF_MOTION: &[Signal] = &[S::Velocity, S::Tracking];

/// The table.
pub const ROWS: [Row; 90] = [
    for_ever(1, "one measurement lost", lose(1, EVER), GoesOn),
    for_ever(2, "1 of 100 measurements lost", lose(1, 100), GoesOn),
    for_ever(2, "1 of 10 measurements lost", lose(1, 10), Ends(LOST, 500)),
    for_ever(2, "10 % of measurements lost", lose_at_random(0.1, 0.0), Ends(LOST, 500)),
    for_ever(2, "20 % of measurements lost", lose_at_random(0.2, 0.0), Ends(LOST, 250)),
    for_ever(2, "30 % of measurements lost", lose_at_random(0.3, 0.0), Ends(LOST, 150)),
    for_ever(2, "4 of 5 measurements lost", lose(4, 5), Ends(LOST, 13)),
    for_ever(2, "1 of 100 commands lost", lose_commands(1, 100), GoesOn),
    for_ever(2, "10 % of commands lost", lose_at_random(0.0, 0.1), Ends(LOST_EITHER_WAY, 500)),
    for_ever(2, "1 of 2 commands lost", lose_commands(1, 2), Ends(LOST_EITHER_WAY, 20)),
    for_ever(2, "3 commands lost in a row", lose_commands(3, EVER), GoesOn),
    for_ever(3, "3 measurements lost in a row", lose(3, EVER), GoesOn),
    for_ever(3, "4 measurements lost in a row", lose(4, EVER), GoesOn),
    for_ever(3, "5 measurements lost in a row", lose(5, EVER), Ends(LOST, 6)),
    for_ever(3, "10 measurements lost in a row", lose(10, EVER), Ends(LOST, 6)),
    for_ever(3, "measurements lost for ever", lose(1, 1), Ends(LOST, 6)),
    for_ever(3, "4 commands lost in a row", lose_commands(4, EVER), GoesOn),
    for_ever(3, "5 commands lost in a row", lose_commands(5, EVER), Ends(NO_COMMANDS, 12)),
    for_ever(3, "commands lost for ever", lose_commands(1, 1), Ends(NO_COMMANDS, 12)),
    for_ever(4, "measurements 1 cycle late", Fault::Delay(1), GoesOn),
    for_ever(4, "measurements 2 cycles late", Fault::Delay(2), GoesOn),
    for_ever(4, "measurements 3 cycles late", Fault::Delay(3), GoesOn),
    for_ever(4, "measurements 5 cycles late at once", Fault::Delay(5), Ends(LOST_OR_OLD, 7)),
    for_ever(4, "measurements 10 cycles late at once", Fault::Delay(10), Ends(LOST_OR_OLD, 12)),
    for_ever(4, "a cycle later every 100 cycles", Fault::Creep(100), Ends(LOST_OR_OLD, 620)),
    // A quarter of the cycles has no new measurement.
    for_ever(5, "at random in its cycle or the next", Fault::Jitter, Ends(LOST, 250)),
    for_ever(6, "every measurement twice", Fault::Duplicate, GoesOn),
    for_ever(6, "copies of one measurement only", Fault::OnlyDuplicates, Ends(LOST_OR_OLD, 7)),
    for_ever(7, "every two measurements swapped", Fault::SwapPairs, Ends(LOST, 20)),
    for_ever(7, "a measurement 1 cycle old before every tenth", old(1, 10), GoesOn),
    for_ever(7, "a measurement 5 cycles old before every tenth", old(5, 10), GoesOn),
    for_ever(7, "a measurement 10 cycles old before every tenth", old(10, 10), GoesOn),
    // The next three are sealed by chance once in 256.
    for_ever(7, "a measurement 14 cycles old, every 500", old(14, 500), GoesOn),
    for_ever(7, "a measurement 15 cycles old, every 500", old(15, 500), GoesOn),
    for_ever(7, "a measurement 16 cycles old, every 500", old(16, 500), GoesOn),
    for_ever(7, "a measurement 30 cycles old, every 500", old(30, 500), GoesOn),
    for_ever(8, "1 bit flipped in every hundredth measurement", flip(1, 100), GoesOn),
    for_ever(8, "1 bit flipped in every measurement", flip(1, 1), Ends(LOST_OR_FOREIGN, 6)),
    for_ever(8, "4 bits flipped in every measurement", flip(4, 1), Ends(LOST_OR_FOREIGN, 8)),
    for_ever(8, "8 bits flipped in every tenth", flip(8, 10), Ends(LOST_OR_FOREIGN, 500)),
    for_ever(8, "random bytes in every measurement", Fault::Garbage(1), Ends(LOST_OR_FOREIGN, 8)),
    for_ever(
        8,
        "random bytes next to every measurement",
        Fault::GarbageBeside,
        Ends(&[S::SecondSender], 3),
    ),
    for_ever(
        9,
        "counter stuck, data go on",
        Fault::StuckCounter,
        Ends(&[S::LostMeasurements, S::OldMeasurements, S::SecondSender], 7),
    ),
    for_ever(10, "force stuck at 8 kN", Fault::StuckForce(8e3), Ends(&[S::StuckForce], 300)),
    for_ever(10, "force zero", Fault::StuckForce(0.0), Ends(&[S::StuckForce], 300)),
    for_ever(
        10,
        "displacement stuck",
        Fault::StuckDisplacement(1e-3),
        Ends(&[S::StuckDisplacement, S::Velocity, S::Tracking], 300),
    ),
    for_ever(
        10,
        "force and displacement stuck",
        Fault::StuckSensors,
        Ends(&[S::StuckForce, S::StuckDisplacement, S::Tracking], 300),
    ),
    for_ever(11, "another rig under this id", Fault::OtherRig, Ends(LOST_OR_FOREIGN, 6)),
    for_ever(
        11,
        "a second sender with the plain CRC",
        Fault::PlainSender,
        Ends(&[S::SecondSender], 3),
    ),
    for_ever(
        11,
        "a second sender one counter ahead, 30 kN",
        Fault::SenderAhead(30e3),
        Ends(&[S::SecondSender], 2),
    ),
    for_ever(
        11,
        "somebody else commands with the plain CRC",
        Fault::PlainCommander,
        Ends(&[S::RigFault, S::SecondSender], 2),
    ),
    row(12, "force invalid in one cycle", Fault::InvalidForce, 1, GoesOn),
    for_ever(12, "force invalid for ever", Fault::InvalidForce, Ends(&[S::InvalidForce], 6)),
    for_ever(
        12,
        "displacement missing",
        Fault::InvalidDisplacement,
        Ends(&[S::InvalidDisplacement], 6),
    ),
    for_ever(12, "99.9 kN for ever", Fault::StuckForce(99.9e3), Ends(OF_FORCE, 3)),
    for_ever(12, "104 kN, the end of the range", Fault::StuckForce(104e3), Ends(OF_FORCE, 3)),
    for_ever(
        12,
        "99 kN in every other cycle",
        Fault::SpikeForce(99e3),
        Ends(&[S::LostMeasurements, S::Force, S::ForceRate], 40),
    ),
    for_ever(
        13,
        "force with the wrong sign",
        Fault::ScaleForce(-1.0),
        Ends(&[S::Work, S::Force, S::ForceRate], 1000),
    ),
    for_ever(
        13,
        "force ten times too large",
        Fault::ScaleForce(10.0),
        Ends(&[S::Force, S::ForceRate, S::Work], 300),
    ),
    for_ever(13, "force twice too large", Fault::ScaleForce(2.0), Ends(OF_FORCE, 4000)),
    for_ever(13, "force half as large", Fault::ScaleForce(0.5), GoesOn),
    for_ever(13, "force a tenth too large", Fault::ScaleForce(1.1), GoesOn),
    for_ever(13, "force 5 kN off", Fault::OffsetForce(5e3), GoesOn),
    for_ever(13, "force drifts by 100 N/s", Fault::DriftForce(0.1), GoesOn),
    for_ever(14, "displacement 1 mm off", Fault::OffsetDisplacement(1e-3), Ends(&[S::Velocity], 3)),
    for_ever(14, "displacement 60 mm off", Fault::OffsetDisplacement(60e-3), Ends(OF_MOTION, 3)),
    for_ever(
        14,
        "displacement with the wrong sign",
        Fault::ScaleDisplacement(-1.0),
        Ends(OF_MOTION, 300),
    ),
    for_ever(
        14,
        "displacement drifts by 2 mm/s",
        Fault::DriftDisplacement(2e-6),
        Ends(&[S::Tracking], 2600),
    ),
    for_ever(15, "bus down", Fault::Down, Ends(&[S::BusDown], 1)),
    row(15, "bus down for one cycle", Fault::Down, 1, Ends(&[S::BusDown], 1)),
    for_ever(17, "60 frames of others in every cycle", Fault::Flood, GoesOn),
    for_ever(
        18,
        "the rig starts anew",
        Fault::Reboot,
        Ends(&[S::LostMeasurements, S::SecondSender, S::RigState, S::SilentRig], 7),
    ),
    for_ever(18, "the rig is gone", Fault::Gone, Ends(LOST, 6)),
    // Clocks that are 500 ppm apart: once in 2000 cycles a measurement misses its own.
    for_ever(20, "clocks slip by a cycle in two seconds", lose(1, 2000), GoesOn),
    for_ever(21, "the host misses 1 slot", Fault::SkipSlots(1), GoesOn),
    for_ever(21, "the host misses 3 slots", Fault::SkipSlots(3), GoesOn),
    for_ever(
        21,
        "the host misses 10 slots",
        Fault::SkipSlots(10),
        Ends(&[S::RigState, S::RigFault], 2),
    ),
    for_ever(22, "no room on the bus in one cycle", no_room(1, EVER), GoesOn),
    for_ever(22, "no room on the bus once a second", no_room(1, 1000), GoesOn),
    for_ever(22, "no room on the bus in two cycles", no_room(2, EVER), Ends(&[S::BusQueue], 3)),
    for_ever(23, "flag of a limit", Fault::Flags(Flags::LIMIT_REACHED), GoesOn),
    for_ever(23, "flag of a lagging actuator", Fault::Flags(Flags::ACTUATOR_LAGGING), GoesOn),
    for_ever(23, "flag of a saturated value", Fault::Flags(Flags::SATURATED), GoesOn),
    for_ever(
        23,
        "flag of an invalid sensor",
        Fault::Flags(Flags::SENSOR_INVALID),
        Ends(&[S::InvalidForce], 6),
    ),
    for_ever(
        25,
        "emergency stop in telemetry",
        Fault::Trips(Trips::EMERGENCY_STOP),
        Ends(&[S::RigTrip], 2),
    ),
    for_ever(
        25,
        "open guard in telemetry",
        Fault::Trips(Trips::GUARD_OPEN),
        Ends(&[S::RigTrip], 2),
    ),
    for_ever(25, "FAULT frame", Fault::ReportFault, Ends(&[S::RigFault], 2)),
    for_ever(25, "heartbeat in FAULT", Fault::Heartbeat(RunState::Fault), Ends(&[S::RigState], 2)),
    row(25, "one measurement in SAFE", Fault::Says(RunState::Safe), 1, Ends(&[S::RigState], 2)),
    row(25, "one measurement in FAULT", Fault::Says(RunState::Fault), 1, Ends(&[S::RigState], 2)),
];

/// Cycle in which the faults of the table begin: the vehicle runs on rough track.
pub(super) const BEGIN: u64 = 4000;

/// Cycles that a run goes on after that.
const WATCHED: u64 = 4000;

/// Injects every fault of the table, one session each.
///
/// # Errors
/// The scenario has no rig, or its rig cannot be armed.
pub fn table(run: &Run, mut each: impl FnMut(&Row, &Injected, bool)) -> Result<bool, BenchError> {
    in_memory(run, |session, node| {
        let mut all_right = true;
        for row in &ROWS {
            let seed = u64::from(row.number);
            let mut bus = FaultyBus::new(&run.rig, node, seed).beside(nodes(session));
            let Row { fault, lasts, .. } = *row;
            let injection = Injection { fault, begin: BEGIN, lasts, until: BEGIN + WATCHED };
            let injected = inject(session, run, &mut bus, &injection)
                .map_err(|why| why.on(&BusChoice::Memory))?;
            let is_right = row.expected.is_met_by(&injected);
            all_right &= is_right;
            each(row, &injected, is_right);
        }
        Ok(all_right)
    })
}

impl Expected {
    /// Whether a fault had this outcome, and every invariant held.
    pub fn is_met_by(self, injected: &Injected) -> bool {
        let is_found = |signals: &[Signal], within: u64| {
            injected.found().is_some_and(|stop| signals.contains(&stop.cause.signal))
                && injected.cycles_to_detect().is_some_and(|cycles| cycles <= within)
        };
        let is_out = injected.dropped_out.is_some();
        let is_as_expected = match (self, injected.stop, injected.end) {
            (GoesOn, None, None) => injected.dropped_out.is_none(),
            (Ends(signals, within), Some(stop), Some(end)) => {
                let may_ramp_out = stop.cause.action == Action::RampOut;
                is_found(signals, within)
                    && injected.dropped_out.is_none()
                    && (end == End::Safe || (end == End::RampedOut && may_ramp_out))
            }
            // It follows nothing any more.
            (Self::DropsOut(signals, within), None, None) => {
                is_found(signals, within) && is_out && !follows(injected.rig)
            }
            // A rig in lock-step that hears nothing has no time to stop in.
            (Self::RampsOut(signals, within), Some(_), Some(End::RampedOut)) => {
                is_found(signals, within) && is_out
            }
            _ => false,
        };
        is_as_expected && injected.violation.is_none()
    }

    /// The cycles within which a fault is to be found.
    pub const fn within(self) -> Option<u64> {
        match self {
            GoesOn => None,
            Ends(_, within) | Self::DropsOut(_, within) | Self::RampsOut(_, within) => Some(within),
        }
    }
}

/// Whether a rig in this state follows commands.
const fn follows(state: RunState) -> bool {
    matches!(state, RunState::OpenLoop | RunState::RampIn | RunState::Run | RunState::RampOut)
}
