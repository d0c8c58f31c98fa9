//! What a late sensor has not yet reported: the force over the last delay.
//!
//! ```text
//! F_read(t) = F(t - t_d)        0 before the start
//! ```
//!
//! The line keeps knots of time and force and reads straight between them. Where the step is longer
//! than a fortieth of the delay, the step is cut at the instant at which a later step of the same
//! length will look ([`DelayLine::cut_s`]), so that a reading meets a knot and nothing is
//! interpolated. Shorter steps are thinned to knots a fortieth of the delay apart, so that the
//! line holds any number of them.

use core::fmt;

/// Most knots.
const KNOTS: usize = 88;

/// Two intervals of kept knots are at least this share of the delay.
const SHARE: f64 = 1.0 / 41.0;

/// A force at a time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Knot {
    time_s: f64,
    force_n: f64,
}

/// The forces of the last delay.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct DelayLine {
    now_s: f64,
    first: usize,
    count: usize,
    knots: [Knot; KNOTS],
}

impl fmt::Debug for DelayLine {
    /// The knots in use.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries((0..self.count).map(|place| self.knot(place))).finish()
    }
}

impl DelayLine {
    /// One knot, which says that there was no force before the start.
    pub(super) const NEW: Self =
        Self { now_s: 0.0, first: 0, count: 1, knots: [Knot { time_s: 0.0, force_n: 0.0 }; KNOTS] };

    /// Where within a step a later reading will look, if a knot there will be kept.
    pub(super) fn cut_s(delay_s: f64, step_s: f64) -> Option<f64> {
        if 2.0 * step_s <= SHARE * delay_s {
            return None;
        }
        let steps = delay_s / step_s;
        let part = steps - libm::floor(steps);
        (part > 1e-9 && part < 1.0 - 1e-9).then_some(step_s * (1.0 - part))
    }

    /// Goes on by `step_s`.
    pub(super) fn pass(&mut self, step_s: f64) {
        self.now_s += step_s;
    }

    /// Keeps the force of an instant `ago_s` before now.
    pub(super) fn keep(&mut self, ago_s: f64, delay_s: f64, force_n: f64) {
        let knot = Knot { time_s: self.now_s - ago_s, force_n };
        let before_last = self.count.checked_sub(2).map(|i| self.knot(i));
        let thin = before_last.is_some_and(|old| knot.time_s - old.time_s < SHARE * delay_s);
        if !thin && self.count < KNOTS {
            self.count += 1;
        }
        debug_assert!(self.count >= 1 && self.count <= KNOTS, "{} of {KNOTS} knots", self.count);
        let last = (self.first + self.count.saturating_sub(1)) % KNOTS;
        if let Some(slot) = self.knots.get_mut(last) {
            *slot = knot;
        }
    }

    /// The force of the instant `delay_s` before now; forgets what was earlier.
    pub(super) fn read(&mut self, delay_s: f64) -> f64 {
        let wanted_s = self.now_s - delay_s;
        while self.count > 2 && self.knot(1).time_s <= wanted_s {
            self.first = (self.first + 1) % KNOTS;
            self.count -= 1;
        }
        let (a, b) = (self.knot(0), self.knot(1.min(self.count.saturating_sub(1))));
        let span_s = b.time_s - a.time_s;
        if wanted_s <= a.time_s || span_s <= 0.0 {
            return a.force_n;
        }
        a.force_n + (b.force_n - a.force_n) * ((wanted_s - a.time_s) / span_s).min(1.0)
    }

    /// The knot at a place in rising order.
    fn knot(&self, place: usize) -> Knot {
        debug_assert!(place < self.count, "knot {place} of {}", self.count);
        self.knots.get((self.first + place) % KNOTS).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_come_late_and_unbent_at_any_step() {
        for step_s in [1e-6, 17e-6, 1e-4, 0.37e-3, 1e-3, 5e-3] {
            for delay_s in [1e-5, 3e-4, 2.3e-3, 20e-3] {
                let mut line = DelayLine::NEW;
                let steps = (0.06 / step_s) as u32;
                for i in 1..=steps {
                    line.pass(step_s);
                    let now_s = f64::from(i) * step_s;
                    let cut_s = DelayLine::cut_s(delay_s, step_s);
                    let ago_s = cut_s.map_or(0.0, |cut_s| step_s - cut_s);
                    line.keep(ago_s, delay_s, 1e6 * (now_s - ago_s));
                    let expected = 1e6 * (now_s - delay_s).max(0.0);
                    let read = line.read(delay_s);
                    assert!((read - expected).abs() < 1e-6, "{step_s} {delay_s} {i}: {read}");
                    assert!(line.count < KNOTS);
                }
            }
        }
    }

    #[test]
    fn a_step_is_cut_where_the_reading_will_look() {
        let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-15);
        assert!(near(DelayLine::cut_s(2.3e-3, 1e-3), 0.7e-3));
        assert!(near(DelayLine::cut_s(0.3e-3, 1e-3), 0.7e-3));
        assert_eq!(DelayLine::cut_s(4e-3, 1e-3), None);
        assert_eq!(DelayLine::cut_s(20e-3, 1e-6), None);
    }
}
