//! Energy along a motion.

/// The energy of a force along a displacement (J).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Energy {
    sum: f64,
    last: Option<(f64, f64)>,
}

impl Energy {
    pub(crate) fn take(&mut self, force: f64, displacement: f64) {
        if let Some((force_before, displacement_before)) = self.last {
            self.sum += 0.5 * (force_before + force) * (displacement - displacement_before);
        }
        self.last = Some((force, displacement));
    }

    pub(crate) const fn sum(&self) -> f64 {
        self.sum
    }
}
