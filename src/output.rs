//! What commands print on standard output.
//!
//! A reader that closes the pipe early (`yawbench ride … | head`) is no error and leaves the exit
//! code as it is. A full disk is an error.

use signal::shards::Computed;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

/// Prints a text and a line end.
///
/// # Errors
/// The output cannot be written, though its reader is still there.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let printed = writeln!(out, "{}", text.trim_end_matches('\n')).and_then(|()| out.flush());
    match printed {
        Err(why) if why.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// The name of a file without its ending.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "run".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The name of a file without its folder.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Prints what is unusual about an input on standard error.
pub(crate) fn warn(warnings: &[String]) {
    for warning in warnings {
        files::say!("warning: {warning}");
    }
}

/// Prints an error on standard error. Where nothing takes it, the exit code still says it.
pub(crate) fn complain(error: &str) {
    files::say!("error: {error}");
}

/// Reports that the file of a study or campaign ended in an incomplete line.
pub(crate) fn note_cut_off(computed: &Computed, item: &str) {
    if computed.cut_off {
        let path = computed.path.display().to_string();
        let path = files::quoted(&path);
        files::say!("note: {path}: the last line was incomplete, its {item} was computed again");
    }
}
