//! How well every rig followed, and what its damper did against its model.
//!
//! ```text
//! e = x_measured - x_command      tau = -<e v> / <v^2>      NRMSE = rms(e) / rms(x_command)
//! ```
//! `v` is the velocity of the command and `tau` the delay that a pure lag would have: the part of
//! the error that goes with the velocity. A command carries the velocity, and a ram without any lag
//! runs on with it: its measurement that arrives in a cycle is the command that leaves in it.

use super::traces::{kilo, milli};
use crate::columns::Columns;
use report::{Cell, Plot, Section, Table};
use scenario::run::{CYCLE_S, Run, SlotForce};
use signal::statistics;

/// The rigs of a run from the row `first` on; none where there is no rig.
pub(super) fn rigs(run: &Run, columns: &Columns, first: usize) -> Option<Section> {
    let time = &columns.time_s[first..];
    let mut section = Section::new("Rigs");
    let mut table = Table::new("Tracking")
        .text("damper")
        .number("delay", "ms")
        .number("error rms", "mm")
        .number("NRMSE", "%")
        .number("error max", "mm")
        .number("force less model, rms", "N");
    let mut any = false;
    for (slot, place) in run.slots.iter().enumerate() {
        if !matches!(place.force, SlotForce::Rig { .. }) || time.len() < 2 {
            continue;
        }
        any = true;
        let command = &columns.command_m[slot][first..];
        let measured = &columns.measured_m[slot][first..];
        let (force, model) = (&columns.measured_n[slot][first..], &columns.model_n[slot][first..]);
        let tracking = Tracking::of(command, measured);
        let residual: Vec<f64> =
            force.iter().zip(model).map(|(f, m)| f - m).filter(|r| r.is_finite()).collect();
        table = table.row([
            Cell::from(place.place.as_str()),
            (tracking.delay_s * 1e3).into(),
            (tracking.rms_m * 1e3).into(),
            (tracking.nrmse * 1e2).into(),
            (tracking.most_m * 1e3).into(),
            statistics::rms(&residual).into(),
        ]);
        let error: Vec<f64> = command.iter().zip(measured).map(|(c, m)| m - c).collect();
        section = section
            .plot(
                Plot::new(&format!("Stroke of {}", place.place))
                    .x("time", "s")
                    .y("displacement", "mm")
                    .line("command", time, &milli(command))
                    .line("measured", time, &milli(measured))
                    .panel_below("error", "mm")
                    .line("measured less command", time, &milli(&error)),
            )
            .plot(
                Plot::new(&format!("Force of {} and of its model", place.place))
                    .x("time", "s")
                    .y("force", "kN")
                    .line("measured", time, &kilo(force))
                    .line("model", time, &kilo(model)),
            );
    }
    any.then(|| section.table(table))
}

/// How well a ram follows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tracking {
    delay_s: f64,
    rms_m: f64,
    nrmse: f64,
    most_m: f64,
}

impl Tracking {
    /// From commands and the measurements of the same cycles.
    fn of(command: &[f64], measured: &[f64]) -> Self {
        let (mut with_rate, mut rate2, mut error2, mut most_m) = (0.0, 0.0, 0.0, 0.0_f64);
        let mut count = 0.0;
        for (pair, measured_m) in command.windows(2).zip(measured.iter().skip(1)) {
            let (error, rate) = (measured_m - pair[1], (pair[1] - pair[0]) / CYCLE_S);
            if !error.is_finite() {
                continue;
            }
            with_rate += error * rate;
            rate2 += rate * rate;
            error2 += error * error;
            most_m = most_m.max(error.abs());
            count += 1.0;
        }
        let rms_m = libm::sqrt(error2 / f64::max(count, 1.0));
        Self { delay_s: -with_rate / rate2, rms_m, nrmse: rms_m / statistics::rms(command), most_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_that_comes_two_milliseconds_late_has_that_delay() {
        let at = |n: f64| 3.46e-3 * libm::sin(2.0 * core::f64::consts::PI * 3.5 * n * CYCLE_S);
        let command: Vec<f64> = (0..4000).map(|n| at(f64::from(n))).collect();
        let measured: Vec<f64> = (0..4000).map(|n| at(f64::from(n) - 2.0)).collect();
        let tracking = Tracking::of(&command, &measured);
        assert!((tracking.delay_s - 2e-3).abs() < 3e-5, "{tracking:?}");
        // w tau = 4.4 %.
        assert!((tracking.nrmse - 0.044).abs() < 1e-3, "{tracking:?}");
    }
}
