//! Text of a file inside a message: cut to a length, control characters shown and not sent.
//!
//! A cell of a CSV file can hold a terminal sequence or a megabyte. Neither may reach the terminal
//! as it is.

use crate::expectation::in_plain_words;
use std::fmt::{self, Write as _};

/// Longest quotation, in characters.
pub const LONGEST: usize = 200;

/// Text that prints with its control characters escaped and at most [`LONGEST`] characters long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quoted<'a>(&'a str);

/// Equal characters that act, one after the other, that are counted and not repeated.
const RUN_LEAST: usize = 4;

/// Quotes text of a file.
///
/// ```
/// assert_eq!(files::quoted("\u{1b}[31mred").to_string(), "\\u{1b}[31mred");
/// let long = "x".repeat(300);
/// assert_eq!(files::quoted(&long).to_string(), format!("{}… (300 characters)", "x".repeat(200)));
/// ```
pub const fn quoted(text: &str) -> Quoted<'_> {
    Quoted(text)
}

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut left = self.0.chars().take(LONGEST).peekable();
        while let Some(shown) = left.next() {
            if !acts(shown) {
                f.write_char(shown)?;
                continue;
            }
            // A run of one such character says nothing by its length on the screen.
            let mut run = 1;
            while left.next_if_eq(&shown).is_some() {
                run += 1;
            }
            let escaped = shown.escape_default();
            match run {
                1..RUN_LEAST => (0..run).try_for_each(|_| write!(f, "{escaped}"))?,
                _ => write!(f, "{escaped}×{run}")?,
            }
        }
        let length = self.0.chars().count();
        if length > LONGEST { write!(f, "… ({length} characters)") } else { Ok(()) }
    }
}

/// True for a character that acts where it is shown: a control character, or a mark that turns the
/// direction of writing, which can make a message say something else.
pub fn acts(shown: char) -> bool {
    shown.is_control()
        || matches!(
            shown,
            '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

/// A message of another library about a file: every part of it in back quotes or double quotes is a
/// quotation, and so is what a quote that never closes leaves; line ends become blanks. Names of
/// Rust types are replaced by plain words ([`expectation`](crate::expectation)).
///
/// ```
/// let said = format!("unknown field `{}`, expected `a`", "x".repeat(300));
/// assert!(files::quote::message(&said).ends_with("… (300 characters)`, expected `a`"));
/// ```
pub fn message(said: &str) -> String {
    let line = in_plain_words(&said.trim().replace(['\n', '\r'], " "));
    let mut shown = String::new();
    let mut rest = line.as_str();
    while let Some(open) = rest.find(['`', '"']) {
        let mark = &rest[open..=open];
        let Some(length) = rest[open + 1..].find(mark) else { break };
        let inside = &rest[open + 1..open + 1 + length];
        // Writing to a string cannot fail.
        let _ = write!(shown, "{}{mark}{}{mark}", escaped(&rest[..open]), quoted(inside));
        rest = &rest[open + 2 + length..];
    }
    let _ = write!(shown, "{}", quoted(rest));
    shown
}

/// Text of any length with the characters that act ([`acts`]) escaped.
pub fn escaped(text: &str) -> String {
    text.chars()
        .flat_map(|c| {
            let escape = acts(c).then(|| c.escape_default()).into_iter().flatten();
            escape.chain((!acts(c)).then_some(c))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_letters_of_any_language_stay() {
        assert_eq!(quoted("Kräfte 力\t\0\u{9b}").to_string(), "Kräfte 力\\t\\u{0}\\u{9b}");
        assert_eq!(quoted(&format!("a{}b", "\0".repeat(50))).to_string(), "a\\u{0}×50b");
        assert_eq!(quoted("a\u{202e}b").to_string(), "a\\u{202e}b");
        assert_eq!(message("no `a\u{7}` in\nline"), "no `a\\u{7}` in line");
        assert_eq!(message("open `quote"), "open `quote");
    }
}
