//! A table on a terminal: aligned columns that survive being copied into a text.

use super::{Cell, Column, Format, Table};
use crate::number::significant;
use std::fmt;

/// Blanks between two columns.
const GAP: &str = "  ";

impl Table {
    /// The table as text: the caption if there is one, the heads with their units, a line per row.
    /// Numbers are aligned right, nothing is clipped, and every line ends with a newline.
    ///
    /// Text from files is shown with its control characters escaped
    /// ([`quoted`](files::quoted)), so that no name acts on the terminal.
    ///
    /// ```
    /// use report::{Cell, Table};
    ///
    /// let table = Table::new("Yaw dampers")
    ///     .text("damper")
    ///     .fixed("rms", "kN", 2)
    ///     .written("over seeds", "km/h")
    ///     .number("work", "J/s")
    ///     .row(["front left".into(), 11.312.into(), "247 to 254".into(), 204.88.into()])
    ///     .row(["rear left".into(), 9.7.into(), Cell::Empty, 1.5.into()]);
    /// assert_eq!(
    ///     table.to_text(),
    ///     "Yaw dampers\n\
    ///      damper      rms kN  over seeds km/h  work J/s\n\
    ///      front left   11.31       247 to 254     204.9\n\
    ///      rear left     9.70                -     1.500\n"
    /// );
    /// ```
    pub fn to_text(&self) -> String {
        self.to_string()
    }

    /// The lines of [`to_text`](Self::to_text) without the caption, for a list of lines.
    pub fn lines(&self) -> Vec<String> {
        let heads: Vec<String> = self.columns.iter().map(Column::head_in_text).collect();
        let row = |cells: &Vec<Cell>| -> Vec<String> {
            let formats = self.columns.iter().map(|column| column.format);
            // A cell without a column, which a page refuses, is shown all the same.
            let formats = formats.chain(std::iter::repeat(Format::Words));
            cells.iter().zip(formats).map(|(cell, format)| cell.in_text(format)).collect()
        };
        let rows: Vec<Vec<String>> =
            std::iter::once(heads).chain(self.rows.iter().map(row)).collect();
        let count = rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..count).map(width).collect();
        let left = |column: usize| {
            self.columns.get(column).is_none_or(|column| column.format == Format::Words)
        };
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
                if left(column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            cells.collect::<Vec<_>>().join(GAP).trim_end().to_owned()
        };
        rows.iter().map(line).collect()
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.caption.is_empty() {
            writeln!(f, "{}", files::quoted(&self.caption))?;
        }
        self.lines().iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

impl Column {
    /// The head with its unit as a terminal has room for it: `rms kN`.
    fn head_in_text(&self) -> String {
        let head = files::quoted(&self.head);
        if self.unit.is_empty() { head.to_string() } else { format!("{head} {}", self.unit) }
    }
}

impl Cell {
    fn in_text(&self, format: Format) -> String {
        match self {
            Self::Text(text) => files::quoted(text).to_string(),
            Self::Count(count) => count.to_string(),
            Self::Number(value) => format.number(*value),
            Self::Empty => "-".to_owned(),
        }
    }
}

impl Format {
    /// A number as its column shows it, on the page and on the terminal.
    pub(super) fn number(self, value: f64) -> String {
        match self {
            Self::Significant(digits) => significant(value, digits),
            Self::Decimals(decimals) => {
                let shown = format!("{value:.decimals$}");
                // What rounds to nothing has no sign.
                let nothing =
                    !shown.contains(|c: char| c.is_alphabetic() || ('1'..='9').contains(&c));
                if nothing { shown.replace('-', "") } else { shown }
            }
            Self::Words | Self::Written => significant(value, 4),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell_and_names_are_whole() {
        let long = "a damper with a name that is never clipped, however narrow the terminal is";
        let table = Table::new("")
            .number_with_digits("speed", "km/h", 5)
            .text("name")
            .row([160.0.into(), long.into()])
            .row([5.into(), "b".into()]);
        let expected = format!("speed km/h  name\n    160.00  {long}\n         5  b\n");
        assert_eq!(table.to_text(), expected);
    }

    #[test]
    fn letters_count_and_not_bytes() {
        let table = Table::new("").text("ä").fixed("b", "", 1).row(["ßü".into(), 1.0.into()]);
        assert_eq!(table.lines(), ["ä     b", "ßü  1.0"]);
    }

    #[test]
    fn text_of_a_file_cannot_act_on_the_terminal() {
        let table = Table::new("a\u{1b}[2J").text("b").row(["\u{1b}[31mred".into()]);
        assert_eq!(table.to_text(), "a\\u{1b}[2J\nb\n\\u{1b}[31mred\n");
        let megabyte = Table::new("").text("b").row(["x".repeat(1_000_000).into()]);
        assert!(megabyte.to_text().len() < 300);
    }

    #[test]
    fn numbers_that_are_none_and_rows_of_another_length_are_shown() {
        let table = Table::new("")
            .fixed("a", "N", 2)
            .number("b", "")
            .row([f64::NAN.into(), f64::INFINITY.into()])
            .row([(-0.001).into()])
            .row([Cell::Empty, 2_u64.into(), "more".into()]);
        assert_eq!(table.lines(), [" a N    b", " NaN  inf", "0.00", "   -    2  more"]);
        assert_eq!(Table::new("empty").to_text(), "empty\n\n");
    }
}
