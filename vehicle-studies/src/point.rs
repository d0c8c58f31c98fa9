//! One point of a study: where it is in the grid, and the answer there.

use crate::trip::Pace;
use scenario::setting::Setting;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use signal::shards::Item;

/// A point of the grid and its answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GridPoint<A> {
    /// Its number in the grid.
    pub index: usize,
    /// The name of the study that it belongs to.
    pub study: String,
    /// The keys that are varied, with their values at this point.
    pub at: Vec<Setting>,
    /// The answer; its default where there is none.
    #[serde(flatten)]
    pub answer: A,
    /// Why there is no answer, or only a part of it.
    pub failure: Option<String>,
    /// How fast its trips were simulated; in the file of a shard only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
}

impl<A> GridPoint<A> {
    /// Its keys and values in words, or `only` where nothing is varied.
    pub fn in_words(&self, only: &str) -> String {
        if self.at.is_empty() {
            return only.to_owned();
        }
        let keys = self.at.iter().map(Setting::called);
        let words = keys.zip(self.values_in_words()).map(|(key, value)| format!("{key} {value}"));
        words.collect::<Vec<_>>().join(", ")
    }

    /// The values of its keys, rounded to six digits.
    pub fn values_in_words(&self) -> Vec<String> {
        let word = |value: f64| {
            let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
            let plain = rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs());
            if plain { rounded.to_string() } else { format!("{rounded:e}") }
        };
        self.at.iter().map(|set| word(set.number())).collect()
    }
}

impl<A> Item for GridPoint<A>
where
    A: Serialize + DeserializeOwned + Clone + PartialEq + Send + Sync,
{
    const SINGULAR: &'static str = "point";
    const PLURAL: &'static str = "points";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        self.study.clone()
    }

    fn lasting(&self) -> Self {
        Self { pace: None, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_written_without_needless_digits() {
        let set = |value: f64| Setting::to("k", value);
        let point = GridPoint {
            index: 0,
            study: String::new(),
            at: [0.2e-3, 80.0 + 100.0 / 3.0, 12.5e6, 0.0, -3e-5].map(set).to_vec(),
            answer: (),
            failure: None,
            pace: None,
        };
        assert_eq!(point.values_in_words(), ["0.0002", "113.333", "1.25e7", "0", "-3e-5"]);
        assert!(point.in_words("only").starts_with("k 0.0002, k 113.333"));
    }
}
