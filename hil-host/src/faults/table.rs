//! The faults that have a name, with what is expected of each.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, inject};
use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::End;
use crate::run::{Plan, Terms, session};
use can_protocol::{Node, Profile};
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

/// The table.
pub const ROWS: [Row; 42] = [
    row(1, "one measurement lost", lose(1, EVER), EVER, GoesOn),
    row(2, "1 of 100 measurements lost", lose(1, 100), EVER, GoesOn),
    row(2, "1 of 10 measurements lost", lose(1, 10), EVER, Ends(&[S::LostMeasurements], 500)),
    row(2, "4 of 5 measurements lost", lose(4, 5), EVER, Ends(&[S::LostMeasurements], 13)),
    row(2, "1 of 100 commands lost", lose_commands(1, 100), EVER, GoesOn),
    row(
        2,
        "1 of 2 commands lost",
        lose_commands(1, 2),
        EVER,
        Ends(&[S::LostCommands, S::LostMeasurements], 20),
    ),
    row(3, "4 measurements lost in a row", lose(4, EVER), EVER, GoesOn),
    row(3, "5 measurements lost in a row", lose(5, EVER), EVER, Ends(&[S::LostMeasurements], 6)),
    row(3, "measurements lost for ever", lose(1, 1), EVER, Ends(&[S::LostMeasurements], 6)),
    row(3, "4 commands lost in a row", lose_commands(4, EVER), EVER, GoesOn),
    row(
        3,
        "commands lost for ever",
        lose_commands(1, 1),
        EVER,
        Ends(
            &[S::LostCommands, S::LostMeasurements, S::OldMeasurements, S::RigState, S::RigFault],
            12,
        ),
    ),
    row(4, "measurements 1 cycle late", Fault::Delay(1), EVER, GoesOn),
    row(
        4,
        "measurements 10 cycles late",
        Fault::Delay(10),
        EVER,
        Ends(&[S::LostMeasurements, S::OldMeasurements], 12),
    ),
    row(6, "every measurement twice", Fault::Duplicate, EVER, GoesOn),
    row(7, "a measurement 10 cycles old before every tenth", Fault::OldFrame, EVER, GoesOn),
    row(8, "1 bit flipped in every hundredth measurement", Fault::FlipBit(100), EVER, GoesOn),
    row(
        8,
        "1 bit flipped in every measurement",
        Fault::FlipBit(1),
        EVER,
        Ends(&[S::LostMeasurements, S::SecondSender], 6),
    ),
    row(
        8,
        "random bytes in every measurement",
        Fault::Garbage(1),
        EVER,
        Ends(&[S::LostMeasurements, S::SecondSender], 8),
    ),
    row(
        9,
        "counter stuck",
        Fault::StuckCounter,
        EVER,
        Ends(&[S::LostMeasurements, S::OldMeasurements, S::SecondSender], 7),
    ),
    row(10, "force stuck at 8 kN", Fault::StuckForce(8e3), EVER, Ends(&[S::StuckForce], 300)),
    row(10, "force zero", Fault::StuckForce(0.0), EVER, Ends(&[S::StuckForce], 300)),
    row(
        10,
        "displacement stuck",
        Fault::StuckDisplacement(1e-3),
        EVER,
        Ends(&[S::StuckDisplacement, S::Velocity, S::Tracking], 300),
    ),
    row(
        11,
        "a second sender with the plain CRC",
        Fault::PlainSender,
        EVER,
        Ends(&[S::SecondSender], 3),
    ),
    row(
        11,
        "somebody else commands with the plain CRC",
        Fault::PlainCommander,
        EVER,
        Ends(&[S::RigFault, S::SecondSender], 2),
    ),
    row(12, "force invalid in one cycle", Fault::InvalidForce, 1, GoesOn),
    row(12, "force invalid for ever", Fault::InvalidForce, EVER, Ends(&[S::InvalidForce], 6)),
    row(
        12,
        "displacement missing",
        Fault::InvalidDisplacement,
        EVER,
        Ends(&[S::InvalidDisplacement], 6),
    ),
    row(
        12,
        "99.9 kN for ever",
        Fault::StuckForce(99.9e3),
        EVER,
        Ends(&[S::Force, S::ForceRate], 3),
    ),
    row(
        12,
        "99 kN in every other cycle",
        Fault::SpikeForce(99e3),
        EVER,
        Ends(&[S::LostMeasurements, S::Force, S::ForceRate], 40),
    ),
    row(
        13,
        "force with the wrong sign",
        Fault::ScaleForce(-1.0),
        EVER,
        Ends(&[S::Work, S::Force, S::ForceRate], 1000),
    ),
    row(
        13,
        "force ten times too large",
        Fault::ScaleForce(10.0),
        EVER,
        Ends(&[S::Force, S::ForceRate, S::Work], 300),
    ),
    row(13, "force a tenth too large", Fault::ScaleForce(1.1), EVER, GoesOn),
    row(
        14,
        "displacement 1 mm off",
        Fault::OffsetDisplacement(1e-3),
        EVER,
        Ends(&[S::Velocity], 3),
    ),
    row(
        14,
        "displacement 60 mm off",
        Fault::OffsetDisplacement(60e-3),
        EVER,
        Ends(&[S::Velocity, S::Tracking], 3),
    ),
    row(15, "bus down", Fault::Down, EVER, Ends(&[S::BusDown], 1)),
    row(17, "60 frames of others in every cycle", Fault::Flood, EVER, GoesOn),
    row(
        18,
        "the rig starts anew",
        Fault::Reboot,
        EVER,
        Ends(&[S::LostMeasurements, S::SecondSender, S::RigState, S::SilentRig], 7),
    ),
    row(22, "no room on the bus in one cycle", Fault::NoRoom { full: 1, of: EVER }, EVER, GoesOn),
    row(
        22,
        "no room on the bus in two cycles",
        Fault::NoRoom { full: 2, of: EVER },
        EVER,
        Ends(&[S::BusQueue], 3),
    ),
    row(23, "flag of a limit for ever", Fault::Flags, EVER, GoesOn),
    row(25, "emergency stop in telemetry", Fault::EmergencyStop, EVER, Ends(&[S::RigTrip], 2)),
    row(25, "a measurement in SAFE", Fault::SaysSafe, 1, Ends(&[S::RigState], 2)),
];

/// Cycle in which the faults of the table begin: the vehicle runs on rough track.
const BEGIN: u64 = 4000;

/// Cycles that a run goes on after that.
const WATCHED: u64 = 4000;

/// Injects every fault of the table, one session each.
///
/// # Errors
/// The scenario has no rig, or its rig cannot be armed.
pub fn table(run: &Run, mut each: impl FnMut(&Row, &Injected, bool)) -> Result<bool, BenchError> {
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &plan.rigs, Terms::in_memory(Profile::Classical))?;
    let node = plan.rigs.first().map_or(Node::ALL[0], |rig| rig.node);
    let mut all_right = true;
    for row in &ROWS {
        let mut bus = FaultyBus::new(&run.rig, node, u64::from(row.number));
        let injection =
            Injection { fault: row.fault, begin: BEGIN, lasts: row.lasts, until: BEGIN + WATCHED };
        let injected = inject(&session, run, &mut bus, &injection)
            .map_err(|why| why.on(&BusChoice::Memory))?;
        let is_right = row.expected.is_met_by(&injected);
        all_right &= is_right;
        each(row, &injected, is_right);
    }
    Ok(all_right)
}

impl Expected {
    /// Whether a fault had this outcome, and every invariant held.
    pub fn is_met_by(self, injected: &Injected) -> bool {
        let is_as_expected = match (self, injected.stop, injected.end) {
            (GoesOn, None, None) => true,
            (Ends(signals, within), Some(stop), Some(end)) => {
                let may_ramp_out = stop.cause.action == Action::RampOut;
                signals.contains(&stop.cause.signal)
                    && injected.cycles_to_detect().is_some_and(|cycles| cycles <= within)
                    && (end == End::Safe || (end == End::RampedOut && may_ramp_out))
            }
            _ => false,
        };
        is_as_expected && injected.violation.is_none()
    }
}
