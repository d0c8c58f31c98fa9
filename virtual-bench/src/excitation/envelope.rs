//! Envelopes of tones: stretches that rise, stay and fall, with rests between them.
//!
//! ```text
//! level(t) = level_k w((t - start_k)/rise_k)             rising
//!            level_k                                     staying
//!            level_k (1 - w((t - end_k)/fall_k))         falling
//! ```
//!
//! with the window w of the excitations, so that the motion has no jump up to its acceleration.

use super::window;

/// One stretch of an envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// When it begins, s.
    pub start_s: f64,
    /// Time in which it rises, s.
    pub rise_s: f64,
    /// Time that it stays, s.
    pub stay_s: f64,
    /// Time in which it falls, s.
    pub fall_s: f64,
    /// Factor on the tones while it stays.
    pub level: f64,
}

impl Stretch {
    /// When it is over, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.rise_s + self.stay_s + self.fall_s
    }
}

/// The value of an envelope at a time and its rate, 1/s; zero between stretches.
pub(super) fn at(stretches: &[Stretch], time_s: f64) -> (f64, f64) {
    let current = stretches.iter().find(|one| (one.start_s..one.end_s()).contains(&time_s));
    let Some(one) = current else { return (0.0, 0.0) };
    let since_s = time_s - one.start_s;
    let falling_s = since_s - one.rise_s - one.stay_s;
    let (value, rate) = if falling_s > 0.0 {
        let (value, rate) = window(falling_s, one.fall_s);
        (1.0 - value, -rate)
    } else {
        window(since_s, one.rise_s)
    };
    (one.level * value, one.level * rate)
}
