//! What is counted of a run while it goes on: nothing of it grows.

use crate::record::{ForceSource, InputKind, Row};
use can_protocol::{RunState, Watch};
use firmware_core::vehicle::DAMPER_SLOTS;
use hdrhistogram::Histogram;

/// Counts of a run.
#[derive(Debug, Clone)]
pub(crate) struct Counts {
    /// The watch over each rig, as the whole run showed it.
    pub(crate) watch: [Watched; DAMPER_SLOTS],
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
    /// Time from which a slot ran on its model, as its rig or the one that stood for it was lost
    /// (s).
    pub(crate) model_from_s: [Option<f64>; DAMPER_SLOTS],
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

impl Default for Counts {
    fn default() -> Self {
        let histogram = || {
            Histogram::new_with_bounds(1, 10_000_000_000, 3)
                .unwrap_or_else(|error| unreachable!("constant bounds: {error}"))
        };
        Self {
            watch: Default::default(),
            run_cycles: 0,
            outside_run: 0,
            compute_ns: histogram(),
            cycle_ns: histogram(),
            lateness_ns: histogram(),
            stale: [0; DAMPER_SLOTS],
            fresh: [0; DAMPER_SLOTS],
            model_from_s: [None; DAMPER_SLOTS],
            skipped: 0,
            last: (0, 0),
        }
    }
}

impl Counts {
    /// Takes in a row.
    pub(crate) fn take(&mut self, row: &Row) {
        self.compute_ns.saturating_record(u64::from(row.compute_ns));
        self.cycle_ns.saturating_record(u64::from(row.cycle_ns));
        self.lateness_ns.saturating_record(u64::from(row.lateness_ns));
        for (slot, input) in row.input.into_iter().enumerate() {
            // A rig that has been stopped has nothing to say.
            let is_out = row.force_source[slot] == ForceSource::DroppedOut;
            let is_due = row.cycle > 1 && row.state != RunState::Safe && !is_out;
            if is_out {
                self.model_from_s[slot].get_or_insert(row.time_s);
            }
            self.stale[slot] += u64::from(is_due && input.is_stale());
            self.fresh[slot] += u64::from(input == InputKind::Fresh);
        }
        self.skipped += u64::from(row.skipped);
        let runs = row.state == RunState::Run;
        self.run_cycles += u64::from(runs);
        self.outside_run += u64::from(!runs);
        self.last = (row.cycle, row.hash);
        for (slot, watched) in self.watch.iter_mut().enumerate() {
            watched.push(row, slot);
        }
    }

    /// Rows so far.
    pub(crate) const fn rows(&self) -> u64 {
        self.run_cycles + self.outside_run
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_of_ten_times_the_cycles_keeps_nothing_more_while_it_goes_on() {
        // The histograms alone could grow: they count in fixed buckets.
        let kept = |cycles: u64| {
            let mut counts = Counts::default();
            for cycle in 1..=cycles {
                let mut row = Row { cycle, time_s: cycle as f64 * 1e-3, ..Row::default() };
                (row.cycle_ns, row.drift) = (cycle as u32, [Watch::Drift; DAMPER_SLOTS]);
                counts.take(&row);
            }
            (counts.cycle_ns.distinct_values(), counts.rows() == cycles)
        };
        assert_eq!(kept(2_000), kept(20_000));
    }
}
