//! What kind of file a TOML text is, by its top-level keys.

use std::fmt;
use toml::{Table, Value};

/// What a file is, by its top-level keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A scenario, as `run` takes it.
    Scenario,
    /// A vehicle, which a scenario names.
    Vehicle,
    /// A test rig.
    Rig,
    /// A damper model.
    DamperModel,
    /// A maker's datasheet.
    Datasheet,
    /// A hydraulic damper of the virtual bench.
    HydraulicDamper,
    /// A mapping of the columns of a record.
    Mapping,
    /// A list of tests of the virtual bench.
    TestList,
}

/// Keys of which one is enough, in the order in which they are looked for.
const KEYS: [(Kind, &[&str]); 8] = [
    (Kind::Vehicle, &["body", "wheel_rail"]),
    (Kind::Scenario, &["vehicle", "speed_kmh"]),
    (Kind::HydraulicDamper, &["geometry", "reservoir", "valve"]),
    (
        Kind::Rig,
        &[
            "servo",
            "stroke_m",
            "rate_m_per_s",
            "lag_s",
            "delay_cycles",
            "fixture_n_per_m",
            "force_noise_n",
            "displacement_noise_m",
            "mounted",
            "sensors",
        ],
    ),
    (Kind::TestList, &["test"]),
    (Kind::Mapping, &["displacement", "time", "separator", "sample_rate_hz"]),
    (Kind::Datasheet, &["force", "dynamic"]),
    (Kind::DamperModel, &["damper"]),
];

/// Keys of a `[damper]` that only a datasheet has.
const OF_DATASHEET: &str = "v_relief_m_per_s";

impl Kind {
    /// True where a file of this kind may be meant as one of the other: a rig and a datasheet may
    /// hold a `[damper]` alone.
    pub(crate) fn passes_for(self, expected: Self) -> bool {
        let only_a_damper = matches!(expected, Self::Rig | Self::Datasheet);
        self == expected || (self == Self::DamperModel && only_a_damper)
    }

    /// The kind of a text, if its keys say so.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let table: Table = text.parse().ok()?;
        let has = |keys: &[&str]| keys.iter().any(|key| table.contains_key(*key));
        let kind = KEYS.iter().find(|(_, keys)| has(keys)).map(|(kind, _)| *kind)?;
        let sheet = table.get("damper").and_then(|damper| damper.get(OF_DATASHEET));
        match kind {
            Self::DamperModel if sheet.is_some_and(|speed| !matches!(speed, Value::Array(_))) => {
                Some(Self::Datasheet)
            }
            kind => Some(kind),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scenario => "a scenario",
            Self::Vehicle => "a vehicle",
            Self::Rig => "a rig",
            Self::DamperModel => "a damper model",
            Self::Datasheet => "a datasheet",
            Self::HydraulicDamper => "a hydraulic damper",
            Self::Mapping => "a mapping of columns",
            Self::TestList => "a list of tests",
        })
    }
}
