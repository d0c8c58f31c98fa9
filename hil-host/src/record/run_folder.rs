//! A folder for the files of a command that does not use [`files::ResultFolder`] yet.

use crate::BenchError;
use files::FolderError;
use std::path::{Path, PathBuf};

/// The files of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// `given`, or the next free `runs/<name>-<n>`.
    pub fn choose(given: Option<&Path>, name: &str) -> Self {
        if let Some(path) = given {
            return Self::at(path.to_owned());
        }
        let free = (1..).map(|n| Path::new("runs").join(format!("{name}-{n}")));
        let path = free.into_iter().find(|path| !path.exists()).unwrap_or_default();
        Self { path }
    }

    /// A folder with a fixed name.
    pub const fn at(path: PathBuf) -> Self {
        Self { path }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes it.
    ///
    /// # Errors
    /// It cannot be made: bad input.
    pub fn create(&self) -> Result<(), BenchError> {
        std::fs::create_dir_all(&self.path)
            .map_err(|why| FolderError::NoPlace(self.path.clone(), why).into())
    }

    /// Shows before long work that it can be made; leaves nothing behind.
    ///
    /// # Errors
    /// It cannot be made: bad input.
    pub fn try_create(&self) -> Result<(), BenchError> {
        let new: Vec<&Path> = self.path.ancestors().take_while(|path| !path.exists()).collect();
        self.create()?;
        for path in new {
            // Another program's files may have come into it by now.
            let _ = std::fs::remove_dir(path);
        }
        Ok(())
    }

    /// Writes a text file in it.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn write(&self, name: &str, text: &str) -> Result<(), BenchError> {
        let file = self.file(name);
        std::fs::write(&file, text).map_err(|why| BenchError::File { file, why })
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}
