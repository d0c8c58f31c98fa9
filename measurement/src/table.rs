//! The text of a file as rows of cells that know their lines.

use crate::error::MeasurementError;
use crate::fault::Fault;
use crate::heading;
use crate::layout::{Decimal, Layout, OPEN, Separator};
use crate::lines::{self, Lines};
use crate::number::Number;
use crate::text::Text;
use csv::StringRecord;
use files::{quote, quoted};
use std::path::{Path, PathBuf};

/// Rows at the end that may be a footer.
const FOOTER_MOST: usize = 5;

/// Rows of a file, or of one block of it, with the names of their columns.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    /// The file.
    pub(crate) file: PathBuf,
    /// Which block of the file, from one; `None` in a file of one block.
    pub(crate) block: Option<usize>,
    /// Names of the columns.
    pub(crate) names: Vec<String>,
    /// The row of units, where there is one.
    pub(crate) units: Option<Vec<String>>,
    /// Line of every row, from one.
    pub(crate) lines: Vec<usize>,
    /// What its comment lines say about the direction: line, text.
    pub(crate) extension: Option<(usize, String)>,
    /// The first comment line that says something else: line, text.
    pub(crate) other_extension: Option<(usize, String)>,
    /// What had to be repaired to read it.
    pub(crate) repairs: Vec<String>,
    rows: Vec<StringRecord>,
    decimal: Decimal,
    decimal_declared: bool,
    has_clock: bool,
}

impl Table {
    /// The tables of a text, one for each block of names and numbers.
    ///
    /// # Errors
    /// No rows, or a row of another length than the first.
    pub(crate) fn parse(
        path: &Path,
        text: &Text,
        layout: &Layout,
    ) -> Result<Vec<Self>, MeasurementError> {
        let lines = Lines::of(&text.content, layout);
        check_decimal_commas(path, &lines, layout)?;
        let (extension, footer) = (lines.extension.clone(), lines.footer.clone());
        let other_extension = lines.other_extension.clone();
        let blocks = lines.blocks(layout);
        let several = blocks.len() > 1;
        let begins: Vec<String> =
            blocks.iter().filter_map(|block| block.numbers.first().map(usize::to_string)).collect();
        let mut tables = Vec::with_capacity(blocks.len());
        for (index, block) in blocks.iter().enumerate() {
            let mut table = Self::of_block(path, block, layout)?;
            table.extension.clone_from(&extension);
            table.other_extension.clone_from(&other_extension);
            table.repairs.clone_from(&text.repairs);
            if several {
                table.block = Some(index + 1);
                table.repairs.push(format!(
                    "block {} of {}: the names of the columns stand in lines {}",
                    index + 1,
                    begins.len(),
                    begins.join(", ")
                ));
            }
            tables.push(table);
        }
        if let (Some((line, text)), Some(last)) = (footer, tables.last_mut()) {
            last.repairs.push(format!(
                "left out: text below the last row of numbers, from line {line} on: \"{}\"",
                quoted(&text)
            ));
        }
        Ok(tables)
    }

    fn of_block(path: &Path, lines: &Lines, layout: &Layout) -> Result<Self, MeasurementError> {
        let rows = rows(path, lines, layout.separator)?;
        let empty = || MeasurementError::File {
            file: path.to_owned(),
            found: "no rows".to_owned(),
            expected: "a row of names and rows of numbers".to_owned(),
        };
        let mut numbered = rows.into_iter().zip(lines.numbers.iter().copied());
        let texts = |row: &StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
        let names = if layout.header {
            Some(texts(&numbered.next().ok_or_else(empty)?.0))
        } else {
            Some(layout.names.clone()).filter(|names| !names.is_empty())
        };
        let below: Vec<StringRecord> =
            numbered.by_ref().take(layout.rows_below_names()).map(|(row, _)| row).collect();
        if below.len() < layout.rows_below_names() {
            return Err(empty());
        }
        let units = if layout.units_row {
            let at = heading::units_among(&below.iter().collect::<Vec<_>>()).unwrap_or(0);
            below.get(at).map(texts)
        } else {
            None
        };
        let (rows, numbers): (Vec<_>, Vec<_>) = numbered.unzip();
        let width = rows.first().map(StringRecord::len).ok_or_else(empty)?;
        let names = names.unwrap_or_else(|| (1..=width).map(|n| n.to_string()).collect());
        let mut table = Self {
            file: path.to_owned(),
            block: None,
            names,
            units,
            lines: numbers,
            extension: None,
            other_extension: None,
            repairs: Vec::new(),
            rows,
            decimal: layout.decimal.unwrap_or_default(),
            decimal_declared: layout.decimal.is_some(),
            has_clock: layout.sample_rate_hz.is_none(),
        };
        table.name_row_numbers();
        table.drop_comment_column();
        table.check_widths()?;
        debug_assert_eq!(table.rows.len(), table.lines.len(), "every row has its line");
        Ok(table)
    }

    /// A column without a name that counts the rows, as R writes it.
    fn name_row_numbers(&mut self) {
        let width = self.names.len() + 1;
        let is_wide = |row: &StringRecord| {
            row.len() == width && row.iter().next_back().is_some_and(|cell| !cell.is_empty())
        };
        if !self.rows.iter().all(is_wide) {
            return;
        }
        let first: Vec<&str> = self.rows.iter().filter_map(|row| row.get(0)).collect();
        if lines::counts(&first) {
            self.names.insert(0, lines::ROW_NUMBER.to_owned());
            self.units.iter_mut().for_each(|units| units.insert(0, String::new()));
        }
    }

    /// A column of comments at the end that no row has, as `LabVIEW` writes it.
    fn drop_comment_column(&mut self) {
        let is_comment = |name: &String| name.eq_ignore_ascii_case("comment");
        let is_absent = |row: &StringRecord| row.len() + 1 == self.names.len();
        if self.names.last().is_some_and(is_comment) && self.rows.iter().all(is_absent) {
            self.names.pop();
        }
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
                let found = format!("{} cells", row.len());
                let is_last = self.lines.last() == Some(line) && row.len() < expected;
                let hint = if is_last { " (the file ends within this row: delete it)" } else { "" };
                let hints = (self.separator_hint(), self.block_hint(row));
                let expected = format!("{expected}{}{}{hint}", hints.0, hints.1);
                return Err(self.cell_error(*line, "row", found, expected));
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

    /// What a row without numbers among the rows may be.
    fn block_hint(&self, row: &StringRecord) -> String {
        let number = |cell: &str| Number::of(cell, self.decimal, self.decimal_declared).is_some();
        if self.names.len() < 2 || row.iter().any(number) {
            return String::new();
        }
        if let [only] = row.iter().collect::<Vec<_>>().as_slice()
            && only.split([',', ';', '\t']).filter(|cell| number(cell.trim())).count() > 1
        {
            return " (another separator in this row, or quotes around all of it?)".to_owned();
        }
        let text: Vec<&str> = row.iter().collect();
        let text = text.join(" ");
        format!(
            " (\"{}\": a new block with other columns? only a block with the same row of names \
             starts a new test; delete a line of text, or cut the file there)",
            quoted(&text)
        )
    }

    /// Number of rows below the names and units.
    pub(crate) fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// True where a column of this name is there.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// Place of a column.
    ///
    /// # Errors
    /// Names the columns that there are.
    pub(crate) fn column(&self, name: &str) -> Result<usize, MeasurementError> {
        let named = |(_, other): &(usize, &String)| *other == name;
        let mut places = self.names.iter().enumerate().filter(named).map(|(place, _)| place);
        let Some(place) = places.next() else {
            let (names, hint) = (self.names.join(", "), self.separator_hint());
            let expected = if name == OPEN {
                format!("the name of one of them in the place of \"{name}\" in the mapping")
            } else {
                format!("one called {}", quoted(name))
            };
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("the columns {}{hint}", quoted(&names)),
                expected,
            });
        };
        // A program may write the same clock next to every channel.
        let is_same = |other: usize| self.rows.iter().all(|row| row.get(place) == row.get(other));
        if !places.all(is_same) {
            return Err(MeasurementError::File {
                file: self.file.clone(),
                found: format!("several columns called {}", quoted(name)),
                expected: "one; a mapping with header = false and skip_lines calls them \"1\", \
                           \"2\", ..."
                    .to_owned(),
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
    pub(crate) fn number(&self, row: usize, column: usize) -> Option<Number> {
        Number::of(self.cell(row, column), self.decimal, self.decimal_declared)
    }

    /// A cell's finite number.
    ///
    /// # Errors
    /// Names file, line and column.
    pub(crate) fn finite(&self, row: usize, column: usize) -> Result<Number, MeasurementError> {
        match self.number(row, column).filter(|number| number.value.is_finite()) {
            Some(number) => Ok(number),
            None => Err(self.not_finite(row, column)),
        }
    }

    /// The error of a cell that holds no finite number.
    pub(crate) fn not_finite(&self, row: usize, column: usize) -> MeasurementError {
        let cell = self.cell(row, column);
        let found = if cell.is_empty() {
            "an empty cell".to_owned()
        } else {
            format!("\"{}\"", quoted(cell))
        };
        let other = match self.decimal {
            Decimal::Point => (Decimal::Comma, "comma"),
            Decimal::Comma => (Decimal::Point, "point"),
        };
        let hint = match Number::of(cell, other.0, true) {
            Some(_) if !self.decimal_declared && cell.contains(',') => {
                " (decimal = \"comma\" or \"point\" in a mapping says what the comma is)".to_owned()
            }
            Some(_) if cell.contains(['.', ',']) => format!(" (decimal = \"{}\"?)", other.1),
            _ => String::new(),
        };
        let name = self.names.get(column).map_or("column", String::as_str);
        let line = self.lines.get(row).copied().unwrap_or(0);
        let fault = Fault::of(cell, |cell| self.is_finite(cell), self.is_footer(row, column));
        let way_out = fault.way_out(line, self.has_clock);
        self.cell_error(line, name, found, format!("a finite number{hint}{way_out}"))
    }

    fn is_finite(&self, cell: &str) -> bool {
        let number = Number::of(cell, self.decimal, self.decimal_declared);
        number.is_some_and(|number| number.value.is_finite())
    }

    /// True for a row near the end below which no row has a number in the column.
    fn is_footer(&self, row: usize, column: usize) -> bool {
        let rows = row..self.rows.len();
        rows.len() <= FOOTER_MOST
            && row > 0
            && rows.into_iter().all(|row| self.number(row, column).is_none())
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

/// Commas as decimal marks and between cells are clear only where cells are quoted.
fn check_decimal_commas(
    path: &Path,
    lines: &Lines,
    layout: &Layout,
) -> Result<(), MeasurementError> {
    let both = layout.separator == Separator::Comma && layout.decimal == Some(Decimal::Comma);
    if !both || lines.text.contains('"') {
        return Ok(());
    }
    Err(MeasurementError::File {
        file: path.to_owned(),
        found: "decimal = \"comma\" with commas between cells that are not quoted".to_owned(),
        expected: "another separator".to_owned(),
    })
}

/// The cells of every line.
fn rows(
    path: &Path,
    lines: &Lines,
    separator: Separator,
) -> Result<Vec<StringRecord>, MeasurementError> {
    let fail = |row: Option<usize>, found: String, expected: &str| MeasurementError::Cell {
        file: path.to_owned(),
        row: row.and_then(|row| lines.numbers.get(row)).copied().unwrap_or(1),
        column: "row".to_owned(),
        found,
        expected: expected.to_owned(),
    };
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator.byte())
        .trim(csv::Trim::All)
        .from_reader(lines.text.as_bytes());
    let mut rows: Vec<StringRecord> = Vec::with_capacity(lines.numbers.len());
    for record in reader.records() {
        let record = record.map_err(|error| {
            let found =
                format!("a row that cannot be read ({})", quote::message(&error.to_string()));
            fail(Some(rows.len()), found, "cells")
        })?;
        rows.push(record);
    }
    if rows.len() != lines.numbers.len() {
        let opened = rows.iter().position(|row| row.iter().any(|cell| cell.contains('\n')));
        let found = "a quoted cell over several lines".to_owned();
        return Err(fail(opened, found, "one line per row"));
    }
    Ok(rows)
}
