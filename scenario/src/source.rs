//! Text files, read with limits, whose errors name the line.

pub use crate::error::ScenarioError;

use crate::error::Place;
use crate::kind::Kind;
use files::identity::content_hash;
use files::input::{self, InputError, Limit};
use files::quote;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// An input file in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    path: PathBuf,
    text: String,
    /// Hash of the file's bytes.
    content_hash: String,
    /// The text is not the file's own: a place in it is named by its table.
    rewritten: bool,
}

impl Source {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read as text.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let (text, content_hash) = read_hashed(path, Limit::Text)?;
        Ok(Self { path: path.to_owned(), text, content_hash, rewritten: false })
    }

    /// Text that is in memory already; `path` names it in errors and anchors relative paths.
    pub fn from_text(path: &Path, text: &str) -> Self {
        Self {
            path: path.to_owned(),
            text: text.to_owned(),
            content_hash: content_hash(text.as_bytes()),
            rewritten: false,
        }
    }

    /// The same file with another text.
    pub(crate) fn rewritten(&self, text: String) -> Self {
        Self { text, rewritten: true, ..self.clone() }
    }

    /// Parses TOML; unknown keys are errors where the type says so.
    ///
    /// # Errors
    /// The first thing that does not fit, with its line.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, ScenarioError> {
        toml::from_str(&self.text).map_err(|error| {
            let (at, message) = self.said(&error);
            ScenarioError::Syntax { at, message }
        })
    }

    /// The same for a file of a kind: one of another known kind is named as such.
    ///
    /// # Errors
    /// [`ScenarioError::Kind`]; else as for [`parse`](Self::parse).
    pub fn parse_as<T: DeserializeOwned>(&self, expected: Kind) -> Result<T, ScenarioError> {
        toml::from_str(&self.text).map_err(|error| {
            let (at, message) = self.said(&error);
            match Kind::of(&self.text).filter(|found| !found.passes_for(expected)) {
                Some(found) => ScenarioError::Kind { at, found, expected, message },
                None => ScenarioError::Syntax { at, message },
            }
        })
    }

    fn said(&self, error: &toml::de::Error) -> (Place, String) {
        let at = error.span().map_or_else(|| Place::whole(&self.path), |span| self.place(&span));
        (at, quote::message(error.message()))
    }

    /// The file's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file's text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Hash of the bytes that the file holds, whatever settings have changed since.
    pub fn content_hash(&self) -> &str {
        &self.content_hash
    }

    /// A path that the file names, relative to its own folder.
    pub fn sibling(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// Reads a file that a key of this one names.
    ///
    /// # Errors
    /// It cannot be read as text; the error names this file and the key too.
    pub(crate) fn named(&self, key: &str, path: &str) -> Result<Self, ScenarioError> {
        Self::read(&self.sibling(path)).map_err(|error| match error {
            ScenarioError::Input(why) => self
                .whole_error(format!("{key} names {why}; the path begins at this file's folder")),
            other => other,
        })
    }

    /// Parts that do not fit each other, at a place in the file. Text of the file in `message` goes
    /// through [`files::quoted`].
    pub fn error(&self, span: &Range<usize>, message: impl Into<String>) -> ScenarioError {
        ScenarioError::Mismatch { at: self.place(span), message: message.into() }
    }

    /// Parts of the file as a whole that do not fit each other.
    pub fn whole_error(&self, message: impl Into<String>) -> ScenarioError {
        ScenarioError::mismatch(&self.path, message)
    }

    /// A place in the file.
    pub(crate) fn place(&self, span: &Range<usize>) -> Place {
        let before = self.text.get(..span.start).unwrap_or(&self.text);
        let (line, table) = if self.rewritten {
            (None, table_of(before).map(Into::into))
        } else {
            (Some(before.matches('\n').count() + 1), None)
        };
        Place { file: self.path.clone(), line, table }
    }
}

/// The text of a file, and the hash of its bytes.
pub(crate) fn read_hashed(path: &Path, limit: Limit) -> Result<(String, String), InputError> {
    let bytes = input::read_bytes(path, limit)?;
    let hash = content_hash(&bytes);
    Ok((input::text(path, bytes)?, hash))
}

/// The table that a text ends in, in words: its head, and its number where it is one of a list.
fn table_of(text: &str) -> Option<String> {
    let heads = || text.lines().filter(|line| line.starts_with('['));
    let head = heads().next_back()?;
    if head.starts_with("[[") {
        let number = heads().filter(|line| *line == head).count() - 1;
        return Some(format!("{head} number {number}"));
    }
    Some(head.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_no_file_has_is_named_by_its_table() {
        let file = Source::from_text(Path::new("a.toml"), "[[body]]\nmass_kg = 1\n");
        assert_eq!(file.error(&(9..16), "odd").to_string(), "a.toml:2: odd");
        let text = "x = 1\n[[body]]\nmass_kg = 1\n[[body]]\nmass_kg = 2\n[damper]\n";
        let changed = file.rewritten(text.to_owned());
        let at = |place: usize| changed.error(&(place..place), "odd").to_string();
        assert_eq!(at(0), "a.toml: odd");
        assert_eq!(at(15), "a.toml: [[body]] number 0: odd");
        assert_eq!(at(36), "a.toml: [[body]] number 1: odd");
        assert_eq!(at(text.len()), "a.toml: [damper]: odd");
    }
}
