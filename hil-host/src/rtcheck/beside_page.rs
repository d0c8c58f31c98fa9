//! What a page costs the loop: seconds with a page that is fed alternate with seconds without.
//!
//! ```text
//! second 0: not fed | second 1: fed | second 2: not fed | ...      the first 0.2 s do not count
//! ```
//! In every cycle the loop puts a row into the queue of a recorder, as in a run. The recorder's
//! thread takes all of them, and feeds the page with those of every other second. A reader on this
//! machine takes the events of the page, as a browser would. Both halves are measured in one run:
//! whatever else this machine does in the meantime meets both.

use super::distribution::empty;
use crate::counts::Counts;
use crate::live::{AgreedLimits, Facts, Feed, LivePage, SlotFacts, edges_us};
use crate::record::{Outlet, Row};
use can_protocol::RunState;
use firmware_core::line::LineState;
use hdrhistogram::Histogram;
use scenario::run::{CYCLE_S, Run};
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Ticks of a block.
const BLOCK_TICKS: u64 = 1000;

/// Ticks at the begin of a block in which the page may still be busy with the last one.
const SETTLING_TICKS: u64 = 200;

/// Time after which the reader looks whether the measurement has ended.
const GLANCE: Duration = Duration::from_millis(100);

/// Times of ticks with a page that is fed, or without.
#[derive(Debug, Clone)]
pub struct PartTimes {
    /// How late the thread woke up (ns).
    pub lateness_ns: Histogram<u64>,
    /// Time of a vehicle step (ns); empty without a scenario.
    pub step_ns: Histogram<u64>,
}

impl Default for PartTimes {
    fn default() -> Self {
        Self { lateness_ns: empty(), step_ns: empty() }
    }
}

/// Both parts of a measurement.
#[derive(Debug, Clone, Default)]
pub struct BesidePage {
    /// Ticks of seconds in which the page was fed.
    pub fed: PartTimes,
    /// Ticks of seconds in which it was not.
    pub unfed: PartTimes,
}

impl BesidePage {
    /// The part that a tick belongs to; none at the begin of a block.
    pub(super) fn part(&mut self, tick: u64) -> Option<&mut PartTimes> {
        let is_settled = tick % BLOCK_TICKS >= SETTLING_TICKS;
        let part = if is_fed(tick) { &mut self.fed } else { &mut self.unfed };
        is_settled.then_some(part)
    }
}

/// Whether the page is fed with the row of a tick.
const fn is_fed(tick: u64) -> bool {
    !(tick / BLOCK_TICKS).is_multiple_of(2)
}

/// The row of a tick, in place of that of a cycle.
pub(super) fn row(tick: u64, lateness_ns: u64, compute_ns: u64, state: Option<&LineState>) -> Row {
    let nanoseconds = |time_ns: u64| u32::try_from(time_ns).unwrap_or(u32::MAX);
    let mut row = Row {
        cycle: tick,
        time_s: tick as f64 * CYCLE_S,
        state: RunState::Run,
        compute_ns: nanoseconds(compute_ns),
        cycle_ns: nanoseconds(compute_ns),
        lateness_ns: nanoseconds(lateness_ns),
        ..Row::default()
    };
    if let Some(state) = state {
        row.distance_m = state.vehicle.distance_m.lane(0);
        for (slot, memory) in state.slots.iter().enumerate() {
            row.extension_m[slot] = state.vehicle.extension_m[slot].lane(0) - memory.mid_stroke_m;
            row.force_n[slot] = state.vehicle.damper_n[slot].lane(0);
        }
    }
    row
}

/// Shows on the page what is measured, and gives the recorder's end of it.
pub(super) fn begin(page: &LivePage, run: Option<&Run>, ticks: u64) -> Feed {
    let slots = run.map(SlotFacts::of).unwrap_or_default();
    // No rig is asked for anything here.
    let modelled = |slot| SlotFacts { is: "modelled", of: None, is_reversed: false, ..slot };
    let slots: Vec<SlotFacts> = slots.into_iter().map(modelled).collect();
    let is_rig = vec![false; slots.len()];
    page.begin(Facts {
        title: "rtcheck: every other second is shown".to_owned(),
        vehicle: run.map_or_else(|| "no vehicle".to_owned(), |run| run.vehicle_name.clone()),
        speed_kmh: run.map_or(0.0, |run| run.speed_m_per_s * 3.6),
        duration_s: ticks as f64 * CYCLE_S,
        bus: "none".to_owned(),
        pace: "realtime",
        is_clocked: true,
        slots,
        warnings: Vec::new(),
        edges_us: edges_us(),
    });
    page.feed(is_rig)
}

/// The recorder's thread.
pub(super) fn take(rows: &Outlet<'_, Row>, mut feed: Feed, ended: &AtomicBool) {
    let (mut counts, none) = (Counts::default(), AgreedLimits::default());
    rows.run(ended, |rows| {
        for row in rows {
            counts.take(row);
            if is_fed(row.cycle) {
                feed.take(row, &none);
            }
        }
        if rows.last().is_some_and(|row| is_fed(row.cycle)) {
            feed.push(&counts, &none, Instant::now());
        }
    });
}

/// Takes the events of a page, as a browser would, and gives their bytes.
pub(super) fn read(address: SocketAddr, ended: &AtomicBool) -> u64 {
    let Ok(mut line) = TcpStream::connect(address) else { return 0 };
    let asked = write!(line, "GET /events HTTP/1.1\r\nHost: {address}\r\n\r\n");
    if asked.and_then(|()| line.set_read_timeout(Some(GLANCE))).is_err() {
        return 0;
    }
    let (mut bytes, mut total) = ([0; 4096], 0);
    while !ended.load(Ordering::Relaxed) {
        match line.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => total += count as u64,
            // Nothing new: not fed.
            Err(_) => {}
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_a_second_alternate_and_their_begin_does_not_count() {
        let mut beside = BesidePage::default();
        for tick in 0..4000 {
            if let Some(part) = beside.part(tick) {
                part.lateness_ns.saturating_record(if is_fed(tick) { 2000 } else { 1000 });
            }
        }
        for (part, time_ns) in [(&beside.fed, 2000), (&beside.unfed, 1000)] {
            assert_eq!(part.lateness_ns.len(), 1600);
            assert!(part.lateness_ns.equivalent(part.lateness_ns.max(), time_ns));
        }
        assert!(!is_fed(999) && is_fed(1000) && is_fed(1999) && !is_fed(2000));
    }
}
