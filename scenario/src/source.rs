//! Text files with one clear line for everything that is wrong in them.

use files::identity::content_hash;
use files::input::{self, InputError, Limit};
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What is wrong with an input, in one line: file, line, place, what was found, what was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioError {
    /// The file.
    pub file: PathBuf,
    /// Line in it, from one, where there is one.
    pub line: Option<usize>,
    /// What is wrong.
    pub message: String,
}

impl std::fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file.display(), self.message),
            None => write!(f, "{}: {}", self.file.display(), self.message),
        }
    }
}

impl std::error::Error for ScenarioError {}

impl From<InputError> for ScenarioError {
    fn from(error: InputError) -> Self {
        Self { file: error.path().to_owned(), line: None, message: error.reason() }
    }
}

/// An input file in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    path: PathBuf,
    text: String,
    /// Hash of the file's bytes.
    content_hash: String,
    /// The text is not the file's own: its lines are told by the table that they stand in.
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
            let message = error.message().replace('\n', " ");
            match error.span() {
                Some(span) => self.error(&span, message.trim()),
                None => self.whole_error(message.trim()),
            }
        })
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
    pub fn beside(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// An error at a place in the file.
    pub fn error(&self, span: &Range<usize>, message: impl Into<String>) -> ScenarioError {
        let message = message.into();
        let before = self.text.get(..span.start).unwrap_or(&self.text);
        if self.rewritten {
            return self.whole_error(format!("{}{message}", table_of(before)));
        }
        let line = Some(before.matches('\n').count() + 1);
        ScenarioError { file: self.path.clone(), line, message }
    }

    /// An error of the file as a whole.
    pub fn whole_error(&self, message: impl Into<String>) -> ScenarioError {
        ScenarioError { file: self.path.clone(), line: None, message: message.into() }
    }
}

/// The text of a file, and the hash of its bytes.
pub(crate) fn read_hashed(path: &Path, limit: Limit) -> Result<(String, String), InputError> {
    let bytes = input::read_bytes(path, limit)?;
    let hash = content_hash(&bytes);
    Ok((input::text(path, bytes)?, hash))
}

/// The table that a text ends in, in words: its head, and its number where it is one of a list.
fn table_of(text: &str) -> String {
    let heads = || text.lines().filter(|line| line.starts_with('['));
    let Some(head) = heads().next_back() else { return String::new() };
    if head.starts_with("[[") {
        let number = heads().filter(|line| *line == head).count() - 1;
        return format!("{head} number {number}: ");
    }
    format!("{head}: ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_no_file_has_is_told_by_its_table() {
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
