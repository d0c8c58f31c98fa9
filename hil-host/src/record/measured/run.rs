//! The record of a run as a damper test.

use super::empty;
use crate::record::force_source::ForceSource;
use crate::record::input_kind::InputKind;
use crate::record::npy::RowReader;
use crate::record::parts::open_parts;
use crate::record::row::Row;
use firmware_core::vehicle::DAMPER_SLOTS;
use measurement::{MeasurementError, Series};
use std::io;
use std::path::Path;

/// What one row holds of a slot.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time_s: f64,
    input: InputKind,
    /// Whether the rig of another slot stood for this one.
    is_stand_in: bool,
    /// Displacement and force that the rig measured.
    measured: (f64, f64),
    /// Displacement and force of the slot in the model.
    modelled: (f64, f64),
}

/// One damper slot (0 to 3) of a run's `record.npy`: what the rig measured in the cycles that had a
/// fresh answer, or motion and force of the model for a slot without a rig. A slot for which the
/// rig of another one stood is no test of a damper. The file and the parts that follow it are read
/// as a stream.
///
/// # Errors
/// The file cannot be read, is no record of this version, or the slot has no such rows.
pub fn read_record(path: &Path, slot: usize) -> Result<Series, MeasurementError> {
    let fail = |found: String, expected: String| MeasurementError::File {
        file: path.to_owned(),
        found,
        expected,
    };
    let unreadable = |why: String| fail(format!("no readable file ({why})"), "a record".to_owned());
    let failed = |why: io::Error| unreadable(why.to_string());
    let parts = open_parts(path).map_err(|why| unreadable(why.reason()))?;
    let other = || fail("another layout".to_owned(), "a record.npy of this version".to_owned());
    let mut rows = RowReader::begin(parts).map_err(failed)?.ok_or_else(other)?;
    if slot >= DAMPER_SLOTS {
        return Err(fail(format!("slot {slot}"), format!("0 to {}", DAMPER_SLOTS - 1)));
    }
    let columns = Columns::of(slot);
    let no_kind = |row: usize, code: u8| MeasurementError::Cell {
        file: path.to_owned(),
        row,
        column: "input".to_owned(),
        found: format!("code {code}"),
        expected: "0 to 3".to_owned(),
    };
    let mut number = 0;
    let mut on_rig = false;
    while let Some(row) = rows.next_row().map_err(failed)? {
        number += 1;
        let sample = columns.sample(row).map_err(|code| no_kind(number, code))?;
        on_rig |= sample.input != InputKind::NoRig;
        if sample.is_stand_in {
            // Its motion and its force are those of two dampers.
            let found = format!("slot {}, for which the rig of another slot stood", slot + 1);
            return Err(fail(found, "the slot of that rig".to_owned()));
        }
    }
    let mut rows = rows.rewind().map_err(failed)?.ok_or_else(other)?;
    let mut series = empty(path, &format!("slot{slot}"));
    let (mut number, mut stale) = (0, 0);
    while let Some(row) = rows.next_row().map_err(failed)? {
        number += 1;
        let sample = columns.sample(row).map_err(|code| no_kind(number, code))?;
        let (x, f) = if on_rig { sample.measured } else { sample.modelled };
        if on_rig && (sample.input != InputKind::Fresh || !x.is_finite() || !f.is_finite()) {
            stale += 1;
            continue;
        }
        series.lines.push(number);
        series.time_s.push(sample.time_s);
        series.displacement_m.push(x);
        series.force_n.push(f);
    }
    if stale > 0 {
        series.repairs.push(format!("{stale} cycles without a fresh measurement left out"));
    }
    Ok(series)
}

/// Where the values of a slot are in the bytes of a row.
#[derive(Debug)]
struct Columns {
    time: usize,
    input: usize,
    source: usize,
    measured: (usize, usize),
    modelled: (usize, usize),
}

impl Columns {
    fn of(slot: usize) -> Self {
        let offset = |name: &str| Row::offset(name).unwrap_or(0);
        let number = |name: &str| offset(name) + 8 * slot;
        Self {
            time: offset("time_s"),
            input: offset("input") + slot,
            source: offset("force_source") + slot,
            measured: (number("measured_m"), number("measured_n")),
            modelled: (number("extension_m"), number("force_n")),
        }
    }

    /// Decodes a row; the code of an unknown input where it has one.
    fn sample(&self, row: &[u8]) -> Result<Sample, u8> {
        let number = |at: usize| {
            let bytes = row.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
            bytes.map_or(f64::NAN, f64::from_le_bytes)
        };
        let pair = |(x, f)| (number(x), number(f));
        let code = row.get(self.input).copied().unwrap_or(u8::MAX);
        Ok(Sample {
            time_s: number(self.time),
            input: InputKind::from_code(code).ok_or(code)?,
            is_stand_in: row.get(self.source) == Some(&ForceSource::StandIn.code()),
            measured: pair(self.measured),
            modelled: pair(self.modelled),
        })
    }
}
