//! Progress of work that is done item by item.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Before the number of items is known.
const WAITING: &str = "{elapsed:>4}  {msg}";
/// Once items are counted.
const COUNTING: &str = "{elapsed:>4} {bar:24} {pos}/{len}, {eta} to go  {msg}";

/// A line on the terminal that shows `first` until an item is done.
pub(crate) fn bar(first: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(4));
    set_template(&bar, WAITING);
    bar.set_message(first);
    bar.tick();
    bar
}

/// Shows how many items of how many are done, the time to go, and a word on the last item.
pub(crate) fn show(bar: &ProgressBar, [done, of]: [usize; 2], last: String) {
    if of > 0 && bar.length().is_none() {
        set_template(bar, COUNTING);
    }
    if of > 0 {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    }
    bar.set_message(last);
}

fn set_template(bar: &ProgressBar, template: &str) {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_counted_before_the_number_of_items_is_known() {
        for template in [WAITING, COUNTING] {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
        assert!(!WAITING.contains("{len}"));
        let bar = bar("the first case");
        show(&bar, [0, 0], "nothing to do".to_owned());
        assert_eq!(bar.length(), None);
        show(&bar, [1, 3], "case 0".to_owned());
        assert_eq!((bar.position(), bar.length()), (1, Some(3)));
    }
}
