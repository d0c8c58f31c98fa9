//! Fading in and out along a raised cosine.
//!
//! ```text
//! g(s) = (1 - cos(pi s)) / 2         s from 0 to 1 over the duration T
//! g'  <= pi / (2 T)                  g'' <= pi^2 / (2 T^2)
//! ```
//!
//! The gain has no corner at either end, so that what it fades begins and ends without a step in
//! speed. A ramp counts cycles: one of 500 is at its end after 500 of them.

use core::f64::consts::PI;

/// A gain on its way from 0 to 1 or back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ramp {
    /// Share of the way up that has passed, 0 to 1.
    progress: f64,
}

/// Sums of rounding within which a ramp is at its end.
const ROUNDING: f64 = 1e-9;

impl Ramp {
    /// Not begun.
    pub(crate) const NONE: Self = Self { progress: 0.0 };

    /// A ramp at its upper end.
    pub const FULL: Self = Self { progress: 1.0 };

    /// One cycle further up, of so many; a ramp of no cycles ends at once.
    pub fn up(&mut self, cycles: u32) {
        let progress = self.progress + share(cycles);
        self.progress = if progress > 1.0 - ROUNDING { 1.0 } else { progress };
        debug_assert!((0.0..=1.0).contains(&self.progress), "progress {}", self.progress);
    }

    /// One cycle further down.
    pub fn down(&mut self, cycles: u32) {
        let progress = self.progress - share(cycles);
        self.progress = if progress < ROUNDING { 0.0 } else { progress };
        debug_assert!((0.0..=1.0).contains(&self.progress), "progress {}", self.progress);
    }

    /// The gain.
    ///
    /// ```
    /// use firmware_core::supervision::Ramp;
    /// let mut ramp = Ramp::default();
    /// (0..250).for_each(|_| ramp.up(500));
    /// assert!((ramp.gain() - 0.5).abs() < 1e-12);
    /// ```
    pub fn gain(self) -> f64 {
        if self.progress >= 1.0 { 1.0 } else { 0.5 * (1.0 - libm::cos(PI * self.progress)) }
    }

    /// What is faded from one value to another: `(1 - g) from + g to`, and at its upper end the
    /// other one itself.
    ///
    /// ```
    /// use firmware_core::supervision::Ramp;
    /// assert_eq!(Ramp::default().between(2.0, 8.0), 2.0);
    /// assert_eq!(Ramp::FULL.between(2.0, 8.0), 8.0);
    /// ```
    #[inline]
    pub fn between(self, from: f64, to: f64) -> f64 {
        if self.is_full() {
            return to;
        }
        let gain = self.gain();
        (1.0 - gain) * from + gain * to
    }

    /// Change of the gain in a cycle on the way up, of so many.
    pub fn slope(self, cycles: u32) -> f64 {
        if self.is_full() || self.is_empty() {
            return 0.0;
        }
        0.5 * PI * libm::sin(PI * self.progress) * share(cycles)
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

/// The share of a way that one of its cycles is.
fn share(cycles: u32) -> f64 {
    if cycles == 0 { 1.0 } else { 1.0 / f64::from(cycles) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_end_has_a_corner_and_the_bounds_hold() {
        let (mut ramp, mut gains) = (Ramp::default(), [0.0; 503]);
        for (n, gain) in gains.iter_mut().enumerate() {
            if n > 0 {
                ramp.up(500);
            }
            *gain = ramp.gain();
            assert_eq!((ramp.is_empty(), ramp.is_full()), (n == 0, n >= 500), "{n}");
        }
        let (rate_most, bend_most) = (PI / 1000.0, PI * PI / (2.0 * 500.0 * 500.0));
        for three in gains.windows(3) {
            let (rate, bend) = (three[1] - three[0], three[2] - 2.0 * three[1] + three[0]);
            assert!((0.0..=rate_most).contains(&rate), "{rate}");
            assert!(bend.abs() <= bend_most, "{bend}");
        }
    }

    #[test]
    fn the_slope_is_the_change_of_the_gain() {
        let mut ramp = Ramp::default();
        for n in 0..499 {
            let before = ramp.gain();
            ramp.up(500);
            let slope = ramp.slope(500);
            let mut next = ramp;
            next.up(500);
            let central = 0.5 * (next.gain() - before);
            assert!((slope - central).abs() < 1e-7, "{n}: {slope} {central}");
        }
    }

    #[test]
    fn down_is_the_same_way_back_and_may_begin_anywhere() {
        let mut ramp = Ramp::default();
        (0..120).for_each(|_| ramp.up(500));
        let there = ramp.gain();
        (0..50).for_each(|_| ramp.up(500));
        (0..50).for_each(|_| ramp.down(500));
        assert!((ramp.gain() - there).abs() < 1e-12);
        (0..120).for_each(|_| ramp.down(500));
        assert!(ramp.is_empty() && ramp.gain() == 0.0);
    }

    #[test]
    fn a_ramp_of_no_length_is_a_switch() {
        let mut ramp = Ramp::default();
        ramp.up(0);
        assert_eq!(ramp, Ramp::FULL);
        ramp.down(0);
        assert_eq!(ramp, Ramp::default());
    }
}
