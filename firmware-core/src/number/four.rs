//! Four numbers in vector registers: one of AVX, or two of SSE2.

use super::Number;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use wide::{CmpGt, CmpLe, f64x4};

/// Four numbers, each rounded as a scalar is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Four(f64x4);

impl Number for Four {
    const PLACES: usize = 4;
    type Truth = f64x4;
    type Each<T: Copy> = [T; 4];

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(f64x4::splat(value))
    }
    #[inline(always)]
    fn each<T: Copy>(of: impl Fn(usize) -> T) -> [T; 4] {
        [of(0), of(1), of(2), of(3)]
    }
    #[inline(always)]
    fn gather<T: Copy>([a, b, c, d]: &[T; 4], value: impl Fn(&T) -> f64) -> Self {
        Self(f64x4::new([value(a), value(b), value(c), value(d)]))
    }
    #[inline(always)]
    fn scatter<T: Copy>(self, [a, b, c, d]: &[T; 4], mut take: impl FnMut(&T, f64)) {
        let [w, x, y, z] = self.0.to_array();
        take(a, w);
        take(b, x);
        take(c, y);
        take(d, z);
    }
    #[inline(always)]
    fn get(self, place: usize) -> f64 {
        self.0.to_array().get(place).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn for_each<T: Copy>([a, b, c, d]: &[T; 4], mut visit: impl FnMut(usize, &T)) {
        visit(0, a);
        visit(1, b);
        visit(2, c);
        visit(3, d);
    }
    #[inline(always)]
    fn to_each<T: Copy>(self, of: impl Fn(f64) -> T) -> [T; 4] {
        let [w, x, y, z] = self.0.to_array();
        [of(w), of(x), of(y), of(z)]
    }
    #[inline(always)]
    fn with_each<T: Copy, R: Copy>(
        self,
        [a, b, c, d]: &[T; 4],
        of: impl Fn(&T, f64) -> R,
    ) -> [R; 4] {
        let [w, x, y, z] = self.0.to_array();
        [of(a, w), of(b, x), of(c, y), of(d, z)]
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn is_above(self, other: Self) -> f64x4 {
        self.0.cmp_gt(other.0)
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> f64x4 {
        self.0.cmp_le(other.0)
    }
    #[inline(always)]
    fn or(one: f64x4, other: f64x4) -> f64x4 {
        one | other
    }
    #[inline(always)]
    fn any(truth: f64x4) -> bool {
        truth.any()
    }
    #[inline(always)]
    fn all(truth: f64x4) -> bool {
        truth.all()
    }
    #[inline(always)]
    fn choose(truth: f64x4, one: Self, other: Self) -> Self {
        Self(truth.blend(one.0, other.0))
    }
}

impl Add for Four {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Four {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Four {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for Four {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Four {
    type Output = Self;
    /// Turns the sign, as a scalar does; the vector's own `0 - x` would lose that of zero.
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0 ^ f64x4::splat(-0.0))
    }
}

impl AddAssign for Four {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Four {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on four against the same on one, bit by bit, with what is special.
    #[test]
    fn four_numbers_are_four_times_one() {
        let values = [0.0, -0.0, 1.0 / 3.0, -7.5e200, 5e-324, f64::INFINITY, f64::NAN, 2.0];
        let bits = |value: f64| if value.is_nan() { u64::MAX } else { value.to_bits() };
        for shift in 0..values.len() {
            let at = |place: usize| values[place % values.len()];
            let (xs, ys) = (Four::each(at), Four::each(|place| at(place * 3 + shift)));
            let (x4, y4) = (Four::gather(&xs, |v| *v), Four::gather(&ys, |v| *v));
            for (place, (x, y)) in xs.into_iter().zip(ys).enumerate() {
                let same = |four: Four, one: f64| {
                    let four = four.to_each(|value| value)[place];
                    // The compiler of Rust 1.95 may take the root of a negative number for one
                    // that is a number, and leave out the question of `bits`.
                    let one = core::hint::black_box(one);
                    assert_eq!(bits(four), bits(one), "{x:e} {y:e}");
                };
                same(x4 + y4, x + y);
                same(x4 - y4, x - y);
                same(x4 * y4, x * y);
                same(x4 / y4, x / y);
                same(-x4, -x);
                same(x4.abs(), Number::abs(x));
                same(x4.sqrt(), Number::sqrt(x));
                same(x4.at_least(0.0), Number::at_least(x, 0.0));
                same(x4.map(libm::atan), libm::atan(x));
                same(Four::choose(x4.is_above(y4), x4, y4), f64::choose(x.is_above(y), x, y));
                same(Four::choose(x4.is_at_most(y4), x4, y4), f64::choose(x.is_at_most(y), x, y));
            }
        }
    }
}
