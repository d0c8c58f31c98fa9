//! Progress of work that is done item by item.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on the terminal with the time that is left; `first` stands there until an item is done.
pub(crate) fn bar(first: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(4));
    let template = "{elapsed:>4} {bar:24} {pos}/{len}, {eta} to go  {msg}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(first);
    bar.tick();
    bar
}

/// Shows how many items are done of how many, and a word on the last one.
pub(crate) fn show(bar: &ProgressBar, [done, of]: [usize; 2], last: String) {
    bar.set_length(of as u64);
    bar.set_position(done as u64);
    bar.set_message(last);
}
