//! The one segment of the law around a deflection, under the factors of a step.
//!
//! Nearly every step begins and ends on one segment, and slow effects change the law from step to
//! step. So only the knots of body and attachment on both sides of the deflection are looked at,
//! and none is copied where the body is no more than scaled. The bits are those of
//! [`super::law::Law::join`].
//!
//! Limits: nothing where the deflection is on a knot, where the force is capped, or where the
//! piston has a law of its own at rest. The whole law covers those.

use super::curve::{Curve, Knot, Line, Side};
use super::parts::{Body, Factors, Parts};
use super::segment::{Point, Segment};

/// The segment that holds a deflection; `nominal` is the body of the parts without any factor.
pub(super) fn segment_around(
    parts: &Parts,
    nominal: &Body,
    factors: &Factors,
    deflection_m: f64,
) -> Option<Segment> {
    if nominal.breaks_away() {
        return None;
    }
    let on = |body: &Scaled<'_>| {
        parts.with_attachment(factors, |attachment| around(body, attachment, deflection_m))
    };
    if !factors.change_body() {
        on(&Scaled::of(&nominal.velocity))
    } else if nominal.is_hydraulic && factors.slack.is_none() {
        on(&Scaled::by(parts, nominal, factors))
    } else {
        let body = nominal.under(parts, factors);
        if body.breaks_away() { None } else { on(&Scaled::of(&body.velocity)) }
    }
}

/// The segment of a body and an attachment, deflection over force, that holds a deflection.
#[inline]
fn around(body: &Scaled<'_>, attachment: &Curve, deflection_m: f64) -> Option<Segment> {
    let knots = attachment.knots();
    let next = knots.iter().position(|knot| knot.y > deflection_m).unwrap_or(knots.len());
    let (low, high) = (next.checked_sub(1).and_then(|i| knots.get(i)), knots.get(next));
    if let (Some(low), Some(high)) = (low, high)
        && low.x == high.x
    {
        let force_n = low.x;
        let (below, above) = body.limits(force_n);
        // Where the body is free too, the joint moves through its clearance and the piston waits.
        let velocity_m_per_s = if above > below { 0.0_f64.max(below).min(above) } else { below };
        let point = |knot: &Knot| Point { deflection_m: knot.y, force_n, velocity_m_per_s };
        return between(point(low), point(high), deflection_m);
    }
    let line = attachment.line_to(next);
    let floor_n = low.map_or(f64::NEG_INFINITY, |knot| knot.x);
    let ceiling_n = high.map_or(f64::INFINITY, |knot| knot.x);
    let (mut from, mut to) = (None, None);
    let mut at = body.first(|force_n| force_n > floor_n);
    while let Some(knot) = body.knot(at).filter(|knot| knot.x < ceiling_n) {
        let deflection = line.at(knot.x);
        let point = Point { deflection_m: deflection, force_n: knot.x, velocity_m_per_s: knot.y };
        if deflection > deflection_m {
            to = Some(point);
            break;
        }
        from = Some(point);
        at += 1;
    }
    let edge = |knot: &Knot, side: Side| {
        let (below, above) = body.limits(knot.x);
        let velocity_m_per_s = if side == Side::Negative { below } else { above };
        Point { deflection_m: knot.y, force_n: knot.x, velocity_m_per_s }
    };
    let from = from.or_else(|| low.map(|knot| edge(knot, Side::Positive)));
    let to = to.or_else(|| high.map(|knot| edge(knot, Side::Negative)));
    match (from, to) {
        (Some(from), Some(to)) => between(from, to, deflection_m),
        (None, Some(to)) if to.velocity_m_per_s.is_finite() => {
            Segment::beyond(Side::Negative, to, body.slope_before, attachment.slope_before())
        }
        (Some(from), None) if from.velocity_m_per_s.is_finite() => {
            Segment::beyond(Side::Positive, from, body.slope_after, attachment.slope_after())
                .filter(|_| deflection_m > from.deflection_m)
        }
        _ => None,
    }
}

/// The segment between two points, if they have one and the deflection is on none of them.
#[inline]
fn between(from: Point, to: Point, deflection_m: f64) -> Option<Segment> {
    let sliding = from.velocity_m_per_s.is_finite() && to.velocity_m_per_s.is_finite();
    (sliding && deflection_m > from.deflection_m).then(|| Segment::between(from, to))
}

/// The velocity of a piston over its force, scaled as it is read.
struct Scaled<'a> {
    curve: &'a Curve,
    force_gain: f64,
    preload_n: f64,
    velocity_gain: f64,
    slope_before: f64,
    slope_after: f64,
}

impl<'a> Scaled<'a> {
    fn of(curve: &'a Curve) -> Self {
        Self {
            curve,
            force_gain: 1.0,
            preload_n: 0.0,
            velocity_gain: 1.0,
            slope_before: curve.slope_before(),
            slope_after: curve.slope_after(),
        }
    }

    /// Of a body that is its hydraulic part alone.
    fn by(parts: &Parts, nominal: &'a Body, factors: &Factors) -> Self {
        let Factors { force_gain, velocity_gain, preload_n, .. } = *factors;
        let slope = |slope: f64| 1.0 / (slope * force_gain / velocity_gain);
        Self {
            curve: &nominal.velocity,
            force_gain,
            preload_n,
            velocity_gain,
            slope_before: slope(parts.hydraulic.slope_before()),
            slope_after: slope(parts.hydraulic.slope_after()),
        }
    }

    #[inline]
    fn knot(&self, index: usize) -> Option<Knot> {
        let knot = self.curve.knots().get(index)?;
        Some(Knot { x: self.force_gain * knot.x + self.preload_n, y: self.velocity_gain * knot.y })
    }

    /// The first knot whose force is meant, or one behind the last.
    #[inline]
    fn first(&self, meant: impl Fn(f64) -> bool) -> usize {
        let count = self.curve.knots().len();
        (0..count).find(|i| self.knot(*i).is_some_and(|knot| meant(knot.x))).unwrap_or(count)
    }

    /// Velocities at a force, from the left and the right.
    #[inline]
    fn limits(&self, force_n: f64) -> (f64, f64) {
        let next = self.first(|x| x >= force_n);
        let left = next.checked_sub(1).and_then(|i| self.knot(i));
        match self.knot(next) {
            Some(here) if here.x == force_n => {
                let behind = self.first(|x| x > force_n);
                let last = behind.checked_sub(1).and_then(|i| self.knot(i));
                (here.y, last.map_or(here.y, |last| last.y))
            }
            right => {
                let ends = (self.slope_before, self.slope_after);
                let velocity = Line::between(left, right, ends).at(force_n);
                (velocity, velocity)
            }
        }
    }
}
