//! Everything that can be wrong with a report before it is written, and the writing itself.

use files::quoted;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a report was not written. Nothing is left behind in any of these cases.
#[derive(Debug)]
pub enum Error {
    /// The columns of one trace differ in length.
    TraceLength {
        /// Title of the plot.
        plot: String,
        /// Name of the trace.
        trace: String,
        /// Number of x values (for bars: of edges less one).
        x: usize,
        /// Number of y values found.
        y: usize,
    },
    /// A map needs rows times columns values.
    MapSize {
        /// Title of the plot.
        plot: String,
        /// Columns times rows.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A span, a zoom or a limit is not a finite, rising range (on a log axis: positive too).
    Range {
        /// Title of the plot.
        plot: String,
        /// Label of the mark or caption of the zoom.
        label: String,
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// A row does not have one cell per column.
    RowLength {
        /// Caption of the table.
        table: String,
        /// Row, counted from 1.
        row: usize,
        /// Number of columns.
        expected: usize,
        /// Number of cells found.
        found: usize,
    },
    /// The file could not be written.
    Write {
        /// Where it should have gone.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

impl Error {
    /// False in every case: the caller's data do not fit each other, or the disk fails.
    pub const fn is_bad_input(&self) -> bool {
        false
    }
}

/// A title or name in quotes: escaped and cut, since it may come from a file.
fn name(text: &str) -> String {
    format!("\"{}\"", quoted(text))
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TraceLength { plot, trace, x, y } => {
                let (plot, trace) = (name(plot), name(trace));
                write!(f, "plot {plot}, trace {trace}: {x} x values but {y} y values")
            }
            Self::MapSize { plot, expected, found } => {
                let plot = name(plot);
                write!(f, "plot {plot}: the map has {found} values, its axes need {expected}")
            }
            Self::Range { plot, label, from, to } => {
                let (plot, label) = (name(plot), name(label));
                write!(f, "plot {plot}, {label}: {from} to {to} is no range on these axes")
            }
            Self::RowLength { table, row, expected, found } => {
                let table = name(table);
                write!(f, "table {table}, row {row}: {found} cells for {expected} columns")
            }
            Self::Write { path, source } => {
                let path = path.display().to_string();
                write!(f, "cannot write {}: {source}", quoted(&path))
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write { source, .. } => Some(source),
            _ => None,
        }
    }
}
