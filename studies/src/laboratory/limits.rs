//! What a datasheet allows at a velocity.

use serde::Serialize;

/// Forces that a datasheet gives for one velocity, with their tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Force in extension, N.
    pub extension_n: Option<f64>,
    /// Force in compression, N, positive.
    pub compression_n: Option<f64>,
    /// Tolerance of both, as a share.
    pub tolerance: f64,
}

impl Limit {
    /// Between two rows of a datasheet (and zero at rest), straight; `None` above its last row.
    ///
    /// ```
    /// use studies::laboratory::Limit;
    /// let row = |velocity_m_per_s, force| Limit {
    ///     velocity_m_per_s, extension_n: Some(force), compression_n: None, tolerance: 0.15,
    /// };
    /// let rows = [row(0.01, 10e3), row(0.05, 14e3)];
    /// assert_eq!(Limit::at(&rows, 0.03).unwrap().extension_n, Some(12e3));
    /// assert_eq!(Limit::at(&rows, 0.06), None);
    /// ```
    pub fn at(rows: &[Self], velocity_m_per_s: f64) -> Option<Self> {
        let rest = Self {
            velocity_m_per_s: 0.0,
            extension_n: Some(0.0),
            compression_n: Some(0.0),
            tolerance: 0.0,
        };
        let slowest = |a: &&Self, b: &&Self| a.velocity_m_per_s.total_cmp(&b.velocity_m_per_s);
        // A measured speed a little above the last row is that row's.
        let reach = 1.02;
        let above = rows
            .iter()
            .filter(|row| reach * row.velocity_m_per_s >= velocity_m_per_s)
            .min_by(slowest)?;
        let below = rows
            .iter()
            .filter(|row| row.velocity_m_per_s < above.velocity_m_per_s)
            .max_by(slowest)
            .unwrap_or(&rest);
        let share = (velocity_m_per_s - below.velocity_m_per_s)
            / (above.velocity_m_per_s - below.velocity_m_per_s);
        let between = |low: Option<f64>, high: Option<f64>| Some(low? + share * (high? - low?));
        Some(Self {
            velocity_m_per_s,
            extension_n: between(below.extension_n, above.extension_n),
            compression_n: between(below.compression_n, above.compression_n),
            tolerance: above.tolerance,
        })
    }

    /// Both forces are within the tolerance, as far as it speaks of them.
    pub fn holds(&self, extension_n: f64, compression_n: f64) -> bool {
        let within = |force: f64, wanted: Option<f64>| {
            wanted.is_none_or(|wanted| (force - wanted).abs() <= self.tolerance * wanted.abs())
        };
        within(extension_n, self.extension_n) && within(compression_n, self.compression_n)
    }
}
