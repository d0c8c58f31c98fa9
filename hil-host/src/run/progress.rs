//! The line of progress, and the columns that it is made from.

use crate::columns::{Columns, Watched};
use crate::record::Batch;
use crate::summary::microseconds;
use can_protocol::Watch;
use crossbeam_channel::Receiver;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// Time after which the line is printed again.
const REFRESH: Duration = Duration::from_millis(100);

/// Collects the columns and shows progress.
pub(super) fn collect(rows: &Receiver<Batch>, cycles: u64, speed_kmh: f64) -> Columns {
    let mut columns = Columns::default();
    let bar = bar(cycles, ProgressDrawTarget::stderr_with_hz(10));
    let mut shown = Instant::now();
    for batch in rows {
        for row in batch.iter() {
            columns.push(row);
        }
        let Some(row) = batch.last() else { continue };
        if shown.elapsed() > REFRESH {
            shown = Instant::now();
            bar.set_position(row.cycle);
            let stale: u64 = columns.stale.iter().sum();
            bar.set_message(format!(
                "{:6.1} s {speed_kmh:3.0} km/h {:7.0} m  stroke {:6.2} mm  force {:6.1} kN  \
                 cycle p50 {:.0} p99 {:.0} µs  lost {stale}{}",
                row.time_s,
                row.distance_m,
                row.extension_m[0] * 1e3,
                row.force_n[0] * 1e-3,
                microseconds(&columns.cycle_ns, 0.5),
                microseconds(&columns.cycle_ns, 0.99),
                watch_text(&columns.watch),
            ));
        }
    }
    bar.finish_and_clear();
    columns
}

/// A bar for so many cycles.
pub(crate) fn bar(cycles: u64, target: ProgressDrawTarget) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(cycles), target);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    bar
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
