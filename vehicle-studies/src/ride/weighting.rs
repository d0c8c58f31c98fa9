//! Frequency weightings of whole-body vibration: Wb for vertical, Wd for lateral acceleration.
//!
//! ```text
//! s^2/(s^2 + s w1/Q1 + w1^2)  w2^2/(s^2 + s w2/Q1 + w2^2)           band limits, 0.4 and 100 Hz
//! (1 + s/w3) / (1 + s/(Q4 w4) + (s/w4)^2)                           acceleration to velocity
//! (w5/w6)^2 (1 + s/(Q5 w5) + (s/w5)^2) / (1 + s/(Q6 w6) + (s/w6)^2)   step upward
//! ```
//! with `Q1 = 1/sqrt 2` and the numbers of ISO 8041-1 (the same as in BS 6841, ISO 2631-1 and -4,
//! and EN 12299). Applied as frequency responses ([`signal::response`]), so that no digital filter
//! has to stand for them.

use realfft::num_complex::Complex;
use signal::SignalError;
use signal::response::through;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Band limits (Hz).
const BAND_HZ: [f64; 2] = [0.4, 100.0];
/// A weighting has forgotten a blow after this (s).
const SETTLE_S: f64 = 5.0;

/// A weighting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weighting {
    /// Corner of the transition from acceleration to velocity (Hz).
    corner_hz: f64,
    /// Its quality.
    quality: f64,
    /// Lower and upper corner of the step upward with their qualities (Hz), where there is one.
    step: Option<[(f64, f64); 2]>,
    /// Factor on all of it.
    gain: f64,
}

impl Weighting {
    /// Vertical: ISO 2631-4, BS 6841.
    pub const WB: Self =
        Self { corner_hz: 16.0, quality: 0.55, step: Some([(2.5, 0.9), (4.0, 0.95)]), gain: 1.024 };
    /// Lateral and longitudinal: ISO 2631-1, BS 6841.
    pub const WD: Self = Self { corner_hz: 2.0, quality: 0.63, step: None, gain: 1.0 };

    /// Its frequency response.
    ///
    /// ```
    /// use vehicle_studies::ride::Weighting;
    /// assert!((Weighting::WD.response(1.0).norm() - 1.011).abs() < 5e-4);
    /// assert!((Weighting::WB.response(1.0).norm() - 0.385).abs() < 5e-4);
    /// ```
    pub fn response(&self, frequency_hz: f64) -> Complex<f64> {
        let s = Complex::new(0.0, TAU * frequency_hz);
        let [low, high] = BAND_HZ.map(|hz| TAU * hz);
        let poles = |w: f64| s * s + s * (w / FRAC_1_SQRT_2) + w * w;
        let band = s * s / poles(low) * (high * high) / poles(high);
        let second = |(hz, quality): (f64, f64)| {
            let w = TAU * hz;
            s / (quality * w) + s * s / (w * w) + 1.0
        };
        let velocity = (s / (TAU * self.corner_hz) + 1.0) / second((self.corner_hz, self.quality));
        let step = self.step.map_or(Complex::from(1.0), |[lower, upper]| {
            let ratio = lower.0 / upper.0;
            second(lower) / second(upper) * (ratio * ratio)
        });
        band * velocity * step * self.gain
    }

    /// A weighted signal.
    ///
    /// # Errors
    /// As for [`through`].
    pub fn apply(&self, values: &[f64], rate_hz: f64) -> Result<Vec<f64>, SignalError> {
        through(values, rate_hz, |hz| self.response(hz), SETTLE_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ISO 2631-1:1997, table 3: nominal frequency (Hz), Wk, Wd, in thousandths. Wd at 10 Hz stands
    /// there as 212; the formula, and the table's own neighbours, give 202.
    const ISO_2631_1: [(f64, f64, f64); 31] = [
        (0.1, 31.2, 62.4),
        (0.125, 48.6, 97.3),
        (0.16, 79.0, 158.0),
        (0.2, 121.0, 243.0),
        (0.25, 182.0, 365.0),
        (0.315, 263.0, 530.0),
        (0.4, 352.0, 713.0),
        (0.5, 418.0, 853.0),
        (0.63, 459.0, 944.0),
        (0.8, 477.0, 992.0),
        (1.0, 482.0, 1011.0),
        (1.25, 484.0, 1008.0),
        (1.6, 494.0, 968.0),
        (2.0, 531.0, 890.0),
        (2.5, 631.0, 776.0),
        (3.15, 804.0, 642.0),
        (4.0, 967.0, 512.0),
        (5.0, 1039.0, 409.0),
        (6.3, 1054.0, 323.0),
        (8.0, 1036.0, 253.0),
        (10.0, 988.0, 202.0),
        (12.5, 902.0, 161.0),
        (16.0, 768.0, 125.0),
        (20.0, 636.0, 100.0),
        (25.0, 513.0, 80.0),
        (31.5, 405.0, 63.2),
        (40.0, 314.0, 49.4),
        (50.0, 246.0, 38.8),
        (63.0, 186.0, 29.5),
        (80.0, 132.0, 21.1),
        (100.0, 88.7, 14.1),
    ];

    #[test]
    fn third_octaves_are_those_of_the_standard() {
        // Wk has Wb's shape with other numbers: its table tries the step as well.
        let wk = Weighting {
            corner_hz: 12.5,
            quality: 0.63,
            step: Some([(2.37, 0.91), (3.35, 0.91)]),
            gain: 1.0,
        };
        for (hz, k, d) in ISO_2631_1 {
            for (name, weighting, table) in [("Wk", wk, k), ("Wd", Weighting::WD, d)] {
                let found = 1e3 * weighting.response(hz).norm();
                assert!((found / table - 1.0).abs() < 6e-3, "{name} {hz} Hz: {found}, {table}");
            }
        }
    }

    #[test]
    fn vertical_weighting_follows_the_straight_lines_of_bs_6841() {
        // 0.4 up to 2 Hz, f/5 up to 5 Hz, 1 up to 16 Hz, 16/f: corners are rounded.
        let lines = |hz: f64| match hz {
            hz if hz < 2.0 => 0.4,
            hz if hz < 5.0 => hz / 5.0,
            hz if hz < 16.0 => 1.0,
            hz => 16.0 / hz,
        };
        for (hz, _, _) in ISO_2631_1.into_iter().filter(|(hz, ..)| (0.8..=50.0).contains(hz)) {
            let found = Weighting::WB.response(hz).norm() / lines(hz);
            let rounded = if (10.0..25.0).contains(&hz) { 0.2 } else { 0.12 };
            assert!((found - 1.0).abs() < rounded, "{hz} Hz: {found}");
        }
    }

    #[test]
    fn a_sine_comes_out_with_the_factor_of_its_frequency() {
        for weighting in [Weighting::WB, Weighting::WD] {
            for hz in [0.8, 2.0, 3.5, 8.0, 20.0] {
                let sine: Vec<f64> =
                    (0..30_000).map(|n| libm::sin(TAU * hz * f64::from(n) * 1e-3)).collect();
                let weighted = weighting.apply(&sine, 1000.0).unwrap();
                let rms = signal::statistics::rms(&weighted[10_000..25_000]);
                let factor = rms * f64::sqrt(2.0) / weighting.response(hz).norm();
                assert!((factor - 1.0).abs() < 2e-3, "{hz} Hz: {factor}");
            }
        }
    }
}
