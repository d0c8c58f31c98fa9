//! The rows of RUN as columns, for statistics and plots.
//!
//! While a run goes on, only what does not grow is collected ([`Columns::count`]). The columns are
//! read from the record when the run has ended ([`Columns::read`]).

use crate::BenchError;
use crate::record::{InputKind, Row, each_row, open_parts};
use can_protocol::{RunState, Watch};
use firmware_core::vehicle::DAMPER_SLOTS;
use hdrhistogram::Histogram;
use std::path::Path;

/// Rows kept for statistics and plots: twenty minutes at 1 kHz. The record itself has no such
/// limit.
pub(crate) const ROWS_MAX: usize = 1_200_000;

/// Columns of a run.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// Model time (s).
    pub(crate) time_s: Vec<f64>,
    /// Extension of each damper slot (m).
    pub(crate) extension_m: [Vec<f64>; DAMPER_SLOTS],
    /// Rate of it (m/s).
    pub(crate) rate_m_per_s: [Vec<f64>; DAMPER_SLOTS],
    /// Force of each slot (N).
    pub(crate) force_n: [Vec<f64>; DAMPER_SLOTS],
    /// Displacement that each rig was commanded; empty without a rig (m).
    pub(crate) command_m: [Vec<f64>; DAMPER_SLOTS],
    /// Force of the model of each slot on a rig; empty without a rig (N).
    pub(crate) model_n: [Vec<f64>; DAMPER_SLOTS],
    /// Displacement that each rig measured (m).
    pub(crate) measured_m: [Vec<f64>; DAMPER_SLOTS],
    /// Force that each rig measured (N).
    pub(crate) measured_n: [Vec<f64>; DAMPER_SLOTS],
    /// Running rms of the residual of each watched rig (N).
    pub(crate) residual_rms_n: [Vec<f64>; DAMPER_SLOTS],
    /// Where drift is raised (N).
    pub(crate) residual_limit_n: [Vec<f64>; DAMPER_SLOTS],
    /// The watch over each rig, as the whole run showed it.
    pub(crate) watch: [Watched; DAMPER_SLOTS],
    /// Lateral and vertical acceleration of carbody, front bogie, first wheelset (m/s2).
    pub(crate) acceleration: [Vec<f64>; 6],
    /// Lateral position of the leading wheelset against the track (m).
    pub(crate) wheelset_lateral_m: Vec<f64>,
    /// Rows that came after the limit.
    pub(crate) left_out: u64,
    /// Rows of RUN.
    pub(crate) run_cycles: u64,
    /// Rows before and after RUN, which statistics leave out.
    pub(crate) outside_run: u64,
    /// Time of one vehicle step (ns).
    pub(crate) compute_ns: Histogram<u64>,
    /// Time from receive to send (ns).
    pub(crate) cycle_ns: Histogram<u64>,
    /// Lateness of wake-ups (ns).
    pub(crate) lateness_ns: Histogram<u64>,
    /// Cycles in which nothing fresh arrived for a rig, after its first answer.
    pub(crate) stale: [u64; DAMPER_SLOTS],
    /// Cycles in which a new measurement with a valid force arrived.
    pub(crate) fresh: [u64; DAMPER_SLOTS],
    /// Ticks that were skipped.
    pub(crate) skipped: u64,
    /// Number of the last cycle, and the trajectory hash after it.
    pub(crate) last: (u64, u64),
}

/// What the watch over a rig showed in the course of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Watched {
    /// Its last verdict.
    pub(crate) verdict: Watch,
    /// Last running rms (N).
    pub(crate) rms_n: f64,
    /// Running rms when the usual residual had been learnt (N).
    pub(crate) learnt_rms_n: Option<f64>,
    /// Time at which drift was first raised (s).
    pub(crate) drift_since_s: Option<f64>,
    /// Cycles with drift.
    pub(crate) drift_cycles: u64,
}

impl Default for Watched {
    fn default() -> Self {
        Self {
            verdict: Watch::None,
            rms_n: 0.0,
            learnt_rms_n: None,
            drift_since_s: None,
            drift_cycles: 0,
        }
    }
}

impl Watched {
    fn push(&mut self, row: &Row, slot: usize) {
        let knows = |verdict| matches!(verdict, Watch::Steady | Watch::Drift);
        let verdict = row.drift[slot];
        self.rms_n = row.residual_rms_n[slot];
        if knows(verdict) && !knows(self.verdict) {
            self.learnt_rms_n = Some(self.rms_n);
        }
        if verdict == Watch::Drift {
            self.drift_since_s.get_or_insert(row.time_s);
            self.drift_cycles += 1;
        }
        self.verdict = verdict;
    }

    /// The last running rms; none without a watch or before the first one (N).
    pub(crate) fn last_rms_n(&self) -> Option<f64> {
        Some(self.rms_n).filter(|rms| self.verdict != Watch::None && rms.is_finite())
    }
}

impl Default for Columns {
    fn default() -> Self {
        let histogram = || {
            Histogram::new_with_bounds(1, 10_000_000_000, 3)
                .unwrap_or_else(|error| unreachable!("constant bounds: {error}"))
        };
        Self {
            time_s: Vec::new(),
            extension_m: Default::default(),
            rate_m_per_s: Default::default(),
            force_n: Default::default(),
            command_m: Default::default(),
            model_n: Default::default(),
            measured_m: Default::default(),
            measured_n: Default::default(),
            residual_rms_n: Default::default(),
            residual_limit_n: Default::default(),
            watch: Default::default(),
            acceleration: Default::default(),
            wheelset_lateral_m: Vec::new(),
            left_out: 0,
            run_cycles: 0,
            outside_run: 0,
            compute_ns: histogram(),
            cycle_ns: histogram(),
            lateness_ns: histogram(),
            stale: [0; DAMPER_SLOTS],
            fresh: [0; DAMPER_SLOTS],
            skipped: 0,
            last: (0, 0),
        }
    }
}

impl Columns {
    /// Takes in a row of a run that goes on: nothing that is kept grows.
    pub(crate) fn count(&mut self, row: &Row) {
        self.compute_ns.saturating_record(u64::from(row.compute_ns));
        self.cycle_ns.saturating_record(u64::from(row.cycle_ns));
        self.lateness_ns.saturating_record(u64::from(row.lateness_ns));
        for (slot, input) in row.input.into_iter().enumerate() {
            self.stale[slot] += u64::from(input.is_stale() && row.cycle > 1);
            self.fresh[slot] += u64::from(input == InputKind::Fresh);
        }
        self.skipped += u64::from(row.skipped);
        if row.state == RunState::Run {
            self.run_cycles += 1;
        }
        self.last = (row.cycle, row.hash);
        for (slot, watched) in self.watch.iter_mut().enumerate() {
            watched.push(row, slot);
        }
    }

    /// Takes in a row of which everything is wanted.
    pub(crate) fn push(&mut self, row: &Row) {
        self.count(row);
        self.keep(row);
    }

    /// Reads the columns of a run that was counted while it went on.
    ///
    /// # Errors
    /// The record cannot be read.
    pub(crate) fn read(&mut self, record: &Path) -> Result<(), BenchError> {
        read(record, |row| self.keep(row))
    }

    /// The columns of a record.
    ///
    /// # Errors
    /// The record cannot be read.
    pub(crate) fn of_record(record: &Path) -> Result<Self, BenchError> {
        let mut columns = Self::default();
        read(record, |row| columns.push(row))?;
        Ok(columns)
    }

    /// Rows in the record.
    pub(crate) fn rows(&self) -> u64 {
        self.time_s.len() as u64 + self.left_out + self.outside_run
    }

    fn keep(&mut self, row: &Row) {
        if row.state != RunState::Run {
            self.outside_run += 1;
            return;
        }
        if self.time_s.len() >= ROWS_MAX {
            self.left_out += 1;
            return;
        }
        debug_assert!(
            self.time_s.last().is_none_or(|last| *last < row.time_s),
            "rows out of order"
        );
        self.time_s.push(row.time_s);
        for slot in 0..DAMPER_SLOTS {
            self.extension_m[slot].push(row.extension_m[slot]);
            self.rate_m_per_s[slot].push(row.extension_m_per_s[slot]);
            self.force_n[slot].push(row.force_n[slot]);
            if row.input[slot] != InputKind::NoRig {
                self.command_m[slot].push(row.command_m[slot]);
                self.model_n[slot].push(row.model_n[slot]);
            }
            self.measured_m[slot].push(row.measured_m[slot]);
            self.measured_n[slot].push(row.measured_n[slot]);
            if row.drift[slot] != Watch::None || !self.residual_rms_n[slot].is_empty() {
                // Not a number before the first measurement, so that the columns stay even.
                self.residual_rms_n[slot].resize(self.time_s.len() - 1, f64::NAN);
                self.residual_limit_n[slot].resize(self.time_s.len() - 1, f64::NAN);
                self.residual_rms_n[slot].push(row.residual_rms_n[slot]);
                self.residual_limit_n[slot].push(row.residual_limit_n[slot]);
            }
        }
        self.wheelset_lateral_m.push(row.wheelset_lateral_m[0]);
        for (column, value) in self.acceleration.iter_mut().zip(row.acceleration_m_per_s2) {
            column.push(value);
        }
    }

    /// Index of the first row that statistics count.
    pub(crate) fn first_after(&self, run_in_s: f64) -> usize {
        self.time_s.partition_point(|time| *time < run_in_s)
    }
}

/// Hands the rows of a record to `take`.
fn read(record: &Path, mut take: impl FnMut(&Row)) -> Result<(), BenchError> {
    let failed = |why| BenchError::File { file: record.to_owned(), why };
    let is_known = each_row(open_parts(record)?, |row| {
        take(row);
        true
    });
    if is_known.map_err(failed)? {
        return Ok(());
    }
    Err(BenchError::Kept {
        file: record.to_owned(),
        found: "another layout".to_owned(),
        expected: "a record of this version",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of all columns that can grow.
    fn growing_bytes(columns: &Columns) -> usize {
        let all = [
            &columns.extension_m[..],
            &columns.rate_m_per_s,
            &columns.force_n,
            &columns.command_m,
            &columns.model_n,
            &columns.measured_m,
            &columns.measured_n,
            &columns.residual_rms_n,
            &columns.residual_limit_n,
            &columns.acceleration,
        ];
        let columns =
            all.into_iter().flatten().chain([&columns.time_s, &columns.wheelset_lateral_m]);
        columns.map(|column| column.capacity() * size_of::<f64>()).sum()
    }

    #[test]
    fn a_run_of_ten_times_the_cycles_keeps_nothing_more_while_it_goes_on() {
        let kept = |cycles: u64| {
            let mut columns = Columns::default();
            for cycle in 1..=cycles {
                let mut row = Row { cycle, time_s: cycle as f64 * 1e-3, ..Row::default() };
                (row.cycle_ns, row.drift) = (cycle as u32, [Watch::Drift; DAMPER_SLOTS]);
                columns.count(&row);
            }
            let buckets = columns.cycle_ns.distinct_values();
            (growing_bytes(&columns), buckets, columns.cycle_ns.len() == cycles)
        };
        assert_eq!(kept(2_000), kept(20_000));
        assert_eq!(kept(2_000).0, 0);
        // The measure works.
        let mut columns = Columns::default();
        columns.push(&Row { cycle: 1, state: RunState::Run, ..Row::default() });
        assert!(growing_bytes(&columns) > 0);
    }
}
