//! One number of the study compared with ours.

use serde::Serialize;
use std::collections::BTreeMap;

/// A figure of the study: its statement and our results.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Its number in the study, such as `10a`.
    pub number: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// The study's statement about it.
    pub said: &'static str,
    /// The numbers.
    pub rows: Vec<Row>,
    /// The numbers in fewer lines, where the report shows them so.
    pub table: Option<report::Table>,
    /// Plots of the numbers.
    pub plots: Vec<report::Plot>,
    /// Where study and model differ, and what was tried.
    pub remarks: Vec<String>,
}

/// A number of the study and ours. What does not apply is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Figure of the study.
    pub figure: &'static str,
    /// What it is.
    pub quantity: &'static str,
    /// Under which conditions: names with units and values.
    pub at: BTreeMap<&'static str, f64>,
    /// The study's number; null where its text gives none.
    pub paper: Option<f64>,
    /// Ours; null where it lies beyond what was searched.
    pub ours: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
    /// Our number minus the study's, relative to the study's.
    pub relative_error: Option<f64>,
    /// How our number depends on the study's.
    pub role: Role,
    /// Range over seeds, and remarks.
    pub note: String,
}

/// How our number depends on the study's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// A parameter was calibrated on this number.
    Calibrated,
    /// The number was known when start values were chosen.
    Informed,
    /// Nothing was adjusted to it.
    Predicted,
}

impl Row {
    /// A number with its conditions.
    pub fn new(
        figure: &'static str,
        quantity: &'static str,
        at: impl IntoIterator<Item = (&'static str, f64)>,
        unit: &'static str,
        ours: Option<f64>,
    ) -> Self {
        Self {
            figure,
            quantity,
            at: at.into_iter().collect(),
            paper: None,
            ours: ours.filter(|value| value.is_finite()),
            unit,
            relative_error: None,
            role: Role::Predicted,
            note: String::new(),
        }
    }

    /// The study's number, and how ours depends on it.
    #[must_use]
    pub fn paper(mut self, paper: f64, role: Role) -> Self {
        self.paper = Some(paper);
        self.relative_error = self.ours.map(|ours| (ours - paper) / paper);
        self.role = role;
        self
    }

    /// A remark.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// A condition that it was found under.
    pub fn at(&self, name: &str) -> Option<f64> {
        self.at.get(name).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_is_relative_to_the_study_and_absent_without_one() {
        let row = Row::new("10a", "critical_speed", [("ke_n_per_m", 3e6)], "km/h", Some(206.7));
        assert_eq!((row.paper, row.relative_error), (None, None));
        let row = row.paper(212.0, Role::Calibrated);
        assert!((row.relative_error.unwrap() + 0.025).abs() < 1e-12);
        let beyond =
            Row::new("10a", "critical_speed", [], "km/h", None).paper(212.0, Role::Predicted);
        assert_eq!(beyond.relative_error, None);
        assert_eq!(Row::new("4", "x", [], "m", Some(f64::NAN)).ours, None);
    }
}
