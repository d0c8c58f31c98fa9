//! One number for each of `L` vehicles that run side by side.
//!
//! Every vehicle state is kept as `[f64; L]` per degree of freedom, so that a sweep over speeds or
//! dampers can run several vehicles in the lanes of one vector register. One lane (`L = 1`, the
//! default everywhere) compiles to plain scalars.

use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// One `f64` per lane, with arithmetic lane by lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lanes<const L: usize>(pub [f64; L]);

impl<const L: usize> Lanes<L> {
    /// Zero in every lane.
    pub const ZERO: Self = Self([0.0; L]);

    /// The same value in every lane.
    pub const fn splat(value: f64) -> Self {
        Self([value; L])
    }

    /// Applies a scalar function lane by lane.
    #[must_use]
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let Self(mut values) = self;
        for value in &mut values {
            *value = f(*value);
        }
        Self(values)
    }

    /// What `value` exceeds the dead band `-half_width..=half_width` by.
    ///
    /// ```
    /// use firmware_core::lanes::Lanes;
    /// assert_eq!(Lanes([1.5, -0.2]).beyond(0.5), Lanes([1.0, 0.0]));
    /// // A width that is no number shows in the result; `f64::clamp` would panic on it.
    /// assert!(Lanes([1.5]).beyond(f64::NAN).lane(0).is_nan());
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn beyond(self, half_width: f64) -> Self {
        self.map(|value| {
            let raised = if value >= -half_width { value } else { -half_width };
            value - if raised > half_width { half_width } else { raised }
        })
    }

    /// The value in one lane. A lane that does not exist is an error of the caller: a debug build
    /// stops, a release build returns zero.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> f64 {
        debug_assert!(lane < L, "lane {lane} of {L}");
        self.0.get(lane).copied().unwrap_or(0.0)
    }

    /// Sets one lane. A lane that does not exist is an error of the caller: a debug build stops, a
    /// release build ignores it.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, value: f64) {
        debug_assert!(lane < L, "lane {lane} of {L}");
        if let Some(slot) = self.0.get_mut(lane) {
            *slot = value;
        }
    }

    /// Adds to one lane. A lane that does not exist is an error of the caller: a debug build stops,
    /// a release build ignores it.
    #[inline(always)]
    pub fn add_lane(&mut self, lane: usize, value: f64) {
        debug_assert!(lane < L, "lane {lane} of {L}");
        if let Some(slot) = self.0.get_mut(lane) {
            *slot += value;
        }
    }
}

impl<const L: usize> Default for Lanes<L> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const L: usize> Add for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl<const L: usize> Sub for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}

impl<const L: usize> Mul<f64> for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|value| value * factor)
    }
}

impl<const L: usize> Mul for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for (value, factor) in self.0.iter_mut().zip(other.0) {
            *value *= factor;
        }
        self
    }
}

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|value| -value)
    }
}

impl<const L: usize> AddAssign for Lanes<L> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        for (value, term) in self.0.iter_mut().zip(other.0) {
            *value += term;
        }
    }
}

impl<const L: usize> SubAssign for Lanes<L> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        for (value, term) in self.0.iter_mut().zip(other.0) {
            *value -= term;
        }
    }
}

#[cfg(all(test, debug_assertions))]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "lane 2 of 2")]
    fn reading_a_lane_that_does_not_exist_stops_a_debug_build() {
        let _ = Lanes([1.0, 2.0]).lane(2);
    }

    #[test]
    #[should_panic(expected = "lane 1 of 1")]
    fn adding_to_a_lane_that_does_not_exist_stops_a_debug_build() {
        Lanes([1.0]).add_lane(1, 1.0);
    }
}
