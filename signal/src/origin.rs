//! What a stored result was computed from.

use files::Identity;
use files::identity::content_hash;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The identity of a result in short form, stored with every line of a shard.
///
/// Lines of different shards belong together only where their origins are equal. The parts are
/// hashed separately so that a difference can be named.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// Hash of the question.
    question: String,
    /// Hash of the content of every file that was read, by the role of the file.
    inputs: BTreeMap<String, String>,
    /// Hash of the sources of the program.
    program: String,
}

impl From<&Identity> for Origin {
    fn from(identity: &Identity) -> Self {
        Self {
            question: content_hash(identity.question.to_string().as_bytes()),
            inputs: identity.inputs.clone(),
            program: identity.program.clone(),
        }
    }
}

impl Origin {
    /// How a line of origin `found` was made otherwise than one of origin `expected`, as short
    /// phrases; none where they are equal.
    pub(crate) fn differences(found: Option<&Self>, expected: Option<&Self>) -> Vec<String> {
        let (found, expected) = match (found, expected) {
            (Some(found), Some(expected)) => (found, expected),
            (None, None) => return Vec::new(),
            (None, Some(_)) => return vec!["without an identity".to_owned()],
            (Some(_), None) => return vec!["with an identity next to one without".to_owned()],
        };
        let mut differences = Vec::new();
        if found.question != expected.question {
            differences.push("of another question".to_owned());
        }
        let roles = found.inputs.keys().chain(expected.inputs.keys());
        let mut roles: Vec<&String> = roles.collect();
        roles.sort_unstable();
        roles.dedup();
        for role in roles {
            if found.inputs.get(role) != expected.inputs.get(role) {
                differences.push(format!("with another content of the {role}"));
            }
        }
        if found.program != expected.program {
            differences.push("by another version of the program".to_owned());
        }
        debug_assert_eq!(differences.is_empty(), found == expected);
        differences
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_name_the_part() {
        let origin = |seeds: u32, profile: &[u8], program: &str| {
            let inputs = BTreeMap::from([("wheel profile".to_owned(), content_hash(profile))]);
            Origin::from(&Identity::new(&seeds, inputs, program).unwrap())
        };
        let first = origin(5, b"1", "a");
        let differences = |other: &Origin| Origin::differences(Some(other), Some(&first));
        assert_eq!(differences(&first), Vec::<String>::new());
        assert_eq!(
            differences(&origin(3, b"2", "b")),
            [
                "of another question",
                "with another content of the wheel profile",
                "by another version of the program"
            ]
        );
        assert_eq!(Origin::differences(None, Some(&first)), ["without an identity"]);
    }
}
