//! What commands print on standard output.
//!
//! Whoever reads may have seen enough and gone (`yawbench ride … | head`): that is no error of ours, and an
//! exit code that says something stays as it is. A full disk is one.

use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Prints a text and a line end.
///
/// # Errors
/// The output takes no more, though somebody is there.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let printed = writeln!(out, "{}", text.trim_end_matches('\n')).and_then(|()| out.flush());
    match printed {
        Err(gone) if gone.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// The name of a file without its ending.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "run".to_owned(), |stem| stem.to_string_lossy().into_owned())
}
