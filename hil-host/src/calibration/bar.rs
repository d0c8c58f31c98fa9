//! A rigid bar: stiffness between the displacement sensor and the ground, and skew of the force.
//!
//! ```text
//! F(t) = K x(t - tau)          H = F / X = K exp(-i w tau)
//! tau  = -sum w arg(H) / sum w^2            a line through the origin, over several frequencies
//! K    = mean of Re(H exp(i w tau))         in phase once the skew is removed
//! ```
//! Standard errors are those of the line and of the mean over the frequencies. The residual is the
//! rms of `H - K exp(-i w tau)` over `K`.
//!
//! Limits: `K` is in series what stands between both ends of the displacement sensor and the
//! ground: fixture and bar where it measures at the ram, the bar alone where it measures across the
//! eyes. The end mass on the fixture takes `m w^2 / K` off it, 0.04 % of 100 MN/m at 10 Hz with 10
//! kg. The damping of the fixture acts as a skew of the other sign, `d / K`, hundredths of a
//! millisecond.

use super::SinePair;
use num_complex::Complex;

/// What a bar has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct BarFit {
    /// Stiffness (N/m).
    pub stiffness_n_per_m: f64,
    /// Its standard error (N/m).
    pub stiffness_error_n_per_m: f64,
    /// How late the force is against the displacement (s).
    pub skew_s: f64,
    /// Its standard error (s).
    pub skew_error_s: f64,
    /// Rms of what neither explains, over the stiffness.
    pub residual: f64,
    /// The points, one for each frequency.
    pub points: Vec<BarPoint>,
}

/// Force over displacement at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarPoint {
    /// Frequency (Hz).
    pub frequency_hz: f64,
    /// Force over displacement in phase, without the skew (N/m).
    pub stiffness_n_per_m: f64,
    /// Phase of the force (rad).
    pub phase_rad: f64,
    /// Share of the force that is no sine of this frequency.
    pub force_rest: f64,
}

impl BarFit {
    /// The fit over sines of at least three frequencies.
    pub fn of(pairs: &[SinePair]) -> Option<Self> {
        if pairs.len() < 3 {
            return None;
        }
        let count = pairs.len() as f64;
        let response = |pair: &SinePair| pair.force_n / pair.displacement_m;
        let squares: f64 = pairs.iter().map(|pair| pair.omega * pair.omega).sum();
        let skew_s =
            -pairs.iter().map(|pair| pair.omega * response(pair).arg()).sum::<f64>() / squares;
        let off_line: f64 =
            pairs.iter().map(|pair| (response(pair).arg() + pair.omega * skew_s).powi(2)).sum();
        let straightened = |pair: &SinePair| response(pair) * Complex::cis(pair.omega * skew_s);
        let stiffness_n_per_m = pairs.iter().map(|pair| straightened(pair).re).sum::<f64>() / count;
        let scatter: f64 =
            pairs.iter().map(|pair| (straightened(pair).re - stiffness_n_per_m).powi(2)).sum();
        let unexplained: f64 =
            pairs.iter().map(|pair| (straightened(pair) - stiffness_n_per_m).norm_sqr()).sum();
        Some(Self {
            stiffness_n_per_m,
            stiffness_error_n_per_m: (scatter / (count - 1.0) / count).sqrt(),
            skew_s,
            skew_error_s: (off_line / (count - 1.0) / squares).sqrt(),
            residual: (unexplained / count).sqrt() / stiffness_n_per_m.abs(),
            points: pairs
                .iter()
                .map(|pair| BarPoint {
                    frequency_hz: pair.frequency_hz(),
                    stiffness_n_per_m: straightened(pair).re,
                    phase_rad: response(pair).arg(),
                    force_rest: pair.force_rest,
                })
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_spring_whose_force_comes_late_has_its_stiffness_and_its_skew() {
        let time_s: Vec<f64> = (0..4000).map(|n| 1e-3 * f64::from(n)).collect();
        let pair = |frequency_hz: f64| {
            let x = |t: f64| 20e-6 * libm::sin(TAU * frequency_hz * t);
            let x_m: Vec<f64> = time_s.iter().map(|t| x(*t)).collect();
            let f_n: Vec<f64> = time_s.iter().map(|t| 300.0 + 90e6 * x(t - 0.4e-3)).collect();
            SinePair::of_samples(&time_s, &x_m, &f_n, frequency_hz).unwrap()
        };
        let fit = BarFit::of(&[1.0, 2.0, 5.0, 10.0].map(pair)).unwrap();
        assert!((fit.stiffness_n_per_m / 90e6 - 1.0).abs() < 1e-9, "{fit:?}");
        assert!((fit.skew_s - 0.4e-3).abs() < 1e-11, "{fit:?}");
        assert!(fit.residual < 1e-9 && fit.skew_error_s < 1e-10, "{fit:?}");
        assert_eq!(BarFit::of(&[1.0, 2.0].map(pair)), None);
    }
}
