//! Root mean square, value by value.

/// A mean square.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Power {
    sum: f64,
    count: u64,
}

impl Power {
    pub(crate) fn take(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
    }

    /// Root of it; zero for no values.
    pub(crate) fn rms(&self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}
