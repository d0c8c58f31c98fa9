//! The emulated rig in a file: drive, load cell, fixture and the damper that is mounted.
//!
//! ```toml
//! kind = "ideal"                   # or "servo", or "rths-benchmark"
//! ```
//! Three kinds of drive move the ram. `ideal` follows its command late by numbers of the file;
//! `servo` is late by its hydraulics, in a table of its own ([`ServoFile`]); `rths-benchmark` is
//! the plant of a published benchmark, which has no numbers to choose. A key that means nothing to
//! the kind is refused. What is mounted and what the sensors show is the same for all ([`Mounted`],
//! [`SensorsFile`]).

use crate::cycle::CYCLE_S;
use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::kind::Kind;
use crate::mounted::MountedKind;
use crate::quantity::Quantity;
use crate::servo::{Around, FIXTURE_N_PER_M};
use crate::source::Source;
use crate::typical;
use files::quoted;
use firmware_core::damper::Damper;
use serde::{Deserialize, Serialize};
use std::path::Path;

pub use crate::mounted::{
    BAR_N_PER_M, DisplacementSensor, FORCE_SKEW_MAX_S, Mounted, SensorSetup, SensorsFile,
};
pub use crate::servo::{FASTEST_HZ, ServoFile, ServoSetup};

/// A rig as it stands in its file. What is absent keeps its default, a good laboratory rig.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RigFile {
    /// In a scenario, the file of the rig, relative to it; only `[rig.damper]` may stand next to
    /// it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// What it is called.
    pub name: Option<String>,
    /// What moves it.
    pub kind: Option<RigKind>,
    /// Largest travel from the middle to either side.
    pub stroke_m: Option<Quantity>,
    /// Largest speed of the ram; a servo rig has that of its flow.
    pub rate_m_per_s: Option<Quantity>,
    /// Time constant of the first-order lag of an ideal rig.
    pub lag_s: Option<Quantity>,
    /// Pure delay of the actuator, in whole cycles of 1 ms.
    pub delay_cycles: Option<u16>,
    /// Stiffness of the fixture in series with the damper; absent for a rigid one, and for the
    /// usual one of a servo rig.
    pub fixture_n_per_m: Option<Quantity>,
    /// Noise of the load cell, rms.
    pub force_noise_n: Option<Quantity>,
    /// Noise of the displacement sensors, rms.
    pub displacement_noise_m: Option<Quantity>,
    /// Seed of the noise.
    pub seed: Option<u64>,
    /// What is mounted; the damper without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mounted: Option<MountedKind>,
    /// Stiffness of a bar that is mounted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar_n_per_m: Option<Quantity>,
    /// A constant load on the load cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_n: Option<Quantity>,
    /// What the sensors show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensors: Option<SensorsFile>,
    /// The hydraulics of a servo rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoFile>,
    /// The damper on the rig.
    #[serde(default)]
    pub damper: DamperFile,
}

/// What moves a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RigKind {
    /// A ram with a lag and a limit of its speed.
    #[default]
    Ideal,
    /// Controller, servo-valve and cylinder.
    Servo,
    /// The plant of the virtual benchmark of real-time hybrid simulation.
    RthsBenchmark,
}

/// What moves a rig, with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// As [`RigKind::Ideal`]; its numbers are those of [`RigSetup`].
    Ideal,
    /// As [`RigKind::Servo`].
    Servo(ServoSetup),
    /// As [`RigKind::RthsBenchmark`].
    RthsBenchmark,
}

/// A rig ready to be emulated.
#[derive(Debug, Clone, PartialEq)]
pub struct RigSetup {
    /// What it is called.
    pub name: String,
    /// What moves it.
    pub drive: Drive,
    /// Largest travel from the middle to either side (m).
    pub stroke_m: f64,
    /// Largest speed of the ram (m/s).
    pub rate_m_per_s: f64,
    /// Time constant of the first-order lag of an ideal rig (s).
    pub lag_s: f64,
    /// Pure delay in whole cycles of 1 ms.
    pub delay_cycles: u16,
    /// Compliance of the fixture (m/N), zero when rigid.
    pub fixture_m_per_n: f64,
    /// Noise of the load cell, rms (N).
    pub force_noise_n: f64,
    /// Noise of the displacement sensors, rms (m).
    pub displacement_noise_m: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// What its sensors show.
    pub sensors: SensorSetup,
    /// What is mounted.
    pub mounted: Mounted,
    /// The damper on the rig, where one is mounted.
    pub damper: Damper,
}

const STROKE_M: f64 = 0.1;
const RATE_M_PER_S: f64 = 1.0;
const LAG_S: f64 = 0.5e-3;
const FORCE_NOISE_N: f64 = 5.0;
const DISPLACEMENT_NOISE_M: f64 = 0.2e-6;

/// Longest pure delay that a rig keeps (cycles of 1 ms).
pub const DELAY_CYCLES_MAX: u16 = 64;
/// The same as a time (s).
pub const DELAY_MAX_S: f64 = DELAY_CYCLES_MAX as f64 * CYCLE_S;

impl RigKind {
    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Servo => "servo",
            Self::RthsBenchmark => "rths-benchmark",
        }
    }

    /// What a rig of this kind is called that has no name.
    const fn usual_name(self) -> &'static str {
        match self {
            Self::Ideal => "laboratory rig",
            Self::Servo => "servo-hydraulic rig",
            Self::RthsBenchmark => "benchmark rig",
        }
    }
}

impl RigSetup {
    /// The same rig with an ideal drive that is late by so much (s): whole cycles, and a lag for
    /// the rest. None of a lead, or of a delay that a rig does not keep.
    #[must_use]
    pub fn late_by(&self, delay_s: f64) -> Option<Self> {
        if !(0.0..=DELAY_MAX_S).contains(&delay_s) {
            return None;
        }
        // A short lag damps least, and none at all lets the speed jump.
        let cycles = libm::floor(((delay_s - LAG_S) / CYCLE_S).max(0.0) + 1e-9);
        Some(Self {
            drive: Drive::Ideal,
            lag_s: delay_s - cycles * CYCLE_S,
            delay_cycles: cycles as u16,
            ..self.clone()
        })
    }

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
        Self::from_source(&source)?.build(&source)
    }

    /// The rig in a file of its own.
    fn from_source(source: &Source) -> Result<Self, ScenarioError> {
        let file: Self = source.parse_as(Kind::Rig)?;
        if file.file.is_some() {
            return Err(source.whole_error("a rig names another file, expected values"));
        }
        Ok(file)
    }

    /// This rig of a scenario with the values of the files that it and its damper name, which are
    /// noted as inputs.
    ///
    /// # Errors
    /// A file cannot be read, or is no rig that can be, with its own file and line; other keys next
    /// to `file`.
    pub(crate) fn resolved(
        mut self,
        source: &Source,
        inputs: &mut Inputs,
    ) -> Result<Self, ScenarioError> {
        let file = self.file.take();
        let damper = std::mem::take(&mut self.damper).resolved(source, "rig damper", inputs)?;
        let Some(file) = file else { return Ok(Self { damper, ..self }) };
        if self != Self::default() {
            let message = "[rig] names a file, expected no other key but those of [rig.damper]";
            return Err(source.whole_error(message));
        }
        let named = source.named("[rig] file", &file)?;
        inputs.note("rig", named.content_hash());
        let mut rig = Self::from_source(&named)?;
        rig.damper = rig.damper.resolved(&named, "damper of the rig", inputs)?;
        rig.build(&named)?;
        Ok(Self { damper: damper.over(&rig.damper), ..rig })
    }

    /// A laboratory rig with a new SS9 yaw damper.
    ///
    /// # Errors
    /// Never: the defaults fit.
    pub fn default_setup() -> Result<RigSetup, ScenarioError> {
        Self::default().build(&Source::from_text(Path::new("built-in rig"), ""))
    }

    /// This rig with every default written out as it was built, and `damper` wherever its own has
    /// no value.
    #[must_use]
    pub fn with_defaults(&self, damper: &DamperFile, built: &RigSetup) -> Self {
        let or = Quantity::or;
        let kind = self.kind.unwrap_or_default();
        let of_kind =
            |has: bool, given: &Option<Quantity>, default| has.then(|| or(given.as_ref(), default));
        let fixture_n_per_m = match kind {
            RigKind::Servo => Some(or(self.fixture_n_per_m.as_ref(), FIXTURE_N_PER_M)),
            RigKind::Ideal | RigKind::RthsBenchmark => self.fixture_n_per_m.clone(),
        };
        let servo = match &built.drive {
            Drive::Servo(drive) => {
                Some(self.servo.as_ref().unwrap_or(&ServoFile::default()).with_defaults(drive))
            }
            Drive::Ideal | Drive::RthsBenchmark => None,
        };
        Self {
            file: None,
            name: Some(self.name.clone().unwrap_or_else(|| kind.usual_name().to_owned())),
            kind: Some(kind),
            stroke_m: Some(or(self.stroke_m.as_ref(), STROKE_M)),
            rate_m_per_s: of_kind(kind != RigKind::Servo, &self.rate_m_per_s, RATE_M_PER_S),
            lag_s: of_kind(kind == RigKind::Ideal, &self.lag_s, LAG_S),
            delay_cycles: Some(self.delay_cycles.unwrap_or(0)),
            fixture_n_per_m,
            force_noise_n: Some(or(self.force_noise_n.as_ref(), FORCE_NOISE_N)),
            displacement_noise_m: Some(or(
                self.displacement_noise_m.as_ref(),
                DISPLACEMENT_NOISE_M,
            )),
            seed: Some(self.seed.unwrap_or(1)),
            mounted: self.mounted,
            bar_n_per_m: self.bar_n_per_m.clone(),
            load_n: self.load_n.clone(),
            sensors: self.sensors.clone(),
            servo,
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
        let kind = self.kind.unwrap_or_default();
        self.refuse_foreign_keys(kind, source)?;
        let stroke_m = match &self.stroke_m {
            Some(stroke) => stroke.within(source, "stroke_m", 0.1, 1.0, "0.1 to 1 m")?,
            None => STROKE_M,
        };
        let mut rate_m_per_s = match &self.rate_m_per_s {
            Some(rate) => rate.positive(source, "rate_m_per_s")?,
            None => RATE_M_PER_S,
        };
        let delay_cycles = self.delay_cycles.unwrap_or(0);
        if delay_cycles > DELAY_CYCLES_MAX {
            return Err(source.whole_error(format!(
                "delay_cycles = {delay_cycles}, expected 0 to {DELAY_CYCLES_MAX}"
            )));
        }
        let mut fixture_m_per_n = match &self.fixture_n_per_m {
            Some(stiffness) => 1.0 / stiffness.positive(source, "fixture_n_per_m")?,
            None => 0.0,
        };
        let damper = self.damper.build(source)?;
        let numbers = (self.bar_n_per_m.as_ref(), self.load_n.as_ref());
        let mounted = Mounted::of(self.mounted, numbers, source)?;
        let sensors = self
            .sensors
            .as_ref()
            .map_or(Ok(SensorSetup::default()), |given| given.build(source))?;
        let drive = match kind {
            RigKind::Ideal => Drive::Ideal,
            RigKind::RthsBenchmark => Drive::RthsBenchmark,
            RigKind::Servo => {
                let fixture = self.fixture_n_per_m.as_ref();
                let fixture_n_per_m = fixture.map_or(FIXTURE_N_PER_M, |given| given.value);
                let mounted_n_per_m = match mounted {
                    Mounted::Bar { stiffness_n_per_m } => stiffness_n_per_m,
                    Mounted::Damper | Mounted::Load { .. } => damper.nominal().ke_n_per_m,
                };
                let around = Around { stroke_m, fixture_n_per_m, mounted_n_per_m, damper: &damper };
                let file = self.servo.clone().unwrap_or_default();
                let drive = file.build(source, around)?;
                rate_m_per_s = drive.no_load_speed_m_per_s();
                fixture_m_per_n = 1.0 / fixture_n_per_m;
                Drive::Servo(drive)
            }
        };
        Ok(RigSetup {
            name: quoted(self.name.as_deref().unwrap_or(kind.usual_name())).to_string(),
            drive,
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
            sensors,
            mounted,
            damper,
        })
    }

    /// Keys that mean nothing to this kind.
    fn refuse_foreign_keys(&self, kind: RigKind, source: &Source) -> Result<(), ScenarioError> {
        let keys = [
            ("rate_m_per_s", &self.rate_m_per_s, kind != RigKind::Servo),
            ("lag_s", &self.lag_s, kind == RigKind::Ideal),
            ("fixture_n_per_m", &self.fixture_n_per_m, kind != RigKind::RthsBenchmark),
        ];
        for (key, given, has_meaning) in keys {
            if let (Some(given), false) = (given, has_meaning) {
                let kind = kind.name();
                return Err(
                    given.error(source, format!("{key} means nothing to kind = \"{kind}\""))
                );
            }
        }
        if self.servo.is_some() && kind != RigKind::Servo {
            let found = format!("[servo] with kind = \"{}\", expected \"servo\"", kind.name());
            return Err(source.whole_error(found));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_rig_is_late_by_whole_cycles_and_a_short_lag() {
        let rig = RigFile::default_setup().unwrap();
        for (ms, cycles, lag_ms) in [(0.0, 0, 0.0), (0.5, 0, 0.5), (1.4, 0, 1.4), (8.5, 8, 0.5)] {
            let late = rig.late_by(1e-3 * ms).unwrap();
            assert_eq!(late.delay_cycles, cycles, "{ms}");
            assert!((late.lag_s - 1e-3 * lag_ms).abs() < 1e-12, "{ms}: {}", late.lag_s);
            assert_eq!(late.damper, rig.damper);
        }
        for s in [-1e-6, 65e-3, f64::NAN] {
            assert_eq!(rig.late_by(s), None, "{s}");
        }
    }
}
