//! The lines of a file that hold cells, and the blocks that they form.

use crate::layout::{Layout, Separator};
use crate::number::Number;
use crate::stamp;
use csv::StringRecord;

/// Lines of text below the last row of numbers that are left out.
const FOOTER_MOST: usize = 5;
/// What a column without a name is called that counts the rows.
pub(crate) const ROW_NUMBER: &str = "row number";

/// Lines with cells.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lines {
    /// Their text, each ended by a line feed.
    pub(crate) text: String,
    /// Their numbers in the file, from one.
    pub(crate) numbers: Vec<usize>,
    /// What a comment line says about the direction: line, text.
    pub(crate) extension: Option<(usize, String)>,
    /// The first comment line that says something else.
    pub(crate) other_extension: Option<(usize, String)>,
    /// Text below the last row of numbers: the first line of it, its text.
    pub(crate) footer: Option<(usize, String)>,
}

impl Lines {
    /// The lines of a text without comments, blank lines, and rows of separators only, which a
    /// spreadsheet writes below its last row.
    pub(crate) fn of(text: &str, layout: &Layout) -> Self {
        let mut lines = Self { text: String::with_capacity(text.len()), ..Self::default() };
        for (at, line) in text.lines().enumerate() {
            let comment =
                !layout.comment.is_empty() && line.trim_start().starts_with(&layout.comment);
            if comment {
                let said = line.trim_start().trim_start_matches(&layout.comment).trim_start();
                if let Some(sign) = said.strip_prefix("extension:") {
                    let said = (at + 1, sign.trim().to_owned());
                    let first = lines.extension.get_or_insert_with(|| said.clone());
                    if first.1 != said.1 {
                        lines.other_extension.get_or_insert(said);
                    }
                }
            }
            // The first line of some spreadsheets names the separator.
            let is_sep =
                at == 0 && line.get(..4).is_some_and(|sep| sep.eq_ignore_ascii_case("sep="));
            if at < layout.skip_lines || comment || is_sep || is_blank(line, layout.separator) {
                continue;
            }
            lines.push(at + 1, line, layout.separator);
        }
        lines.cut_footer(layout);
        lines
    }

    /// Takes off a few lines without any number below the last row of numbers.
    fn cut_footer(&mut self, layout: &Layout) {
        let plain =
            |cell: &str| Number::of(cell, layout.decimal.unwrap_or_default(), true).is_some();
        // A date in a sentence is no row.
        let is_text = |line: &str| {
            let cells = cells(line, layout.separator);
            let is_one = cells.len() < 2;
            cells.iter().all(|cell| !plain(cell) && (is_one || !stamp::is_stamp(cell)))
        };
        let names = self.text.lines().next().unwrap_or("").trim().to_owned();
        let below: Vec<&str> = self
            .text
            .lines()
            .rev()
            .take(FOOTER_MOST + 1)
            .take_while(|line| is_text(line) && line.trim() != names)
            .collect();
        let count = below.len();
        let is_below_numbers =
            self.text.lines().rev().nth(count).is_some_and(|line| !is_text(line));
        if !(1..=FOOTER_MOST).contains(&count) || !is_below_numbers {
            return;
        }
        let bytes: usize = below.iter().map(|line| line.len() + 1).sum();
        let text = below.last().map(|line| line.trim().to_owned()).unwrap_or_default();
        self.text.truncate(self.text.len() - bytes);
        let line = self.numbers.get(self.numbers.len() - count).copied().unwrap_or(0);
        self.numbers.truncate(self.numbers.len() - count);
        self.footer = Some((line, text));
    }

    fn push(&mut self, number: usize, line: &str, separator: Separator) {
        self.numbers.push(number);
        if separator == Separator::Whitespace {
            let cells: Vec<&str> = line.split_whitespace().collect();
            self.text.push_str(&cells.join("\t"));
        } else {
            self.text.push_str(line);
        }
        self.text.push('\n');
    }

    /// The blocks of a file whose row of names comes again, each from its row of names on and
    /// without the text above the next one; else all lines.
    pub(crate) fn blocks(self, layout: &Layout) -> Vec<Self> {
        let lines: Vec<&str> = self.text.lines().collect();
        let Some(names) = lines.first().map(|line| line.trim()).filter(|_| layout.header) else {
            return vec![self];
        };
        // A row of numbers that comes again is no row of names.
        let has_numbers = |line: &str| pattern(line, layout).contains(&true);
        let again = |line: &&str| line.trim() == names && !has_numbers(names);
        let starts: Vec<usize> =
            (0..lines.len()).filter(|at| lines.get(*at).is_some_and(again)).collect();
        if starts.len() < 2 {
            return vec![self];
        }
        let first = lines.get(1 + layout.rows_below_names()).copied().unwrap_or("");
        let is_blank_first = cells(first, layout.separator).get(0).is_some_and(str::is_empty);
        let pattern = pattern(first, layout);
        let ends = starts.iter().skip(1).copied().chain([lines.len()]);
        let mut blocks = Vec::with_capacity(starts.len());
        for (start, end) in starts.iter().copied().zip(ends) {
            let is_last = end == lines.len();
            let above =
                // A tag in front of numbers, where rows have nothing, is LabVIEW's.
                |at: &usize| {
                    let is_tagged = |line: &str| {
                        cells(line, layout.separator).get(0).is_some_and(|cell| !cell.is_empty())
                    };
                    lines.get(*at).is_some_and(|line| {
                        is_data(line, layout, &pattern) && !(is_blank_first && is_tagged(line))
                    })
                };
            let last = (start..end).rev().find(|at| is_last || above(at)).unwrap_or(start);
            let mut block = Self::default();
            for at in start..=last {
                if let (Some(line), Some(number)) = (lines.get(at), self.numbers.get(at)) {
                    block.push(*number, line, layout.separator);
                }
            }
            blocks.push(block);
        }
        blocks
    }
}

/// True for a line of blanks, separators and empty quotations.
pub(crate) fn is_blank(line: &str, separator: Separator) -> bool {
    let byte = char::from(separator.byte());
    line.chars().all(|c| c == byte || c == '"' || c.is_whitespace())
}

/// True for a cell that holds a number or a time.
fn is_number(cell: &str, layout: &Layout) -> bool {
    Number::of(cell, layout.decimal.unwrap_or_default(), true).is_some() || stamp::is_stamp(cell)
}

/// Which cells of a line are numbers.
fn pattern(line: &str, layout: &Layout) -> Vec<bool> {
    cells(line, layout.separator).iter().map(|cell| is_number(cell, layout)).collect()
}

/// Whether a line has numbers, or nothing, where a row of numbers has them.
fn is_data(line: &str, layout: &Layout, pattern: &[bool]) -> bool {
    let cells = cells(line, layout.separator);
    let mut numbers = 0;
    for (cell, _) in cells.iter().zip(pattern).filter(|(_, is_number)| **is_number) {
        if !cell.is_empty() && !is_number(cell, layout) {
            return false;
        }
        numbers += usize::from(!cell.is_empty());
    }
    numbers > 0 && cells.len() >= pattern.len()
}

/// True for cells that count 1, 2, 3 or 0, 1, 2.
pub(crate) fn counts(cells: &[&str]) -> bool {
    let number = |cell: &str| cell.parse::<u64>().ok();
    let Some(first) = cells.first().and_then(|cell| number(cell)).filter(|first| *first <= 1)
    else {
        return false;
    };
    cells.iter().zip(first..).all(|(cell, expected)| number(cell) == Some(expected))
}

/// The cells of a line, blanks taken as one where they separate.
pub(crate) fn row(line: &str, separator: Separator) -> StringRecord {
    if separator == Separator::Whitespace {
        return cells(&line.split_whitespace().collect::<Vec<_>>().join("\t"), separator);
    }
    cells(line, separator)
}

/// The cells of one line.
pub(crate) fn cells(line: &str, separator: Separator) -> StringRecord {
    // A line without quotes needs no reader: making one takes longer than a thousand cells.
    if line.is_empty() || line.contains(['"', '\r', '\n']) {
        return quoted_cells(line, separator);
    }
    line.split(char::from(separator.byte())).map(str::trim).collect()
}

/// The same for a line that may have quotes.
fn quoted_cells(line: &str, separator: Separator) -> StringRecord {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator.byte())
        .trim(csv::Trim::All)
        .from_reader(line.as_bytes());
    reader.records().next().and_then(Result::ok).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_quotes_has_the_cells_that_the_reader_finds() {
        let lines =
            ["1,2;3\t4 5", " 1.5 ; -2,0 ;;", ",,", "   ", "\u{a0}time\u{2003}, s ", "n", "µ\tm"];
        for separator in [Separator::Comma, Separator::Semicolon, Separator::Tab] {
            for line in lines {
                assert_eq!(cells(line, separator), quoted_cells(line, separator), "{line:?}");
            }
        }
        assert_eq!(cells("a,\"b, c\"", Separator::Comma), vec!["a", "b, c"]);
        assert!(cells("", Separator::Comma).is_empty());
    }
}
