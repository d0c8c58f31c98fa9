//! A damper in a file: the nominal parameters and the effects that it has beyond them.

use crate::quantity::Quantity;
use crate::source::{ScenarioError, Source};
use firmware_core::damper::effects::{CATALOGUE, Effect};
use firmware_core::damper::{Damper, Nominal};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

/// A damper. What is absent keeps the value of a new SS9 yaw damper (calibrated, not its maker's).
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DamperFile {
    /// Damping below relief.
    pub ce_n_s_per_m: Option<Quantity>,
    /// Effective series stiffness.
    pub ke_n_per_m: Option<Quantity>,
    /// Total clearance.
    pub clearance_2a_m: Option<Quantity>,
    /// Force at which the relief valve opens.
    pub f_relief_n: Option<Quantity>,
    /// Slope beyond relief.
    pub c2_n_s_per_m: Option<Quantity>,
    /// Effects beyond the nominal model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<EffectFile>,
}

/// An effect by name with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectFile {
    /// Its name in the catalogue.
    pub name: String,
    /// Its parameters by the names of its table.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Quantity>,
}

impl<'de> Deserialize<'de> for EffectFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(EffectTable)
    }
}

/// Reads `name` as text and every other key as a quantity, keeping their places in the file.
struct EffectTable;

impl<'de> Visitor<'de> for EffectTable {
    type Value = EffectFile;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a table with the name of an effect and its parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<EffectFile, A::Error> {
        let (mut name, mut parameters) = (None, BTreeMap::new());
        while let Some(key) = map.next_key::<String>()? {
            if key == "name" {
                name = Some(map.next_value()?);
            } else {
                parameters.insert(key, map.next_value()?);
            }
        }
        let name = name.ok_or_else(|| A::Error::missing_field("name"))?;
        Ok(EffectFile { name, parameters })
    }
}

impl DamperFile {
    /// The values of [`Nominal::NEW`], each written out.
    pub fn new_damper() -> Self {
        let plain = |value| Some(Quantity::plain(value));
        Self {
            ce_n_s_per_m: plain(Nominal::NEW.ce_n_s_per_m),
            ke_n_per_m: plain(Nominal::NEW.ke_n_per_m),
            clearance_2a_m: plain(Nominal::NEW.clearance_2a_m),
            f_relief_n: plain(Nominal::NEW.f_relief_n),
            c2_n_s_per_m: plain(Nominal::NEW.c2_n_s_per_m),
            effect: Vec::new(),
        }
    }

    /// This damper with another one's values wherever it has none.
    #[must_use]
    pub fn over(&self, base: &Self) -> Self {
        Self {
            ce_n_s_per_m: self.ce_n_s_per_m.clone().or(base.ce_n_s_per_m.clone()),
            ke_n_per_m: self.ke_n_per_m.clone().or(base.ke_n_per_m.clone()),
            clearance_2a_m: self.clearance_2a_m.clone().or(base.clearance_2a_m.clone()),
            f_relief_n: self.f_relief_n.clone().or(base.f_relief_n.clone()),
            c2_n_s_per_m: self.c2_n_s_per_m.clone().or(base.c2_n_s_per_m.clone()),
            effect: if self.effect.is_empty() { base.effect.clone() } else { self.effect.clone() },
        }
    }

    /// Builds the damper.
    ///
    /// # Errors
    /// A value that no damper can have, an unknown effect or parameter, with file and line.
    pub fn build(&self, source: &Source) -> Result<Damper, ScenarioError> {
        let mut nominal = Nominal::NEW;
        let given = [
            (&self.ce_n_s_per_m, &mut nominal.ce_n_s_per_m, "ce_n_s_per_m", true),
            (&self.ke_n_per_m, &mut nominal.ke_n_per_m, "ke_n_per_m", true),
            (&self.clearance_2a_m, &mut nominal.clearance_2a_m, "clearance_2a_m", false),
            (&self.f_relief_n, &mut nominal.f_relief_n, "f_relief_n", true),
            (&self.c2_n_s_per_m, &mut nominal.c2_n_s_per_m, "c2_n_s_per_m", false),
        ];
        let mut place = None;
        for (value, slot, key, above_zero) in given {
            if let Some(value) = value {
                *slot = if above_zero {
                    value.positive(source, key)?
                } else {
                    value.not_negative(source, key)?
                };
                place = Some(value);
            }
        }
        let located = |message: String| match place {
            Some(value) => value.error(source, message),
            None => source.whole_error(message),
        };
        nominal.validate().map_err(|error| located(error.to_string()))?;
        let effects =
            self.effect.iter().map(|effect| effect.build(source)).collect::<Result<Vec<_>, _>>()?;
        Damper::new(nominal, &effects).map_err(|error| located(error.to_string()))
    }
}

impl EffectFile {
    fn build(&self, source: &Source) -> Result<Effect, ScenarioError> {
        let Some(info) = CATALOGUE.iter().find(|info| info.name == self.name) else {
            let known: Vec<&str> = CATALOGUE.iter().map(|info| info.name).collect();
            return Err(source.whole_error(format!(
                "effect \"{}\" is not known, expected one of {}",
                self.name,
                known.join(", ")
            )));
        };
        let mut values = Vec::new();
        for row in info.parameters {
            let value = self.parameters.get(row.name).ok_or_else(|| {
                source.whole_error(format!(
                    "effect \"{}\" has no {}: {} ({})",
                    self.name,
                    row.name,
                    row.meaning,
                    row.unit.symbol()
                ))
            })?;
            values.push(value.finite(source, row.name)?);
        }
        if let Some((extra, value)) = self
            .parameters
            .iter()
            .find(|(key, _)| info.parameters.iter().all(|row| row.name != *key))
        {
            let known: Vec<&str> = info.parameters.iter().map(|row| row.name).collect();
            return Err(value.error(
                source,
                format!(
                    "effect \"{}\": unknown key `{extra}`, expected {}",
                    self.name,
                    known.join(", ")
                ),
            ));
        }
        Effect::from_values(info.name, &values).map_err(|error| {
            let near = self.parameters.values().next();
            match near {
                Some(value) => value.error(source, error.to_string()),
                None => source.whole_error(error.to_string()),
            }
        })
    }
}
