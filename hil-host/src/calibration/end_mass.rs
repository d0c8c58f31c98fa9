//! A dry run: the mass that the load cell feels with nothing mounted.
//!
//! ```text
//! F = m x''          A = -w^2 X          m = sum Re(F conj(A)) / sum |A|^2   over all frequencies
//! ```
//! The standard error is that of the line through the origin over the frequencies, in phase; the
//! residual is the rms of `F - m A` over that of `F`, in phase and out of it. Limits: a skew `tau`
//! of the force leaves a residual of `w tau` and takes `(w tau)^2 / 2` off the mass; hoses and
//! guides behind the load cell are springs in parallel, which make the mass depend on the
//! frequency.

use super::SinePair;

/// What a dry run has shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndMassFit {
    /// Mass between load cell and specimen (kg).
    pub mass_kg: f64,
    /// Its standard error (kg).
    pub mass_error_kg: f64,
    /// Rms of the force that the mass does not explain, over that of the force.
    pub residual: f64,
}

impl EndMassFit {
    /// The fit over sines of at least two frequencies.
    pub fn of(pairs: &[SinePair]) -> Option<Self> {
        if pairs.len() < 2 {
            return None;
        }
        let acceleration = |pair: &SinePair| pair.displacement_m * -(pair.omega * pair.omega);
        let squares: f64 = pairs.iter().map(|pair| acceleration(pair).norm_sqr()).sum();
        let along: f64 =
            pairs.iter().map(|pair| (pair.force_n * acceleration(pair).conj()).re).sum();
        let mass_kg = along / squares;
        let off = |pair: &SinePair| (pair.force_n - acceleration(pair) * mass_kg).norm_sqr();
        let unexplained: f64 = pairs.iter().map(off).sum();
        let whole: f64 = pairs.iter().map(|pair| pair.force_n.norm_sqr()).sum();
        let in_phase: f64 = pairs
            .iter()
            .map(|pair| {
                let acceleration = acceleration(pair);
                let off_n = pair.force_n - acceleration * mass_kg;
                (off_n * acceleration.conj()).re.powi(2) / acceleration.norm_sqr()
            })
            .sum();
        let freedom = pairs.len() as f64 - 1.0;
        Some(Self {
            mass_kg,
            mass_error_kg: (in_phase / freedom / squares).sqrt(),
            residual: (unexplained / whole).sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_mass_is_the_force_over_its_acceleration() {
        let time_s: Vec<f64> = (0..3000).map(|n| 1e-3 * f64::from(n)).collect();
        let pair = |frequency_hz: f64| {
            let x = |t: f64| 1e-3 * libm::sin(TAU * frequency_hz * t);
            let x_m: Vec<f64> = time_s.iter().map(|t| x(*t)).collect();
            let w2 = (TAU * frequency_hz).powi(2);
            // The force comes 3 N too large at one of the frequencies.
            let more_n = if frequency_hz == 4.0 { 3.0 } else { 0.0 };
            let f = |t: &f64| -(12.0 * w2 + more_n / 1e-3) * x(*t);
            let f_n: Vec<f64> = time_s.iter().map(f).collect();
            SinePair::of_samples(&time_s, &x_m, &f_n, frequency_hz).unwrap()
        };
        let fit = EndMassFit::of(&[6.0, 9.0, 12.0].map(pair)).unwrap();
        assert!((fit.mass_kg - 12.0).abs() < 1e-9 && fit.mass_error_kg < 1e-9, "{fit:?}");
        let off = EndMassFit::of(&[4.0, 9.0, 12.0].map(pair)).unwrap();
        assert!((off.mass_kg - 12.0).abs() < 2.0 * off.mass_error_kg, "{off:?}");
        assert!(off.mass_error_kg > 1e-2 && off.residual > 1e-2, "{off:?}");
        assert_eq!(EndMassFit::of(&[pair(6.0)]), None);
    }
}
