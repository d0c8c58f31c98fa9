//! Figures and traces of a run, from its record in two passes and in bounded memory: the second one
//! needs the mean of every stroke, and how many rows there are.
//!
//! A row counts if it belongs to RUN and comes after the run-in. A run that ended before its run-in
//! was over has no figures; its report shows the whole of it.

mod clock;
mod energy;
mod liveliest;
mod pairs;
mod power;
mod sums;
mod trace;
mod traces;
mod tracking;

pub(crate) use clock::ClockTraces;
pub(crate) use liveliest::Liveliest;
pub(crate) use sums::{SPECTRA_OF, SlotSums, Sums};
pub(crate) use trace::Trace;
pub(crate) use traces::{RigTraces, Traces};
pub(crate) use tracking::Tracking;

use crate::BenchError;
use crate::progress_bar::LateBar;
use crate::record::{Row, RowReader};
use can_protocol::RunState;
use std::path::Path;

/// Length of a spectrum's segments (s).
pub(crate) const SEGMENT_S: f64 = 8.192;

/// Figures and traces of a run.
#[derive(Debug, Clone)]
pub(crate) struct Statistics {
    /// Figures of the rows that are shown.
    pub(crate) shown: Sums,
    /// The same where the run-in is over, otherwise those of no row.
    counted: Option<Sums>,
    pub(crate) traces: Traces,
}

impl Statistics {
    /// Of the record of a run in cycles of `cycle_s` that leaves out the first `run_in_s`. Each row
    /// goes to `each` once.
    ///
    /// # Errors
    /// The record cannot be read.
    pub(crate) fn of(
        record: &Path,
        run_in_s: f64,
        cycle_s: f64,
        mut each: impl FnMut(&Row),
    ) -> Result<Self, BenchError> {
        let (mut shown, mut is_over) = (Sums::new(cycle_s), false);
        let (mut all_rows, mut run_rows) = (0, 0);
        let mut bar = LateBar::new("reading the record", 2 * PARTS);
        read(record, (&mut bar, 0), |row| {
            each(row);
            all_rows += 1;
            if row.state != RunState::Run {
                return;
            }
            run_rows += 1;
            if !is_over && row.time_s >= run_in_s {
                (shown, is_over) = (Sums::new(cycle_s), true);
            }
            shown.take(row);
        })?;
        let from_s = if is_over { run_in_s } else { f64::NEG_INFINITY };
        let mut traces = Traces::new(&shown, all_rows, run_rows);
        shown.begin_cycles();
        read(record, (&mut bar, PARTS), |row| {
            traces.clock.take(row);
            if row.state != RunState::Run {
                return;
            }
            traces.take_residual(row);
            if row.time_s >= from_s {
                shown.take_cycles(row);
                traces.take(row);
            }
        })?;
        bar.finish();
        traces.finish();
        let counted = (!is_over).then(|| Sums::new(cycle_s));
        Ok(Self { shown, counted, traces })
    }

    /// Figures of the rows after the run-in; those of no row where the run ended before.
    pub(crate) fn after_run_in(&self) -> &Sums {
        self.counted.as_ref().unwrap_or(&self.shown)
    }
}

/// Parts of a pass over a record, for its progress.
const PARTS: u64 = 1000;

/// Hands the rows of a record to `take`, and shows progress in a pass that begins at a part.
fn read(
    record: &Path,
    (bar, begin): (&mut LateBar, u64),
    mut take: impl FnMut(&Row),
) -> Result<(), BenchError> {
    let failed = |why| BenchError::File { file: record.to_owned(), why };
    let mut reader = RowReader::open(record)?;
    // Not less than one row: rows may be lost.
    let rows_of_part = (reader.rows().map_err(failed)? / PARTS).max(1);
    let mut rows = 0_u64;
    while let Some(row) = reader.next().map_err(failed)? {
        take(&row);
        rows += 1;
        if rows.is_multiple_of(rows_of_part) {
            bar.at(begin + (rows / rows_of_part).min(PARTS));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counts::Counts;
    use crate::record::NpyWriter;
    use scenario::run::CYCLE_S;
    use signal::spectrum::Spectrum;
    use signal::statistics;
    use std::fs::File;

    /// A record of a ramp, and of so many cycles of RUN in which a damper moves.
    fn record(cycles: u64) -> (std::path::PathBuf, Vec<Row>) {
        let name = format!("hil-host-statistics-{}-{cycles}.npy", std::process::id());
        let path = std::env::temp_dir().join(name);
        let mut writer = NpyWriter::begin(File::create(&path).unwrap()).unwrap();
        let row = |n: u64| {
            let time_s = (n as f64 - 100.0) * 1e-3;
            let mut row = Row { cycle: n + 1, time_s, ..Row::default() };
            row.state = if n < 100 { RunState::RampIn } else { RunState::Run };
            row.extension_m[1] = 1e-4 + 3e-3 * libm::sin(21.0 * time_s + libm::sin(time_s));
            row.extension_m_per_s[1] = libm::cos(21.0 * time_s) / 16.0;
            row.force_n[1] = 9e3 * libm::cos(21.0 * time_s) + 40.0 * libm::sin(900.0 * time_s);
            row.acceleration_m_per_s2[2] = libm::sin(70.0 * time_s);
            row
        };
        let rows: Vec<Row> = (0..100 + cycles).map(row).collect();
        writer.write(&rows).unwrap();
        writer.finish().unwrap();
        (path, rows)
    }

    #[test]
    fn figures_in_passes_are_those_of_all_samples_at_once() {
        let (path, rows) = record(20_000);
        let mut counts = Counts::default();
        let found = Statistics::of(&path, 2.0, CYCLE_S, |row| counts.take(row)).unwrap();
        std::fs::remove_file(path).unwrap();
        let after: Vec<&Row> = rows.iter().filter(|row| row.time_s >= 2.0).collect();
        assert_eq!((counts.rows(), counts.run_cycles), (20_100, 20_000));
        let sums = found.after_run_in();
        assert_eq!(sums.rows, after.len() as u64);
        let of = |value: &dyn Fn(&Row) -> f64| after.iter().map(|row| value(row)).collect();
        let stroke: Vec<f64> = of(&|row| row.extension_m[1]);
        let force: Vec<f64> = of(&|row| row.force_n[1]);
        let slot = &sums.slots[1];
        assert_eq!(slot.force_range, statistics::min_max(&force));
        assert_eq!(slot.force.rms(), statistics::rms(&force));
        let dead_band = 0.01 * statistics::rms(&stroke);
        assert_eq!(slot.mean_peak_m(), statistics::mean_peak(&stroke, dead_band));
        let crossing_hz = statistics::zero_crossing_hz(&stroke, 1.0 / CYCLE_S, dead_band);
        assert_eq!(slot.zero_crossing_hz(), crossing_hz);
        let spectrum = Spectrum::welch(&stroke, 1.0 / CYCLE_S, SEGMENT_S).unwrap();
        assert_eq!(slot.spectrum.spectrum().unwrap(), spectrum);
        assert_eq!(found.traces.force[1].value, force);
        // From the first row on: the ramp too.
        assert_eq!(found.traces.clock.skipped.value.len(), rows.len());
        let acceleration: Vec<f64> = of(&|row| row.acceleration_m_per_s2[2]);
        assert_eq!(sums.acceleration[2].rms(), statistics::rms(&acceleration));
    }

    #[test]
    fn a_run_that_ends_before_its_run_in_is_over_is_shown_and_has_no_figures() {
        let (path, _) = record(1000);
        let found = Statistics::of(&path, 2.0, CYCLE_S, |_| {}).unwrap();
        std::fs::remove_file(path).unwrap();
        assert_eq!((found.shown.rows, found.after_run_in().rows), (1000, 0));
        assert_eq!(found.traces.force[1].value.len(), 1000);
        assert_eq!(found.after_run_in().slots[1].mean_peak_m(), None);
    }
}
