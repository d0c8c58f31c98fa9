//! The rows of two runs in pairs, from their records, without keeping either.

use crate::BenchError;
use crate::record::{Row, RowReader};
use can_protocol::RunState;
use std::path::{Path, PathBuf};

/// Hands the rows of RUN from `from_s` on to `take`, the first of one run with the first of the
/// other, and so on, as far as both have rows.
///
/// # Errors
/// A record cannot be read.
pub(super) fn each_pair(
    records: &[PathBuf; 2],
    from_s: f64,
    mut take: impl FnMut(&Row, &Row),
) -> Result<(), BenchError> {
    let [first, second] = records;
    let (mut one, mut other) = (Rows::of(first)?, Rows::of(second)?);
    while let (Some(one), Some(other)) = (one.next()?, other.next()?) {
        if one.time_s >= from_s {
            take(&one, &other);
        }
    }
    Ok(())
}

/// The rows of RUN of a record.
struct Rows<'a> {
    path: &'a Path,
    reader: RowReader,
}

impl<'a> Rows<'a> {
    fn of(path: &'a Path) -> Result<Self, BenchError> {
        Ok(Self { path, reader: RowReader::open(path)? })
    }

    fn next(&mut self) -> Result<Option<Row>, BenchError> {
        let failed = |why| BenchError::File { file: self.path.to_owned(), why };
        loop {
            match self.reader.next().map_err(failed)? {
                Some(row) if row.state != RunState::Run => {}
                row => return Ok(row),
            }
        }
    }
}
