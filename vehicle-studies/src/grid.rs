//! Points of a study: every combination of the values of some keys.
//!
//! ```text
//! damper.ke_n_per_m=3e6:15e6:13       13 values from 3 to 15 MN/m, ends included
//! damper.clearance_2a_m=0.2e-3,1e-3   these two
//! vehicle.body.*.mass_kg*=0.9:1.1:3   0.9, 1.0 and 1.1 times what stands there
//! ```
//! The first axis changes slowest.

use crate::error::StudyError;
use scenario::setting::{Change, Setting};
use std::str::FromStr;

/// Most points of a study.
const POINTS_MAX: usize = 1_000_000;

/// A key that is varied and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The key, as [`Setting`] understands it.
    pub key: String,
    /// The values or factors, in order.
    pub changes: Vec<Change>,
}

impl Axis {
    /// The key with each of its values or factors.
    pub fn settings(&self) -> impl Iterator<Item = Setting> + '_ {
        self.changes.iter().map(|change| Setting { key: self.key.clone(), change: *change })
    }
}

impl FromStr for Axis {
    type Err = StudyError;

    /// ```
    /// let axis: vehicle_studies::grid::Axis = "damper.ke_n_per_m=3e6:15e6:5".parse().unwrap();
    /// assert_eq!(axis.changes, [3e6, 6e6, 9e6, 12e6, 15e6].map(scenario::setting::Change::Value));
    /// assert!("ke=3:4".parse::<vehicle_studies::grid::Axis>().is_err());
    /// ```
    fn from_str(text: &str) -> Result<Self, StudyError> {
        let expected = || StudyError::NoAxis(text.to_owned());
        let (key, values) = text.split_once('=').ok_or_else(expected)?;
        let number = |text: &str| {
            text.trim().parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(expected)
        };
        let (key, change): (&str, fn(f64) -> Change) = match key.strip_suffix('*') {
            Some(key) if !key.ends_with('.') => (key, Change::Factor),
            _ => (key, Change::Value),
        };
        let values = match values.split(':').collect::<Vec<_>>()[..] {
            [from, to, count] => {
                let (from, to) = (number(from)?, number(to)?);
                let count: usize = count.trim().parse().map_err(|_| expected())?;
                even(from, to, count)
                    .ok_or_else(|| StudyError::AxisCount(count, text.to_owned(), POINTS_MAX))?
            }
            [list] => list.split(',').map(number).collect::<Result<_, _>>()?,
            _ => return Err(expected()),
        };
        if key.trim().is_empty() {
            return Err(expected());
        }
        let mut sorted = values.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(StudyError::ValueTwice(text.to_owned()));
        }
        let changes = values.into_iter().map(change).collect();
        Ok(Self { key: key.trim().to_owned(), changes })
    }
}

/// So many values from one to another, ends included; one value only where both are the same.
fn even(from: f64, to: f64, count: usize) -> Option<Vec<f64>> {
    match count {
        0 => None,
        1 => (from == to).then(|| vec![from]),
        _ if count > POINTS_MAX => None,
        _ => {
            let last = (count - 1) as f64;
            Some((0..count).map(|n| from + (to - from) * (n as f64 / last)).collect())
        }
    }
}

/// All combinations.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// The axes, the slowest first; none for a single point.
    pub axes: Vec<Axis>,
}

impl Grid {
    /// The combinations of some axes.
    ///
    /// # Errors
    /// More than a million points, or a key given twice.
    pub fn new(axes: Vec<Axis>) -> Result<Self, StudyError> {
        for (index, axis) in axes.iter().enumerate() {
            if axes.iter().take(index).any(|earlier| earlier.key == axis.key) {
                return Err(StudyError::KeyTwice(axis.key.clone()));
            }
        }
        let lengths = axes.iter().map(|axis| axis.changes.len());
        let points = lengths.fold(1, usize::saturating_mul);
        if points > POINTS_MAX {
            return Err(StudyError::TooManyPoints(points, POINTS_MAX));
        }
        Ok(Self { axes })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.changes.len()).product()
    }

    /// False: there is one point at least.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of a point.
    pub fn point(&self, index: usize) -> Vec<Setting> {
        debug_assert!(index < self.len(), "{index} lies outside a grid of {}", self.len());
        let mut rest = index;
        let mut settings: Vec<Setting> = Vec::new();
        for axis in self.axes.iter().rev() {
            let count = axis.changes.len().max(1);
            settings.extend(axis.settings().nth(rest % count));
            rest /= count;
        }
        settings.reverse();
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_axis_changes_slowest() {
        let axes = ["a=1,2", "b=10:30:3"].map(|text| text.parse::<Axis>().unwrap());
        let grid = Grid::new(axes.to_vec()).unwrap();
        let values = |index| grid.point(index).iter().map(Setting::number).collect::<Vec<_>>();
        assert_eq!(grid.len(), 6);
        assert_eq!(values(0), [1.0, 10.0]);
        assert_eq!(values(2), [1.0, 30.0]);
        assert_eq!(values(3), [2.0, 10.0]);
        assert_eq!(Grid::default().len(), 1);
        assert!(Grid::default().point(0).is_empty());
    }

    #[test]
    fn a_star_before_the_sign_multiplies() {
        let axis: Axis = "vehicle.body.*.mass_kg*=0.9,1.1".parse().unwrap();
        assert_eq!(axis.key, "vehicle.body.*.mass_kg");
        assert_eq!(axis.changes, [0.9, 1.1].map(Change::Factor));
        let whole: Axis = "vehicle.body.*=1".parse().unwrap();
        assert_eq!(
            (whole.key.as_str(), whole.changes),
            ("vehicle.body.*", vec![Change::Value(1.0)])
        );
    }

    #[test]
    fn what_is_no_axis_is_refused() {
        for text in
            ["a", "=1", "a=", "a=1:2", "a=1:2:0", "a=1:2:1", "a=1:2:x", "a=nan", "a=1:2:3:4"]
        {
            assert!(text.parse::<Axis>().is_err(), "{text}");
        }
        let twice = Grid::new(vec!["a=1".parse().unwrap(), "a=2".parse().unwrap()]);
        let expected = "`a` is varied twice, expected each key once";
        assert_eq!(twice.unwrap_err().to_string(), expected);
    }
}
