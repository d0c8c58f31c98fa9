//! The window of a trace with the greatest sum of squares.

use std::collections::VecDeque;

/// Finds the window of so many values with the greatest sum of squares, value by value.
#[derive(Debug, Clone)]
pub(crate) struct Liveliest {
    window: usize,
    /// Time and value of those that the sum holds.
    held: VecDeque<(f64, f64)>,
    count: usize,
    sum: f64,
    best: f64,
    at_s: f64,
}

impl Liveliest {
    pub(crate) fn new(window: usize) -> Self {
        let held = VecDeque::with_capacity(window + 1);
        Self { window, held, count: 0, sum: 0.0, best: -1.0, at_s: 0.0 }
    }

    pub(crate) fn take(&mut self, time_s: f64, value: f64) {
        self.sum += value * value;
        self.held.push_back((time_s, value));
        self.count += 1;
        if self.held.len() > self.window
            && let Some((_, old)) = self.held.pop_front()
        {
            self.sum -= old * old;
        }
        if self.count >= self.window
            && self.sum > self.best
            && let Some((begin_s, _)) = self.held.front()
        {
            (self.best, self.at_s) = (self.sum, *begin_s);
        }
    }

    /// Time at which the window begins; none in a trace hardly longer than it.
    pub(crate) fn begin_s(&self) -> Option<f64> {
        (self.count > 2 * self.window).then_some(self.at_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_with_the_most_in_it_is_found() {
        let mut found = Liveliest::new(10);
        for n in 0..100 {
            found.take(f64::from(n), if (40..50).contains(&n) { -3.0 } else { 1.0 });
            assert_eq!(found.begin_s().is_some(), n >= 20);
        }
        assert_eq!(found.begin_s(), Some(40.0));
    }
}
