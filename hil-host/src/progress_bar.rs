//! Bars of progress on the terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Work that takes longer shows its progress.
const SILENT: Duration = Duration::from_secs(2);

/// How often a bar is drawn at most (Hz).
const DRAWN_HZ: u8 = 10;

/// A bar for so many cycles.
pub(crate) fn bar(cycles: u64) -> ProgressBar {
    drawn_to(ProgressDrawTarget::stderr_with_hz(DRAWN_HZ), cycles)
}

fn drawn_to(target: ProgressDrawTarget, steps: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), target);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    bar
}

/// A bar that appears when the work has taken two seconds.
#[derive(Debug)]
pub(crate) struct LateBar {
    bar: ProgressBar,
    begin: Instant,
}

impl LateBar {
    /// For so many steps of some work.
    pub(crate) fn new(work: &'static str, steps: u64) -> Self {
        let bar = drawn_to(ProgressDrawTarget::hidden(), steps);
        bar.set_message(work);
        Self { bar, begin: Instant::now() }
    }

    /// So many steps are done.
    pub(crate) fn at(&mut self, steps: u64) {
        if self.bar.is_hidden() && self.begin.elapsed() > SILENT {
            self.bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(DRAWN_HZ));
        }
        self.bar.set_position(steps);
    }

    /// The work is done.
    pub(crate) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
