//! Grades of ride quality, and where they end.
//!
//! GB 5599-85 for coaches, TB/T 2360-93 for locomotives (Sperling index, peak acceleration); EN
//! 12299 for mean comfort, after its scale.

use serde::{Deserialize, Serialize};

/// What kind of vehicle grades are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Kind {
    Locomotive,
    Coach,
}

/// How well it rides, by the Chinese standards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Grade {
    Excellent,
    Good,
    Qualified,
    Unqualified,
}

impl Grade {
    /// The grades that have an upper end, in order.
    pub const BOUNDED: [Self; 3] = [Self::Excellent, Self::Good, Self::Qualified];

    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Excellent => "excellent",
            Self::Good => "good",
            Self::Qualified => "qualified",
            Self::Unqualified => "unqualified",
        }
    }

    /// The grade of a value, with the upper ends of the first three.
    fn below([excellent, good, qualified]: [f64; 3], value: f64) -> Self {
        match value {
            v if v <= excellent => Self::Excellent,
            v if v <= good => Self::Good,
            v if v <= qualified => Self::Qualified,
            _ => Self::Unqualified,
        }
    }
}

impl Kind {
    /// Upper ends of the grades of the Sperling index, either direction.
    pub const fn sperling(self) -> [f64; 3] {
        match self {
            Self::Locomotive => [2.75, 3.10, 3.45],
            Self::Coach => [2.50, 2.75, 3.00],
        }
    }

    /// The grade of a Sperling index.
    ///
    /// ```
    /// use vehicle_studies::ride::{Grade, Kind};
    /// assert_eq!(Kind::Locomotive.grade(2.75), Grade::Excellent);
    /// assert_eq!(Kind::Coach.grade(2.76), Grade::Qualified);
    /// ```
    pub fn grade(self, sperling: f64) -> Grade {
        Grade::below(self.sperling(), sperling)
    }
}

/// Upper ends of a locomotive's grades of peak acceleration, lateral and vertical (m/s2).
pub(super) const LOCOMOTIVE_PEAK_M_PER_S2: [[f64; 3]; 2] = [[1.47, 1.96, 2.45], [2.45, 2.95, 3.63]];

/// Upper ends of EN 12299's words for mean comfort.
pub(super) const MEAN_COMFORT: [(f64, &str); 4] =
    [(1.5, "very comfortable"), (2.5, "comfortable"), (3.5, "medium"), (4.5, "uncomfortable")];

/// The word for a mean comfort.
pub(super) fn mean_comfort(n_mv: f64) -> &'static str {
    let found = MEAN_COMFORT.iter().find(|(end, _)| n_mv < *end);
    found.map_or("very uncomfortable", |(_, word)| word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mean_comfort_has_a_word() {
        assert_eq!(mean_comfort(2.1), "comfortable");
        assert_eq!(mean_comfort(5.0), "very uncomfortable");
    }
}
