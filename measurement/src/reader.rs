//! Readers of files that are no tables of text.

use crate::error::MeasurementError;
use crate::series::Series;
use std::fmt::Debug;
use std::path::Path;

/// Reads one kind of files that are no tables of text, such as those that a bench records.
///
/// This crate knows text only. Who knows another kind hands a reader to
/// [`read_tests_with`](crate::read_tests_with).
pub trait RecordReader: Debug {
    /// Whether a file is of this kind. A file that cannot be read is of none.
    fn reads(&self, path: &Path) -> bool;

    /// The series of a file of this kind.
    ///
    /// # Errors
    /// The first thing that does not fit, in one line.
    fn read(&self, path: &Path) -> Result<Vec<Series>, MeasurementError>;
}
