//! How the delay of a rig is compensated.
//!
//! ```toml
//! [[slot]]
//! place = "front left"
//! on = "rig"
//! accept_delay_error = false         # true: a run whose delay costs too much is not refused
//! [slot.compensation]                # may be left out: kind = "none"
//! kind = "polynomial"                # extrapolation over a delay
//! order = 2                          # 1 to 3
//! delay_s = 10e-3                    # of the rig: from the instant of a command to the ram there
//! ```
//! The other kinds are
//!
//! | kind | keys | what |
//! | --- | --- | --- |
//! | `none` | | the command is the wanted motion |
//! | `polynomial` | `delay_s`, `order` | a Taylor polynomial over the delay |
//! | `inverse` | `coefficients` | the inverse of a rig `1 / (a0 + a1 s + a2 s^2 + a3 s^3)` |
//! | `adaptive` | `gain_check_hz`, `coefficients` or `delay_s` and `order` | coefficients that follow the rig from there; `gain_check_hz` is a mode of the rig, at which their gain is bounded |
//!
//! An adaptive one also takes `load_m_per_n` and `load_s_per_n`: by how much the rig gives way
//! under a force, and by how much later a force makes it ([`Load`]). Both feed the measured force
//! back, in the sense that adds to it; their ranges keep that gain below one on a damper of 12.5
//! MN/m.
//!
//! What lies outside of the rig, half a cycle of lead, is known and not stated here.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use files::number;
use firmware_core::compensation::{Adaptive, Compensator, Feedforward, Load, Series};
use serde::{Deserialize, Serialize};

/// A compensator as it stands in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CompensationFile {
    /// Which one.
    pub kind: CompensationKind,
    /// Order of the polynomial.
    pub order: Option<Quantity>,
    /// Delay of the rig.
    pub delay_s: Option<Quantity>,
    /// Coefficients of the rig's inverse, in powers of a second.
    pub coefficients: Option<[Quantity; 4]>,
    /// A mode of the rig, at which the gain of an adaptive compensator is bounded.
    pub gain_check_hz: Option<Quantity>,
    /// By how much the rig gives way under a force (m/N).
    pub load_m_per_n: Option<Quantity>,
    /// By how much later a force makes it (s/N).
    pub load_s_per_n: Option<Quantity>,
}

/// The kinds of compensators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CompensationKind {
    /// None.
    #[default]
    None,
    /// A Taylor polynomial over a delay.
    Polynomial,
    /// The inverse of a model of the rig.
    Inverse,
    /// Coefficients that follow the rig.
    Adaptive,
}

/// Order of a polynomial unless a file says otherwise: a third one amplifies noise and is no better
/// at the frequencies of a yaw damper.
const ORDER: f64 = 2.0;
/// Longest delay that is extrapolated (s): more than a quarter of a period at 3.5 Hz.
const DELAY_MAX_S: f64 = 0.064;
/// Range of each coefficient, in powers of a second.
const COEFFICIENTS: [(f64, f64); 4] = [(0.5, 2.0), (-0.1, 0.1), (-0.01, 0.01), (-1e-3, 1e-3)];

/// Most that a load may take: half of the stroke of a damper of 12.5 MN/m, which is a gain of 0.5;
/// and three quarters at a speed of 0.3 m/s.
const LOAD_MAX_M_PER_N: (f64, &str) = (4e-8, "m/N");
const LOAD_MAX_S_PER_N: (f64, &str) = (2e-7, "s/N");

impl CompensationFile {
    /// The same with every default written out.
    #[must_use]
    pub(crate) fn with_defaults(&self) -> Self {
        let has_order = self.kind == CompensationKind::Polynomial
            || (self.kind == CompensationKind::Adaptive && self.coefficients.is_none());
        let order = has_order.then(|| Quantity::or(self.order.as_ref(), ORDER));
        Self { order, ..self.clone() }
    }

    /// Builds it.
    ///
    /// # Errors
    /// The first key that does not fit, with file and line.
    pub(crate) fn build(&self, source: &Source) -> Result<Compensator, ScenarioError> {
        use CompensationKind::{Adaptive as Adapting, Inverse, None as Uncompensated, Polynomial};
        let (by_delay, by_series) = (self.delay_s.is_some(), self.coefficients.is_some());
        let allowed: &[&str] = match self.kind {
            Uncompensated => &[],
            Polynomial => &["delay_s", "order"],
            Inverse => &["coefficients"],
            Adapting if by_series => {
                &["gain_check_hz", "coefficients", "load_m_per_n", "load_s_per_n"]
            }
            Adapting => &["gain_check_hz", "delay_s", "order", "load_m_per_n", "load_s_per_n"],
        };
        self.check_keys(source, allowed)?;
        Ok(match self.kind {
            Uncompensated => Compensator::None,
            Polynomial => Compensator::Feedforward(self.polynomial(source)?),
            Inverse => Compensator::Feedforward(Feedforward::inverse(self.series(source)?)),
            Adapting => {
                let start = match (by_series, by_delay) {
                    (true, _) => Series(self.series(source)?),
                    (false, true) => self.polynomial(source)?.series,
                    (false, false) => {
                        return Err(self.missing(source, "coefficients, or delay_s"));
                    }
                };
                let given = self.gain_check_hz.as_ref();
                let check = given.ok_or_else(|| self.missing(source, "gain_check_hz"))?;
                let range = "5 to 500 Hz";
                let gain_check_hz = check.within(source, "gain_check_hz", 5.0, 500.0, range)?;
                let load = self.load(source)?;
                Compensator::Adaptive(Adaptive { load, ..Adaptive::new(start, gain_check_hz) })
            }
        })
    }

    /// The word of the kind.
    const fn name(&self) -> &'static str {
        match self.kind {
            CompensationKind::None => "none",
            CompensationKind::Polynomial => "polynomial",
            CompensationKind::Inverse => "inverse",
            CompensationKind::Adaptive => "adaptive",
        }
    }

    /// Refuses a key that the kind does not have.
    fn check_keys(&self, source: &Source, allowed: &[&str]) -> Result<(), ScenarioError> {
        let first = self.coefficients.as_ref().map(|[first, ..]| first);
        let given = [
            ("order", self.order.as_ref()),
            ("delay_s", self.delay_s.as_ref()),
            ("coefficients", first),
            ("gain_check_hz", self.gain_check_hz.as_ref()),
            ("load_m_per_n", self.load_m_per_n.as_ref()),
            ("load_s_per_n", self.load_s_per_n.as_ref()),
        ];
        for (key, value) in given {
            let Some(value) = value.filter(|_| !allowed.contains(&key)) else { continue };
            let expected = match allowed {
                [] => "no other key".to_owned(),
                keys => keys.join(", "),
            };
            let kind = self.name();
            let message =
                format!("compensation of kind \"{kind}\": found {key}, expected {expected}");
            return Err(value.error(source, message));
        }
        Ok(())
    }

    fn missing(&self, source: &Source, key: &str) -> ScenarioError {
        let kind = self.name();
        source.whole_error(format!("compensation of kind \"{kind}\": expected {key}"))
    }

    fn polynomial(&self, source: &Source) -> Result<Feedforward, ScenarioError> {
        let delay = self.delay_s.as_ref().ok_or_else(|| self.missing(source, "delay_s"))?;
        let range = format!("0 to {} s", number(DELAY_MAX_S));
        let delay_s = delay.within(source, "delay_s", 0.0, DELAY_MAX_S, &range)?;
        let order = match &self.order {
            None => ORDER,
            Some(order) if [1.0, 2.0, 3.0].contains(&order.value) => order.value,
            Some(order) => return Err(order.refused(source, "order", "1, 2 or 3")),
        };
        Ok(Feedforward::polynomial(order as u8, delay_s))
    }

    fn load(&self, source: &Source) -> Result<Load, ScenarioError> {
        let value = |key: &str, given: &Option<Quantity>, (most, unit): (f64, &str)| {
            let range = format!("0 to {} {unit}", number(most));
            given.as_ref().map_or(Ok(0.0), |given| given.within(source, key, 0.0, most, &range))
        };
        Ok(Load {
            m_per_n: value("load_m_per_n", &self.load_m_per_n, LOAD_MAX_M_PER_N)?,
            s_per_n: value("load_s_per_n", &self.load_s_per_n, LOAD_MAX_S_PER_N)?,
        })
    }

    fn series(&self, source: &Source) -> Result<[f64; 4], ScenarioError> {
        let Some(given) = &self.coefficients else {
            return Err(self.missing(source, "coefficients"));
        };
        let mut series = [0.0; 4];
        for (value, (given, (least, most))) in series.iter_mut().zip(given.iter().zip(COEFFICIENTS))
        {
            let range = format!("{} to {}", number(least), number(most));
            *value = given.within(source, "coefficients", least, most, &range)?;
        }
        Ok(series)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn file(text: &str) -> (CompensationFile, Source) {
        let source = Source::from_text(Path::new("slot.toml"), text);
        (source.parse().unwrap(), source)
    }

    fn built(text: &str) -> Result<Compensator, ScenarioError> {
        let source = Source::from_text(Path::new("slot.toml"), text);
        source.parse::<CompensationFile>()?.build(&source)
    }

    #[test]
    fn every_kind_is_built_and_its_defaults_written_out_build_the_same() {
        let series = Series([1.0, 0.01, 5e-5, 0.0]);
        let fixed = Compensator::Feedforward(Feedforward::inverse(series.0));
        let adaptive = Compensator::Adaptive(Adaptive::new(series, 60.0));
        for (text, expected) in [
            ("kind = \"none\"", Compensator::None),
            ("kind = \"polynomial\"\ndelay_s = 10e-3", fixed),
            ("kind = \"inverse\"\ncoefficients = [1.0, 0.01, 5e-5, 0.0]", fixed),
            ("kind = \"adaptive\"\ndelay_s = 10e-3\ngain_check_hz = 60.0", adaptive),
            (
                "kind = \"adaptive\"\ncoefficients = [1.0, 0.01, 5e-5, 0.0]\ngain_check_hz = 60.0",
                adaptive,
            ),
        ] {
            assert_eq!(built(text).unwrap(), expected, "{text}");
            let written = toml::to_string(&file(text).0.with_defaults()).unwrap();
            assert_eq!(built(&written).unwrap(), expected, "{written}");
        }
        let load = Load { m_per_n: 1e-8, s_per_n: 8e-8 };
        let text = "kind = \"adaptive\"\ndelay_s = 10e-3\ngain_check_hz = 60.0\n\
                    load_m_per_n = 1e-8\nload_s_per_n = 8e-8";
        let loaded = Compensator::Adaptive(Adaptive { load, ..Adaptive::new(series, 60.0) });
        assert_eq!(built(text).unwrap(), loaded);
        let written = toml::to_string(&file(text).0.with_defaults()).unwrap();
        assert_eq!(built(&written).unwrap(), loaded, "{written}");
        let written =
            toml::to_string(&file("kind = \"polynomial\"\ndelay_s = 1e-3").0.with_defaults());
        assert!(written.unwrap().contains("order = 2.0"));
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_line() {
        for (text, expected) in [
            (
                "kind = \"none\"\ndelay_s = 1e-3",
                "slot.toml:2: compensation of kind \"none\": found delay_s, expected no other key",
            ),
            (
                "kind = \"polynomial\"\ndelay_s = 1.0",
                "slot.toml:2: delay_s = 1, expected 0 to 0.064 s",
            ),
            (
                "kind = \"polynomial\"\ndelay_s = 1e-3\norder = 4",
                "slot.toml:3: order = 4, expected 1, 2 or 3",
            ),
            (
                "kind = \"inverse\"\ncoefficients = [0.1, 0.0, 0.0, 0.0]",
                "slot.toml:2: coefficients = 0.1, expected 0.5 to 2",
            ),
            (
                "kind = \"inverse\"\ncoefficients = [1.0, 0.0, 0.0, 0.0]\ndelay_s = 1e-3",
                "slot.toml:3: compensation of kind \"inverse\": found delay_s, expected \
                 coefficients",
            ),
            (
                "kind = \"adaptive\"\ngain_check_hz = 60.0",
                "slot.toml: compensation of kind \"adaptive\": expected coefficients, or delay_s",
            ),
            (
                "kind = \"adaptive\"\ndelay_s = 1e-3",
                "slot.toml: compensation of kind \"adaptive\": expected gain_check_hz",
            ),
            (
                "kind = \"adaptive\"\ndelay_s = 1e-3\ngain_check_hz = 60.0\nload_m_per_n = 1e-6",
                "slot.toml:4: load_m_per_n = 1e-6, expected 0 to 4e-8 m/N",
            ),
            (
                "kind = \"polynomial\"\ndelay_s = 1e-3\nload_s_per_n = 1e-8",
                "slot.toml:3: compensation of kind \"polynomial\": found load_s_per_n, expected \
                 delay_s, order",
            ),
        ] {
            assert_eq!(built(text).unwrap_err().to_string(), expected, "{text}");
        }
        for text in ["kind = \"magic\"", "delay_s = 1e-3", "kind = \"none\"\ngain = 1.0"] {
            let said = built(text).unwrap_err().to_string();
            assert!(said.starts_with("slot.toml:"), "{said}");
        }
    }
}
