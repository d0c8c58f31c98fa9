//! Motion between samples, and records cut short.

use super::{Measurement, interpolant};

impl Measurement {
    /// Displacement, m, and velocity, m/s, a share of the way from a sample to the next one: the
    /// cubic through both displacements with both velocities.
    #[inline]
    pub fn motion_between(&self, sample: usize, share: f64) -> (f64, f64) {
        let end = |at: usize| (self.drive_m[at], self.velocity_m_per_s[at]);
        interpolant::between(end(sample), end(sample + 1), self.step_s, share)
    }

    /// The record from a sample on; its own run-in is its first cycle, or a tenth.
    #[must_use]
    pub fn since(&self, start: usize) -> Self {
        let start = start.min(self.force_n.len());
        let cut = |values: &[f64]| values[start..].to_vec();
        let cycles: Vec<usize> =
            self.cycles.iter().filter(|at| **at >= start).map(|at| at - start).collect();
        let left = self.force_n.len() - start;
        let run_in = cycles.iter().copied().find(|at| *at > 0).unwrap_or(left / 10);
        Self {
            start_s: self.start_s + start as f64 * self.step_s,
            displacement_m: cut(&self.displacement_m),
            drive_m: cut(&self.drive_m),
            velocity_m_per_s: cut(&self.velocity_m_per_s),
            acceleration_m_per_s2: cut(&self.acceleration_m_per_s2),
            force_n: cut(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(cut),
            cycles,
            run_in,
            ..self.clone()
        }
    }

    /// The record up to, not with, a sample.
    #[must_use]
    pub fn until(&self, end: usize) -> Self {
        let end = end.min(self.force_n.len());
        let cut = |values: &[f64]| values[..end].to_vec();
        Self {
            displacement_m: cut(&self.displacement_m),
            drive_m: cut(&self.drive_m),
            velocity_m_per_s: cut(&self.velocity_m_per_s),
            acceleration_m_per_s2: cut(&self.acceleration_m_per_s2),
            force_n: cut(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(cut),
            cycles: self.cycles.iter().copied().filter(|at| *at <= end).collect(),
            ..self.clone()
        }
    }

    /// The record with every `factor`-th sample.
    #[must_use]
    pub fn thinned(&self, factor: usize) -> Self {
        let factor = factor.max(1);
        let pick = |values: &[f64]| values.iter().step_by(factor).copied().collect();
        Self {
            step_s: self.step_s * factor as f64,
            displacement_m: pick(&self.displacement_m),
            drive_m: pick(&self.drive_m),
            velocity_m_per_s: pick(&self.velocity_m_per_s),
            acceleration_m_per_s2: pick(&self.acceleration_m_per_s2),
            force_n: pick(&self.force_n),
            temperature_degc: self.temperature_degc.as_deref().map(pick),
            cycles: self.cycles.iter().map(|at| at / factor).collect(),
            run_in: self.run_in.div_ceil(factor),
            ..self.clone()
        }
    }
}
