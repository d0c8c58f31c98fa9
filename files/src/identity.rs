//! Which question a result answers.
//!
//! An answer depends on the question, on the content of every file that was read, and on the
//! program that computed it. Two results with one identity are the same result; where a folder's
//! identity is another, [`Identity::changes`] says in which part. Paths are no part of it: a moved
//! file is the same file.

use firmware_core::fnv;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// A question, what was read for it, and what computes the answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The question as it is serialised.
    pub question: Value,
    /// Hash of the content of every file that was read, by what the file is for.
    pub inputs: BTreeMap<String, String>,
    /// Hash over the sources of the crates that compute the answer.
    pub program: String,
}

impl Identity {
    /// The identity of a question.
    ///
    /// # Errors
    /// A question that is no JSON, such as one with keys that are no text.
    pub fn new(
        question: &impl Serialize,
        inputs: BTreeMap<String, String>,
        program: &str,
    ) -> Result<Self, serde_json::Error> {
        let question = serde_json::to_value(question)?;
        Ok(Self { question, inputs, program: program.to_owned() })
    }

    /// A short name that two identities share only when they are the same.
    ///
    /// ```
    /// let asked = |seeds: u32| files::Identity::new(&seeds, Default::default(), "1").unwrap();
    /// assert_eq!(asked(5).name(), asked(5).name());
    /// assert_ne!(asked(5).name(), asked(6).name());
    /// ```
    pub fn name(&self) -> String {
        // Objects of `Value` are sorted by key, so the text is the same for the same content.
        let question = self.question.to_string();
        let inputs = self.inputs.iter().flat_map(|(role, hash)| [role.as_str(), hash]);
        let parts = std::iter::once(question.as_str()).chain(inputs).chain([&*self.program]);
        let add = |hash: u64, part: &str| {
            let bytes = part.bytes().fold(hash, |hash, byte| fnv::add(hash, byte.into()));
            // Ends the part: no byte of UTF-8 is 0xff.
            fnv::add(bytes, 0xff)
        };
        format!("{:016x}", parts.fold(fnv::START, add))
    }

    /// What makes this identity another than `earlier`, one short phrase each; none if they are
    /// one.
    pub fn changes(&self, earlier: &Self) -> Vec<String> {
        let mut changes = Vec::new();
        differences("", &earlier.question, &self.question, &mut changes);
        for (role, hash) in &self.inputs {
            match earlier.inputs.get(role) {
                Some(before) if before == hash => {}
                Some(_) => changes.push(format!("the content of the {role}")),
                None => changes.push(format!("the {role}, which is new")),
            }
        }
        for role in earlier.inputs.keys().filter(|role| !self.inputs.contains_key(*role)) {
            changes.push(format!("the {role}, which is no longer read"));
        }
        if self.program != earlier.program {
            changes.push("the program's own sources".to_owned());
        }
        debug_assert_eq!(changes.is_empty(), self == earlier);
        changes
    }
}

/// Hash of a file's content, as [`Identity::inputs`] holds it.
pub fn content_hash(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(fnv::START, |hash, byte| fnv::add(hash, u64::from(*byte)));
    format!("{hash:016x}-{}", bytes.len())
}

/// Keys at which two values differ, with both values where they are short.
fn differences(key: &str, before: &Value, now: &Value, changes: &mut Vec<String>) {
    let below = |name: &str| match key {
        "" => name.to_owned(),
        _ => format!("{key}.{name}"),
    };
    if let (Value::Object(before), Value::Object(now)) = (before, now) {
        for (name, value) in now {
            differences(&below(name), before.get(name).unwrap_or(&Value::Null), value, changes);
        }
        for name in before.keys().filter(|name| !now.contains_key(*name)) {
            changes.push(format!("{}, which is gone", below(name)));
        }
    } else if before != now {
        let name = if key.is_empty() { "the question" } else { key };
        changes.push(match (in_words(before), in_words(now)) {
            (Some(before), Some(now)) if before.len().max(now.len()) <= 60 => {
                format!("{name}: {now}, before {before}")
            }
            _ => name.to_owned(),
        });
    }
}

/// A value as a sentence takes it; none where it is nested.
fn in_words(value: &Value) -> Option<String> {
    match value {
        Value::Null => Some("none".to_owned()),
        Value::Array(list) if list.is_empty() => Some("none".to_owned()),
        Value::Array(list) => {
            let plain = list.iter().all(|value| !(value.is_array() || value.is_object()));
            plain.then(|| list.iter().filter_map(in_words).collect::<Vec<_>>().join(", "))
        }
        Value::Object(_) => None,
        Value::String(text) => Some(format!("\"{}\"", crate::quoted(text))),
        Value::Number(number) => {
            let short = number.as_f64().map(|value| crate::number(value).to_string());
            Some(if number.is_f64() { short? } else { number.to_string() })
        }
        Value::Bool(_) => Some(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn changes_name_the_part() {
        let inputs =
            |profile: &[u8]| BTreeMap::from([("wheel profile".to_owned(), content_hash(profile))]);
        let first = Identity::new(&json!({"seeds": 5, "method": "fold"}), inputs(b"1"), "a");
        let other = Identity::new(&json!({"seeds": 3, "method": "fold"}), inputs(b"2"), "b");
        let (first, other) = (first.unwrap(), other.unwrap());
        assert_eq!(first.changes(&first), Vec::<String>::new());
        assert_eq!(
            other.changes(&first),
            ["seeds: 3, before 5", "the content of the wheel profile", "the program's own sources"]
        );
    }

    #[test]
    fn changes_are_words_and_not_json() {
        let of = |question: &Value| Identity::new(question, BTreeMap::new(), "").unwrap();
        let first = of(&json!({"axes": [], "seeds": [1, 2], "k1": null, "method": "fold"}));
        let other = of(&json!({"axes": [{"key": "a"}], "seeds": [1], "k1": 0.85, "method": "all"}));
        assert_eq!(
            other.changes(&first),
            [
                "axes",
                "k1: 0.85, before none",
                "method: \"all\", before \"fold\"",
                "seeds: 1, before 1, 2"
            ]
        );
        assert_eq!(first.changes(&other)[0], "axes");
    }

    #[test]
    fn parts_do_not_run_into_each_other() {
        let of = |question: &str, program: &str| {
            Identity::new(&question, BTreeMap::new(), program).unwrap().name()
        };
        assert_ne!(of("a", "b"), of("a\"", ""));
        assert_ne!(content_hash(b""), content_hash(b"\0"));
    }
}
