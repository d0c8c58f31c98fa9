//! The line of progress. It is drawn by a thread of its own: a terminal that takes nothing must not
//! hold up the record.

use crate::counts::{Counts, Watched};
use crate::progress_bar::bar;
use crate::record::Row;
use crate::summary::microseconds;
use can_protocol::Watch;
use crossbeam_channel::{Receiver, Sender, bounded};
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// Time after which the line is printed again.
const REFRESH: Duration = Duration::from_millis(100);

/// A line of progress.
#[derive(Debug)]
pub(super) struct Line {
    cycle: u64,
    text: String,
}

/// Makes a line from time to time.
#[derive(Debug)]
pub(super) struct Progress {
    lines: Sender<Line>,
    shown: Instant,
    speed_kmh: f64,
}

impl Progress {
    /// The progress of a run, and its lines.
    pub(super) fn new(speed_kmh: f64) -> (Self, Receiver<Line>) {
        let (lines, shown) = bounded(1);
        (Self { lines, shown: Instant::now(), speed_kmh }, shown)
    }

    /// Takes in the last row.
    pub(super) fn take(&mut self, row: &Row, counts: &Counts) {
        if self.shown.elapsed() <= REFRESH || self.lines.is_full() {
            return;
        }
        self.shown = Instant::now();
        let (speed_kmh, stale): (f64, u64) = (self.speed_kmh, counts.stale.iter().sum());
        let text = format!(
            "{:6.1} s {speed_kmh:3.0} km/h {:7.0} m  stroke {:6.2} mm  force {:6.1} kN  \
             cycle p50 {:.0} p99 {:.0} µs  lost {stale}{}",
            row.time_s,
            row.distance_m,
            row.extension_m[0] * 1e3,
            row.force_n[0] * 1e-3,
            microseconds(&counts.cycle_ns, 0.5),
            microseconds(&counts.cycle_ns, 0.99),
            watch_text(&counts.watch),
        );
        // A line that finds no room is outdated.
        let _ = self.lines.try_send(Line { cycle: row.cycle, text });
    }
}

/// Draws lines until there are no more.
pub(super) fn show(lines: &Receiver<Line>, cycles: u64) {
    let bar = bar(cycles);
    for line in lines {
        bar.set_position(line.cycle);
        bar.set_message(line.text);
    }
    bar.finish_and_clear();
}

/// The residual of every watched rig whose usual residual is known.
fn watch_text(watched: &[Watched]) -> String {
    let mut text = String::new();
    for (slot, Watched { verdict, rms_n, .. }) in watched.iter().enumerate() {
        let drift = match verdict {
            Watch::None | Watch::Learning => continue,
            Watch::Steady => "",
            Watch::Drift => " DRIFT",
        };
        // Writing to a string cannot fail.
        let _ = write!(text, "  residual {} {rms_n:.0} N{drift}", slot + 1);
    }
    text
}
