//! A test as it was sampled: SI values and the lines they come from, before any clock.

use super::error::MeasurementError;
use super::mapping::{Extension, Layout, Reading};
use super::table::Table;
use std::path::{Path, PathBuf};

/// Readings of one test in SI units. Anything that can fill one, a file or the log of a bus, can
/// become a [`Measurement`](super::Measurement).
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name of the test.
    pub name: String,
    /// The file it comes from.
    pub file: PathBuf,
    /// Line of every sample in it.
    pub lines: Vec<usize>,
    /// Time stamps, s.
    pub time_s: Vec<f64>,
    /// Finest difference that the time stamps can show, s; zero for none that matters.
    pub time_resolution_s: f64,
    /// Displacement, m.
    pub displacement_m: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Velocity, m/s, where a column holds it.
    pub velocity_m_per_s: Option<Vec<f64>>,
    /// Temperature, degrees Celsius, where a column holds it.
    pub temperature_degc: Option<Vec<f64>>,
    /// Which sign means extension.
    pub extension: Extension,
    /// What was mended so far, each a line.
    pub repairs: Vec<String>,
    /// Names of the columns of time, displacement and force in the file.
    pub columns: [String; 3],
}

impl Series {
    /// A series without a file: samples at a constant rate, by this project's names and signs.
    pub fn sampled(name: &str, rate_hz: f64, displacement_m: Vec<f64>, force_n: Vec<f64>) -> Self {
        let count = displacement_m.len();
        Self {
            name: name.to_owned(),
            file: PathBuf::from(name),
            lines: (1..=count).collect(),
            time_s: (0..count).map(|n| n as f64 / rate_hz).collect(),
            time_resolution_s: 0.0,
            displacement_m,
            force_n,
            velocity_m_per_s: None,
            temperature_degc: None,
            extension: Extension::Positive,
            repairs: Vec::new(),
            columns: ["time_s", "displacement_m", "force_n"].map(str::to_owned),
        }
    }

    /// An error of this test as a whole.
    pub(super) fn error(&self, found: String, expected: String) -> MeasurementError {
        let stem = self.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        if stem.as_deref() == Some(self.name.as_str()) {
            return MeasurementError::File { file: self.file.clone(), found, expected };
        }
        MeasurementError::Test { file: self.file.clone(), test: self.name.clone(), found, expected }
    }

    /// An error at a sample.
    pub(super) fn error_at(
        &self,
        sample: usize,
        column: usize,
        found: String,
        expected: String,
    ) -> MeasurementError {
        MeasurementError::Cell {
            file: self.file.clone(),
            row: self.line(sample),
            column: self.columns.get(column).cloned().unwrap_or_default(),
            found,
            expected,
        }
    }

    /// Line of a sample.
    pub(super) fn line(&self, sample: usize) -> usize {
        self.lines.get(sample).copied().unwrap_or(0)
    }
}

/// All tests of a file, in order of appearance; those of several force columns one after the other.
///
/// # Errors
/// The first thing that does not fit, with file, line and column.
pub fn read(path: &Path, layout: &Layout) -> Result<Vec<Series>, MeasurementError> {
    tests_of(&Table::read(path, layout)?, layout)
}

/// All tests of a table.
///
/// # Errors
/// The first thing that does not fit, with file, line and column.
pub fn tests_of(table: &Table, layout: &Layout) -> Result<Vec<Series>, MeasurementError> {
    let extension = extension_of(table, layout)?;
    let kept = kept_rows(table, layout)?;
    let mut tests = Vec::new();
    for (label, rows) in groups(table, layout, &kept)? {
        for force in &layout.force {
            let mut name = stem(&table.file);
            name.push_str(&label);
            if layout.force.len() > 1 {
                name.push('-');
                name.push_str(&plain(&force.column));
            }
            tests.push(series(table, layout, &rows, force, name, extension)?);
        }
    }
    Ok(tests)
}

fn series(
    table: &Table,
    layout: &Layout,
    rows: &[usize],
    force: &Reading,
    name: String,
    extension: Extension,
) -> Result<Series, MeasurementError> {
    let (time_s, time_resolution_s, time_name) = if let Some(rate) = layout.sample_rate_hz {
        ((0..rows.len()).map(|n| n as f64 / rate).collect(), 0.0, "sample_rate_hz".to_owned())
    } else {
        let column = table.column(&layout.time.column)?;
        let decimals = rows.iter().map(|row| table.decimals(*row, column));
        let decimals = decimals.collect::<Option<Vec<_>>>().and_then(|all| all.into_iter().max());
        let last_digit = decimals.map_or(0.0, |n| libm::pow(10.0, -(n as f64)));
        let resolution_s = last_digit * unit_of(table, &layout.time)?.factor();
        (values(table, rows, &layout.time)?, resolution_s, layout.time.column.clone())
    };
    let optional =
        |(reading, required): &(Reading, bool)| match (required, table.column(&reading.column)) {
            (true, _) | (false, Ok(_)) => values(table, rows, reading).map(Some),
            (false, Err(_)) => Ok(None),
        };
    Ok(Series {
        name,
        file: table.file.clone(),
        lines: rows.iter().map(|row| table.lines.get(*row).copied().unwrap_or(0)).collect(),
        time_s,
        time_resolution_s,
        displacement_m: values(table, rows, &layout.displacement)?,
        force_n: values(table, rows, force)?,
        velocity_m_per_s: optional(&layout.velocity)?,
        temperature_degc: optional(&layout.temperature)?,
        extension,
        repairs: table.repairs.clone(),
        columns: [time_name, layout.displacement.column.clone(), force.column.clone()],
    })
}

fn unit_of(table: &Table, reading: &Reading) -> Result<super::unit::Unit, MeasurementError> {
    let from_row = |units: &Vec<String>| -> Result<_, MeasurementError> {
        let column = table.column(&reading.column)?;
        let name = units.get(column).map_or("", String::as_str);
        reading.kind.unit(name).ok_or_else(|| MeasurementError::File {
            file: table.file.clone(),
            found: format!("unit \"{name}\" of {}", reading.column),
            expected: format!("one of {}", reading.kind.names()),
        })
    };
    match (reading.unit, &table.units) {
        (Some(unit), _) => Ok(unit),
        (None, Some(units)) => from_row(units),
        (None, None) => Ok(reading.kind.si()),
    }
}

/// `sign * unit(reading - offset)`.
fn values(table: &Table, rows: &[usize], reading: &Reading) -> Result<Vec<f64>, MeasurementError> {
    let column = table.column(&reading.column)?;
    let unit = unit_of(table, reading)?;
    rows.iter()
        .map(|row| {
            let number = table.finite(*row, column)?;
            Ok(reading.sign * unit.si(number - reading.offset))
        })
        .collect()
}

fn extension_of(table: &Table, layout: &Layout) -> Result<Extension, MeasurementError> {
    match (layout.extension, &table.extension) {
        (Some(extension), _) => Ok(extension),
        (None, Some((line, said))) => match said.as_str() {
            "positive" => Ok(Extension::Positive),
            "negative" => Ok(Extension::Negative),
            "unknown" => Ok(Extension::Unknown),
            other => Err(table.cell_error(
                *line,
                "extension",
                format!("\"{other}\""),
                "positive, negative or unknown",
            )),
        },
        (None, None) if layout.own_columns => Ok(Extension::Positive),
        (None, None) => Ok(Extension::Unknown),
    }
}

/// Rows that hold what `where` asks for.
fn kept_rows(table: &Table, layout: &Layout) -> Result<Vec<usize>, MeasurementError> {
    let mut kept: Vec<usize> = (0..table.rows.len()).collect();
    for (name, wanted) in &layout.only {
        let column = table.column(name)?;
        let holds =
            |row: &usize| wanted.holds(table.cell(*row, column), table.number(*row, column));
        let left: Vec<usize> = kept.iter().copied().filter(holds).collect();
        if left.is_empty() {
            let mut there: Vec<&str> = Vec::new();
            for row in &kept {
                let cell = table.cell(*row, column);
                if there.len() == 6 && !there.contains(&cell) {
                    there.push("...");
                    break;
                }
                if !there.contains(&cell) {
                    there.push(cell);
                }
            }
            return Err(MeasurementError::File {
                file: table.file.clone(),
                found: format!("no row that fits where.{name}"),
                expected: format!("one of {} = {}", name, there.join(", ")),
            });
        }
        kept = left;
    }
    Ok(kept)
}

/// Rows of every test with the end of its name, in order of appearance.
fn groups(
    table: &Table,
    layout: &Layout,
    kept: &[usize],
) -> Result<Vec<(String, Vec<usize>)>, MeasurementError> {
    let columns =
        layout.split_by.iter().map(|name| table.column(name)).collect::<Result<Vec<_>, _>>()?;
    let mut found: Vec<(String, Vec<usize>)> = Vec::new();
    for row in kept {
        let mut label = String::new();
        for (name, column) in layout.split_by.iter().zip(&columns) {
            label.push('-');
            label.push_str(&plain(name));
            label.push_str(&plain(table.cell(*row, *column)));
        }
        // Rows of one test mostly stand together: look from the back.
        match found.iter_mut().rev().find(|(known, _)| *known == label) {
            Some((_, rows)) => rows.push(*row),
            None => found.push((label, vec![*row])),
        }
    }
    Ok(found)
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| plain(&stem.to_string_lossy())).unwrap_or_default()
}

/// A text as part of a file's name.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_alphanumeric() || "_-.".contains(c) { c } else { '_' }).collect()
}
