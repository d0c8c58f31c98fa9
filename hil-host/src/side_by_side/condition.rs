//! The condition of a run: everything that its files state and that a repeat has in common with it.
//!
//! Keys and values of `scenario.toml` and `vehicle.toml`, of every number its value alone: where it
//! comes from changes nothing. Title, seed of the emulated rig's noise and the second run of
//! `[compare]` are left out, and on a real bus all of the emulated rig.

use serde::Serialize;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Keys with their values.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Condition(BTreeMap<String, String>);

/// One key in which a condition differs from another.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Differing {
    /// The key, with its slot or number in brackets.
    pub key: String,
    /// Its value here; null where there is none.
    pub value: Option<String>,
    /// Its value in the group that this one is compared with.
    pub reference: Option<String>,
}

/// What moves the vehicle whatever its dampers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Surroundings {
    Vehicle,
    Speed,
    Track,
    Duration,
}

impl Condition {
    /// Of the two files of a run, and of what else it states about itself, key by key.
    pub(super) fn of(
        scenario: &Table,
        vehicle: &Table,
        on_memory: bool,
        more: &[(&str, String)],
    ) -> Self {
        let mut keys = BTreeMap::new();
        for (key, value) in scenario {
            let is_left_out = match key.as_str() {
                "title" | "vehicle" | "compare" => true,
                "rig" => !on_memory,
                _ => false,
            };
            if !is_left_out {
                flatten(key, value, &mut keys);
            }
        }
        keys.remove("rig.seed");
        for (key, value) in vehicle {
            flatten(&format!("vehicle.{key}"), value, &mut keys);
        }
        keys.extend(more.iter().map(|(key, value)| ((*key).to_owned(), value.clone())));
        Self(keys)
    }

    /// The keys in which it differs from another one, in their order.
    pub(super) fn differing(&self, reference: &Self) -> Vec<Differing> {
        let mut keys: Vec<&String> = self.0.keys().chain(reference.0.keys()).collect();
        keys.sort_unstable();
        keys.dedup();
        let differ = keys.into_iter().filter(|key| self.0.get(*key) != reference.0.get(*key));
        let differing = differ.map(|key| Differing {
            key: key.clone(),
            value: self.0.get(key).cloned(),
            reference: reference.0.get(key).cloned(),
        });
        differing.collect()
    }
}

impl Differing {
    /// What it belongs to, where that is not the damper, its rig or the way it is driven.
    pub(super) fn surroundings(&self) -> Option<Surroundings> {
        let table = self.key.split(['.', '[']).next().unwrap_or_default();
        match table {
            "vehicle" => Some(Surroundings::Vehicle),
            "speed_kmh" => Some(Surroundings::Speed),
            "track" => Some(Surroundings::Track),
            // A short run keeps half of itself for its statistics: both change together.
            "duration_s" | "run_in_s" => Some(Surroundings::Duration),
            _ => None,
        }
    }

    /// Whether it is a clearance or a stiffness, of a damper or put before one in software.
    pub(super) fn is_wear(&self) -> bool {
        let name = self.key.rsplit('.').next().unwrap_or_default();
        ["clearance_2a_m", "ke_n_per_m", "stiffness_n_per_m"].contains(&name)
    }

    /// As it is shown: `damper.clearance_2a_m 0.004 (0.0002)`.
    pub(super) fn shown(&self) -> String {
        let word = |value: &Option<String>| value.clone().unwrap_or_else(|| "none".to_owned());
        format!("{} {} ({})", self.key, word(&self.value), word(&self.reference))
    }
}

/// Puts every value below a key into a list.
fn flatten(key: &str, value: &Value, keys: &mut BTreeMap<String, String>) {
    match value {
        Value::Table(table) => match quantity(table) {
            Some(value) => flatten(key, value, keys),
            None => {
                for (name, value) in table {
                    flatten(&format!("{key}.{name}"), value, keys);
                }
            }
        },
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                let place = item.get("place").and_then(Value::as_str);
                let name = place.map_or_else(|| (index + 1).to_string(), str::to_owned);
                flatten(&format!("{key}[{name}]"), item, keys);
            }
        }
        // 160 and 160.0 are one speed.
        Value::Integer(number) => drop(keys.insert(key.to_owned(), (*number as f64).to_string())),
        Value::Float(number) => drop(keys.insert(key.to_owned(), number.to_string())),
        Value::String(text) => drop(keys.insert(key.to_owned(), text.clone())),
        other => drop(keys.insert(key.to_owned(), other.to_string())),
    }
}

/// The number of a table that is a number with its provenance.
fn quantity(table: &Table) -> Option<&Value> {
    let is_about = |key: &String| ["value", "provenance", "note"].contains(&key.as_str());
    table.get("value").filter(|_| table.keys().all(is_about))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn condition(scenario: &str, on_memory: bool) -> Condition {
        let vehicle = "mass_kg = 126000.0".parse().unwrap();
        Condition::of(&scenario.parse().unwrap(), &vehicle, on_memory, &[("bus", "memory".into())])
    }

    const NEW: &str = "title = 'one'\nspeed_kmh = 160\n[rig]\nseed = 1\nlag_s = 1e-3\n\
        [[slot]]\nplace = 'front left'\ndamper = { ke_n_per_m = { value = 3e6, note = 'a' } }\n";

    #[test]
    fn title_seed_provenance_and_way_of_writing_a_number_are_no_condition() {
        let again = NEW.replace("'one'", "'two'").replace("seed = 1", "seed = 2");
        let again = again.replace("160", "160.0").replace("{ value = 3e6, note = 'a' }", "3000000");
        let again = format!("{again}[compare]\nname = 'other'\n");
        assert_eq!(condition(NEW, true).differing(&condition(&again, true)), []);
    }

    #[test]
    fn what_differs_is_named_with_its_slot_and_its_surroundings() {
        let worn = NEW.replace("3e6", "2e6").replace("160", "200").replace("1e-3", "2e-3");
        let found = |on_memory| condition(&worn, on_memory).differing(&condition(NEW, on_memory));
        let shown: Vec<String> = found(true).iter().map(Differing::shown).collect();
        let slot = "slot[front left].damper.ke_n_per_m 2000000 (3000000)";
        assert_eq!(shown, ["rig.lag_s 0.002 (0.001)", slot, "speed_kmh 200 (160)"]);
        let surroundings: Vec<_> = found(true).iter().map(Differing::surroundings).collect();
        assert_eq!(surroundings, [None, None, Some(Surroundings::Speed)]);
        // A real rig is not the emulated one.
        assert_eq!(found(false).len(), 2);
    }
}
