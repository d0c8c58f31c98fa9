//! Which files a run reads, by what they are for.
//!
//! The answer of a study depends on the content of every one of them. A role such as "wheel
//! profile" names a file, never its path: a file that is moved is the same input.

use std::collections::BTreeMap;

/// Hash of the content of every file that was read, by its role.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Inputs(BTreeMap<String, String>);

impl Inputs {
    /// Notes a file by its role and the hash of its bytes
    /// ([`content_hash`](files::identity::content_hash)).
    pub(crate) fn note(&mut self, role: impl Into<String>, content_hash: impl Into<String>) {
        let role = role.into();
        debug_assert!(!self.0.contains_key(&role), "two files with the role {role}");
        self.0.insert(role, content_hash.into());
    }

    /// The hashes by role.
    pub(crate) fn by_role(self) -> BTreeMap<String, String> {
        self.0
    }
}
