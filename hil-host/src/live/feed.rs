//! The recorder's end of the page: rows come in, an update goes out ten times a second.
//!
//! The recorder's thread calls it for rows that have left the loop. Every row counts for interlocks
//! and times; of the rows themselves every fifth is drawn. Where cycles follow each other faster
//! than the clock, samples are thinned again and again until they fit.

use super::board::{Board, RigNow, Update};
use super::interlocks::{AgreedLimits, Interlocks};
use super::timing::Timing;
use crate::control::Notice;
use crate::counts::Counts;
use crate::record::Row;
use can_protocol::{RunState, Watch};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time between two updates.
const PUSH: Duration = Duration::from_millis(100);

/// Time between two sums of the times.
const SUM: Duration = Duration::from_secs(1);

/// Cycles between two rows that are drawn: 200 Hz.
const STRIDE: u64 = 5;

/// Most rows of an update: at twenty times the pace of the clock 10 ms apart, which shows a loop.
const SAMPLES_MAX: usize = 256;

/// Makes the updates of a run.
#[derive(Debug)]
pub(crate) struct Feed {
    board: Arc<Board>,
    /// Whether each slot has a rig.
    is_rig: Vec<bool>,
    interlocks: Interlocks,
    cause: Option<String>,
    samples: Vec<(u64, Vec<Option<i64>>)>,
    stride: u64,
    last: Row,
    number: u64,
    pushed: Option<Instant>,
    timing: (Option<Instant>, Timing),
}

impl Feed {
    /// The feed of a run with these slots.
    pub(super) fn new(board: Arc<Board>, is_rig: Vec<bool>) -> Self {
        Self {
            board,
            is_rig,
            interlocks: Interlocks::default(),
            cause: None,
            samples: Vec::with_capacity(SAMPLES_MAX),
            stride: STRIDE,
            last: Row::default(),
            number: 0,
            pushed: None,
            timing: (None, Timing::default()),
        }
    }

    /// Takes in what the loop has found.
    pub(crate) fn notice(&mut self, notice: &Notice) {
        if let Notice::Cause(stop) = notice {
            self.cause.get_or_insert_with(|| stop.to_string());
        }
    }

    /// Takes in a row.
    pub(crate) fn take(&mut self, row: &Row, agreed: &AgreedLimits) {
        self.interlocks.take(row, agreed);
        self.last = *row;
        if row.cycle.is_multiple_of(self.stride) {
            self.samples.push((row.cycle, sample(row, &self.is_rig)));
        }
        if self.samples.len() == SAMPLES_MAX {
            self.stride *= 2;
            let stride = self.stride;
            self.samples.retain(|(cycle, _)| cycle.is_multiple_of(stride));
        }
    }

    /// Puts an update on the board, if it is time for one.
    pub(crate) fn push(&mut self, counts: &Counts, agreed: &AgreedLimits, now: Instant) {
        let is_due = |last: Option<Instant>, every: Duration| {
            last.is_none_or(|last| now.saturating_duration_since(last) >= every)
        };
        if is_due(self.pushed, PUSH) {
            if is_due(self.timing.0, SUM) {
                self.timing = (Some(now), Timing::of(counts));
            }
            self.pushed = Some(now);
            self.put(counts, agreed);
        }
    }

    /// Puts the last update on the board.
    pub(crate) fn finish(&mut self, counts: &Counts, agreed: &AgreedLimits) {
        self.timing.1 = Timing::of(counts);
        // The page takes an update in no time: the second trial finds the board free.
        if !self.put(counts, agreed) {
            std::thread::yield_now();
            self.put(counts, agreed);
        }
    }

    fn put(&mut self, counts: &Counts, agreed: &AgreedLimits) -> bool {
        self.number += 1;
        self.stride = STRIDE;
        let row = &self.last;
        let rigs = self.is_rig.iter().enumerate().filter(|(_, is_rig)| **is_rig);
        self.board.put(Update {
            number: self.number,
            cycle: row.cycle,
            time_s: row.time_s,
            distance_m: row.distance_m,
            state: row.state.name(),
            cause: self.cause.clone(),
            samples: self.samples.drain(..).map(|(_, sample)| sample).collect(),
            rigs: rigs.map(|(slot, _)| rig_now(slot, row, counts)).collect(),
            interlocks: self.interlocks.reached(agreed),
            timing: self.timing.1.clone(),
        })
    }
}

/// A row as it is drawn.
fn sample(row: &Row, is_rig: &[bool]) -> Vec<Option<i64>> {
    let whole = |value: f64| value.is_finite().then(|| value.round() as i64);
    let mut values = vec![whole(row.time_s * 1e3)];
    for (slot, is_rig) in is_rig.iter().enumerate() {
        let of_rig = [row.command_m[slot] * 1e6, row.measured_m[slot] * 1e6, row.measured_n[slot]];
        let of_vehicle = [row.extension_m[slot] * 1e6, row.force_n[slot]];
        values.extend(of_rig.map(|value| whole(value).filter(|_| *is_rig)));
        values.extend(of_vehicle.map(whole));
    }
    values
}

fn rig_now(slot: usize, row: &Row, counts: &Counts) -> RigNow {
    let temperature_degc = row.temperature_degc[slot];
    RigNow {
        slot,
        state: RunState::from_code(row.rig_state[slot]).map(RunState::name),
        age_cycles: Some(row.age_cycles[slot]).filter(|age| *age != u8::MAX),
        fresh: counts.fresh[slot],
        lost: counts.stale[slot],
        coupling: row.coupling[slot],
        temperature_degc: temperature_degc.is_finite().then_some(temperature_degc),
        watch: Some(row.drift[slot]).filter(|watch| *watch != Watch::None).map(Watch::name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::InputKind;

    fn fed(cycles: impl Iterator<Item = u64>) -> (Feed, Counts) {
        let mut feed = Feed::new(Arc::new(Board::default()), vec![true, false]);
        let mut counts = Counts::default();
        for cycle in cycles {
            let mut row = Row { cycle, time_s: cycle as f64 * 1e-3, ..Row::default() };
            (row.command_m[0], row.measured_m[0], row.measured_n[0]) = (1e-3, 2e-3, f64::NAN);
            (row.extension_m[1], row.force_n[1], row.input[0]) = (-3e-3, 4e3, InputKind::Fresh);
            (row.extension_m[0], row.force_n[0]) = (5e-3, 6e3);
            counts.take(&row);
            feed.take(&row, &AgreedLimits::default());
        }
        (feed, counts)
    }

    #[test]
    fn of_a_clock_every_fifth_row_is_drawn_and_of_a_fast_run_as_many_as_fit() {
        let none = AgreedLimits::default();
        let (mut feed, counts) = fed(1..=100);
        feed.push(&counts, &none, Instant::now());
        let update = feed.board.take().unwrap();
        assert_eq!((update.number, update.cycle, update.samples.len()), (1, 100, 20));
        // Command, measured displacement and force of a rig, and what the vehicle has of its slot:
        // with wear in software the ram does not move as the vehicle does. A model has no command.
        let [at, rig, model] = [0, 1, 6].map(|from| &update.samples[0][from..]);
        assert_eq!((at[0], at.len()), (Some(5), 11));
        assert_eq!(rig[..5], [Some(1000), Some(2000), None, Some(5000), Some(6000)]);
        assert_eq!(model, [None, None, None, Some(-3000), Some(4000)]);
        assert_eq!(update.rigs.len(), 1);
        assert_eq!((update.rigs[0].fresh, update.rigs[0].lost), (100, 0));

        let (mut feed, counts) = fed(1..=3200);
        feed.push(&counts, &none, Instant::now());
        let times: Vec<i64> =
            feed.board.take().unwrap().samples.iter().map(|row| row[0].unwrap()).collect();
        // 640 were halved at 256, twice.
        assert_eq!(times.len(), 160);
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 20), "{times:?}");
    }

    #[test]
    fn an_update_comes_ten_times_a_second_at_most() {
        let none = AgreedLimits::default();
        let (mut feed, counts) = fed(1..=10);
        let begin = Instant::now();
        let mut pushed = 0;
        for ms in 0..1000 {
            feed.push(&counts, &none, begin + Duration::from_millis(ms));
            pushed += usize::from(feed.board.take().is_some());
        }
        assert_eq!(pushed, 10);
        feed.finish(&counts, &none);
        assert_eq!(feed.board.take().map(|update| update.number), Some(11));
    }
}
