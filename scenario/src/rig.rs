//! The emulated rig in a file: actuator, load cell, fixture and the damper that is mounted.

use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::kind::Kind;
use crate::quantity::Quantity;
use crate::source::Source;
use crate::typical;
use files::quoted;
use firmware_core::damper::Damper;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A rig as it stands in its file. What is absent keeps its default, a good laboratory rig.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RigFile {
    /// What it is called.
    pub name: Option<String>,
    /// Largest travel from the middle to either side.
    pub stroke_m: Option<Quantity>,
    /// Largest speed of the ram.
    pub rate_m_per_s: Option<Quantity>,
    /// Time constant of the actuator's first-order lag.
    pub lag_s: Option<Quantity>,
    /// Pure delay of the actuator, in whole cycles.
    pub delay_cycles: Option<u16>,
    /// Stiffness of the fixture in series with the damper; absent for a rigid one.
    pub fixture_n_per_m: Option<Quantity>,
    /// Noise of the load cell, rms.
    pub force_noise_n: Option<Quantity>,
    /// Noise of the displacement sensors, rms.
    pub displacement_noise_m: Option<Quantity>,
    /// Seed of the noise.
    pub seed: Option<u64>,
    /// The damper on the rig.
    #[serde(default)]
    pub damper: DamperFile,
}

/// A rig ready to be emulated.
#[derive(Debug, Clone, PartialEq)]
pub struct RigSetup {
    /// What it is called.
    pub name: String,
    /// Largest travel from the middle to either side (m).
    pub stroke_m: f64,
    /// Largest speed of the ram (m/s).
    pub rate_m_per_s: f64,
    /// Time constant of the first-order lag (s).
    pub lag_s: f64,
    /// Pure delay in whole cycles.
    pub delay_cycles: u16,
    /// Compliance of the fixture (m/N), zero when rigid.
    pub fixture_m_per_n: f64,
    /// Noise of the load cell, rms (N).
    pub force_noise_n: f64,
    /// Noise of the displacement sensors, rms (m).
    pub displacement_noise_m: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// The damper on the rig.
    pub damper: Damper,
}

const NAME: &str = "laboratory rig";
const STROKE_M: f64 = 0.1;
const RATE_M_PER_S: f64 = 1.0;
const LAG_S: f64 = 0.5e-3;
const FORCE_NOISE_N: f64 = 5.0;
const DISPLACEMENT_NOISE_M: f64 = 0.2e-6;

/// Longest pure delay that a rig keeps (cycles).
pub const DELAY_CYCLES_MAX: u16 = 64;

impl RigSetup {
    /// What is unusual about the numbers of its damper, one line each, for a command to print.
    pub fn warnings(&self) -> Vec<String> {
        let lines = typical::damper_warnings(&self.damper);
        lines.into_iter().map(|line| format!("{}: {line}", self.name)).collect()
    }
}

impl RigFile {
    /// Reads a rig file.
    ///
    /// # Errors
    /// The first thing that does not fit, with file and line.
    pub fn load(path: &Path) -> Result<RigSetup, ScenarioError> {
        let source = Source::read(path)?;
        let file: Self = source.parse_as(Kind::Rig)?;
        file.build(&source)
    }

    /// A laboratory rig with a new SS9 yaw damper.
    ///
    /// # Errors
    /// Never: the defaults fit.
    pub fn default_setup() -> Result<RigSetup, ScenarioError> {
        Self::default().build(&Source::from_text(Path::new("built-in rig"), ""))
    }

    /// This rig with every default written out, and `damper` wherever its own has no value.
    #[must_use]
    pub fn with_defaults(&self, damper: &DamperFile) -> Self {
        let or = Quantity::or;
        Self {
            name: Some(self.name.clone().unwrap_or_else(|| NAME.to_owned())),
            stroke_m: Some(or(self.stroke_m.as_ref(), STROKE_M)),
            rate_m_per_s: Some(or(self.rate_m_per_s.as_ref(), RATE_M_PER_S)),
            lag_s: Some(or(self.lag_s.as_ref(), LAG_S)),
            delay_cycles: Some(self.delay_cycles.unwrap_or(0)),
            fixture_n_per_m: self.fixture_n_per_m.clone(),
            force_noise_n: Some(or(self.force_noise_n.as_ref(), FORCE_NOISE_N)),
            displacement_noise_m: Some(or(
                self.displacement_noise_m.as_ref(),
                DISPLACEMENT_NOISE_M,
            )),
            seed: Some(self.seed.unwrap_or(1)),
            damper: self.damper.over(damper),
        }
    }

    /// Builds the rig.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub fn build(&self, source: &Source) -> Result<RigSetup, ScenarioError> {
        let number = |given: &Option<Quantity>, key: &str, default: f64| match given {
            Some(value) => value.not_negative(source, key),
            None => Ok(default),
        };
        let stroke_m = match &self.stroke_m {
            Some(stroke) => stroke.within(source, "stroke_m", 0.1, 1.0, "0.1 to 1 m")?,
            None => STROKE_M,
        };
        let rate_m_per_s = match &self.rate_m_per_s {
            Some(rate) => rate.positive(source, "rate_m_per_s")?,
            None => RATE_M_PER_S,
        };
        let delay_cycles = self.delay_cycles.unwrap_or(0);
        if delay_cycles > DELAY_CYCLES_MAX {
            return Err(source.whole_error(format!(
                "delay_cycles = {delay_cycles}, expected 0 to {DELAY_CYCLES_MAX}"
            )));
        }
        let fixture_m_per_n = match &self.fixture_n_per_m {
            Some(stiffness) => 1.0 / stiffness.positive(source, "fixture_n_per_m")?,
            None => 0.0,
        };
        Ok(RigSetup {
            name: quoted(self.name.as_deref().unwrap_or(NAME)).to_string(),
            stroke_m,
            rate_m_per_s,
            lag_s: number(&self.lag_s, "lag_s", LAG_S)?,
            delay_cycles,
            fixture_m_per_n,
            force_noise_n: number(&self.force_noise_n, "force_noise_n", FORCE_NOISE_N)?,
            displacement_noise_m: number(
                &self.displacement_noise_m,
                "displacement_noise_m",
                DISPLACEMENT_NOISE_M,
            )?,
            seed: self.seed.unwrap_or(1),
            damper: self.damper.build(source)?,
        })
    }
}
