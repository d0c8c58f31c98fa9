//! The text of a file, in whatever encoding a laboratory writes it.

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
    pub(crate) fn read(path: &Path) -> Result<Self, InputError> {
        let bytes = input::read_bytes(path, Limit::Table)?;
        match no_table(&bytes) {
            Some((what, advice)) => Err(InputError::OtherKind(path.to_owned(), what, advice)),
            None => Ok(Self::decoded(bytes).with_line_feeds()),
        }
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
    let is_wide = start.starts_with(b"\xff\xfe") || start.starts_with(b"\xfe\xff");
    if !is_wide && start.contains(&0) {
        return Some(("a binary file of a kind that is not known", "export it as CSV"));
    }
    None
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
