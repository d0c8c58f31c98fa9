//! `manifest.json`: which files of a folder are the program's own.
//!
//! Only what stands here is ever replaced or removed. A manifest that names anything outside its
//! folder is not believed.

use crate::error::FolderError;
use crate::identity::Identity;
use crate::input::{self, Limit};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Component, Path};

/// Its name in the folder.
pub(crate) const NAME: &str = "manifest.json";
const FORMAT: u32 = 1;

/// What a folder holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    pub(crate) format: u32,
    /// The command whose result it is.
    pub(crate) command: String,
    /// What the result answers; none where every result is one of its own.
    pub(crate) identity: Option<Identity>,
    /// Names of the files, with `/` between folder and file.
    pub(crate) files: BTreeSet<String>,
}

impl Manifest {
    pub(crate) fn new(command: &str, identity: Option<&Identity>) -> Self {
        let identity = identity.cloned();
        Self { format: FORMAT, command: command.to_owned(), identity, files: BTreeSet::new() }
    }

    /// The manifest of a folder, if it has one.
    pub(crate) fn of(folder: &Path) -> Result<Option<Self>, FolderError> {
        let path = folder.join(NAME);
        if path.symlink_metadata().is_err() {
            return Ok(None);
        }
        let damaged = |why: String| FolderError::Manifest(path.clone(), why);
        let text = input::read_text(&path, Limit::Text).map_err(|why| damaged(why.reason()))?;
        let manifest: Self = serde_json::from_str(&text)
            .map_err(|why| damaged(crate::quote::message(&why.to_string())))?;
        if manifest.format != FORMAT {
            return Err(damaged(format!("found format {}, expected {FORMAT}", manifest.format)));
        }
        if let Some(outside) = manifest.files.iter().find(|name| !is_inside(name)) {
            let outside = crate::quoted(outside);
            return Err(damaged(format!("found \"{outside}\", expected names inside the folder")));
        }
        Ok(Some(manifest))
    }
}

/// True for `file` and `folder/file`.
pub(crate) fn is_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    let plain = parts.by_ref().all(|part| matches!(part, Component::Normal(_)))
        && !name.chars().any(char::is_control);
    plain && (1..=2).contains(&Path::new(name).components().count())
}
