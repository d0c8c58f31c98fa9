//! The text of a file as rows of cells that know their lines.

use crate::error::MeasurementError;
use crate::layout::{Decimal, Layout, Separator};
use crate::text::Text;
use csv::StringRecord;
use files::{quote, quoted};
use std::path::{Path, PathBuf};

/// Rows of a file with the names of their columns.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    /// The file.
    pub(crate) file: PathBuf,
    /// Names of the columns.
    pub(crate) names: Vec<String>,
    /// The row of units, where there is one.
    pub(crate) units: Option<Vec<String>>,
    /// Line of every row, from one.
    pub(crate) lines: Vec<usize>,
    /// What its comment lines say about the direction: line, text.
    pub(crate) extension: Option<(usize, String)>,
    /// What had to be repaired to read it.
    pub(crate) repairs: Vec<String>,
    rows: Vec<StringRecord>,
    decimal: Decimal,
}

impl Table {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, has no rows, or a row of another length than the first.
    pub(crate) fn read(path: &Path, layout: &Layout) -> Result<Self, MeasurementError> {
        Self::parse(path, Text::read(path)?, layout)
    }

    /// Parses text that is in memory already.
    ///
    /// # Errors
    /// No rows, or a row of another length than the first.
    pub(crate) fn parse(
        path: &Path,
        text: Text,
        layout: &Layout,
    ) -> Result<Self, MeasurementError> {
        let lines = Lines::of(&text.content, layout);
        let rows = lines.rows(path, layout.separator)?;
        let empty = || MeasurementError::File {
            file: path.to_owned(),
            found: "no rows".to_owned(),
            expected: "a row of names and rows of numbers".to_owned(),
        };
        let mut numbered = rows.into_iter().zip(lines.numbers);
        let mut head = |is_there: bool| -> Result<Option<Vec<String>>, MeasurementError> {
            if !is_there {
                return Ok(None);
            }
            let (row, _) = numbered.next().ok_or_else(empty)?;
            Ok(Some(row.iter().map(str::to_owned).collect()))
        };
        let (names, units) = (head(layout.header)?, head(layout.units_row)?);
        let (rows, numbers): (Vec<_>, Vec<_>) = numbered.unzip();
        let width = rows.first().map(StringRecord::len).ok_or_else(empty)?;
        let names = names.unwrap_or_else(|| (1..=width).map(|n| n.to_string()).collect());
        let mut table = Self {
            file: path.to_owned(),
            names,
            units,
            lines: numbers,
            extension: lines.extension,
            repairs: text.repairs,
            rows,
            decimal: layout.decimal,
        };
        table.check_widths()?;
        debug_assert_eq!(table.rows.len(), table.lines.len(), "every row has its line");
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

    /// What may be wrong where all names are in one cell.
    fn separator_hint(&self) -> &'static str {
        match self.names.as_slice() {
            [only] if only.contains([';', '\t', ' ']) => {
                " (another separator? a mapping says which)"
            }
            _ => "",
        }
    }

    /// Number of rows below the names and units.
    pub(crate) fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Place of a column.
    ///
    /// # Errors
    /// Names the columns that there are.
    pub(crate) fn column(&self, name: &str) -> Result<usize, MeasurementError> {
        let mut places = self.names.iter().enumerate().filter(|(_, other)| *other == name);
        let Some((place, _)) = places.next() else {
            let (names, hint) = (self.names.join(", "), self.separator_hint());
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("the columns {}{hint}", quoted(&names)),
                expected: format!("one called {}", quoted(name)),
            });
        };
        if places.next().is_some() {
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("several columns called {}", quoted(name)),
                expected: "one".to_owned(),
            });
        }
        Ok(place)
    }

    /// A cell's text.
    pub(crate) fn cell(&self, row: usize, column: usize) -> &str {
        debug_assert!(row < self.rows.len() && column < self.names.len(), "{row}, {column}");
        self.rows.get(row).and_then(|cells| cells.get(column)).unwrap_or("")
    }

    /// A cell's number, if it is one; not a number and infinities are numbers here.
    pub(crate) fn number(&self, row: usize, column: usize) -> Option<f64> {
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
    pub(crate) fn finite(&self, row: usize, column: usize) -> Result<f64, MeasurementError> {
        if let Some(number) = self.number(row, column).filter(|number| number.is_finite()) {
            return Ok(number);
        }
        let cell = self.cell(row, column);
        let found = if cell.is_empty() {
            "an empty cell".to_owned()
        } else {
            format!("\"{}\"", quoted(cell))
        };
        let name = self.names.get(column).map_or("column", String::as_str);
        let line = self.lines.get(row).copied().unwrap_or(0);
        Err(self.cell_error(line, name, found, "a finite number"))
    }

    /// Decimals in a cell; exponents count as none.
    pub(crate) fn decimals(&self, row: usize, column: usize) -> Option<usize> {
        let cell = self.cell(row, column);
        let mark = if self.decimal == Decimal::Comma { ',' } else { '.' };
        if cell.contains(['e', 'E']) {
            return None;
        }
        Some(cell.split_once(mark).map_or(0, |(_, decimals)| decimals.len()))
    }

    /// An error at a line.
    pub(crate) fn cell_error(
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

/// The lines of a file that hold cells.
struct Lines {
    /// Their text.
    text: String,
    /// Their numbers in the file, from one.
    numbers: Vec<usize>,
    /// What a comment line says about the direction: line, text.
    extension: Option<(usize, String)>,
}

impl Lines {
    fn of(text: &str, layout: &Layout) -> Self {
        let mut lines =
            Self { text: String::with_capacity(text.len()), numbers: vec![], extension: None };
        for (at, line) in text.lines().enumerate() {
            let comment =
                !layout.comment.is_empty() && line.trim_start().starts_with(&layout.comment);
            if comment {
                let said = line.trim_start().trim_start_matches(&layout.comment).trim_start();
                if let Some(sign) = said.strip_prefix("extension:") {
                    lines.extension = Some((at + 1, sign.trim().to_owned()));
                }
            }
            if at < layout.skip_lines || comment || line.trim().is_empty() {
                continue;
            }
            lines.numbers.push(at + 1);
            if layout.separator == Separator::Whitespace {
                let cells: Vec<&str> = line.split_whitespace().collect();
                lines.text.push_str(&cells.join("\t"));
            } else {
                lines.text.push_str(line);
            }
            lines.text.push('\n');
        }
        lines
    }

    /// The cells of every line.
    fn rows(
        &self,
        path: &Path,
        separator: Separator,
    ) -> Result<Vec<StringRecord>, MeasurementError> {
        let fail = |row: Option<usize>, found: String, expected: &str| MeasurementError::Cell {
            file: path.to_owned(),
            row: row.and_then(|row| self.numbers.get(row)).copied().unwrap_or(1),
            column: "row".to_owned(),
            found,
            expected: expected.to_owned(),
        };
        let delimiter = match separator {
            Separator::Comma => b',',
            Separator::Semicolon => b';',
            Separator::Tab | Separator::Whitespace => b'\t',
        };
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .from_reader(self.text.as_bytes());
        let mut rows: Vec<StringRecord> = Vec::with_capacity(self.numbers.len());
        for record in reader.records() {
            let record = record.map_err(|error| {
                let found =
                    format!("a row that cannot be read ({})", quote::message(&error.to_string()));
                fail(Some(rows.len()), found, "cells")
            })?;
            rows.push(record);
        }
        if rows.len() != self.numbers.len() {
            let opened = rows.iter().position(|row| row.iter().any(|cell| cell.contains('\n')));
            let found = "a quoted cell over several lines".to_owned();
            return Err(fail(opened, found, "one line per row"));
        }
        Ok(rows)
    }
}
