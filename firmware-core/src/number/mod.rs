//! One number or four of them, so that a formula is written once and runs on either.
//!
//! The wheels of a vehicle are alike and do not depend on each other: four at a time fill a vector
//! register. IEEE 754 rounds each place of a vector as it rounds a scalar, so both give the same
//! bits. What a scalar decides by a branch, four decide place by place: [`Number::choose`]
//! takes both results and keeps one.

#[cfg(target_arch = "x86_64")]
mod four;

#[cfg(target_arch = "x86_64")]
pub use four::Four;

/// The widest number of this processor: wheels are taken in groups of this many.
#[cfg(target_arch = "x86_64")]
pub type Group = Four;
/// The widest number of this processor: wheels are taken in groups of this many.
#[cfg(not(target_arch = "x86_64"))]
pub type Group = f64;

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number in a formula that is written once for one and for four.
pub trait Number:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// Places: one or four.
    const PLACES: usize;
    /// A truth per place.
    type Truth: Copy;
    /// A thing per place.
    type Each<T: Copy>: Copy;

    /// The same value in every place.
    fn splat(value: f64) -> Self;
    /// What a function makes of the number of each place.
    fn each<T: Copy>(of: impl Fn(usize) -> T) -> Self::Each<T>;
    /// A number from a thing per place.
    fn gather<T: Copy>(things: &Self::Each<T>, value: impl Fn(&T) -> f64) -> Self;
    /// Hands every place its thing and its value.
    fn scatter<T: Copy>(self, things: &Self::Each<T>, take: impl FnMut(&T, f64));
    /// The value in a place; zero in one that does not exist.
    fn get(self, place: usize) -> f64;
    /// Visits the thing of each place.
    fn for_each<T: Copy>(things: &Self::Each<T>, visit: impl FnMut(usize, &T));
    /// A thing per place from its value.
    fn to_each<T: Copy>(self, of: impl Fn(f64) -> T) -> Self::Each<T>;
    /// A thing per place from its value and another thing.
    fn with_each<T: Copy, R: Copy>(
        self,
        things: &Self::Each<T>,
        of: impl Fn(&T, f64) -> R,
    ) -> Self::Each<R>;

    /// A scalar function in every place.
    #[inline(always)]
    #[must_use]
    fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self::gather(&self.to_each(of), |value| *value)
    }
    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The size without the sign.
    #[must_use]
    fn abs(self) -> Self;
    /// Where it is above another; nowhere that either is no number.
    fn is_above(self, other: Self) -> Self::Truth;
    /// Where it is at or below another; nowhere that either is no number.
    fn is_at_most(self, other: Self) -> Self::Truth;
    /// Where one or the other is true.
    fn or(one: Self::Truth, other: Self::Truth) -> Self::Truth;
    /// Whether it is true anywhere.
    fn any(truth: Self::Truth) -> bool;
    /// Whether it is true everywhere.
    fn all(truth: Self::Truth) -> bool;
    /// One value where it is true, the other elsewhere.
    #[must_use]
    fn choose(truth: Self::Truth, one: Self, other: Self) -> Self;

    /// Raised to a bound where it is below it, or no number.
    #[inline(always)]
    #[must_use]
    fn at_least(self, bound: f64) -> Self {
        let bound = Self::splat(bound);
        Self::choose(self.is_above(bound), self, bound)
    }

    /// Held between zero and one; what is no number stays none.
    #[inline(always)]
    #[must_use]
    fn within_unit(self) -> Self {
        let (zero, one) = (Self::splat(0.0), Self::splat(1.0));
        let raised = Self::choose(zero.is_above(self), zero, self);
        Self::choose(raised.is_above(one), one, raised)
    }
}

impl Number for f64 {
    const PLACES: usize = 1;
    type Truth = bool;
    type Each<T: Copy> = [T; 1];

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn each<T: Copy>(of: impl Fn(usize) -> T) -> [T; 1] {
        [of(0)]
    }
    #[inline(always)]
    fn gather<T: Copy>([thing]: &[T; 1], value: impl Fn(&T) -> f64) -> Self {
        value(thing)
    }
    #[inline(always)]
    fn scatter<T: Copy>(self, [thing]: &[T; 1], mut take: impl FnMut(&T, f64)) {
        take(thing, self);
    }
    #[inline(always)]
    fn get(self, place: usize) -> f64 {
        if place == 0 { self } else { 0.0 }
    }
    #[inline(always)]
    fn for_each<T: Copy>([thing]: &[T; 1], mut visit: impl FnMut(usize, &T)) {
        visit(0, thing);
    }
    #[inline(always)]
    fn to_each<T: Copy>(self, of: impl Fn(f64) -> T) -> [T; 1] {
        [of(self)]
    }
    #[inline(always)]
    fn with_each<T: Copy, R: Copy>(self, [thing]: &[T; 1], of: impl Fn(&T, f64) -> R) -> [R; 1] {
        [of(thing, self)]
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        crate::sqrt::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn is_above(self, other: Self) -> bool {
        self > other
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn or(one: bool, other: bool) -> bool {
        one || other
    }
    #[inline(always)]
    fn any(truth: bool) -> bool {
        truth
    }
    #[inline(always)]
    fn all(truth: bool) -> bool {
        truth
    }
    #[inline(always)]
    fn choose(truth: bool, one: Self, other: Self) -> Self {
        if truth { one } else { other }
    }
}
