//! The motion of a test with its measured and simulated forces, as a CSV file.
//!
//! Columns: `time_s,displacement_m,force_n,datasheet_n,refitted_n,with_effects_n`, and
//! `with_empirical_n` where there is an empirical map. A force that is missing has empty cells. The
//! names stand in line 1, so that other programs read the file as it is. Which side is extension
//! stands in a mapping with the same name and the ending `.toml`.

use super::fit::Fit;
use super::identify::Identification;
use super::result::Models;
use super::test_set::{Test, TestSet};
use measurement::mapping::{Companion, Extension};
use std::fmt::Write as _;

/// A test with measured and simulated forces.
#[derive(Debug, Clone, Copy)]
pub struct Prediction<'a> {
    /// The test.
    pub test: &'a Test,
    /// Measured force, N.
    pub measured_n: Option<&'a [f64]>,
    /// Forces of the three models, N.
    pub models_n: Models<Option<&'a [f64]>>,
    /// Force of the last model with an empirical map, N; without a map there is no column.
    pub with_empirical_n: Option<&'a [f64]>,
}

impl Prediction<'_> {
    /// The CSV file.
    pub fn to_csv(&self) -> String {
        let record = &self.test.record;
        let columns = self.columns();
        debug_assert!(
            columns.iter().filter_map(|(_, force_n)| *force_n).all(|n| n.len() == record.len()),
            "every force covers its record"
        );
        let mut text = "time_s,displacement_m".to_owned();
        for (name, _) in &columns {
            text.push(',');
            text.push_str(name);
        }
        text.push('\n');
        for sample in 0..record.len() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{},{}", record.time_s(sample), record.displacement_m[sample]);
            for (_, force_n) in &columns {
                text.push(',');
                if let Some(force_n) = force_n.and_then(|force_n| force_n.get(sample)) {
                    let _ = write!(text, "{force_n}");
                }
            }
            text.push('\n');
        }
        text
    }

    /// The mapping for the CSV file of this name: which sign means extension, and the specimen.
    pub fn to_mapping(&self, csv_name: &str) -> String {
        let record = &self.test.record;
        let known = record.direction_declared;
        let extension = if known { Extension::Positive } else { Extension::Unknown };
        let (specimen, notes) = (record.specimen.clone(), Vec::new());
        Companion { specimen, notes, extension, temperature: false }.to_toml(csv_name)
    }

    fn columns(&self) -> Vec<(&'static str, Option<&[f64]>)> {
        let mut columns = vec![
            ("force_n", self.measured_n),
            ("datasheet_n", self.models_n.datasheet),
            ("refitted_n", self.models_n.refitted),
            ("with_effects_n", self.models_n.with_effects),
        ];
        if self.with_empirical_n.is_some() {
            columns.push(("with_empirical_n", self.with_empirical_n));
        }
        columns
    }
}

impl Identification {
    /// The predictions of all tests, those fitted first.
    pub fn predictions(&self) -> impl Iterator<Item = Prediction<'_>> {
        let map = self.kept_map();
        let on_train = map.map(|map| map.on_train.as_slice());
        let on_holdout = map.map(|map| map.on_holdout.as_slice());
        let fitted = of_tests(&self.train, &self.on_train, on_train);
        fitted.chain(of_tests(&self.holdout, &self.on_holdout, on_holdout))
    }
}

fn of_tests<'a>(
    tests: &'a TestSet,
    models: &'a Models<Option<Fit>>,
    with_map: Option<&'a [Vec<f64>]>,
) -> impl Iterator<Item = Prediction<'a>> {
    tests.tests.iter().enumerate().map(move |(index, test)| Prediction {
        test,
        measured_n: Some(&test.record.force_n),
        models_n: models.map(|fit| fit.as_ref().map(|fit| fit.force_n[index].as_slice())),
        with_empirical_n: with_map.map(|force_n| force_n[index].as_slice()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};

    #[test]
    fn names_stand_in_line_1_and_a_missing_force_has_empty_cells() {
        let w = std::f64::consts::TAU * 2.0;
        let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
        let f = |n: usize| 1e4 * libm::cos(w * n as f64 * 1e-3);
        let series =
            Series::sampled("a", 1e3, (0..2000).map(x).collect(), (0..2000).map(f).collect());
        let tests = TestSet::new(vec![Measurement::from_series(series).unwrap()]);
        let test = &tests.tests[0];
        let simulated_n = vec![1.5; test.record.len()];
        let prediction = Prediction {
            test,
            measured_n: None,
            models_n: Models {
                datasheet: None,
                refitted: None,
                with_effects: Some(simulated_n.as_slice()),
            },
            with_empirical_n: None,
        };
        let text = prediction.to_csv();
        let mut lines = text.lines();
        let names = "time_s,displacement_m,force_n,datasheet_n,refitted_n,with_effects_n";
        assert_eq!(lines.next(), Some(names));
        assert_eq!(lines.next(), Some("0,0,,,,1.5"));
        assert_eq!(lines.count(), test.record.len() - 1);
        let mapping = prediction.to_mapping("a.csv");
        assert!(
            mapping.ends_with("mapping_for = \"a.csv\"\nextension = \"positive\"\n"),
            "{mapping}"
        );
    }
}
