//! A part of long work.

use crate::error::SignalError;
use std::str::FromStr;

/// Every item of the numbers `part - 1`, `part - 1 + of`, `part - 1 + 2 of` and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 1.
    pub part: usize,
    /// Of how many.
    pub of: usize,
}

impl Shard {
    /// All items.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// True when an item is in this shard.
    ///
    /// ```
    /// let shard: signal::shards::Shard = "2/3".parse().unwrap();
    /// assert!(shard.holds(1) && shard.holds(4) && !shard.holds(2));
    /// ```
    pub const fn holds(&self, index: usize) -> bool {
        debug_assert!(1 <= self.part && self.part <= self.of);
        index % self.of == self.part - 1
    }

    /// The name of its file; `items` is the plural of what it holds.
    pub fn file_name(&self, items: &str) -> String {
        format!("{items}-{}-of-{}.jsonl", self.part, self.of)
    }
}

impl FromStr for Shard {
    type Err = SignalError;

    fn from_str(text: &str) -> Result<Self, SignalError> {
        let parts = text
            .split_once('/')
            .and_then(|(part, of)| Some(Self { part: part.parse().ok()?, of: of.parse().ok()? }));
        match parts {
            Some(shard) if shard.part >= 1 && shard.part <= shard.of => Ok(shard),
            _ => Err(SignalError::NoShard(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_in_exactly_one_shard() {
        for of in 1..5 {
            for index in 0..20 {
                let holding = (1..=of).filter(|part| Shard { part: *part, of }.holds(index));
                assert_eq!(holding.count(), 1);
            }
        }
    }

    #[test]
    fn text_that_names_no_shard_is_refused() {
        for text in ["", "1", "0/2", "3/2", "1/0", "a/b", "1/2/3"] {
            let why = text.parse::<Shard>().unwrap_err().to_string();
            assert!(why.contains("expected part/parts, such as 1/4"), "{why}");
        }
    }
}
