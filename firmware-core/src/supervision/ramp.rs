//! Fading in and out along a raised cosine.
//!
//! ```text
//! g(s) = (1 - cos(pi s)) / 2         s from 0 to 1 over the duration T
//! g'  <= pi / (2 T)                  g'' <= pi^2 / (2 T^2)
//! ```
//!
//! The gain has no corner at either end, so that what it fades begins and ends without a step in
//! speed.

use core::f64::consts::PI;

/// A gain on its way from 0 to 1 or back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ramp {
    /// Share of the duration that has passed on the way up, 0 to 1.
    progress: f64,
}

impl Ramp {
    /// A ramp at its upper end.
    pub const FULL: Self = Self { progress: 1.0 };

    /// One cycle further up; a duration of 0 ends at once.
    pub fn up(&mut self, cycle_s: f64, duration_s: f64) {
        self.progress =
            if duration_s > 0.0 { (self.progress + cycle_s / duration_s).min(1.0) } else { 1.0 };
        debug_assert!((0.0..=1.0).contains(&self.progress), "progress {}", self.progress);
    }

    /// One cycle further down.
    pub fn down(&mut self, cycle_s: f64, duration_s: f64) {
        self.progress =
            if duration_s > 0.0 { (self.progress - cycle_s / duration_s).max(0.0) } else { 0.0 };
        debug_assert!((0.0..=1.0).contains(&self.progress), "progress {}", self.progress);
    }

    /// The gain.
    ///
    /// ```
    /// use firmware_core::supervision::Ramp;
    /// let mut ramp = Ramp::default();
    /// (0..250).for_each(|_| ramp.up(1e-3, 0.5));
    /// assert!((ramp.gain() - 0.5).abs() < 1e-12);
    /// ```
    pub fn gain(self) -> f64 {
        if self.progress >= 1.0 { 1.0 } else { 0.5 * (1.0 - libm::cos(PI * self.progress)) }
    }

    /// Whether it is at its upper end.
    pub fn is_full(self) -> bool {
        self.progress >= 1.0
    }

    /// Whether it is at its lower end.
    pub fn is_empty(self) -> bool {
        self.progress <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_end_has_a_corner_and_the_bounds_hold() {
        let (cycle_s, duration_s) = (1e-3, 0.5);
        let (mut ramp, mut gains) = (Ramp::default(), [0.0; 503]);
        for (n, gain) in gains.iter_mut().enumerate() {
            if n > 0 {
                ramp.up(cycle_s, duration_s);
            }
            *gain = ramp.gain();
        }
        assert!(ramp.is_full() && gains[500] == 1.0 && gains[502] == 1.0);
        for three in gains.windows(3) {
            let rate = (three[1] - three[0]) / cycle_s;
            let bend = (three[2] - 2.0 * three[1] + three[0]) / (cycle_s * cycle_s);
            assert!((0.0..=PI / (2.0 * duration_s)).contains(&rate), "{rate}");
            assert!(bend.abs() <= PI * PI / (2.0 * duration_s * duration_s), "{bend}");
        }
    }

    #[test]
    fn down_is_the_same_way_back_and_may_begin_anywhere() {
        let mut ramp = Ramp::default();
        (0..120).for_each(|_| ramp.up(1e-3, 0.5));
        let there = ramp.gain();
        (0..50).for_each(|_| ramp.up(1e-3, 0.5));
        (0..50).for_each(|_| ramp.down(1e-3, 0.5));
        assert!((ramp.gain() - there).abs() < 1e-12);
        (0..121).for_each(|_| ramp.down(1e-3, 0.5));
        assert!(ramp.is_empty() && ramp.gain() == 0.0);
    }

    #[test]
    fn a_ramp_of_no_length_is_a_switch() {
        let mut ramp = Ramp::default();
        ramp.up(1e-3, 0.0);
        assert_eq!(ramp, Ramp::FULL);
        ramp.down(1e-3, 0.0);
        assert_eq!(ramp, Ramp::default());
    }
}
