//! The queues between the loop and the threads that write.
//!
//! The loop tries to put an entry in and goes on; the other end polls. As nobody ever waits at a
//! queue, neither end takes a lock, and the room is allocated before the run.

use super::bus_log::BusEvent;
use super::row::Row;
use crate::control::Notice;
use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use firmware_core::supervision::Signal;
use firmware_core::vehicle::DAMPER_SLOTS;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time that the queues hold (s).
const HELD_S: usize = 4;

/// Rows in a second at one cycle per millisecond.
const ROWS_PER_S: usize = 1024;

/// Rows that fit between the loop and the thread that writes them, at one cycle per millisecond.
pub const ROWS: usize = HELD_S * ROWS_PER_S;

/// Frames in a second for each rig: a command and a measurement in every cycle, and slow messages.
const FRAMES_PER_S: usize = 2 * ROWS_PER_S + 128;

/// What a run can find: one cause, and one note for each signal of each rig.
const NOTICES: usize = 1 + DAMPER_SLOTS * Signal::ALL.len();

/// Time between two looks into an empty queue.
const POLL: Duration = Duration::from_millis(10);

/// Entries that are taken out together.
const BATCH: usize = 1024;

/// A frame with the cycle that it belongs to: that of the next row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoggedFrame {
    /// Number of the cycle, from one.
    pub cycle: u64,
    /// The frame.
    pub event: BusEvent,
}

/// The queues between the loop and the recorder.
#[derive(Debug)]
pub struct Queues {
    rows: (Sender<Row>, Receiver<Row>),
    events: (Sender<LoggedFrame>, Receiver<LoggedFrame>),
    notices: (Sender<Notice>, Receiver<Notice>),
}

impl Default for Queues {
    /// Queues for as many rigs as there can be.
    fn default() -> Self {
        Self::for_rigs(DAMPER_SLOTS)
    }
}

impl Queues {
    /// Queues that hold four seconds of a run with so many rigs, at one cycle per millisecond.
    pub fn for_rigs(rigs: usize) -> Self {
        Self::for_cycles(1, rigs)
    }

    /// The same at so many cycles per millisecond.
    pub fn for_cycles(per_ms: usize, rigs: usize) -> Self {
        debug_assert!((1..=4).contains(&per_ms), "{per_ms} cycles per millisecond");
        Self {
            rows: bounded(per_ms * ROWS),
            events: bounded(per_ms * HELD_S * FRAMES_PER_S * rigs.max(1)),
            notices: bounded(NOTICES),
        }
    }

    /// The loop's end and the recorder's end.
    pub fn split(&mut self) -> (Recorder<'_>, Drain<'_>) {
        (
            Recorder {
                rows: &self.rows.0,
                events: &self.events.0,
                notices: &self.notices.0,
                cycle: 1,
                may_wait: false,
                rows_lost_at_most: u64::MAX,
                dropped_rows: 0,
                dropped_events: 0,
                dropped_in_a_row: 0,
            },
            Drain {
                rows: Outlet(&self.rows.1),
                events: Outlet(&self.events.1),
                notices: Outlet(&self.notices.1),
            },
        )
    }
}

/// The loop's end: neither allocates nor locks.
pub struct Recorder<'a> {
    rows: &'a Sender<Row>,
    events: &'a Sender<LoggedFrame>,
    notices: &'a Sender<Notice>,
    /// The cycle that frames belong to.
    cycle: u64,
    /// Whether the loop may wait for room: there is no clock that it would miss.
    pub may_wait: bool,
    /// Rows that may be lost one after the other.
    pub rows_lost_at_most: u64,
    /// Rows that found no room.
    pub dropped_rows: u64,
    /// Frames that found no room.
    pub dropped_events: u64,
    /// Rows that found no room since the last one that did.
    dropped_in_a_row: u64,
}

impl Recorder<'_> {
    /// Hands over a row.
    pub fn row(&mut self, row: Row) {
        self.cycle = row.cycle + 1;
        if put(self.rows, row, self.may_wait) {
            self.dropped_in_a_row = 0;
        } else {
            self.dropped_rows += 1;
            self.dropped_in_a_row += 1;
        }
    }

    /// Hands over a frame.
    pub fn event(&mut self, event: BusEvent) {
        if !put(self.events, LoggedFrame { cycle: self.cycle, event }, self.may_wait) {
            self.dropped_events += 1;
        }
    }

    /// Hands over what the loop has found.
    pub fn notice(&mut self, notice: Notice) {
        // A run has room for all of its own; every one is in the summary too.
        let _has_room = put(self.notices, notice, false);
    }

    /// Whether more rows were lost one after the other than may be.
    pub const fn is_overrun(&self) -> bool {
        self.dropped_in_a_row > self.rows_lost_at_most
    }
}

/// Puts an entry into a queue; false where there is no room.
fn put<T>(queue: &Sender<T>, mut entry: T, may_wait: bool) -> bool {
    while let Err(TrySendError::Full(back)) = queue.try_send(entry) {
        if !may_wait {
            return false;
        }
        entry = back;
        std::thread::yield_now();
    }
    // The queue itself holds the other end: it is never closed.
    true
}

/// The recorder's end.
#[derive(Debug)]
pub struct Drain<'a> {
    /// Rows out of the loop.
    pub rows: Outlet<'a, Row>,
    /// Frames out of the loop.
    pub events: Outlet<'a, LoggedFrame>,
    /// What the loop has found, before the row of its cycle.
    pub notices: Outlet<'a, Notice>,
}

impl Drain<'_> {
    /// Empties the queues of rows and frames until `done` is set and they are empty, and keeps
    /// nothing.
    pub fn discard(self, done: &AtomicBool) {
        std::thread::scope(|scope| {
            scope.spawn(|| self.events.run(done, |_| {}));
            self.rows.run(done, |_| {});
        });
    }
}

/// The end of a queue that is emptied.
#[derive(Debug)]
pub struct Outlet<'a, T>(&'a Receiver<T>);

impl<T> Outlet<'_, T> {
    /// The next entry, if there is one.
    pub fn next(&self) -> Option<T> {
        self.0.try_recv().ok()
    }

    /// Hands what is in the queue to `take`, in batches, until `done` is set and nothing is left.
    pub fn run(&self, done: &AtomicBool, mut take: impl FnMut(&[T])) {
        let mut batch = Vec::with_capacity(BATCH);
        loop {
            // Read before emptying: what was queued before `done` is taken after it.
            let last = done.load(Ordering::Acquire);
            batch.clear();
            batch.extend(self.0.try_iter().take(BATCH));
            match () {
                () if !batch.is_empty() => take(&batch),
                () if last => return,
                // Polling keeps the loop free of wake-up calls.
                () => std::thread::sleep(POLL),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_queues_hold_four_seconds_and_count_what_is_lost_behind_them() {
        let mut queues = Queues::for_rigs(1);
        let (mut recorder, drain) = queues.split();
        recorder.rows_lost_at_most = 1000;
        for cycle in 1..=ROWS as u64 + 1000 {
            recorder.row(Row { cycle, ..Row::default() });
        }
        const { assert!(ROWS >= 4000) };
        assert_eq!((recorder.dropped_rows, recorder.is_overrun()), (1000, false));
        recorder.row(Row::default());
        assert!(recorder.is_overrun());
        // Every row that found room comes out, in order.
        let mut last = 0;
        drain.rows.run(&AtomicBool::new(true), |rows| {
            for row in rows {
                assert_eq!(row.cycle, last + 1);
                last = row.cycle;
            }
        });
        assert_eq!(last, ROWS as u64);
        recorder.row(Row::default());
        assert!(!recorder.is_overrun());
    }
}
