//! What a rig has to answer before the host arms it.
//!
//! ```toml
//! [readiness]                      # all of it may be left out; these are the defaults
//! zero_age_s = 28800.0             # oldest zero of the load cell
//! force_at_rest_n = 2000.0         # largest force at rest
//! stroke_left_m = 5e-3             # least stroke left to either end
//! shunt_check = true               # whether the shunt check of the load cell must have passed
//! ```
//! The key switch of a real rig and the 300 quiet cycles are rules of the protocol, and no choice.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use serde::{Deserialize, Serialize};

/// The readiness that a scenario asks for.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ReadinessFile {
    /// Oldest zero of the load cell.
    pub zero_age_s: Option<Quantity>,
    /// Largest force at rest.
    pub force_at_rest_n: Option<Quantity>,
    /// Least stroke left to either end.
    pub stroke_left_m: Option<Quantity>,
    /// Whether the shunt check must have passed.
    pub shunt_check: Option<bool>,
}

/// What a rig has to answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Readiness {
    /// Oldest zero of the load cell (s).
    pub zero_age_s: f64,
    /// Largest force at rest (N): what a gas preload explains.
    pub force_at_rest_n: f64,
    /// Least stroke left to either end (m).
    pub stroke_left_m: f64,
    /// Whether the shunt check must have passed.
    pub shunt_check: bool,
}

impl Default for Readiness {
    fn default() -> Self {
        Self {
            zero_age_s: 8.0 * 3600.0,
            force_at_rest_n: 2000.0,
            stroke_left_m: 5e-3,
            shunt_check: true,
        }
    }
}

impl ReadinessFile {
    /// The same with every default written out.
    pub(crate) fn with_defaults(&self) -> Self {
        let usual = Readiness::default();
        let or = |given: &Option<Quantity>, usual| Some(Quantity::or(given.as_ref(), usual));
        Self {
            zero_age_s: or(&self.zero_age_s, usual.zero_age_s),
            force_at_rest_n: or(&self.force_at_rest_n, usual.force_at_rest_n),
            stroke_left_m: or(&self.stroke_left_m, usual.stroke_left_m),
            shunt_check: Some(self.shunt_check.unwrap_or(usual.shunt_check)),
        }
    }

    /// Builds it.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub(crate) fn build(&self, source: &Source) -> Result<Readiness, ScenarioError> {
        let usual = Readiness::default();
        let within = |given: &Option<Quantity>, key, (least, most), unit, or| {
            Quantity::within_or(given.as_ref(), source, key, (least, most, unit), or)
        };
        Ok(Readiness {
            zero_age_s: within(&self.zero_age_s, "zero_age_s", (1.0, 1e9), "s", usual.zero_age_s)?,
            force_at_rest_n: within(
                &self.force_at_rest_n,
                "force_at_rest_n",
                (1.0, 1e5),
                "N",
                usual.force_at_rest_n,
            )?,
            stroke_left_m: within(
                &self.stroke_left_m,
                "stroke_left_m",
                (0.0, 1.0),
                "m",
                usual.stroke_left_m,
            )?,
            shunt_check: self.shunt_check.unwrap_or(usual.shunt_check),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn built(text: &str) -> Result<Readiness, ScenarioError> {
        let source = Source::from_text(Path::new("ready.toml"), text);
        source.parse::<ReadinessFile>()?.build(&source)
    }

    #[test]
    fn what_is_absent_keeps_its_default_and_what_is_impossible_is_refused() {
        assert_eq!(built("").unwrap(), Readiness::default());
        let written = toml::to_string(&ReadinessFile::default().with_defaults()).unwrap();
        assert_eq!(built(&written).unwrap(), Readiness::default());
        let own = built("force_at_rest_n = 500\nshunt_check = false").unwrap();
        let usual = Readiness::default();
        assert_eq!(own, Readiness { force_at_rest_n: 500.0, shunt_check: false, ..usual });
        let said = built("\nzero_age_s = 0").unwrap_err().to_string();
        assert_eq!(said, "ready.toml:2: zero_age_s = 0, expected 1 to 1000000000 s");
    }
}
