//! The columns of a table as tests in SI units.

use crate::error::MeasurementError;
use crate::layout::{Extension, Layout, OptionalReading, Reading};
use crate::series::Series;
use crate::table::Table;
use crate::unit::Unit;
use files::quoted;
use std::path::Path;

/// Longest part of a name that comes from a file, in characters.
const PART_LONGEST: usize = 100;

/// All tests of a table, in order of appearance; those of several force columns one after the
/// other.
///
/// # Errors
/// The first thing that does not fit, with file, line and column.
pub(crate) fn tests_of(table: &Table, layout: &Layout) -> Result<Vec<Series>, MeasurementError> {
    let extension = extension_of(table, layout)?;
    let kept = kept_rows(table, layout)?;
    let mut tests = Vec::new();
    for (label, rows) in groups(table, layout, &kept)? {
        for force in &layout.force {
            let mut name = stem(&table.file);
            name.extend(label.chars().take(PART_LONGEST));
            if layout.force.len() > 1 {
                name.push('-');
                name.push_str(&plain(&force.column));
            }
            tests.push(series(table, layout, &rows, force, name, extension)?);
        }
    }
    Ok(tests)
}

/// Which sign means extension: the mapping decides before the file, the file before the convention
/// of this project's own columns.
fn extension_of(table: &Table, layout: &Layout) -> Result<Extension, MeasurementError> {
    match (layout.extension, &table.extension) {
        (Some(extension), _) => Ok(extension),
        (None, Some((line, name))) => Extension::of_name(name).ok_or_else(|| {
            let found = format!("\"{}\"", quoted(name));
            table.cell_error(*line, "extension", found, "positive, negative or unknown")
        }),
        (None, None) if layout.own_columns => Ok(Extension::Positive),
        (None, None) => Ok(Extension::Unknown),
    }
}

/// Rows that hold what `where` asks for.
fn kept_rows(table: &Table, layout: &Layout) -> Result<Vec<usize>, MeasurementError> {
    let mut kept: Vec<usize> = (0..table.row_count()).collect();
    for (name, wanted) in &layout.only {
        let column = table.column(name)?;
        let holds =
            |row: &usize| wanted.holds(table.cell(*row, column), table.number(*row, column));
        let held: Vec<usize> = kept.iter().copied().filter(holds).collect();
        if held.is_empty() {
            let name = quoted(name);
            return Err(MeasurementError::File {
                file: table.file.clone(),
                found: format!("no row that fits where.{name}"),
                expected: format!("one of {name} = {}", first_values(table, &kept, column)),
            });
        }
        kept = held;
    }
    Ok(kept)
}

/// The first six different values of a column, for a message.
fn first_values(table: &Table, rows: &[usize], column: usize) -> String {
    let mut values: Vec<&str> = Vec::new();
    for row in rows {
        let cell = table.cell(*row, column);
        if values.contains(&cell) {
            continue;
        }
        if values.len() == 6 {
            values.push("...");
            break;
        }
        values.push(cell);
    }
    quoted(&values.join(", ")).to_string()
}

/// Rows of every test with the end of its name, in order of appearance.
fn groups(
    table: &Table,
    layout: &Layout,
    kept: &[usize],
) -> Result<Vec<(String, Vec<usize>)>, MeasurementError> {
    let columns =
        layout.split_by.iter().map(|name| table.column(name)).collect::<Result<Vec<_>, _>>()?;
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for row in kept {
        let mut label = String::new();
        for (name, column) in layout.split_by.iter().zip(&columns) {
            label.push('-');
            label.push_str(&plain(name));
            label.push_str(&plain(table.cell(*row, *column)));
        }
        // Rows of one test mostly follow each other: search from the end.
        match groups.iter_mut().rev().find(|(known, _)| *known == label) {
            Some((_, rows)) => rows.push(*row),
            None => groups.push((label, vec![*row])),
        }
    }
    Ok(groups)
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
        let resolution_s = time_resolution_s(table, rows, &layout.time)?;
        (values(table, rows, &layout.time)?, resolution_s, quoted_name(&layout.time))
    };
    let series = Series {
        name,
        file: table.file.clone(),
        lines: rows.iter().map(|row| table.lines.get(*row).copied().unwrap_or(0)).collect(),
        time_s,
        time_resolution_s,
        displacement_m: values(table, rows, &layout.displacement)?,
        force_n: values(table, rows, force)?,
        velocity_m_per_s: optional_values(table, rows, &layout.velocity)?,
        temperature_degc: optional_values(table, rows, &layout.temperature)?,
        extension,
        repairs: table.repairs.clone(),
        columns: [time_name, quoted_name(&layout.displacement), quoted_name(force)],
    };
    debug_assert!(series.is_complete(), "every column has every row");
    Ok(series)
}

/// The last digit of the time stamps, s.
fn time_resolution_s(
    table: &Table,
    rows: &[usize],
    time: &Reading,
) -> Result<f64, MeasurementError> {
    let column = table.column(&time.column)?;
    let decimals = rows.iter().map(|row| table.decimals(*row, column));
    let decimals = decimals.collect::<Option<Vec<_>>>().and_then(|all| all.into_iter().max());
    let last_digit = decimals.map_or(0.0, |n| libm::pow(10.0, -(n as f64)));
    Ok(last_digit * unit_of(table, time)?.factor())
}

fn optional_values(
    table: &Table,
    rows: &[usize],
    optional: &OptionalReading,
) -> Result<Option<Vec<f64>>, MeasurementError> {
    let OptionalReading { reading, required } = optional;
    match (required, table.column(&reading.column)) {
        (true, _) | (false, Ok(_)) => values(table, rows, reading).map(Some),
        (false, Err(_)) => Ok(None),
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

fn unit_of(table: &Table, reading: &Reading) -> Result<Unit, MeasurementError> {
    let from_row = |units: &Vec<String>| -> Result<_, MeasurementError> {
        let column = table.column(&reading.column)?;
        let name = units.get(column).map_or("", String::as_str);
        reading.kind.unit(name).ok_or_else(|| MeasurementError::File {
            file: table.file.clone(),
            found: format!("unit \"{}\" of {}", quoted(name), quoted(&reading.column)),
            expected: format!("one of {}", reading.kind.names()),
        })
    };
    match (reading.unit, &table.units) {
        (Some(unit), _) => Ok(unit),
        (None, Some(units)) => from_row(units),
        (None, None) => Ok(Unit::SI),
    }
}

fn quoted_name(reading: &Reading) -> String {
    quoted(&reading.column).to_string()
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| plain(&stem.to_string_lossy())).unwrap_or_default()
}

/// A text as part of a file's name.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_alphanumeric() || "_-.".contains(c) { c } else { '_' }).collect()
}
