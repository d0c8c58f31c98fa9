//! How the rigs of a run are moved: the ramps at both ends, and the limits of the commands.
//!
//! ```toml
//! [motion]                         # all of it may be left out
//! ramp_s = 0.5                     # each of the two fades: of the motion, of the coupling
//! stroke_m = 0.1                   # furthest command from mid-stroke
//! velocity_m_per_s = 0.5
//! acceleration_m_per_s2 = 20.0
//! beyond_limits = "saturate"       # what becomes of a command beyond them: or "stop"
//! ```
//! The limits are those of the host's commands. A rig has its own, and the tighter ones rule. A
//! command that asks for more is replaced by the nearest one within them; with `"stop"` that also
//! brings the bench to SAFE. Wear in software and `ramp_s = 0` need commands to be cut.

use crate::cycle::Rate;
use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use serde::{Deserialize, Serialize};

/// The motion of rigs as it stands in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MotionFile {
    /// Duration of each fade.
    pub ramp_s: Option<Quantity>,
    /// Furthest command from mid-stroke.
    pub stroke_m: Option<Quantity>,
    /// Highest speed of a command.
    pub velocity_m_per_s: Option<Quantity>,
    /// Highest acceleration of a command.
    pub acceleration_m_per_s2: Option<Quantity>,
    /// What becomes of a command beyond them.
    pub beyond_limits: Option<BeyondLimits>,
    /// Where the largest believed force stood before there was `[plausibility]`.
    #[serde(skip_serializing)]
    pub force_n: Option<Quantity>,
}

/// What becomes of a command beyond its limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BeyondLimits {
    /// The nearest command within them is sent.
    #[default]
    Saturate,
    /// The same, and the bench goes to SAFE.
    Stop,
}

/// The motion of rigs, ready to run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Length of each fade (cycles).
    pub ramp_cycles: u32,
    /// Furthest command from mid-stroke (m).
    pub stroke_m: f64,
    /// Highest speed of a command (m/s).
    pub velocity_m_per_s: f64,
    /// Highest acceleration of a command (m/s2).
    pub acceleration_m_per_s2: f64,
    /// What becomes of a command beyond them.
    pub beyond_limits: BeyondLimits,
}

const RAMP_S: f64 = 0.5;
const RAMP_MAX_S: f64 = 60.0;
const STROKE_M: f64 = 0.1;
/// A hunting locomotive asks for 0.4 m/s at most.
const VELOCITY_M_PER_S: f64 = 0.5;
/// Five times what a run at 160 km/h on class-6 track asks for.
const ACCELERATION_M_PER_S2: f64 = 20.0;

impl MotionFile {
    /// The same with every default written out.
    pub(crate) fn with_defaults(&self) -> Self {
        let or = Quantity::or;
        Self {
            ramp_s: Some(or(self.ramp_s.as_ref(), RAMP_S)),
            stroke_m: Some(or(self.stroke_m.as_ref(), STROKE_M)),
            velocity_m_per_s: Some(or(self.velocity_m_per_s.as_ref(), VELOCITY_M_PER_S)),
            acceleration_m_per_s2: Some(or(
                self.acceleration_m_per_s2.as_ref(),
                ACCELERATION_M_PER_S2,
            )),
            beyond_limits: Some(self.beyond_limits.unwrap_or_default()),
            force_n: None,
        }
    }

    /// Builds it.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub(crate) fn build(&self, source: &Source, rate: Rate) -> Result<Motion, ScenarioError> {
        if let Some(force) = &self.force_n {
            let new = format!(
                "[motion] force_n is now `force = {{ limit_n = {} }}` under [plausibility]",
                files::number(force.value)
            );
            return Err(force.error(source, new));
        }
        let within = |given: &Option<Quantity>, key, (least, most), unit, or| {
            Quantity::within_or(given.as_ref(), source, key, (least, most, unit), or)
        };
        let ramp_s = within(&self.ramp_s, "ramp_s", (0.0, RAMP_MAX_S), "s", RAMP_S)?;
        Ok(Motion {
            ramp_cycles: rate.cycles(ramp_s) as u32,
            stroke_m: within(&self.stroke_m, "stroke_m", (1e-3, 1.0), "m", STROKE_M)?,
            velocity_m_per_s: within(
                &self.velocity_m_per_s,
                "velocity_m_per_s",
                (1e-3, 10.0),
                "m/s",
                VELOCITY_M_PER_S,
            )?,
            acceleration_m_per_s2: within(
                &self.acceleration_m_per_s2,
                "acceleration_m_per_s2",
                (0.1, 1e4),
                "m/s2",
                ACCELERATION_M_PER_S2,
            )?,
            beyond_limits: self.beyond_limits.unwrap_or_default(),
        })
    }
}

/// Time between the fades in which a host on a real bus measures the delay of its rigs (s).
pub const MEASURING_S: f64 = 6.0;

impl Motion {
    /// The time that the ramps at both ends and the measurement of the delay take, from a ram that
    /// does not begin far away (s).
    pub(crate) fn ramps_s(&self, rate: Rate) -> f64 {
        (4.0 * f64::from(self.ramp_cycles) + rate.cycles(MEASURING_S) as f64) * rate.cycle_s()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn built(text: &str) -> Result<Motion, ScenarioError> {
        let source = Source::from_text(Path::new("motion.toml"), text);
        source.parse::<MotionFile>()?.build(&source, Rate::Usual)
    }

    #[test]
    fn what_is_absent_keeps_its_default_and_what_is_impossible_is_refused() {
        let usual = built("").unwrap();
        assert_eq!((usual.ramp_cycles, usual.acceleration_m_per_s2), (500, 20.0));
        assert_eq!(built("ramp_s = 0.0").unwrap(), Motion { ramp_cycles: 0, ..usual });
        for text in [
            "ramp_s = -1.0",
            "ramp_s = 1e9",
            "stroke_m = 0.0",
            "velocity_m_per_s = 0.0",
            "beyond_limits = \"cut\"",
        ] {
            assert!(built(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_key_that_has_moved_is_refused_with_its_new_name() {
        let expected = "motion.toml:2: [motion] force_n is now `force = { limit_n = 30000 }` under \
                        [plausibility]";
        assert_eq!(built("ramp_s = 0.1\nforce_n = 30e3").unwrap_err().to_string(), expected);
    }

    #[test]
    fn the_defaults_written_out_build_the_same() {
        let source = Source::from_text(Path::new("motion.toml"), "");
        let written = MotionFile::default().with_defaults().build(&source, Rate::Usual).unwrap();
        assert_eq!(written, built("").unwrap());
    }
}
