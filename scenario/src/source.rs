//! Text files with one clear line for everything that is wrong in them.

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

/// An input file in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read as text.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        match std::fs::read_to_string(path) {
            Ok(text) => Ok(Self { path: path.to_owned(), text }),
            Err(error) => Err(ScenarioError {
                file: path.to_owned(),
                line: None,
                message: format!("cannot be read: {error}"),
            }),
        }
    }

    /// Text that is in memory already; `path` names it in errors and anchors relative paths.
    pub fn from_text(path: &Path, text: &str) -> Self {
        Self { path: path.to_owned(), text: text.to_owned() }
    }

    /// Parses TOML; unknown keys are errors where the type says so.
    ///
    /// # Errors
    /// The first thing that does not fit, with its line.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, ScenarioError> {
        toml::from_str(&self.text).map_err(|error| {
            let message = error.message().replace('\n', " ");
            ScenarioError {
                file: self.path.clone(),
                line: error.span().map(|span| self.line(&span)),
                message: message.trim().to_owned(),
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

    /// A path that the file names, relative to its own folder.
    pub fn beside(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }

    /// An error at a place in the file.
    pub fn error(&self, span: &Range<usize>, message: impl Into<String>) -> ScenarioError {
        ScenarioError {
            file: self.path.clone(),
            line: Some(self.line(span)),
            message: message.into(),
        }
    }

    /// An error of the file as a whole.
    pub fn whole_error(&self, message: impl Into<String>) -> ScenarioError {
        ScenarioError { file: self.path.clone(), line: None, message: message.into() }
    }

    fn line(&self, span: &Range<usize>) -> usize {
        let before = self.text.get(..span.start).unwrap_or(&self.text);
        before.matches('\n').count() + 1
    }
}
