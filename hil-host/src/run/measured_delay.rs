//! Before anything moves: what compensation leaves of the delay that an open loop has measured.
//!
//! ```text
//! tau = tau_ram - a1 / a0        compensated for a1 / a0
//! tau = tau_ram - T / 2          not compensated
//! ```
//! An adaptive compensator follows the rig as far as its reach. The gate before RUN measures again;
//! this check says it before the rig is armed, and has the run keep where its delay is from.

use crate::BenchError;
use crate::control::{COST_REFUSED, COST_WARNED};
use crate::linear_vehicle::LinearVehicle;
use crate::measured_ram::{MeasuredRam, MeasuredRams};
use crate::options::RunOptions;
use firmware_core::compensation::{Compensator, damping_energy_lost};
use firmware_core::line::{KNOWN_DELAY_CYCLES, Sensitivity};
use scenario::run::{Run, SlotForce};
use serde::{Deserialize, Serialize};

/// How late the ram of a rig was before a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct KnownRam {
    /// The slot.
    place: String,
    /// The delay, of several the one that costs most.
    #[serde(flatten)]
    ram: MeasuredRam,
}

/// Prints one line for each rig of a run whose delay was measured before; what is kept of it.
///
/// # Errors
/// What is left costs more of the damping than the gate before RUN lets through; the delays are
/// those of other rigs, or of other motions.
pub(super) fn pass(run: &Run, options: &RunOptions) -> Result<Vec<KnownRam>, BenchError> {
    let (Some(rams), Some(linear)) = (&options.measured, &options.linear) else {
        return Ok(Vec::new());
    };
    let judged = judge(run, rams, linear)?;
    let mut known = Vec::new();
    for (line, ram) in judged {
        files::say!("{line}");
        known.extend(ram);
    }
    Ok(known)
}

/// Judges every rig of a run by its measured delays: a line for each, and the delay.
///
/// # Errors
/// As [`pass`].
fn judge(
    run: &Run,
    rams: &MeasuredRams,
    linear: &LinearVehicle,
) -> Result<Vec<(String, Option<KnownRam>)>, BenchError> {
    let frequency_hz = linear.hunting.frequency_hz;
    let mut lines = Vec::new();
    for slot in &run.slots {
        let SlotForce::Rig { model, compensator, accept_delay_error, node, .. } = &slot.force
        else {
            continue;
        };
        let place = &slot.place;
        let Sensitivity { relaxation_s, .. } = Sensitivity::of(model, frequency_hz);
        let cost = |ram: &MeasuredRam| {
            let left_s = left_s(compensator, ram.delay_s, run.cycle_s());
            (left_s, damping_energy_lost(left_s, frequency_hz, relaxation_s))
        };
        let of_rig = rams.of_rig(place, *node, frequency_hz);
        let dearest =
            of_rig.iter().max_by(|one, other| cost(one).1.abs().total_cmp(&cost(other).1.abs()));
        let Some(ram) = dearest else {
            lines.push((format!("warning: {place}: the delay of its ram was not measured"), None));
            continue;
        };
        let (left_s, cost) = cost(ram);
        let effect = if left_s < 0.0 {
            let (lead_ms, gain) = (-1e3 * left_s, 100.0 * cost.abs());
            format!(
                "compensation takes {lead_ms:.3} ms too much, which adds {gain:.1} % of damping"
            )
        } else {
            let (late_ms, loss) = (1e3 * left_s, 100.0 * cost);
            format!("{late_ms:.3} ms are left, which cost {loss:.1} % of the damping")
        };
        let found = format!(
            "{}, the worst of {} near {frequency_hz:.1} Hz: a ram that is {:.3} ms late; {effect}",
            ram.source,
            of_rig.len(),
            1e3 * ram.delay_s
        );
        if cost.abs() > COST_REFUSED && !accept_delay_error {
            return Err(BenchError::MeasuredDelay { place: place.clone(), found });
        }
        let warning = if cost.abs() > COST_WARNED { "warning: " } else { "" };
        let known = KnownRam { place: place.clone(), ram: (*ram).clone() };
        lines.push((format!("{warning}{place}: {found}"), Some(known)));
    }
    if lines.iter().all(|(_, known)| known.is_none()) {
        return Err(BenchError::OtherRams { found: rams.found(), frequency_hz });
    }
    Ok(lines)
}

/// What a compensator leaves of the delay of a ram (s).
fn left_s(compensator: &Compensator, ram_s: f64, cycle_s: f64) -> f64 {
    let [gain, delay_s, ..] = compensator.series(&compensator.start()).0;
    match compensator {
        Compensator::None => ram_s + KNOWN_DELAY_CYCLES * cycle_s,
        Compensator::Feedforward(_) => ram_s - delay_s / gain,
        Compensator::Adaptive(adaptive) => {
            let [_, reach, _] = adaptive.reach;
            let off_s = ram_s - delay_s / gain;
            (off_s.abs() - reach).max(0.0).copysign(off_s)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::compensation::{Adaptive, Feedforward, Series};

    #[test]
    fn what_is_left_is_the_delay_that_no_compensator_is_made_for() {
        let made_for = |ms: f64| Compensator::Feedforward(Feedforward::polynomial(2, 1e-3 * ms));
        for (compensator, ram_ms, expected_ms) in [
            (Compensator::None, 0.5, 0.0),
            (Compensator::None, 5.5, 5.0),
            (made_for(5.4), 5.4, 0.0),
            (made_for(5.4), 4.4, -1.0),
            // Half of the delay and 2 ms are within reach.
            (Compensator::Adaptive(Adaptive::new(Series([1.0, 6e-3, 0.0, 0.0]), 60.0)), 9.0, 0.0),
            (Compensator::Adaptive(Adaptive::new(Series([1.0, 6e-3, 0.0, 0.0]), 60.0)), 12.0, 1.0),
        ] {
            let found_ms = 1e3 * left_s(&compensator, 1e-3 * ram_ms, 1e-3);
            assert!((found_ms - expected_ms).abs() < 1e-9, "{ram_ms}: {found_ms}, {expected_ms}");
        }
    }
}
