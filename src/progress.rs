//! Progress of work that is done item by item.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Before the first item is done nobody knows how many there are.
const BEFORE: &str = "{elapsed:>4}  {msg}";
/// From the first item on.
const COUNTED: &str = "{elapsed:>4} {bar:24} {pos}/{len}, {eta} to go  {msg}";

/// A bar on the terminal with the remaining time; `first` names what is being done until an item is done.
pub(crate) fn bar(first: &'static str) -> ProgressBar {
    bar_on(ProgressDrawTarget::stderr_with_hz(4), first)
}

fn bar_on(target: ProgressDrawTarget, first: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, target);
    set_template(&bar, BEFORE);
    bar.set_message(first);
    bar.tick();
    bar
}

/// Shows how many of all items are done, and a word on the last one.
pub(crate) fn show(bar: &ProgressBar, [done, of]: [usize; 2], last: String) {
    if bar.length() != Some(of as u64) {
        set_template(bar, COUNTED);
        bar.set_length(of as u64);
    }
    bar.set_position(done as u64);
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
    use indicatif::TermLike;
    use std::io;
    use std::sync::{Arc, Mutex};

    /// A terminal that keeps what is written to it.
    #[derive(Debug, Clone, Default)]
    struct Kept(Arc<Mutex<String>>);

    impl Kept {
        fn text(&self) -> String {
            self.0.lock().unwrap().clone()
        }
    }

    impl TermLike for Kept {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, line: &str) -> io::Result<()> {
            self.write_str(line)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn progress_shows_no_count_of_zero_of_zero() {
        let kept = Kept::default();
        let target = ProgressDrawTarget::term_like(Box::new(kept.clone()));
        let bar = bar_on(target, "the first points");
        bar.force_draw();
        assert!(kept.text().contains("the first points"), "{}", kept.text());
        show(&bar, [1, 3], "point 1 of 3".to_owned());
        bar.force_draw();
        assert!(kept.text().contains("1/3"), "{}", kept.text());
        assert!(!kept.text().contains("0/0"), "{}", kept.text());
    }
}
