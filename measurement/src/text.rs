//! The text of a file, in whatever encoding a laboratory writes it.

use crate::error::MeasurementError;
use files::input::{self, InputError, Limit};
use std::path::Path;

/// The text of a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Text {
    /// Its lines.
    pub(crate) content: String,
    /// What had to be assumed to read it.
    pub(crate) repairs: Vec<String>,
}

impl Text {
    /// Reads a regular file.
    pub(crate) fn read(path: &Path) -> Result<Self, MeasurementError> {
        let bytes = input::read_bytes(path, Limit::Table)?;
        if let Some((what, advice)) = no_table(&bytes) {
            return Err(InputError::OtherKind(path.to_owned(), what, advice).into());
        }
        if let Some(line) = line_of_nul(&bytes) {
            return Err(MeasurementError::File {
                file: path.to_owned(),
                found: format!("NUL bytes in a text, from line {line} on"),
                expected:
                    "none: the file is damaged, or was not written to its end; cut it there, \
                           or delete them (tr -d '\\000' < FILE > NEW)"
                        .to_owned(),
            });
        }
        Ok(Self::decoded(bytes).with_line_feeds())
    }

    /// Lines that end as they did on old computers end as they do now.
    fn with_line_feeds(self) -> Self {
        if self.content.contains('\n') || !self.content.contains('\r') {
            return self;
        }
        Self { content: self.content.replace('\r', "\n"), ..self }
    }

    /// UTF-8 with or without its mark, UTF-16 of spreadsheets, else Latin-1.
    fn decoded(bytes: Vec<u8>) -> Self {
        let utf_16 = |from_bytes: fn([u8; 2]) -> u16| {
            let pairs = bytes.as_chunks::<2>().0.iter().skip(1);
            let units: Vec<u16> = pairs.map(|pair| from_bytes(*pair)).collect();
            Self { content: String::from_utf16_lossy(&units), repairs: Vec::new() }
        };
        match bytes.as_slice() {
            [0xff, 0xfe, ..] => return utf_16(u16::from_le_bytes),
            [0xfe, 0xff, ..] => return utf_16(u16::from_be_bytes),
            _ => {}
        }
        match String::from_utf8(bytes) {
            Ok(text) => {
                let content = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
                Self { content, repairs: Vec::new() }
            }
            Err(error) => Self {
                content: error.as_bytes().iter().map(|byte| char::from(*byte)).collect(),
                repairs: vec!["the text is not UTF-8: read as Latin-1".to_owned()],
            },
        }
    }
}

/// What bytes are that hold no table of text, and what to do about it.
fn no_table(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let start = bytes.get(..4096.min(bytes.len())).unwrap_or_default();
    let start = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    let next = start.get(1..).unwrap_or_default().trim_ascii_start().first();
    // A row of units in brackets begins with a letter.
    let is_json = match start.first() {
        Some(b'{') => matches!(next, Some(b'"' | b'}')),
        Some(b'[') => matches!(next, Some(b'{' | b'[' | b'"')),
        _ => false,
    };
    if is_json {
        return Some(("JSON", "write it as CSV, with pandas.read_json(..).to_csv(..) for example"));
    }
    if is_marked_wide(bytes) {
        return None;
    }
    match bare_wide(bytes) {
        Some(true) => return Some(("UTF-16 text without a byte-order mark", SAVE_LITTLE)),
        Some(false) => return Some(("UTF-16 text without a byte-order mark", SAVE_BIG)),
        None => {}
    }
    // Text with NUL bytes has no other control characters.
    let controls = bytes.iter().any(|byte| matches!(byte, 1..=8 | 14..=25 | 28..=31));
    if controls && bytes.contains(&0) {
        return Some(("a binary file of a kind that is not known", "export it as CSV"));
    }
    None
}

const SAVE_LITTLE: &str =
    "save it as UTF-8 in an editor, or with iconv -f UTF-16LE -t UTF-8 FILE > NEW";
const SAVE_BIG: &str =
    "save it as UTF-8 in an editor, or with iconv -f UTF-16BE -t UTF-8 FILE > NEW";

/// True for UTF-16 text that begins with its mark.
fn is_marked_wide(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff")
}

/// Whether a text looks like UTF-16 without its mark: every second byte is mostly zero, and the
/// others never are. True where the low byte comes first.
fn bare_wide(bytes: &[u8]) -> Option<bool> {
    let start = bytes.get(..4096.min(bytes.len())).unwrap_or_default();
    let pairs = start.as_chunks::<2>().0;
    let zeros = |at: usize| pairs.iter().filter(|pair| pair.get(at) == Some(&0)).count();
    let (first, second) = (zeros(0), zeros(1));
    let is_text = |high: usize, low: usize| pairs.len() >= 8 && low == 0 && 2 * high > pairs.len();
    match () {
        () if is_text(second, first) => Some(true),
        () if is_text(first, second) => Some(false),
        () => None,
    }
}

/// The line of the first NUL byte.
fn line_of_nul(bytes: &[u8]) -> Option<usize> {
    if is_marked_wide(bytes) {
        return None;
    }
    let at = bytes.iter().position(|byte| *byte == 0)?;
    Some(1 + bytes.iter().take(at).filter(|byte| **byte == b'\n').count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_and_binary_files_are_named() {
        for json in ["{\"time\": [0, 1]}", "[{\"t\": 0}]", "\u{feff}  [\n[0, 1], [2, 3]]"] {
            assert_eq!(no_table(json.as_bytes()).map(|kind| kind.0), Some("JSON"), "{json}");
        }
        assert!(no_table(b"1.0\0\0\x01").is_some());
        for text in ["[s],[mm],[N]\n", "time_s,x\n", "{a},{b}\n", "", "\u{feff}[s];[mm]"] {
            assert_eq!(no_table(text.as_bytes()), None, "{text}");
        }
    }
}
