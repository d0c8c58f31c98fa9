//! Columns of numbers in a CSV file of somebody else.

use crate::error::StudyError;
use files::quote::message;
use files::{Limit, quoted};
use std::path::{Path, PathBuf};

/// The columns of a file.
pub(super) struct Columns {
    file: PathBuf,
    /// Line of every row.
    lines: Vec<usize>,
    /// Column by column; none for a column that is not there.
    cells: Vec<Option<Vec<Option<f64>>>>,
}

impl Columns {
    /// Reads the columns with these names, of which the first `needed` have to be there; others are
    /// not read. A cell may be empty.
    ///
    /// # Errors
    /// A file that cannot be read, a column that is missing or there twice, a cell that is no
    /// finite number.
    pub(super) fn read(path: &Path, names: &[&str], needed: usize) -> Result<Self, StudyError> {
        Self::parse(path, &files::input::read_text(path, Limit::Text)?, names, needed)
    }

    /// The same of a text; `path` names it in errors.
    pub(super) fn parse(
        path: &Path,
        text: &str,
        names: &[&str],
        needed: usize,
    ) -> Result<Self, StudyError> {
        let wrong = |line: Option<usize>, found: String, expected: String| StudyError::Table {
            file: path.to_owned(),
            line,
            found,
            expected,
        };
        let broken = |why: &csv::Error| {
            let line = why.position().map(|place| place.line() as usize);
            wrong(line, message(&why.to_string()), "a table of numbers, comma separated".into())
        };
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let heads = reader.headers().map_err(|why| broken(&why))?.clone();
        let mut places = Vec::new();
        for (number, name) in names.iter().enumerate() {
            let mut found = heads.iter().enumerate().filter(|(_, head)| head == name);
            let place = found.next().map(|(place, _)| place);
            let expected = || names[..needed].join(",");
            if found.next().is_some() {
                return Err(wrong(Some(1), format!("column {name} twice"), expected()));
            }
            if number < needed && place.is_none() {
                return Err(wrong(Some(1), format!("no column {name}"), expected()));
            }
            places.push(place);
        }
        let mut columns: Vec<Option<Vec<Option<f64>>>> =
            places.iter().map(|place| place.map(|_| Vec::new())).collect();
        let mut lines = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|why| broken(&why))?;
            let line = record.position().map_or(0, |place| place.line() as usize);
            lines.push(line);
            for ((place, column), name) in places.iter().zip(&mut columns).zip(names) {
                let (Some(place), Some(column)) = (place, column) else { continue };
                let cell = record.get(*place).unwrap_or_default();
                let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
                if value.is_none() && !cell.is_empty() {
                    let found = format!("\"{}\" in column {name}", quoted(cell));
                    return Err(wrong(Some(line), found, "a finite number".to_owned()));
                }
                column.push(value);
            }
        }
        Ok(Self { file: path.to_owned(), lines, cells: columns })
    }

    /// Rows below the head.
    pub(super) fn rows(&self) -> usize {
        self.lines.len()
    }

    /// The numbers of a column, which has no empty cell; none of a column that is not there.
    ///
    /// # Errors
    /// An empty cell.
    pub(super) fn full(&self, column: usize) -> Result<Option<Vec<f64>>, StudyError> {
        let Some(Some(cells)) = self.cells.get(column) else { return Ok(None) };
        let number = |(row, cell): (usize, &Option<f64>)| {
            cell.ok_or_else(|| self.wrong(row, "an empty cell".to_owned(), "a finite number"))
        };
        cells.iter().enumerate().map(number).collect::<Result<Vec<f64>, StudyError>>().map(Some)
    }

    /// The numbers of a column up to its first empty cell, below which all have to be empty.
    ///
    /// # Errors
    /// A number below an empty cell.
    pub(super) fn leading(&self, column: usize) -> Result<Vec<f64>, StudyError> {
        let Some(Some(cells)) = self.cells.get(column) else { return Ok(Vec::new()) };
        let values: Vec<f64> = cells.iter().map_while(|cell| *cell).collect();
        match cells.iter().skip(values.len()).position(Option::is_some) {
            None => Ok(values),
            Some(after) => {
                let found = "a number below an empty cell".to_owned();
                Err(self.wrong(values.len() + after, found, "none below the last coefficient"))
            }
        }
    }

    /// What is wrong in a row.
    pub(super) fn wrong(&self, row: usize, found: String, expected: &str) -> StudyError {
        let line = self.lines.get(row).copied();
        let (file, expected) = (self.file.clone(), expected.to_owned());
        StudyError::Table { file, line, found, expected }
    }

    /// What is wrong with the file as a whole.
    pub(super) fn wrong_whole(&self, found: String, expected: String) -> StudyError {
        StudyError::Table { file: self.file.clone(), line: None, found, expected }
    }
}
