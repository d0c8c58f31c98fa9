//! The queues between the loop and the threads that write.

use super::bus_log::BusEvent;
use super::row::Row;
use crossbeam_channel::Sender;
use heapless::spsc::{Consumer, Producer, Queue};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Rows that fit between loop and recorder: a second at 1 kHz.
pub const ROWS: usize = 1024;
/// Frames that fit: a second with two rigs.
pub const EVENTS: usize = 4096;

/// The queues between the loop and the recorder.
#[derive(Debug)]
pub struct Queues {
    rows: Box<Queue<Row, ROWS>>,
    events: Box<Queue<BusEvent, EVENTS>>,
}

impl Default for Queues {
    fn default() -> Self {
        Self { rows: Box::new(Queue::new()), events: Box::new(Queue::new()) }
    }
}

impl Queues {
    /// The loop's end and the recorder's end.
    pub fn split(&mut self) -> (Recorder<'_>, Drain<'_>) {
        let (rows_in, rows_out) = self.rows.split();
        let (events_in, events_out) = self.events.split();
        (
            Recorder {
                rows: rows_in,
                events: events_in,
                may_wait: false,
                dropped_rows: 0,
                dropped_events: 0,
            },
            Drain { rows: rows_out, events: events_out },
        )
    }
}

/// The loop's end: neither allocates nor locks.
pub struct Recorder<'a> {
    rows: Producer<'a, Row>,
    events: Producer<'a, BusEvent>,
    /// Whether the loop may wait for room: there is no clock that it would miss.
    pub may_wait: bool,
    /// Rows that found no room.
    pub dropped_rows: u64,
    /// Frames that found no room.
    pub dropped_events: u64,
}

impl Recorder<'_> {
    /// Hands over a row.
    pub fn row(&mut self, mut row: Row) {
        while let Err(back) = self.rows.enqueue(row) {
            if !self.may_wait {
                self.dropped_rows += 1;
                return;
            }
            row = back;
            std::thread::yield_now();
        }
    }

    /// Hands over a frame.
    pub fn event(&mut self, mut event: BusEvent) {
        while let Err(back) = self.events.enqueue(event) {
            if !self.may_wait {
                self.dropped_events += 1;
                return;
            }
            event = back;
            std::thread::yield_now();
        }
    }
}

/// Rows that left the loop together.
pub type Batch = Arc<[Row]>;

/// The recorder's end.
pub struct Drain<'a> {
    rows: Consumer<'a, Row>,
    events: Consumer<'a, BusEvent>,
}

impl Drain<'_> {
    /// Empties both queues until `done` is set and they are empty, sending on what it finds.
    pub fn run(
        mut self,
        done: &AtomicBool,
        rows: &[Sender<Batch>],
        events: &Sender<Vec<BusEvent>>,
    ) {
        loop {
            // Read before draining: what was queued before `done` is drained after it.
            let last = done.load(Ordering::Acquire);
            let mut found = false;
            loop {
                let batch: Vec<Row> =
                    std::iter::from_fn(|| self.rows.dequeue()).take(ROWS).collect();
                if batch.is_empty() {
                    break;
                }
                found = true;
                let batch: Batch = batch.into();
                for channel in rows {
                    // A receiver that has ended reports the reason itself.
                    let _ = channel.send(Arc::clone(&batch));
                }
            }
            let frames: Vec<BusEvent> =
                std::iter::from_fn(|| self.events.dequeue()).take(EVENTS).collect();
            if !frames.is_empty() {
                found = true;
                let _ = events.send(frames);
            }
            if last && !found {
                return;
            }
            if !found {
                // Polling keeps the loop free of wake-up calls.
                std::thread::sleep(Duration::from_millis(2));
            }
        }
    }
}
