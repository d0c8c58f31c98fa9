//! The map: which signals of a DBC are command, measurement and status.
//!
//! ```toml
//! [command]
//! displacement = "SetPosition"        # a name, or a table with its unit, scale or sign
//! velocity = { signal = "SetVelocity", unit = "mm/s", sign = -1 }
//! enable = { signal = "Control.Mode", armed = 1, stopped = 0 }
//! counter = "SetCounter"
//! constants = { "Control.Source" = 2 }
//!
//! [measurement]
//! force = "LoadCell"
//! displacement = "Position"
//! counter = "Alive"
//! echo = "SetCounterSeen"
//! valid = { signal = "SensorsOk", value = 1 }
//!
//! [status]
//! state = { signal = "RigState", running = 2, fault = 4 }
//! temperature = "OilTemperature"
//! timeout_s = 0.1                     # the rig stops by itself after this time without a command
//!
//! [limits]                            # of the rig; tighter ones than the scenario's are kept
//! stroke_m = 0.05
//! ```

use serde::de::{
    self, Deserialize, Deserializer, MapAccess, Visitor, value::MapAccessDeserializer,
};
use std::collections::BTreeMap;
use std::fmt;

/// The file.
#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MapFile {
    pub(super) command: CommandMap,
    pub(super) measurement: MeasurementMap,
    #[serde(default)]
    pub(super) status: StatusMap,
    #[serde(default)]
    pub(super) limits: LimitsMap,
}

#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CommandMap {
    pub(super) displacement: Mapped,
    pub(super) velocity: Option<Mapped>,
    pub(super) enable: Option<EnableMap>,
    pub(super) counter: Option<String>,
    /// Not supported: named so that it is refused in words.
    pub(super) crc: Option<toml::Value>,
    /// Values of further signals, by their names.
    #[serde(default)]
    pub(super) constants: BTreeMap<String, f64>,
}

#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnableMap {
    pub(super) signal: String,
    pub(super) armed: f64,
    pub(super) stopped: f64,
}

#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasurementMap {
    pub(super) force: Mapped,
    pub(super) displacement: Mapped,
    pub(super) counter: Option<String>,
    pub(super) echo: Option<String>,
    pub(super) valid: Option<ValidMap>,
}

#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ValidMap {
    pub(super) signal: String,
    pub(super) value: f64,
}

#[derive(Debug, Clone, PartialEq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StatusMap {
    pub(super) state: Option<StateMap>,
    pub(super) temperature: Option<Mapped>,
    pub(super) timeout_s: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StateMap {
    pub(super) signal: String,
    pub(super) running: f64,
    pub(super) fault: f64,
}

/// Limits of the rig, as far as they are known.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LimitsMap {
    pub(super) stroke_m: Option<f64>,
    pub(super) velocity_m_per_s: Option<f64>,
    pub(super) acceleration_m_per_s2: Option<f64>,
    pub(super) force_n: Option<f64>,
}

/// A signal with a unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mapped {
    pub(super) signal: String,
    /// Instead of the unit of the DBC.
    pub(super) unit: Option<String>,
    /// SI units in one unit of the DBC, instead of any unit.
    pub(super) scale: Option<f64>,
    /// -1 where the rig counts the other way round.
    pub(super) sign: f64,
}

#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct MappedTable {
    signal: String,
    unit: Option<String>,
    scale: Option<f64>,
    sign: Option<i64>,
}

impl<'de> Deserialize<'de> for Mapped {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NameOrTable)
    }
}

struct NameOrTable;

impl<'de> Visitor<'de> for NameOrTable {
    type Value = Mapped;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a signal, or a table with signal, unit, scale, sign")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Mapped, E> {
        Ok(Mapped { signal: name.to_owned(), unit: None, scale: None, sign: 1.0 })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Mapped, A::Error> {
        let table = MappedTable::deserialize(MapAccessDeserializer::new(map))?;
        let MappedTable { signal, unit, scale, sign } = table;
        let sign = match sign {
            None | Some(1) => 1.0,
            Some(-1) => -1.0,
            Some(other) => {
                return Err(de::Error::custom(format!("found sign {other}, expected 1 or -1")));
            }
        };
        if let Some(scale) = scale.filter(|scale| !(scale.is_finite() && *scale > 0.0)) {
            let message = format!("found scale {scale}, expected a number over 0");
            return Err(de::Error::custom(message));
        }
        if unit.is_some() && scale.is_some() {
            return Err(de::Error::custom("found unit and scale, expected one of them"));
        }
        Ok(Mapped { signal, unit, scale, sign })
    }
}
