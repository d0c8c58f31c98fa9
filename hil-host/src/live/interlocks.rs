//! How far the signals of every rig have come towards their limits, computed from the record.
//!
//! The loop judges what a rig sends by the checks of [`firmware_core::supervision`]. The page must
//! not ask the loop, so the same code judges the rows of the record once more, on the recorder's
//! thread:
//!
//! ```text
//! row -> what arrived, its age, the command that was sent -> Belief -> largest value / limit
//! ```
//!
//! A row holds the age of a measurement and no counters; these are made up so that they give that
//! age. Rows that the recorder has lost are missing here too: what the loop has found is in the
//! cause that it gives itself.
//!
//! The limits of commands are judged by the commands that were sent. One that was cut stands at its
//! limit; by how much it was beyond `yawbench rehearse` says.

use super::board::Interlock;
use crate::control::Agreed;
use crate::record::{InputKind, Row};
use can_protocol::{MeasurementFlags, RunState};
use firmware_core::command::Command;
use firmware_core::supervision::{
    Action, Arrival, Belief, Checks, Demand, Measured, OLDEST_CYCLES, Reached,
};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::BeyondLimits;

/// What holds for the rig of every slot that has one.
pub(crate) type AgreedLimits = [Option<Agreed>; DAMPER_SLOTS];

/// Range of the counters that are made up.
const MODULUS: u8 = 255;

/// In the record: no measurement is believed yet.
const NO_AGE: u8 = u8::MAX;

/// The checks of all rigs, as the rows show them.
#[derive(Debug, Default)]
pub(super) struct Interlocks {
    beliefs: [Belief; DAMPER_SLOTS],
    /// The last command of every rig, and what all of them have asked of the rams.
    commands: [(Command, Demand); DAMPER_SLOTS],
    /// State and forces of the models after the last cycle.
    last: Option<(RunState, [f64; DAMPER_SLOTS])>,
    /// Ticks since the begin, of which the made-up counters are the rest.
    ticks: u64,
}

impl Interlocks {
    /// Takes in the row of a cycle.
    pub(super) fn take(&mut self, row: &Row, agreed: &AgreedLimits) {
        self.ticks += u64::from(row.skipped) + 1;
        for (slot, (belief, agreed)) in self.beliefs.iter_mut().zip(agreed).enumerate() {
            let Some(Agreed { checks, limits, .. }) = agreed else { continue };
            let checks = &Checks { counter_modulus: MODULUS, ..*checks };
            let command = Command {
                displacement_m: row.command_m[slot],
                velocity_m_per_s: row.command_m_per_s[slot],
            };
            let (last, demand) = &mut self.commands[slot];
            if self.last.is_none() {
                belief.begin(command);
                *last = command;
            }
            *demand = demand.larger(limits.limited(*last, command, checks.cycle_s).demand);
            *last = command;
            if row.skipped > 0 {
                belief.skip(row.skipped);
            }
            if row.temperature_degc[slot].is_finite() {
                belief.temperature(checks, row.temperature_degc[slot]);
            }
            belief.take(checks, arrival(row, slot, self.ticks), Some(counter(row.cycle)));
            if let Some((RunState::Run, models_n)) = self.last
                && row.state == RunState::Run
                && row.input[slot] == InputKind::Fresh
            {
                belief.residual(checks, row.measured_n[slot] - models_n[slot]);
            }
            belief.sent(command);
        }
        self.last = Some((row.state, row.model_n));
    }

    /// How far each has come.
    pub(super) fn reached(&self, agreed: &AgreedLimits) -> Vec<Interlock> {
        let mut found = Vec::new();
        for (slot, (belief, agreed)) in self.beliefs.iter().zip(agreed).enumerate() {
            let Some(agreed) = agreed else { continue };
            found.extend(belief.reached(&agreed.checks).map(|reached| interlock(slot, &reached)));
            found.extend(of_commands(slot, agreed, self.commands[slot].1));
        }
        found
    }
}

/// How far the commands of a slot have come towards their limits.
fn of_commands(slot: usize, agreed: &Agreed, demand: Demand) -> [Interlock; 3] {
    let (limits, cycle_s) = (agreed.limits, agreed.checks.cycle_s);
    let action = match agreed.beyond_limits {
        BeyondLimits::Saturate => "cut",
        BeyondLimits::Stop => "stop",
    };
    [
        ("command_stroke", "m", demand.stroke_m, limits.stroke_m),
        ("command_velocity", "m/s", demand.velocity_m_per_s, limits.velocity_m_per_s),
        (
            "command_acceleration",
            "m/s2",
            demand.speed_change_m_per_s / cycle_s,
            limits.acceleration_m_per_s2,
        ),
    ]
    .map(|(key, unit, largest, limit)| {
        let (unit, largest) = (Some(unit), Some(largest));
        let reached = Reached { key, unit, largest, limit, has_tripped: false, action: None };
        Interlock { action: Some(action), ..interlock(slot, &reached) }
    })
}

fn interlock(slot: usize, reached: &Reached) -> Interlock {
    let finite = |value: f64| value.is_finite().then_some(value);
    Interlock {
        slot,
        check: reached.key,
        unit: reached.unit,
        largest: reached.largest.and_then(finite),
        limit: finite(reached.limit),
        margin_percent: reached.margin().map(|margin| 100.0 * margin).and_then(finite),
        has_tripped: reached.has_tripped,
        action: reached.action.map(Action::name),
    }
}

/// A made-up counter.
const fn counter(number: u64) -> u8 {
    (number % MODULUS as u64) as u8
}

/// What arrived for a slot in a cycle.
fn arrival(row: &Row, slot: usize, ticks: u64) -> Arrival {
    let has_frame = row.frame[slot].iter().any(|byte| *byte != 0);
    match row.input[slot] {
        InputKind::NoRig => return Arrival::Nothing,
        InputKind::Missing if !has_frame => return Arrival::Nothing,
        InputKind::Invalid if !has_frame => return Arrival::Damaged,
        InputKind::Fresh | InputKind::Missing | InputKind::Invalid => {}
    }
    let age = row.age_cycles[slot];
    // A frame that was not believed to be new was too old, or answered nothing yet.
    let is_old = row.input[slot] == InputKind::Missing || age > OLDEST_CYCLES;
    let answered = if is_old { u64::from(OLDEST_CYCLES) + 1 } else { u64::from(age) };
    let echo = counter(row.cycle + u64::from(MODULUS) - answered);
    let finite = |value: f64| value.is_finite().then_some(value);
    let flags = MeasurementFlags::from_bits_truncate(row.rig_flags[slot]);
    let state = RunState::from_code(row.rig_state[slot]);
    Arrival::Frame(Measured {
        counter: counter(ticks),
        echo: (age != NO_AGE).then_some(echo),
        displacement_m: finite(row.measured_m[slot]),
        force_n: finite(row.measured_n[slot]),
        is_valid: !flags.contains(MeasurementFlags::SENSOR_INVALID),
        runs: state.is_some_and(RunState::moves),
    })
}

#[cfg(test)]
mod tests;
