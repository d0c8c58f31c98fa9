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
        input::read_bytes(path, Limit::Table).map(Self::decoded)
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
