//! The controller of the published table: proportional and integral, behind a phase lead.

/// Proportional gain.
const PROPORTIONAL: f64 = 2.0;
/// Integral gain, 1/s.
const INTEGRAL_PER_S: f64 = 95.0;
/// The lead is `(LEAD s + CORNER) / (s + CORNER)`.
const LEAD: f64 = 50.8316;
/// Corner of the lead, 1/s.
const CORNER_PER_S: f64 = 8570.397;

/// The controller with its memory, discretised by the bilinear transform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Baseline {
    step_s: f64,
    wanted_m: f64,
    led_m: f64,
    error_m: f64,
    integral_m: f64,
}

impl Baseline {
    /// The controller at rest.
    pub(crate) const fn new(step_s: f64) -> Self {
        Self { step_s, wanted_m: 0.0, led_m: 0.0, error_m: 0.0, integral_m: 0.0 }
    }

    /// The command, m, for a wanted and a measured displacement.
    pub(crate) fn command_m(&mut self, wanted_m: f64, measured_m: f64) -> f64 {
        let bilinear = 2.0 / self.step_s;
        let rising = (LEAD * bilinear + CORNER_PER_S) * wanted_m;
        let before = (CORNER_PER_S - LEAD * bilinear) * self.wanted_m;
        let memory = (CORNER_PER_S - bilinear) * self.led_m;
        self.led_m = (rising + before - memory) / (bilinear + CORNER_PER_S);
        self.wanted_m = wanted_m;
        let error_m = self.led_m - measured_m;
        self.integral_m += INTEGRAL_PER_S * (error_m + self.error_m) / bilinear;
        self.error_m = error_m;
        PROPORTIONAL * error_m + self.integral_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_led_and_integrated() {
        let step_s = 1.0 / 4096.0;
        let mut baseline = Baseline::new(step_s);
        let last = (0..4096).map(|_| baseline.command_m(1e-3, 0.0)).last().unwrap();
        // Proportional, a second of the integral, and the integral of what the lead adds.
        let expected = (2.0 + 95.0 + 95.0 * (50.8316 - 1.0) / 8570.397) * 1e-3;
        assert!((last - expected).abs() < 2e-5, "{last}, {expected}");
    }
}
