//! A number put in the place of one in a scenario, or in its vehicle, by its key.
//!
//! ```text
//! damper.ke_n_per_m                            a key of the scenario, there or not
//! slot.front left.damper.clearance_2a_m        a table of a list by its name or place, or by its number from 0
//! vehicle.body.bogie_front.yaw_inertia_kg_m2   a key of the vehicle's file
//! vehicle.suspension.primary.stiffness_y_n_per_m   all tables of that name
//! vehicle.body.*.mass_kg                       all tables of a list
//! ```
//! What the number replaces may stand there with provenance and note; these go with it.

use crate::source::{ScenarioError, Source};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// What keys of the vehicle's file begin with.
const VEHICLE: &str = "vehicle.";
/// Keys by which a table of a list is known.
const NAMES: [&str; 2] = ["name", "place"];

/// A key and the number that is put there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The key.
    pub key: String,
    /// The number.
    pub value: f64,
}

impl Source {
    /// The scenario with the settings that are its own. Lines of later errors are those of the text as
    /// it is written anew.
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
            put(table, &path, setting.value)
                .map_err(|why| self.whole_error(format!("cannot set `{}`: {why}", setting.key)))?;
        }
        let Some(table) = table else { return Ok(self.clone()) };
        let text = toml::to_string(&table).map_err(|why| self.whole_error(why.to_string()))?;
        Ok(Self::from_text(self.path(), &text))
    }
}

/// Puts a number into a table; tables on the way are made where they are missing.
fn put(table: &mut Table, path: &[&str], value: f64) -> Result<(), String> {
    match path {
        [] | [""] => Err("a key is expected".to_owned()),
        [last] => {
            table.insert((*last).to_owned(), Value::Float(value));
            Ok(())
        }
        [first, rest @ ..] => {
            let next = table.entry(*first).or_insert_with(|| Value::Table(Table::new()));
            match next {
                Value::Table(next) => put(next, rest, value),
                Value::Array(list) => put_into_list(list, first, rest, value),
                other => Err(format!("{first} is a {}, expected a table", other.type_str())),
            }
        }
    }
}

/// Puts a number into the tables of a list that the first part of the path means.
fn put_into_list(list: &mut [Value], of: &str, path: &[&str], value: f64) -> Result<(), String> {
    let [which, rest @ ..] = path else {
        return Err(format!("{of} is a list, expected a name or a number behind it"));
    };
    let named = |table: &Table| {
        NAMES.iter().any(|key| table.get(*key).and_then(Value::as_str) == Some(which))
    };
    let mut known: Vec<String> = Vec::new();
    let mut found = false;
    for (index, entry) in list.iter_mut().enumerate() {
        let Value::Table(table) = entry else { continue };
        if *which == "*" || which.parse() == Ok(index) || named(table) {
            put(table, rest, value)?;
            found = true;
        }
        let name = NAMES.iter().find_map(|key| table.get(*key).and_then(Value::as_str));
        known.push(name.map_or_else(|| index.to_string(), str::to_owned));
    }
    known.dedup();
    if found {
        Ok(())
    } else {
        Err(format!("{of} has no \"{which}\", expected one of {}, or *", known.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    const TEXT: &str = "title = \"a\"\nspeed_kmh = { value = 160.0, note = \"n\" }\n\
        [[body]]\nname = \"bogie\"\nmass_kg = 1.0\n[[body]]\nname = \"wheel\"\nmass_kg = 2.0\n";

    fn set(key: &str) -> Result<Table, String> {
        let source = Source::from_text(Path::new("a.toml"), TEXT);
        let setting = Setting { key: key.to_owned(), value: 7.0 };
        let changed = match key.strip_prefix(VEHICLE) {
            Some(_) => source.with_vehicle_settings(&[setting]),
            None => source.with_settings(&[setting]),
        };
        let changed = changed.map_err(|error| error.to_string())?;
        changed.parse().map_err(|error| error.to_string())
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
    fn a_key_that_leads_nowhere_is_told_with_what_there_is() {
        let expected = "a.toml: cannot set `body.axle.mass_kg`: body has no \"axle\", expected one \
                        of bogie, wheel, or *";
        assert_eq!(set("body.axle.mass_kg").unwrap_err(), expected);
        assert!(set("body").is_ok_and(|table| table["body"].is_float()));
        assert!(set("body.wheel").is_err());
        assert!(set("title.x").unwrap_err().ends_with("title is a string, expected a table"));
        assert!(set("").unwrap_err().ends_with("a key is expected"));
    }
}
