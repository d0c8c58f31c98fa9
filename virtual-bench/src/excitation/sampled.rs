//! A motion of many tones, read from a table.
//!
//! ```text
//! x(t), v(t) = cubic through displacement and velocity at both ends of a step
//! ```
//!
//! Every simulator asks for the motion at each of its own steps, tens of thousands a second; the
//! table makes that as cheap as a single sine. It is the motion itself and not an approximation of
//! one: all that record or simulate it see the same. It differs from its source by x (w h)^4 / 384:
//! at 20 Hz and a step of a millisecond by a millionth.

use measurement::interpolant::between;

/// Displacement and velocity at equal steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    step_s: f64,
    at: Vec<(f64, f64)>,
    pub(super) frequency_hz: f64,
}

impl Sampled {
    /// The motion of a function over a time, with its characteristic frequency.
    pub(super) fn of(
        motion: impl Fn(f64) -> (f64, f64),
        (duration_s, step_s): (f64, f64),
        frequency_hz: f64,
    ) -> Self {
        debug_assert!(step_s > 0.0 && duration_s >= step_s, "{duration_s} s in {step_s} s");
        let steps = libm::ceil(duration_s / step_s) as usize;
        let at = (0..=steps).map(|n| motion(n as f64 * step_s)).collect();
        Self { step_s, at, frequency_hz }
    }

    /// When the table ends, s.
    pub(super) fn end_s(&self) -> f64 {
        (self.at.len() - 1) as f64 * self.step_s
    }

    /// Displacement and velocity; beyond its end it stays where it is.
    pub(super) fn at(&self, time_s: f64) -> (f64, f64) {
        let place = (time_s / self.step_s).max(0.0);
        let index = place as usize;
        match (self.at.get(index), self.at.get(index + 1)) {
            (Some(from), Some(to)) => between(*from, *to, self.step_s, place - index as f64),
            _ => (self.at.last().map_or(0.0, |(x, _)| *x), 0.0),
        }
    }

    /// Greatest speed, m/s, and distance, m, at its steps.
    pub(super) fn reach(&self) -> (f64, f64) {
        self.at.iter().fold((0.0, 0.0), |(v, x), at| (at.1.abs().max(v), at.0.abs().max(x)))
    }
}
