//! A number put in the place of one in a scenario, or in its vehicle, by its key; or that number
//! times a factor.
//!
//! ```text
//! damper.ke_n_per_m                            a key of the scenario, there or not
//! slot.front left.damper.clearance_2a_m        a table of a list, by name, place or number from 0
//! vehicle.body.bogie_front.yaw_inertia_kg_m2   a key of the vehicle's file
//! vehicle.suspension.primary.stiffness_y_n_per_m   all tables of that name
//! vehicle.body.*.mass_kg                       all tables of a list
//! ```
//! What the number replaces may stand there with provenance and note; these go with it.

use crate::error::{ScenarioError, SettingError};
use crate::source::Source;
use files::quote;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// What keys of the vehicle's file begin with.
const VEHICLE: &str = "vehicle.";
/// Keys by which a table of a list is known.
const NAMES: [&str; 2] = ["name", "place"];

/// What becomes of the number at a key.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// This number stands there, whatever did.
    Value(f64),
    /// The number that stands there is multiplied.
    Factor(f64),
}

/// A key and what becomes of the number there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The key.
    pub key: String,
    /// What becomes of it.
    #[serde(flatten)]
    pub change: Change,
}

impl Setting {
    /// This number at the key.
    pub fn to(key: impl Into<String>, value: f64) -> Self {
        Self { key: key.into(), change: Change::Value(value) }
    }

    /// The number at the key, so many times.
    pub fn times(key: impl Into<String>, factor: f64) -> Self {
        Self { key: key.into(), change: Change::Factor(factor) }
    }

    /// The number, or the factor.
    pub const fn number(&self) -> f64 {
        match self.change {
            Change::Value(number) | Change::Factor(number) => number,
        }
    }

    /// The key in words, as the head of a column of numbers.
    pub fn called(&self) -> String {
        match self.change {
            Change::Value(_) => self.key.clone(),
            Change::Factor(_) => format!("{} times", self.key),
        }
    }
}

impl Source {
    /// The scenario with the settings that are its own. Later errors name a table, for the text is
    /// written anew and its lines are no one's.
    ///
    /// # Errors
    /// A key that leads nowhere.
    pub fn with_settings(&self, settings: &[Setting]) -> Result<Self, ScenarioError> {
        self.with(settings.iter().filter(|setting| !setting.key.starts_with(VEHICLE)), "")
    }

    /// The vehicle's file with the settings that are its own.
    ///
    /// # Errors
    /// A key that leads nowhere.
    pub fn with_vehicle_settings(&self, settings: &[Setting]) -> Result<Self, ScenarioError> {
        self.with(settings.iter().filter(|setting| setting.key.starts_with(VEHICLE)), VEHICLE)
    }

    fn with<'a>(
        &self,
        settings: impl Iterator<Item = &'a Setting>,
        prefix: &str,
    ) -> Result<Self, ScenarioError> {
        let mut table: Option<Table> = None;
        for setting in settings {
            let table = match &mut table {
                Some(table) => table,
                None => table.insert(self.parse()?),
            };
            let key = setting.key.get(prefix.len()..).unwrap_or_default();
            let path: Vec<&str> = key.split('.').collect();
            put(table, &path, setting.change).map_err(|why| self.unset(&setting.key, why))?;
        }
        let Some(table) = table else { return Ok(self.clone()) };
        let text = toml::to_string(&table).map_err(|why| {
            self.unset("the file", SettingError::Unwritable(quote::message(&why.to_string())))
        })?;
        Ok(self.rewritten(text))
    }

    fn unset(&self, key: &str, why: SettingError) -> ScenarioError {
        ScenarioError::Setting { file: self.path().to_owned(), key: key.to_owned(), why }
    }
}

/// Changes a number in a table; tables on the way are made where they are missing.
fn put(table: &mut Table, path: &[&str], change: Change) -> Result<(), SettingError> {
    match path {
        [] | [""] => Err(SettingError::NoKey),
        [last] => {
            let value = match change {
                Change::Value(value) => value,
                Change::Factor(factor) => factor * standing(table.get(*last))?,
            };
            // A whole number in the place of one, such as a seed; keys of quantities take either.
            let whole = table.get(*last).is_some_and(Value::is_integer) && value == value.trunc();
            let value = if whole { Value::Integer(value as i64) } else { Value::Float(value) };
            table.insert((*last).to_owned(), value);
            Ok(())
        }
        [first, rest @ ..] => {
            let next = table.entry(*first).or_insert_with(|| Value::Table(Table::new()));
            match next {
                Value::Table(next) => put(next, rest, change),
                Value::Array(list) => put_into_list(list, first, rest, change),
                other => Err(SettingError::NotATable((*first).to_owned(), other.type_str())),
            }
        }
    }
}

/// The number that stands at a place, with provenance or without.
fn standing(at: Option<&Value>) -> Result<f64, SettingError> {
    let number = |at: &Value| at.as_float().or_else(|| at.as_integer().map(|whole| whole as f64));
    let found = at.and_then(|at| number(at.get("value").unwrap_or(at)));
    found.ok_or(SettingError::NoNumber)
}

/// Changes a number in the tables of a list that the first part of the path means.
fn put_into_list(
    list: &mut [Value],
    of: &str,
    path: &[&str],
    change: Change,
) -> Result<(), SettingError> {
    let [which, rest @ ..] = path else {
        return Err(SettingError::List(of.to_owned()));
    };
    let named = |table: &Table| {
        NAMES.iter().any(|key| table.get(*key).and_then(Value::as_str) == Some(which))
    };
    let mut known: Vec<String> = Vec::new();
    let mut found = false;
    for (index, entry) in list.iter_mut().enumerate() {
        let Value::Table(table) = entry else { continue };
        if *which == "*" || which.parse() == Ok(index) || named(table) {
            put(table, rest, change)?;
            found = true;
        }
        let name = NAMES.iter().find_map(|key| table.get(*key).and_then(Value::as_str));
        known.push(name.map_or_else(|| index.to_string(), str::to_owned));
    }
    known.dedup();
    if found {
        Ok(())
    } else {
        Err(SettingError::Absent(of.to_owned(), (*which).to_owned(), known))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    const TEXT: &str = "title = \"a\"\nspeed_kmh = { value = 160.0, note = \"n\" }\n\
        [[body]]\nname = \"bogie\"\nmass_kg = 1.0\n[[body]]\nname = \"wheel\"\nmass_kg = 2.0\n";

    fn set(key: &str) -> Result<Table, ScenarioError> {
        with(Setting::to(key, 7.0))
    }

    fn with(setting: Setting) -> Result<Table, ScenarioError> {
        let source = Source::from_text(Path::new("a.toml"), TEXT);
        let changed = match setting.key.strip_prefix(VEHICLE) {
            Some(_) => source.with_vehicle_settings(&[setting]),
            None => source.with_settings(&[setting]),
        };
        changed?.parse()
    }

    #[test]
    fn numbers_are_put_where_the_key_says() {
        let seven = Some(&Value::Float(7.0));
        assert_eq!(set("speed_kmh").unwrap().get("speed_kmh"), seven);
        assert_eq!(set("damper.ke_n_per_m").unwrap()["damper"].get("ke_n_per_m"), seven);
        let masses = |key: &str| -> Vec<Option<f64>> {
            let table = set(key).unwrap();
            let bodies = table["body"].as_array().unwrap().iter();
            bodies.map(|body| body["mass_kg"].as_float()).collect()
        };
        assert_eq!(masses("vehicle.body.wheel.mass_kg"), [Some(1.0), Some(7.0)]);
        assert_eq!(masses("vehicle.body.0.mass_kg"), [Some(7.0), Some(2.0)]);
        assert_eq!(masses("vehicle.body.*.mass_kg"), [Some(7.0), Some(7.0)]);
    }

    #[test]
    fn a_whole_number_stays_one() {
        let source = Source::from_text(Path::new("a.toml"), "seed = 1\n");
        let seed = |value| {
            let changed = source.with_settings(&[Setting::to("seed", value)]).unwrap();
            changed.parse::<Table>().unwrap()["seed"].clone()
        };
        assert_eq!(seed(2.0), Value::Integer(2));
        assert_eq!(seed(2.5), Value::Float(2.5));
    }

    #[test]
    fn numbers_are_multiplied_where_they_stand() {
        let times = |key: &str| with(Setting::times(key, 0.5));
        assert_eq!(times("speed_kmh").unwrap().get("speed_kmh"), Some(&Value::Float(80.0)));
        let table = times("vehicle.body.*.mass_kg").unwrap();
        let bodies = table["body"].as_array().unwrap().iter();
        let masses: Vec<_> = bodies.map(|body| body["mass_kg"].as_float()).collect();
        assert_eq!(masses, [Some(0.5), Some(1.0)]);
        let expected = "a.toml: cannot set `damper.ke_n_per_m`: no number stands there, expected one \
                        to multiply";
        assert_eq!(times("damper.ke_n_per_m").unwrap_err().to_string(), expected);
    }

    #[test]
    fn a_key_that_leads_nowhere_is_told_with_what_there_is() {
        let expected = "a.toml: cannot set `body.axle.mass_kg`: body has no \"axle\", expected one \
                        of bogie, wheel, or *";
        assert_eq!(set("body.axle.mass_kg").unwrap_err().to_string(), expected);
        assert!(set("body").is_ok_and(|table| table["body"].is_float()));
        assert!(set("body.wheel").is_err());
        assert!(
            set("title.x")
                .unwrap_err()
                .to_string()
                .ends_with("title is a string, expected a table")
        );
        assert!(set("").unwrap_err().to_string().ends_with("a key is expected"));
    }
}
