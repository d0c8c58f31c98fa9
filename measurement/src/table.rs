//! A text file as rows of cells that know their lines.

use super::error::MeasurementError;
use super::mapping::{Decimal, Layout, Separator};
use csv::StringRecord;
use std::path::{Path, PathBuf};

/// Rows of a file with the names of their columns.
#[derive(Debug, Clone)]
pub struct Table {
    /// The file.
    pub file: PathBuf,
    /// Names of the columns.
    pub names: Vec<String>,
    /// The row of units, where there is one.
    pub units: Option<Vec<String>>,
    /// Line of every row, from one.
    pub lines: Vec<usize>,
    /// Cells of every row.
    pub rows: Vec<StringRecord>,
    /// What its comment lines say about the direction, as text.
    pub extension: Option<(usize, String)>,
    /// What had to be mended to read it.
    pub repairs: Vec<String>,
    decimal: Decimal,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, has no rows, or a row of another length than the first.
    pub fn read(path: &Path, layout: &Layout) -> Result<Self, MeasurementError> {
        let bytes = std::fs::read(path).map_err(|error| MeasurementError::File {
            file: path.to_owned(),
            found: format!("no readable file ({error})"),
            expected: "a table of text".to_owned(),
        })?;
        let mut repairs = Vec::new();
        let text = decode(bytes, &mut repairs);
        Self::parse(path, &text, layout, repairs)
    }

    /// Reads text that is in memory already.
    ///
    /// # Errors
    /// No rows, or a row of another length than the first.
    pub fn parse(
        path: &Path,
        text: &str,
        layout: &Layout,
        repairs: Vec<String>,
    ) -> Result<Self, MeasurementError> {
        let fail = |row, found: String, expected: String| MeasurementError::Cell {
            file: path.to_owned(),
            row,
            column: "row".to_owned(),
            found,
            expected,
        };
        let (mut kept, mut lines, mut extension) =
            (String::with_capacity(text.len()), vec![], None);
        for (at, line) in text.lines().enumerate() {
            let comment =
                !layout.comment.is_empty() && line.trim_start().starts_with(&layout.comment);
            if comment {
                let said = line.trim_start().trim_start_matches(&layout.comment).trim_start();
                if let Some(sign) = said.strip_prefix("extension:") {
                    extension = Some((at + 1, sign.trim().to_owned()));
                }
            }
            if at < layout.skip_lines || comment || line.trim().is_empty() {
                continue;
            }
            lines.push(at + 1);
            if layout.separator == Separator::Whitespace {
                let cells: Vec<&str> = line.split_whitespace().collect();
                kept.push_str(&cells.join("\t"));
            } else {
                kept.push_str(line);
            }
            kept.push('\n');
        }
        let delimiter = match layout.separator {
            Separator::Comma => b',',
            Separator::Semicolon => b';',
            Separator::Tab | Separator::Whitespace => b'\t',
        };
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .from_reader(kept.as_bytes());
        let mut rows: Vec<StringRecord> = Vec::with_capacity(lines.len());
        for record in reader.records() {
            let record = record.map_err(|error| {
                let line = lines.get(rows.len()).copied().unwrap_or(0);
                fail(line, format!("a row that cannot be read ({error})"), "cells".to_owned())
            })?;
            rows.push(record);
        }
        if rows.len() != lines.len() {
            let opened = rows.iter().position(|row| row.iter().any(|cell| cell.contains('\n')));
            let line = opened.and_then(|row| lines.get(row)).copied().unwrap_or(1);
            return Err(fail(
                line,
                "a quoted cell over several lines".into(),
                "one line per row".into(),
            ));
        }
        let empty = || MeasurementError::File {
            file: path.to_owned(),
            found: "no rows".to_owned(),
            expected: "a row of names and rows of numbers".to_owned(),
        };
        let mut rows = rows.into_iter();
        let mut lines = lines.into_iter();
        let mut next = || rows.next().zip(lines.next());
        let owned = |row: &StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
        let names = if layout.header { Some(owned(&next().ok_or_else(empty)?.0)) } else { None };
        let units = if layout.units_row { Some(owned(&next().ok_or_else(empty)?.0)) } else { None };
        let (rows, lines): (Vec<_>, Vec<_>) = (rows.collect(), lines.collect());
        let width = rows.first().map(StringRecord::len).ok_or_else(empty)?;
        let names = names.unwrap_or_else(|| (1..=width).map(|n| n.to_string()).collect());
        let mut table = Self {
            file: path.to_owned(),
            names,
            units,
            lines,
            rows,
            extension,
            repairs,
            decimal: layout.decimal,
        };
        table.check_widths()?;
        Ok(table)
    }

    /// Every row must have as many cells as there are names; a separator at the end of every line
    /// makes one nameless empty column, which is no column.
    fn check_widths(&mut self) -> Result<(), MeasurementError> {
        while self.names.last().is_some_and(String::is_empty) {
            self.names.pop();
        }
        let expected = self.names.len();
        for (row, line) in self.rows.iter().zip(&self.lines) {
            let spare = row.iter().skip(expected).any(|cell| !cell.is_empty());
            if row.len() < expected || spare {
                return Err(self.cell_error(
                    *line,
                    "row",
                    format!("{} cells", row.len()),
                    format!("{expected}{}", self.separator_hint()),
                ));
            }
        }
        Ok(())
    }

    /// What may be wrong where all names stand in one cell.
    fn separator_hint(&self) -> &'static str {
        match self.names.as_slice() {
            [only] if only.contains([';', '\t', ' ']) => {
                " (another separator? a mapping says which)"
            }
            _ => "",
        }
    }

    /// Place of a column.
    ///
    /// # Errors
    /// Names the columns that there are.
    pub fn column(&self, name: &str) -> Result<usize, MeasurementError> {
        let mut places = self.names.iter().enumerate().filter(|(_, other)| *other == name);
        let Some((place, _)) = places.next() else {
            let (names, hint) = (self.names.join(", "), self.separator_hint());
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("the columns {names}{hint}"),
                expected: format!("one called {name}"),
            });
        };
        if places.next().is_some() {
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("several columns called {name}"),
                expected: "one".to_owned(),
            });
        }
        Ok(place)
    }

    /// A cell's text.
    pub fn cell(&self, row: usize, column: usize) -> &str {
        self.rows.get(row).and_then(|cells| cells.get(column)).unwrap_or("")
    }

    /// A cell's number, if it is one; not a number and infinities are numbers here.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        let cell = self.cell(row, column);
        match self.decimal {
            Decimal::Point => cell.parse().ok(),
            Decimal::Comma => cell.replace(',', ".").parse().ok(),
        }
    }

    /// A cell's finite number.
    ///
    /// # Errors
    /// Names file, line and column.
    pub fn finite(&self, row: usize, column: usize) -> Result<f64, MeasurementError> {
        if let Some(number) = self.number(row, column).filter(|number| number.is_finite()) {
            return Ok(number);
        }
        let cell = self.cell(row, column);
        let found =
            if cell.is_empty() { "an empty cell".to_owned() } else { format!("\"{cell}\"") };
        let name = self.names.get(column).map_or("column", String::as_str);
        let line = self.lines.get(row).copied().unwrap_or(0);
        Err(self.cell_error(line, name, found, "a finite number"))
    }

    /// Decimals in a cell; exponents count as none.
    pub fn decimals(&self, row: usize, column: usize) -> Option<usize> {
        let cell = self.cell(row, column);
        let mark = if self.decimal == Decimal::Comma { ',' } else { '.' };
        if cell.contains(['e', 'E']) {
            return None;
        }
        Some(cell.split_once(mark).map_or(0, |(_, decimals)| decimals.len()))
    }

    /// An error at a line.
    pub fn cell_error(
        &self,
        row: usize,
        column: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> MeasurementError {
        MeasurementError::Cell {
            file: self.file.clone(),
            row,
            column: column.to_owned(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Bytes as text: UTF-8 with or without its mark, UTF-16 of spreadsheets, else Latin-1.
fn decode(bytes: Vec<u8>, repairs: &mut Vec<String>) -> String {
    let pairs = |of: fn([u8; 2]) -> u16| -> String {
        let units: Vec<u16> =
            bytes.as_chunks::<2>().0.iter().skip(1).map(|pair| of(*pair)).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes.as_slice() {
        [0xff, 0xfe, ..] => return pairs(u16::from_le_bytes),
        [0xfe, 0xff, ..] => return pairs(u16::from_be_bytes),
        _ => {}
    }
    match String::from_utf8(bytes) {
        Ok(text) => text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text),
        Err(error) => {
            repairs.push("the text is not UTF-8: read as Latin-1".to_owned());
            error.as_bytes().iter().map(|byte| char::from(*byte)).collect()
        }
    }
}
