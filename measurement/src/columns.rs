//! The columns of a table as tests in SI units.

use crate::error::MeasurementError;
use crate::layout::{Extension, Layout, OptionalReading, Reading};
use crate::series::Series;
use crate::table::Table;
use crate::unit::Unit;
use crate::{integral, stamp, suspicion};
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
            if let Some(block) = table.block {
                name = format!("{name}-{block}");
            }
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
    if let (None, Some((line, name)), Some((first, other))) =
        (layout.extension, &table.other_extension, &table.extension)
    {
        let (name, other) = (quoted(name), quoted(other));
        let found = format!("\"{name}\" after \"{other}\" in line {first}");
        return Err(table.cell_error(*line, "extension", found, "one direction"));
    }
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
        let holds = |row: &usize| {
            let number = table.number(*row, column).map(|number| number.value);
            wanted.holds(table.cell(*row, column), number)
        };
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
    let mut repairs = table.repairs.clone();
    repairs.extend(layout.understood.clone());
    let clock = clock(table, layout, rows, &mut repairs)?;
    let velocity = optional_values(table, rows, &layout.velocity)?;
    let is_integrated = integrates(table, layout) && velocity.is_some();
    let displacement =
        if is_integrated { &layout.velocity.reading } else { &layout.displacement.reading };
    let displacement_m = if let Some(velocity) = velocity.as_ref().filter(|_| is_integrated) {
        integral::first(&clock.time_s, velocity)
    } else {
        values(table, rows, displacement)?
    };
    let mut series = Series {
        name,
        file: table.file.clone(),
        lines: rows.iter().map(|row| table.lines.get(*row).copied().unwrap_or(0)).collect(),
        time_s: clock.time_s,
        time_resolution_s: clock.resolution_s,
        displacement_m,
        force_n: values(table, rows, force)?,
        velocity_m_per_s: velocity,
        temperature_degc: slow_values(table, rows, &layout.temperature, &mut repairs)?,
        is_integrated,
        extension,
        repairs,
        columns: [clock.name, quoted_name(displacement), quoted_name(force)],
    };
    for reading in [displacement, force] {
        let remark = unit_of(table, reading)?.remark();
        series.repairs.extend(remark.map(|said| format!("{}: {said}", quoted_name(reading))));
    }
    suspicion::report_temperature(&mut series, &quoted_name(&layout.temperature.reading));
    suspicion::report(&mut series, |reading| is_stated(table, reading), displacement, force);
    debug_assert!(series.is_complete(), "every column has every row");
    Ok(series)
}

/// A velocity takes the place of a displacement that neither the mapping names nor the file has.
fn integrates(table: &Table, layout: &Layout) -> bool {
    !layout.displacement.required && !table.has(&layout.displacement.reading.column)
}

/// The mapping or the file states the unit of a column.
fn is_stated(table: &Table, reading: &Reading) -> bool {
    reading.unit.is_some() || reading.scale.is_some() || table.units.is_some()
}

/// Time stamps with the sizes of their last digits.
struct Clock {
    time_s: Vec<f64>,
    resolution_s: Vec<f64>,
    name: String,
}

fn clock(
    table: &Table,
    layout: &Layout,
    rows: &[usize],
    repairs: &mut Vec<String>,
) -> Result<Clock, MeasurementError> {
    if let Some(rate) = layout.sample_rate_hz {
        return Ok(Clock {
            time_s: (0..rows.len()).map(|n| n as f64 / rate).collect(),
            resolution_s: Vec::new(),
            name: "sample_rate_hz".to_owned(),
        });
    }
    let time = &layout.time;
    let (column, name) = (table.column(&time.column)?, quoted_name(time));
    let first = rows.first().map_or("", |row| table.cell(*row, column));
    if stamp::is_stamp(first) {
        let cells = rows.iter().map(|row| table.cell(*row, column));
        let stamps = stamp::stamps(cells).map_err(|index| {
            let row = rows.get(index).copied().unwrap_or(0);
            let line = table.lines.get(row).copied().unwrap_or(0);
            let found = format!("\"{}\"", quoted(table.cell(row, column)));
            let expected = format!("a time as in the first row, \"{}\"", quoted(first));
            table.cell_error(line, &time.column, found, expected)
        })?;
        let midnight = if stamps.passed_midnight { ", past midnight" } else { "" };
        repairs.push(format!("{name}: taken as seconds since {}{midnight}", quoted(first)));
        return Ok(Clock { time_s: stamps.seconds, resolution_s: stamps.last_digits_s, name });
    }
    let size = unit_of(table, time)?.factor() * time.scale.unwrap_or(1.0).abs();
    let digit = |row: &usize| Ok(table.finite(*row, column)?.last_digit * size);
    Ok(Clock {
        time_s: values(table, rows, time)?,
        resolution_s: rows.iter().map(digit).collect::<Result<_, MeasurementError>>()?,
        name,
    })
}

fn optional_values(
    table: &Table,
    rows: &[usize],
    optional: &OptionalReading,
) -> Result<Option<Vec<f64>>, MeasurementError> {
    let OptionalReading { reading, required } = optional;
    if *required || table.has(&reading.column) {
        return values(table, rows, reading).map(Some);
    }
    Ok(None)
}

/// A column that may be slower than the others: between its readings it goes on straight, before
/// the first and after the last it stays.
fn slow_values(
    table: &Table,
    rows: &[usize],
    optional: &OptionalReading,
    repairs: &mut Vec<String>,
) -> Result<Option<Vec<f64>>, MeasurementError> {
    let OptionalReading { reading, required } = optional;
    if !(*required || table.has(&reading.column)) {
        return Ok(None);
    }
    let column = table.column(&reading.column)?;
    let cell = |row: usize| table.cell(row, column);
    let blank = |row: &&usize| cell(**row).is_empty();
    let not_a_number = |row: &&usize| cell(**row).eq_ignore_ascii_case("nan");
    // One that is not a number among numbers is a fault; a program that fills every row in which
    // the slow channel has no reading writes more of them than numbers.
    let (blanks, nans) =
        (rows.iter().filter(blank).count(), rows.iter().filter(not_a_number).count());
    let is_filled = 2 * (blanks + nans) > rows.len();
    let is_there = |row: &usize| !(cell(*row).is_empty() || is_filled && not_a_number(&row));
    let (places, read): (Vec<usize>, Vec<usize>) =
        rows.iter().copied().enumerate().filter(|(_, row)| is_there(row)).unzip();
    let readings = values(table, &read, reading)?;
    if readings.len() == rows.len() {
        return Ok(Some(readings));
    }
    let name = quoted_name(reading);
    if readings.is_empty() {
        repairs.push(format!("{name}: no reading in any row, left out"));
        return Ok(None);
    }
    repairs.push(format!(
        "{name}: {} readings in {} rows, interpolated between them",
        readings.len(),
        rows.len()
    ));
    let known: Vec<(usize, f64)> = places.into_iter().zip(readings).collect();
    Ok(Some((0..rows.len()).map(|place| between_readings(&known, place)).collect()))
}

fn between_readings(known: &[(usize, f64)], place: usize) -> f64 {
    let next = known.partition_point(|(at, _)| *at < place);
    match (next.checked_sub(1).and_then(|before| known.get(before)), known.get(next)) {
        (Some((a, from)), Some((b, to))) => {
            from + (to - from) * (place - a) as f64 / (b - a) as f64
        }
        (Some((_, value)), None) | (None, Some((_, value))) => *value,
        (None, None) => 0.0,
    }
}

/// `sign * unit(scale * (reading - offset))`.
fn values(table: &Table, rows: &[usize], reading: &Reading) -> Result<Vec<f64>, MeasurementError> {
    let column = table.column(&reading.column)?;
    let unit = unit_of(table, reading)?;
    let scale = reading.scale.unwrap_or(1.0);
    rows.iter()
        .map(|row| {
            let number = table.finite(*row, column)?.value;
            Ok(reading.sign * unit.si(scale * (number - reading.offset)))
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
        // The units row is about counts or volts.
        (None, Some(units)) if reading.scale.is_none() => from_row(units),
        (None, _) => Ok(Unit::SI),
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
