//! How well a ram follows.
//!
//! ```text
//! e = x_measured - x_command      tau = -<e v> / <v^2>      NRMSE = rms(e) / std(x_command)
//! ```
//! `v` is the velocity of the command and `tau` the delay that a pure lag would have: the part of
//! the error that goes with the velocity. A command carries the velocity, and a ram without any lag
//! runs on with it: its measurement that arrives in a cycle is the command that leaves in it.

use super::power::Power;

/// How well a ram follows, from commands and the measurements of the same cycles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tracking {
    /// Length of a cycle (s).
    cycle_s: f64,
    command: Power,
    command_sum_m: f64,
    commands: u64,
    error: Power,
    last_m: Option<f64>,
    with_rate: f64,
    rate2: f64,
    most_m: f64,
}

impl Tracking {
    /// That of no command yet, in cycles of `cycle_s`.
    pub(crate) fn new(cycle_s: f64) -> Self {
        debug_assert!(cycle_s > 0.0 && cycle_s.is_finite(), "a cycle of {cycle_s} s");
        Self {
            cycle_s,
            command: Power::default(),
            command_sum_m: 0.0,
            commands: 0,
            error: Power::default(),
            last_m: None,
            with_rate: 0.0,
            rate2: 0.0,
            most_m: 0.0,
        }
    }

    pub(crate) fn take(&mut self, command_m: f64, measured_m: f64) {
        self.command.take(command_m);
        self.command_sum_m += command_m;
        self.commands += 1;
        let Some(before_m) = self.last_m.replace(command_m) else { return };
        let (error, rate) = (measured_m - command_m, (command_m - before_m) / self.cycle_s);
        if !error.is_finite() {
            return;
        }
        self.with_rate += error * rate;
        self.rate2 += rate * rate;
        self.error.take(error);
        self.most_m = self.most_m.max(error.abs());
    }

    /// The delay of a pure lag (s).
    pub(crate) fn delay_s(&self) -> f64 {
        -self.with_rate / self.rate2
    }

    /// Rms of the error (m).
    pub(crate) fn rms_m(&self) -> f64 {
        self.error.rms()
    }

    /// The same over the standard deviation of the command: where the motion is on the stroke does
    /// not matter.
    pub(crate) fn nrmse(&self) -> f64 {
        self.rms_m() / self.deviation_m()
    }

    /// Frequency of a sine with the deviation and the speed of the command (Hz).
    pub(crate) fn frequency_hz(&self) -> f64 {
        let rate2 = self.rate2 / self.commands.saturating_sub(1).max(1) as f64;
        rate2.sqrt() / (std::f64::consts::TAU * self.deviation_m())
    }

    /// Standard deviation of the command (m).
    fn deviation_m(&self) -> f64 {
        let mean_m = self.command_sum_m / self.commands.max(1) as f64;
        let variance_m2 = self.command.rms().powi(2) - mean_m.powi(2);
        variance_m2.max(0.0).sqrt()
    }

    /// The largest error (m).
    pub(crate) const fn most_m(&self) -> f64 {
        self.most_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::run::CYCLE_S;

    #[test]
    fn a_sine_that_comes_two_milliseconds_late_has_that_delay() {
        let at = |n: f64| 3.46e-3 * libm::sin(2.0 * core::f64::consts::PI * 3.5 * n * CYCLE_S);
        let mut tracking = Tracking::new(CYCLE_S);
        for n in (0..4000).map(f64::from) {
            tracking.take(at(n), at(n - 2.0));
        }
        assert!((tracking.delay_s() - 2e-3).abs() < 3e-5, "{tracking:?}");
        assert!((tracking.frequency_hz() - 3.5).abs() < 0.01, "{tracking:?}");
        // w tau = 4.4 %.
        assert!((tracking.nrmse() - 0.044).abs() < 1e-3, "{tracking:?}");
        // 40 mm away from the middle it is the same.
        let mut away = Tracking::new(CYCLE_S);
        for n in (0..4000).map(f64::from) {
            away.take(at(n) + 40e-3, at(n - 2.0) + 40e-3);
        }
        assert!((away.nrmse() - tracking.nrmse()).abs() < 1e-9, "{away:?}");
    }
}
