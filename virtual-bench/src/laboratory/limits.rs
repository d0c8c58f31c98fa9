//! What a datasheet allows at a velocity.

use scenario::datasheet::{Datasheet, TOLERANCE};
use scenario::quantity::Quantity;
use scenario::source::{ScenarioError, Source};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Speed to which a datasheet without a force table is drawn out, m/s.
const FASTEST_M_PER_S: f64 = 0.3;

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
    /// use virtual_bench::laboratory::Limit;
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

    /// The force table of a datasheet; where it has none, the curve of its nominal numbers with the
    /// usual tolerance.
    ///
    /// # Errors
    /// What does not fit in the datasheet, with file and line.
    pub fn load(path: &Path) -> Result<Vec<Self>, ScenarioError> {
        let source = Source::read(path)?;
        let nominal = Datasheet::from_source(&source)?.nominal;
        let table: ForceTable = source.parse()?;
        if table.force.is_empty() {
            let row = |velocity_m_per_s: f64, force_n: f64| Self {
                velocity_m_per_s,
                extension_n: Some(force_n),
                compression_n: Some(force_n),
                tolerance: TOLERANCE,
            };
            let knee = nominal.v_relief_m_per_s();
            if knee >= FASTEST_M_PER_S {
                return Ok(vec![row(FASTEST_M_PER_S, nominal.ce_n_s_per_m * FASTEST_M_PER_S)]);
            }
            let beyond_n = nominal.c2_n_s_per_m * (FASTEST_M_PER_S - knee);
            let fastest = row(FASTEST_M_PER_S, nominal.f_relief_n + beyond_n);
            return Ok(vec![row(knee, nominal.f_relief_n), fastest]);
        }
        let rows = table.force.iter().map(|row| Self {
            velocity_m_per_s: row.velocity_m_per_s.value,
            extension_n: row.extension_n.as_ref().map(|force| force.value.abs()),
            compression_n: row.compression_n.as_ref().map(|force| force.value.abs()),
            tolerance: row.tolerance.as_ref().map_or(TOLERANCE, |share| share.value),
        });
        Ok(rows.collect())
    }

    /// Both forces are within the tolerance, as far as it speaks of them.
    pub fn holds(&self, extension_n: f64, compression_n: f64) -> bool {
        let within = |force: f64, wanted: Option<f64>| {
            wanted.is_none_or(|wanted| (force - wanted).abs() <= self.tolerance * wanted.abs())
        };
        within(extension_n, self.extension_n) && within(compression_n, self.compression_n)
    }
}

/// The rows of a datasheet whose values are checked already.
#[derive(Deserialize)]
struct ForceTable {
    #[serde(default)]
    force: Vec<ForceRow>,
}

#[derive(Deserialize)]
struct ForceRow {
    velocity_m_per_s: Quantity,
    extension_n: Option<Quantity>,
    compression_n: Option<Quantity>,
    tolerance: Option<Quantity>,
}
