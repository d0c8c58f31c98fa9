//! Opening and reading what a user names.
//!
//! Only regular files are read: a named pipe would wait for ever, a device has no end. A file over
//! its limit is refused before it is read, one of a known other kind by its first bytes.

use crate::kind;
use crate::quote::quoted;
use crate::suggestion;
use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::os::unix::fs::{FileTypeExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

/// How large a file may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// TOML and JSON: 16 MB.
    Text,
    /// CSV and measured track: 4 GB.
    Table,
    /// None: the file is read as a stream.
    Stream,
}

impl Limit {
    /// The limit, bytes.
    ///
    /// ```
    /// assert_eq!(files::Limit::Text.bytes(), 16_000_000);
    /// ```
    pub const fn bytes(self) -> u64 {
        match self {
            Self::Text => 16_000_000,
            Self::Table => 4_000_000_000,
            Self::Stream => u64::MAX,
        }
    }
}

/// Why a file is not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InputError {
    /// The system refuses: file, the system's message.
    Unreadable(PathBuf, String),
    /// Not a regular file: file, what it is.
    NotAFile(PathBuf, &'static str),
    /// Over its limit: file, its size, the limit, bytes.
    TooLarge(PathBuf, u64, u64),
    /// Of another kind: file, what it is, what to do.
    OtherKind(PathBuf, &'static str, &'static str),
    /// Not UTF-8: file, the line where it breaks.
    NotText(PathBuf, usize),
}

impl InputError {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Unreadable(path, _)
            | Self::NotAFile(path, _)
            | Self::TooLarge(path, ..)
            | Self::OtherKind(path, ..)
            | Self::NotText(path, _) => path,
        }
    }

    /// True: what the user named cannot be read.
    pub const fn is_bad_input(&self) -> bool {
        true
    }

    /// What is wrong, without the file's name.
    pub fn reason(&self) -> String {
        match self {
            Self::Unreadable(_, why) => format!("cannot be read: {why}"),
            Self::NotAFile(_, what) => format!("found {what}, expected a file"),
            Self::TooLarge(_, size, limit) => {
                format!("found {size} bytes, expected at most {} MB", limit / 1_000_000)
            }
            Self::OtherKind(_, what, advice) => {
                format!("found {what}, expected text: {advice}")
            }
            Self::NotText(_, line) => {
                format!("line {line} is not UTF-8, expected text: save the file as UTF-8")
            }
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", quoted(&self.path().display().to_string()), self.reason())
    }
}

impl std::error::Error for InputError {}

/// Opens a regular file at its start.
///
/// # Errors
/// It cannot be opened, is no regular file, or is over the limit.
pub fn open(path: &Path, limit: Limit) -> Result<File, InputError> {
    let unreadable = |why: io::Error| InputError::Unreadable(path.to_owned(), why.to_string());
    // Opening a named pipe waits for its other end without this flag.
    let file = File::options().read(true).custom_flags(libc::O_NONBLOCK).open(path);
    let file = file.map_err(|why| match why.kind() {
        io::ErrorKind::NotFound => absent(path, &why),
        // A socket cannot be opened at all.
        _ if path.metadata().is_ok_and(|about| about.file_type().is_socket()) => {
            InputError::NotAFile(path.to_owned(), "a socket")
        }
        _ => unreadable(why),
    })?;
    let about = file.metadata().map_err(unreadable)?;
    let kind = about.file_type();
    let what = match () {
        () if kind.is_file() => None,
        () if kind.is_dir() => Some("a folder"),
        () if kind.is_fifo() => Some("a named pipe"),
        () if kind.is_char_device() || kind.is_block_device() => Some("a device"),
        () => Some("a socket"),
    };
    if let Some(what) = what {
        return Err(InputError::NotAFile(path.to_owned(), what));
    }
    if about.len() > limit.bytes() {
        return Err(InputError::TooLarge(path.to_owned(), about.len(), limit.bytes()));
    }
    Ok(file)
}

/// A file that is not there, with the name that was probably meant.
fn absent(path: &Path, why: &io::Error) -> InputError {
    let similar = suggestion::file_like(path).map(|file| file.display().to_string());
    let similar =
        similar.map_or(String::new(), |file| format!("; did you mean {}?", quoted(&file)));
    let link = std::fs::read_link(path).map_or(String::new(), |target| {
        format!("; it is a link to {}", quoted(&target.display().to_string()))
    });
    InputError::Unreadable(path.to_owned(), format!("{why}{link}{similar}"))
}

/// The bytes of a file that should hold text in any encoding.
///
/// # Errors
/// As for [`open`]; a file of a known other kind.
pub fn read_bytes(path: &Path, limit: Limit) -> Result<Vec<u8>, InputError> {
    let unreadable = |why: io::Error| InputError::Unreadable(path.to_owned(), why.to_string());
    let mut file = open(path, limit)?;
    let mut start = Vec::with_capacity(kind::START_BYTES);
    file.by_ref().take(kind::START_BYTES as u64).read_to_end(&mut start).map_err(unreadable)?;
    if let Some((what, advice)) = kind::of(&start) {
        return Err(InputError::OtherKind(path.to_owned(), what, advice));
    }
    // A file can grow while it is read, and some of the system's have no size.
    let rest = limit.bytes() - start.len() as u64;
    file.by_ref().take(rest.saturating_add(1)).read_to_end(&mut start).map_err(unreadable)?;
    if start.len() as u64 > limit.bytes() {
        let size = file.stream_position().unwrap_or(start.len() as u64);
        return Err(InputError::TooLarge(path.to_owned(), size, limit.bytes()));
    }
    Ok(start)
}

/// The text of a UTF-8 file, without a byte-order mark.
///
/// # Errors
/// As for [`read_bytes`]; bytes that are no UTF-8.
pub fn read_text(path: &Path, limit: Limit) -> Result<String, InputError> {
    text(path, read_bytes(path, limit)?)
}

/// Bytes of a file as UTF-8 text, without a byte-order mark. For a caller that needs the bytes too.
///
/// # Errors
/// [`InputError::NotText`], with the line.
pub fn text(path: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    let text = String::from_utf8(bytes).map_err(|why| {
        let good = &why.as_bytes()[..why.utf8_error().valid_up_to()];
        let line = good.split(|byte| *byte == b'\n').count();
        InputError::NotText(path.to_owned(), line)
    })?;
    match text.strip_prefix('\u{feff}') {
        Some(after) => Ok(after.to_owned()),
        None => Ok(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("files-input-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        path
    }

    #[test]
    fn pipes_devices_and_folders_are_named_and_not_read() {
        let folder = folder("kinds");
        let pipe = folder.join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let said = |path: &Path| read_text(path, Limit::Text).unwrap_err().reason();
        assert_eq!(said(&pipe), "found a named pipe, expected a file");
        assert_eq!(said(Path::new("/dev/zero")), "found a device, expected a file");
        assert_eq!(said(&folder), "found a folder, expected a file");
        let socket = folder.join("socket");
        let _bound = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert_eq!(said(&socket), "found a socket, expected a file");
        assert!(said(&folder.join("none")).starts_with("cannot be read: No such file"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_similar_name_is_suggested_for_an_absent_file() {
        let folder = folder("similar");
        for name in ["coach-80kmh.toml", "notes.txt"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let said = |name: &str| read_text(&folder.join(name), Limit::Text).unwrap_err().reason();
        let expected = format!("; did you mean {}?", folder.join("coach-80kmh.toml").display());
        assert!(said("coach-80kmh.tml").ends_with(&expected));
        assert!(said("caoch-80kmh.toml").ends_with(&expected));
        assert!(said("coach-80kmh").ends_with(&expected));
        for other in ["xyz.toml", "tone", "none/notes.txt"] {
            assert!(said(other).ends_with("(os error 2)"), "{other}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_link_to_nothing_was_suggested_in_its_own_place() {
        let folder = folder("dangling");
        let link = folder.join("work.csv");
        std::os::unix::fs::symlink("nowhere.csv", &link).unwrap();
        let said = || read_text(&link, Limit::Text).unwrap_err().reason();
        assert!(said().ends_with("(os error 2); it is a link to nowhere.csv"), "{}", said());
        std::fs::write(folder.join("works.csv"), "").unwrap();
        let expected = format!("; did you mean {}?", folder.join("works.csv").display());
        assert!(said().ends_with(&expected), "{}", said());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_file_over_its_limit_is_refused_unread() {
        let folder = folder("limit");
        let path = folder.join("large.toml");
        File::create(&path).unwrap().set_len(16_000_001).unwrap();
        let said = read_text(&path, Limit::Text).unwrap_err().reason();
        assert_eq!(said, "found 16000001 bytes, expected at most 16 MB");
        File::create(&path).unwrap().set_len(16_000_000).unwrap();
        assert!(read_text(&path, Limit::Text).is_ok());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn text_is_utf_8_and_loses_its_byte_order_mark() {
        let folder = folder("text");
        let path = folder.join("a.toml");
        std::fs::write(&path, b"\xef\xbb\xbfx = 1\n").unwrap();
        assert_eq!(read_text(&path, Limit::Text).unwrap(), "x = 1\n");
        std::fs::write(&path, b"x = 1\ny = \"\xe4\"\n").unwrap();
        let said = read_text(&path, Limit::Text).unwrap_err().to_string();
        assert!(
            said.ends_with("a.toml: line 2 is not UTF-8, expected text: save the file as UTF-8")
        );
        std::fs::write(&path, b"PK\x03\x04 xl/workbook.xml").unwrap();
        let said = read_text(&path, Limit::Text).unwrap_err().reason();
        assert_eq!(said, "found an Excel workbook, expected text: save the sheet as CSV");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
