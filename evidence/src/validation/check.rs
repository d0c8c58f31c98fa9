//! One number of ours, the known number, and the tolerance between them.

use report::Plot;
use report::significant;
use serde::Serialize;

/// A comparison. A value that is not a number passes nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What is compared.
    pub quantity: String,
    /// Where: speed, lateral shift, frequency, case.
    pub at: String,
    /// The known value.
    pub expected: f64,
    /// Ours.
    pub ours: f64,
    /// Least that passes, where there is a least.
    pub lowest: Option<f64>,
    /// Most that passes, where there is a most.
    pub highest: Option<f64>,
    /// Unit of all four.
    pub unit: &'static str,
    /// Whether ours lies between.
    pub passes: bool,
}

impl Check {
    /// The range that passes, in words.
    pub(super) fn allowed(&self) -> String {
        let number = |value: f64| significant(value, 5);
        match (self.lowest, self.highest) {
            (Some(low), Some(high)) => {
                let (below, above) = (self.expected - low, high - self.expected);
                if (below - above).abs() <= 1e-6 * (below + above) {
                    format!("±{}", significant(above, 2))
                } else {
                    format!("{} to {}", number(low), number(high))
                }
            }
            (Some(low), None) => format!("at least {}", number(low)),
            (None, Some(high)) => format!("at most {}", number(high)),
            (None, None) => String::new(),
        }
    }

    /// Whether being far from the known value is worse on both sides, or on the only one that has a
    /// bound.
    pub(super) const fn is_two_sided(&self) -> bool {
        self.highest.is_some()
    }

    /// Ours within `tolerance` of what is known.
    pub fn near(quantity: &str, at: &str, [expected, ours]: [f64; 2], tolerance: f64) -> Self {
        let limits = [Some(expected - tolerance), Some(expected + tolerance)];
        Self::new(quantity, at, [expected, ours], limits)
    }

    /// Ours within a share of what is known.
    pub fn within(quantity: &str, at: &str, values: [f64; 2], share: f64) -> Self {
        Self::near(quantity, at, values, share * values[0].abs())
    }

    /// Ours between two bounds, both included.
    pub fn between(quantity: &str, at: &str, values: [f64; 2], bounds: [f64; 2]) -> Self {
        Self::new(quantity, at, values, bounds.map(Some))
    }

    /// Ours at most so much, where nothing would be perfect.
    pub fn at_most(quantity: &str, at: &str, ours: f64, highest: f64) -> Self {
        Self::new(quantity, at, [0.0, ours], [None, Some(highest)])
    }

    /// Ours at least so much.
    pub fn at_least(quantity: &str, at: &str, ours: f64, lowest: f64) -> Self {
        Self::new(quantity, at, [lowest, ours], [Some(lowest), None])
    }

    /// The unit of the numbers.
    #[must_use]
    pub fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Share of the tolerance that is used up: 0 on the known value, 1 at a bound, more beyond.
    pub fn used(&self) -> f64 {
        let room = |bound: f64| {
            let (off, room) = (self.ours - self.expected, bound - self.expected);
            if off == 0.0 { 0.0 } else { off / room }
        };
        let most = [self.lowest, self.highest].into_iter().flatten().map(room);
        let used = most.fold(0.0, f64::max);
        if self.passes { used.min(1.0) } else { used.max(1.0) }
    }

    fn new(
        quantity: &str,
        at: &str,
        [expected, ours]: [f64; 2],
        [lowest, highest]: [Option<f64>; 2],
    ) -> Self {
        debug_assert!(
            !lowest.zip(highest).is_some_and(|(lowest, highest)| lowest > highest),
            "{quantity}: {lowest:?} to {highest:?}"
        );
        let passes = ours.is_finite()
            && lowest.is_none_or(|bound| ours >= bound)
            && highest.is_none_or(|bound| ours <= bound);
        let (quantity, at) = (quantity.to_owned(), at.to_owned());
        Self { quantity, at, expected, ours, lowest, highest, unit: "", passes }
    }
}

/// Everything that is compared with one source.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// A short name without spaces.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// What is compared, in a few sentences.
    pub what: String,
    /// Where the known numbers come from.
    pub source: &'static str,
    /// Where the tolerances come from.
    pub tolerance: String,
    /// What is left out, and why.
    pub limits: Vec<String>,
    /// The comparisons.
    pub checks: Vec<Check>,
    /// Ours and theirs, drawn.
    #[serde(skip)]
    pub plots: Vec<Plot>,
}

impl Reference {
    /// `passes`, or `MISSES` where any comparison misses.
    pub(super) fn verdict(&self) -> &'static str {
        if self.passes() { "passes" } else { "MISSES" }
    }

    /// Whether there is something to compare, and all of it passes.
    pub fn passes(&self) -> bool {
        !self.checks.is_empty() && self.checks.iter().all(|check| check.passes)
    }

    /// What misses.
    pub fn misses(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| !check.passes)
    }

    /// Of every quantity the check that uses most of its tolerance, how many there are, in order.
    pub fn tightest(&self) -> Vec<(&Check, usize)> {
        let mut found: Vec<(&Check, usize)> = Vec::new();
        for check in &self.checks {
            match found.iter_mut().find(|(other, _)| other.quantity == check.quantity) {
                Some((tightest, count)) => {
                    *count += 1;
                    if check.used() > tightest.used() {
                        *tightest = check;
                    }
                }
                None => found.push((check, 1)),
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_passes_up_to_its_bounds_and_no_number_passes_nothing() {
        let near = |ours| Check::near("", "", [2.0, ours], 0.5);
        assert!(near(2.5).passes && near(1.5).passes);
        assert!(!near(2.51).passes && !near(f64::NAN).passes && !near(f64::INFINITY).passes);
        assert!((near(2.25).used() - 0.5).abs() < 1e-12 && near(3.0).used() > 1.0);
        assert!(near(f64::NAN).used() >= 1.0);
        assert!(Check::at_most("", "", -3.0, 1e-3).passes);
        assert!(!Check::at_least("", "", 0.9, 1.0).passes);
        // On a known value without room a match uses nothing.
        assert_eq!(Check::near("", "", [2.0, 2.0], 0.0).used(), 0.0);
    }

    #[test]
    fn the_tightest_of_each_quantity_stands_for_it() {
        let check = |quantity, ours| Check::near(quantity, "", [0.0, ours], 1.0);
        let checks = vec![check("a", 0.1), check("b", 0.2), check("a", -0.9)];
        let reference = Reference {
            name: "",
            title: "",
            what: String::new(),
            source: "",
            tolerance: String::new(),
            limits: Vec::new(),
            checks,
            plots: Vec::new(),
        };
        let tightest: Vec<(f64, usize)> =
            reference.tightest().iter().map(|(check, count)| (check.ours, *count)).collect();
        assert_eq!(tightest, [(-0.9, 2), (0.2, 1)]);
    }
}
