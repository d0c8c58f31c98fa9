//! Key numbers, large, in a row: what a reader wants to know first.

use crate::html::escape;
use crate::number::significant;

/// One key number or word with its label.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    label: String,
    value: String,
    unit: String,
    /// Class of its element, with the space before it.
    verdict: &'static str,
}

impl Tile {
    /// A number with its unit, shown with four significant digits.
    pub fn number(label: &str, value: f64, unit: &str) -> Self {
        Self { unit: unit.to_owned(), ..Self::text(label, &significant(value, 4)) }
    }

    /// A count, shown with all its digits.
    pub fn count(label: &str, value: u64) -> Self {
        Self::text(label, &value.to_string())
    }

    /// A word, or a number that the caller has written out.
    pub fn text(label: &str, value: &str) -> Self {
        Self { label: label.to_owned(), value: value.to_owned(), unit: String::new(), verdict: "" }
    }

    /// Marks the tile as passed: a tick and a green edge.
    #[must_use]
    pub fn good(self) -> Self {
        Self { verdict: " good", ..self }
    }

    /// Marks the tile as failed: a cross and a red edge.
    #[must_use]
    pub fn bad(self) -> Self {
        Self { verdict: " bad", ..self }
    }

    /// Marks the tile as doubtful: an exclamation mark and an amber edge.
    #[must_use]
    pub fn doubtful(self) -> Self {
        Self { verdict: " doubtful", ..self }
    }

    pub(crate) fn html(&self) -> String {
        // The sign says what the colour says, for print and for eyes that do not see it.
        let sign = match self.verdict {
            " good" => "<span class=\"sign\">✓</span>",
            " bad" => "<span class=\"sign\">✗</span>",
            " doubtful" => "<span class=\"sign\">!</span>",
            _ => "",
        };
        // Words are longer than numbers and get a smaller size.
        let size = if self.value.len() > 7 && self.value.starts_with(char::is_alphabetic) {
            " word"
        } else {
            ""
        };
        let unit = match self.unit.as_str() {
            "" => String::new(),
            unit => format!(" <span class=\"unit\">{}</span>", escape(unit)),
        };
        format!(
            "<div class=\"tile{}{size}\"><dt>{}</dt><dd>{sign}{}{unit}</dd></div>\n",
            self.verdict,
            escape(&self.label),
            escape(&self.value),
        )
    }
}
