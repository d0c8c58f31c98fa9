//! A piecewise-linear law: force over velocity, deflection over force.
//!
//! Knots in rising order with a slope beyond each end. Two knots at the same place are a step (dry
//! friction, a clearance). Parallel parts add their forces at equal velocity and parts in series
//! their deflections at equal force, so both are [`Curve::plus`].
//!
//! Values between knots are taken from the knot nearer to zero: a curve and its mirror image then
//! give mirrored bits.

use heapless::Vec;

/// How many knots one curve holds.
pub(super) const CURVE_KNOTS: usize = 63;

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// Where.
    pub x: f64,
    /// How much.
    pub y: f64,
}

/// A piecewise-linear curve with straight ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    knots: Vec<Knot, CURVE_KNOTS>,
    slope_before: f64,
    slope_after: f64,
}

impl Curve {
    /// Zero everywhere.
    pub const ZERO: Self = Self { knots: Vec::new(), slope_before: 0.0, slope_after: 0.0 };

    /// Without a knot yet. A function, and not [`Self::ZERO`] with other slopes, which would copy
    /// the room for all knots.
    #[inline]
    pub(super) fn straight(slope_before: f64, slope_after: f64) -> Self {
        Self { knots: Vec::new(), slope_before, slope_after }
    }

    /// The same ends without a knot, to be filled. Slopes that are constants would have the
    /// compiler clear the room for all knots.
    #[inline]
    pub(super) fn without_knots(&self) -> Self {
        Self::straight(self.slope_before, self.slope_after)
    }

    /// A curve through rising knots with a slope beyond each end. Knots beyond the capacity are
    /// dropped: the damper is then refused, before a step is made with it.
    pub fn through(knots: &[Knot], slope_before: f64, slope_after: f64) -> Self {
        let mut curve = Self::straight(slope_before, slope_after);
        for knot in knots {
            curve.push(*knot);
        }
        curve
    }

    /// An odd curve from its knots at zero and above, with one slope beyond both ends.
    pub fn odd(above: &[Knot], slope: f64) -> Self {
        let mut curve = Self::straight(slope, slope);
        for knot in above.iter().rev().filter(|knot| knot.x > 0.0) {
            curve.push(Knot { x: -knot.x, y: -knot.y });
        }
        for knot in above {
            curve.push(*knot);
        }
        curve
    }

    /// The knots, rising.
    pub fn knots(&self) -> &[Knot] {
        &self.knots
    }

    /// Slope before the first knot.
    pub fn slope_before(&self) -> f64 {
        self.slope_before
    }

    /// Slope after the last knot.
    pub fn slope_after(&self) -> f64 {
        self.slope_after
    }

    /// The value at `x`; at a step, the middle of it.
    pub fn at(&self, x: f64) -> f64 {
        let next = self.knots.iter().position(|knot| knot.x >= x).unwrap_or(self.knots.len());
        let (before, after) = Reader { curve: self, next, line: None }.limits(x);
        0.5 * (before + after)
    }

    /// The sum of two curves.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.without_knots();
        self.plus_into(other, &mut sum);
        sum
    }

    /// Writes the sum of two curves into a third. No curve is copied: in a step that would cost
    /// more than the sum.
    pub(super) fn plus_into(&self, other: &Self, sum: &mut Self) {
        sum.clear(self.slope_before + other.slope_before, self.slope_after + other.slope_after);
        for (x, a, b) in merged(self, other) {
            let (before, after) = (a.0 + b.0, a.1 + b.1);
            sum.push(Knot { x, y: before });
            if after != before {
                sum.push(Knot { x, y: after });
            }
        }
    }

    /// Adds a straight line through the origin.
    pub fn add_line(&mut self, slope: f64) {
        for knot in &mut self.knots {
            knot.y += slope * knot.x;
        }
        self.slope_before += slope;
        self.slope_after += slope;
    }

    /// Adds `other`, a curve over the values of this one, to its places: two throttles side by side
    /// add their velocities at equal force.
    pub(super) fn add_across(&mut self, other: &Self) {
        self.invert();
        *self = self.plus(other);
        self.invert();
    }

    /// Stretches one side of zero: `x` by `x_gain`, `y` by `y_gain`; both above zero.
    pub fn stretch(&mut self, side: Side, x_gain: f64, y_gain: f64) {
        for knot in &mut self.knots {
            if if side == Side::Negative { knot.x < 0.0 } else { knot.x > 0.0 } {
                knot.x *= x_gain;
                knot.y *= y_gain;
            }
        }
        let slope =
            if side == Side::Negative { &mut self.slope_before } else { &mut self.slope_after };
        *slope *= y_gain / x_gain;
    }

    /// Makes one side of zero flat, at the value at zero.
    pub(super) fn slacken(&mut self, side: Side) {
        let zero = Knot { x: 0.0, y: self.at(0.0) };
        let knots = core::mem::take(&mut self.knots);
        if side == Side::Negative {
            self.slope_before = 0.0;
            self.push(zero);
            knots.iter().filter(|knot| knot.x > 0.0).for_each(|knot| self.push(*knot));
        } else {
            self.slope_after = 0.0;
            knots.iter().filter(|knot| knot.x < 0.0).for_each(|knot| self.push(*knot));
            self.push(zero);
        }
    }

    /// Writes `x_gain * x`, `y_gain * y + y_shift` of `source` into `self`.
    pub(super) fn copy_scaled(&mut self, source: &Self, x_gain: f64, y_gain: f64, y_shift: f64) {
        self.knots.clear();
        for knot in &source.knots {
            self.push(Knot { x: x_gain * knot.x, y: y_gain * knot.y + y_shift });
        }
        self.slope_before = source.slope_before * y_gain / x_gain;
        self.slope_after = source.slope_after * y_gain / x_gain;
    }

    /// Exchanges `x` and `y`. A flat end becomes an infinite slope.
    pub(super) fn invert(&mut self) {
        for knot in &mut self.knots {
            *knot = Knot { x: knot.y, y: knot.x };
        }
        self.slope_before = 1.0 / self.slope_before;
        self.slope_after = 1.0 / self.slope_after;
    }

    /// Cuts a curve through zero down to its rising part, outward from zero on both sides, and
    /// returns the two values at zero as they were.
    ///
    /// What falls on the way outward is lowered to the lowest force that is still to come: the
    /// force at which a piston that slides comes to rest.
    pub(super) fn cut_to_rising(&mut self) -> (f64, f64) {
        let before = self.knots.iter().find(|knot| knot.x >= 0.0).map_or(0.0, |knot| knot.y);
        let after = self.knots.iter().rfind(|knot| knot.x <= 0.0).map_or(0.0, |knot| knot.y);
        let first = self.knots.iter().position(|knot| knot.x >= 0.0);
        let mut lowest = f64::INFINITY;
        for knot in self.knots.iter_mut().rev().filter(|knot| knot.x >= 0.0) {
            if knot.x == 0.0 && knot.y == before && before != after {
                break;
            }
            lowest = lowest.min(knot.y);
            knot.y = lowest;
        }
        let mut highest = f64::NEG_INFINITY;
        for knot in self.knots.iter_mut().take(first.map_or(CURVE_KNOTS, |i| i + 1)) {
            highest = highest.max(knot.y);
            knot.y = highest;
        }
        (before, after)
    }

    /// True when the curve never falls and every slope between steps is at least `slope`.
    pub(super) fn rises_at_least(&self, slope: f64) -> bool {
        let pairs = self.knots.iter().zip(self.knots.iter().skip(1));
        self.slope_before >= slope
            && self.slope_after >= slope
            && pairs.clone().all(|(a, b)| b.x >= a.x && b.y - a.y >= slope * (b.x - a.x))
    }

    /// True where it is zero everywhere.
    pub(super) fn is_zero(&self) -> bool {
        self.knots.is_empty() && self.slope_before == 0.0 && self.slope_after == 0.0
    }

    /// Without a knot, with these slopes.
    pub(super) fn clear(&mut self, slope_before: f64, slope_after: f64) {
        self.knots.clear();
        (self.slope_before, self.slope_after) = (slope_before, slope_after);
    }

    /// Adds a knot behind the others.
    pub(super) fn push(&mut self, knot: Knot) {
        // A full curve is refused when the damper is built, so nothing is lost in a step.
        let _ = self.knots.push(knot);
    }

    /// The line from the knot before `next` to it.
    #[inline]
    pub(super) fn line_to(&self, next: usize) -> Line {
        let left = next.checked_sub(1).and_then(|i| self.knots.get(i)).copied();
        let right = self.knots.get(next).copied();
        Line::between(left, right, (self.slope_before, self.slope_after))
    }
}

/// One side of zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Below zero: compression.
    Negative,
    /// Above zero: extension.
    Positive,
}

/// Limits of a curve at a place, from the left and the right.
type Limits = (f64, f64);

/// Every place where one of two curves has a knot, rising, with the limits of both.
#[inline]
pub(super) fn merged(a: &Curve, b: &Curve) -> impl Iterator<Item = (f64, Limits, Limits)> {
    let (mut a, mut b) = (Reader::of(a), Reader::of(b));
    (0..2 * CURVE_KNOTS).map_while(move |_| {
        let x = match (a.knot(), b.knot()) {
            (None, None) => return None,
            (Some(knot), None) | (None, Some(knot)) => knot.x,
            (Some(p), Some(q)) => p.x.min(q.x),
        };
        Some((x, a.limits(x), b.limits(x)))
    })
}

/// Reads a curve at rising places.
struct Reader<'a> {
    curve: &'a Curve,
    /// The first knot that was not reached yet.
    next: usize,
    /// The straight line towards it, once it was needed: of two curves that are merged, one often
    /// has no knot for a long time.
    line: Option<Line>,
}

/// A straight line through a knot.
#[derive(Clone, Copy)]
pub(super) struct Line {
    through: Knot,
    slope: f64,
}

impl Line {
    /// Through the one of two neighbours that is nearer to zero; `ends` are the slopes beyond the
    /// first and the last knot.
    #[inline]
    pub(super) fn between(left: Option<Knot>, right: Option<Knot>, ends: (f64, f64)) -> Self {
        match (left, right) {
            (None, None) => Self { through: Knot { x: 0.0, y: 0.0 }, slope: 0.0 },
            (None, Some(b)) => Self { through: b, slope: ends.0 },
            (Some(a), None) => Self { through: a, slope: ends.1 },
            (Some(a), Some(b)) => {
                let through = if a.x.abs() <= b.x.abs() { a } else { b };
                Self { through, slope: (b.y - a.y) / (b.x - a.x) }
            }
        }
    }

    /// The value at `x`.
    #[inline]
    pub(super) fn at(self, x: f64) -> f64 {
        self.through.y + self.slope * (x - self.through.x)
    }
}

impl<'a> Reader<'a> {
    fn of(curve: &'a Curve) -> Self {
        Self { curve, next: 0, line: None }
    }

    /// The first knot that was not reached yet.
    #[inline]
    fn knot(&self) -> Option<Knot> {
        self.curve.knots.get(self.next).copied()
    }

    /// Limits from the left and the right at `x`, at or before the next knot.
    #[inline]
    fn limits(&mut self, x: f64) -> Limits {
        let Some(here) = self.knot().filter(|knot| knot.x == x) else {
            let line = *self.line.get_or_insert_with(|| self.curve.line_to(self.next));
            let value = line.at(x);
            return (value, value);
        };
        let mut after = here.y;
        self.next += 1;
        while let Some(knot) = self.knot().filter(|knot| knot.x == x) {
            after = knot.y;
            self.next += 1;
        }
        self.line = None;
        (here.y, after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(x: f64, y: f64) -> Knot {
        Knot { x, y }
    }

    #[test]
    fn parallel_parts_add_at_equal_velocity() {
        let dashpot = Curve::through(&[knot(-1.0, -2.0), knot(0.0, 0.0), knot(1.0, 2.0)], 0.5, 0.5);
        let friction = Curve::through(&[knot(0.0, -3.0), knot(0.0, 3.0)], 0.0, 0.0);
        let sum = dashpot.plus(&friction);
        let expected = [knot(-1.0, -5.0), knot(0.0, -3.0), knot(0.0, 3.0), knot(1.0, 5.0)];
        assert_eq!(sum.knots(), &expected);
        assert_eq!(sum.at(0.5), 4.0);
        assert_eq!(sum.at(3.0), 6.0);
        assert_eq!(sum.at(-3.0), -6.0);
        assert_eq!(sum.at(0.0), 0.0);
    }

    #[test]
    fn falling_part_is_cut_to_the_lowest_sliding_force() {
        let mut curve = Curve::through(
            &[knot(-1.0, -2.0), knot(0.0, -5.0), knot(0.0, 5.0), knot(1.0, 2.0), knot(2.0, 6.0)],
            1.0,
            1.0,
        );
        assert_eq!(curve.cut_to_rising(), (-5.0, 5.0));
        let expected =
            [knot(-1.0, -2.0), knot(0.0, -2.0), knot(0.0, 2.0), knot(1.0, 2.0), knot(2.0, 6.0)];
        assert_eq!(curve.knots(), &expected);
        assert!(curve.rises_at_least(0.0));
    }

    #[test]
    fn rising_curve_is_left_as_it_is() {
        let source = Curve::through(&[knot(-1.0, -2.0), knot(0.0, 0.0), knot(1.0, 3.0)], 0.5, 0.5);
        let mut curve = source.clone();
        assert_eq!(curve.cut_to_rising(), (0.0, 0.0));
        assert_eq!(curve, source);
    }
}
