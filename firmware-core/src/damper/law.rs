//! The whole chain as one rising law: piston velocity over attachment deflection.
//!
//! Attachment and body carry the same force, so the deflection e of the attachment fixes the force
//! F, and the force fixes the velocity v of the piston. With every law piecewise linear, so is
//! v(e), and the chain driven at x(t) is one scalar equation:
//!
//! ```text
//! e = x - x_d        e' = x'(t) - v(e)        F = F(e)
//! ```
//!
//! On one segment its solution is an exponential. Where v jumps (a hard cap of the force) e stands
//! still; where F does not change (the clearance) e moves freely.
//!
//! A body whose force falls after breakaway has two laws, one for the piston at rest and one for
//! the sliding piston. Both rise; which one holds is a memory of the piston.

use core::ops::ControlFlow;
use heapless::{Vec, VecView};

use super::curve::{CURVE_KNOTS, Curve, Knot, Side, merged};
use super::error::DamperError;
use super::series::Gains;

/// Most knots of hydraulic and dry law together.
pub const BODY_KNOTS: usize = CURVE_KNOTS - 1;

/// Most knots of the attachment; wear may split the one at zero.
pub const ATTACHMENT_KNOTS: usize = CURVE_KNOTS - 1;

/// How many segments the law of a chain holds: one behind every knot, one before the first, two
/// where clearance and friction are free at once.
pub const LAW_SEGMENTS: usize = BODY_KNOTS + ATTACHMENT_KNOTS + 4;

/// How many segments the law of a piston at rest holds.
pub const RESTING_SEGMENTS: usize = ATTACHMENT_KNOTS + 6;

/// The parts of a chain at nominal state, and what effects have made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Hydraulic force over piston velocity; slow factors scale it.
    pub hydraulic: Curve,
    /// Dry force over piston velocity, parallel to the hydraulic one.
    pub dry: Curve,
    /// Deflection of the attachment over force, without its creep.
    pub attachment: Curve,
}

impl Parts {
    /// Scales the elastic deflection of the attachment; its clearance stays.
    pub(super) fn scale_compliance(&mut self, gain: f64) {
        let scaled = Factors { compliance_gain: gain, ..Factors::NONE };
        if scaled.change_attachment() {
            let nominal = self.attachment.clone();
            attachment_under(&nominal, &scaled, &mut self.attachment);
        }
    }
}

/// What slow states do to the parts, frozen for one step. All gains are above zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// Hydraulic force at equal velocity.
    pub force_gain: f64,
    /// Velocity at equal hydraulic force: a thinner oil has a higher one, its relief force stays.
    pub velocity_gain: f64,
    /// Force that stands on the piston at rest, N, positive in tension.
    pub preload_n: f64,
    /// Deflection of the attachment at equal force, without the clearance.
    pub compliance_gain: f64,
    /// Half clearance that wear has added, m.
    pub added_half_clearance_m: f64,
    /// The side on which the hydraulic part carries nothing: a void has to close first.
    pub slack: Option<Side>,
}

impl Factors {
    /// Nothing changed.
    pub const NONE: Self = Self {
        force_gain: 1.0,
        velocity_gain: 1.0,
        preload_n: 0.0,
        compliance_gain: 1.0,
        added_half_clearance_m: 0.0,
        slack: None,
    };

    /// True where the attachment is not the nominal one.
    pub(super) fn change_attachment(&self) -> bool {
        self.compliance_gain != 1.0 || self.added_half_clearance_m != 0.0
    }

    /// True where the body is not the nominal one.
    fn change_body(&self) -> bool {
        self.force_gain != 1.0
            || self.velocity_gain != 1.0
            || self.preload_n != 0.0
            || self.slack.is_some()
    }
}

/// Hydraulic and dry force of a piston as one law that never falls.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Velocity of the piston over force.
    velocity: Curve,
    /// Forces between which a resting piston stays.
    breakaway_n: [f64; 2],
    /// Forces between which a sliding piston comes to rest.
    rest_n: [f64; 2],
}

impl Body {
    /// The body of nominal parts.
    pub(super) fn nominal(parts: &Parts) -> Self {
        let velocity = parts.hydraulic.without_knots();
        let mut body = Self { velocity, breakaway_n: [0.0; 2], rest_n: [0.0; 2] };
        body.join(parts, &Factors::NONE);
        body
    }

    /// Joins hydraulic and dry force under the given factors, in place.
    fn join(&mut self, parts: &Parts, factors: &Factors) {
        let Factors { velocity_gain, force_gain, preload_n, slack, .. } = *factors;
        let scale = |scaled: &mut Curve| {
            scaled.copy_scaled(&parts.hydraulic, velocity_gain, force_gain, preload_n);
            if let Some(side) = slack {
                scaled.slacken(side);
            }
        };
        let velocity = &mut self.velocity;
        if parts.dry.is_zero() {
            scale(velocity);
        } else {
            let mut hydraulic = parts.hydraulic.without_knots();
            scale(&mut hydraulic);
            hydraulic.plus_into(&parts.dry, velocity);
        }
        let (breakaway_from, breakaway_to) = velocity.cut_to_rising();
        let at_rest = |knot: &&Knot| knot.x == 0.0;
        let rest_from = velocity.knots().iter().find(at_rest).map_or(0.0, |knot| knot.y);
        let rest_to = velocity.knots().iter().rfind(at_rest).map_or(0.0, |knot| knot.y);
        velocity.invert();
        self.breakaway_n = [breakaway_from, breakaway_to];
        self.rest_n = [rest_from, rest_to];
    }

    /// True when the piston has a law of its own at rest.
    fn breaks_away(&self) -> bool {
        let ([breakaway_from, breakaway_to], [rest_from, rest_to]) =
            (self.breakaway_n, self.rest_n);
        breakaway_from < rest_from || breakaway_to > rest_to
    }
}

/// A stretch of the law between two deflections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where it begins, m; minus infinity for the first.
    pub from_m: f64,
    /// Where it ends, m.
    pub to_m: f64,
    /// Piston velocity at its beginning, m/s.
    pub velocity_from: f64,
    /// Piston velocity at its end, m/s.
    pub velocity_to: f64,
    /// Rate dv/de, 1/s.
    pub rate_per_s: f64,
    /// Stiffness dF/de, N/m.
    pub stiffness_n_per_m: f64,
    /// The end nearer to zero: deflection, force, velocity.
    pub anchor: Point,
    /// Response over the step the damper was prepared for.
    pub gains: Gains,
}

/// A point of the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Deflection of the attachment, m.
    pub deflection_m: f64,
    /// Force, N.
    pub force_n: f64,
    /// Piston velocity, m/s.
    pub velocity_m_per_s: f64,
}

impl Segment {
    /// Piston velocity at a deflection.
    #[inline]
    pub fn velocity(&self, deflection_m: f64) -> f64 {
        self.anchor.velocity_m_per_s + self.rate_per_s * (deflection_m - self.anchor.deflection_m)
    }

    /// Force at a deflection.
    #[inline]
    pub fn force(&self, deflection_m: f64) -> f64 {
        self.anchor.force_n + self.stiffness_n_per_m * (deflection_m - self.anchor.deflection_m)
    }
}

/// The joined law of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// The law while the piston slides, or at all times when its force never falls.
    pub sliding: Vec<Segment, LAW_SEGMENTS>,
    /// The law of the piston at rest, up to breakaway; empty when its force never falls.
    pub resting: Vec<Segment, RESTING_SEGMENTS>,
    /// Deflection range in which a sliding piston comes to rest, m.
    pub rest_from_m: f64,
    /// End of that range, m.
    pub rest_to_m: f64,
    /// The step for which the gains of the segments hold, s; zero for none.
    pub step_s: f64,
}

impl Law {
    /// A law to be filled by [`Law::join`]. No constant: that would be copied, unused room and all,
    /// in every step that needs one.
    #[inline]
    pub fn empty() -> Self {
        Self {
            sliding: Vec::new(),
            resting: Vec::new(),
            rest_from_m: 0.0,
            rest_to_m: 0.0,
            step_s: 0.0,
        }
    }

    /// Joins the parts under the given factors, in place; `nominal` is their body without any. Bounded by
    /// the number of knots.
    pub fn join(&mut self, parts: &Parts, nominal: &Body, factors: &Factors) {
        under(parts, nominal, factors, |body, attachment| {
            self.step_s = 0.0;
            join_into(&mut self.sliding, &body.velocity, attachment);
            self.resting.clear();
            if body.breaks_away() {
                let stuck_between = body.breakaway_n.map(|x| Knot { x, y: 0.0 });
                let stuck = Curve::through(&stuck_between, f64::INFINITY, f64::INFINITY);
                join_into(&mut self.resting, &stuck, attachment);
                [self.rest_from_m, self.rest_to_m] =
                    body.rest_n.map(|at_n| outer(attachment, at_n));
            }
        });
    }

    /// Computes the gains of every segment for one length of step.
    pub fn prepare(&mut self, step_s: f64) {
        for segment in self.sliding.iter_mut().chain(self.resting.iter_mut()) {
            segment.gains = Gains::over(segment.rate_per_s, step_s);
        }
        self.step_s = step_s;
    }

    /// True when the piston has a law of its own at rest.
    #[inline]
    pub fn breaks_away(&self) -> bool {
        !self.resting.is_empty()
    }

    /// Refuses parts that the tables cannot hold or that do not rise.
    ///
    /// # Errors
    /// [`DamperError::TooManyKnots`], [`DamperError::NotMonotone`].
    pub fn check(parts: &Parts) -> Result<(), DamperError> {
        // A curve that has run out of room is as long as its limit allows, or longer.
        let body = parts.hydraulic.knots().len() + parts.dry.knots().len();
        if body > BODY_KNOTS {
            return Err(DamperError::TooManyKnots { law: "body", limit: BODY_KNOTS });
        }
        if parts.attachment.knots().len() > ATTACHMENT_KNOTS {
            let limit = ATTACHMENT_KNOTS;
            return Err(DamperError::TooManyKnots { law: "attachment", limit });
        }
        if !parts.attachment.rises_at_least(f64::MIN_POSITIVE) {
            return Err(DamperError::NotMonotone { law: "attachment" });
        }
        if !parts.hydraulic.rises_at_least(0.0) {
            return Err(DamperError::NotMonotone { law: "body" });
        }
        Ok(())
    }
}

/// Force of the attachment at a deflection under the given factors.
pub fn attachment_force_n(parts: &Parts, factors: &Factors, deflection_m: f64) -> f64 {
    let mut curve = parts.attachment.without_knots();
    attachment_under(&parts.attachment, factors, &mut curve);
    curve.invert();
    curve.at(deflection_m)
}

/// Writes the attachment with its compliance scaled and its clearance widened.
fn attachment_under(nominal: &Curve, factors: &Factors, changed: &mut Curve) {
    let outer_end = |side: f64| {
        let knots = nominal.knots().iter().filter(|knot| knot.x == 0.0);
        knots.map(|knot| side * knot.y).fold(0.0, f64::max)
    };
    let (below, above) = (outer_end(-1.0), outer_end(1.0));
    let added = factors.added_half_clearance_m;
    let gain = factors.compliance_gain;
    let positive = |y: f64| above + added + gain * (y - above);
    let negative = |y: f64| -(below + added + gain * (-y - below));
    let split = nominal.knots().iter().filter(|knot| knot.x == 0.0).count() == 1;
    changed.clear(gain * nominal.slope_before(), gain * nominal.slope_after());
    for knot in nominal.knots() {
        if knot.x == 0.0 && split && added > 0.0 {
            changed.push(Knot { x: 0.0, y: negative(knot.y) });
            changed.push(Knot { x: 0.0, y: positive(knot.y) });
            continue;
        }
        let below_zero = knot.x < 0.0 || (knot.x == 0.0 && knot.y < 0.0);
        let y = if below_zero { negative(knot.y) } else { positive(knot.y) };
        changed.push(Knot { x: knot.x, y });
    }
}

/// Deflection at a force, on the far side of a step.
fn outer(attachment: &Curve, force_n: f64) -> f64 {
    let knots = attachment.knots().iter().filter(|knot| knot.x == force_n);
    let far = knots.fold(None, |far: Option<f64>, knot| {
        Some(far.map_or(knot.y, |y| if knot.y.abs() > y.abs() { knot.y } else { y }))
    });
    far.unwrap_or_else(|| attachment.at(force_n))
}

/// The segment of the joined law that holds a deflection, without the rest of the law: a step that stays on
/// it needs no other. Nothing where the deflection is on a knot or the piston has a law of its own at rest.
pub fn segment_around(
    parts: &Parts,
    nominal: &Body,
    factors: &Factors,
    deflection_m: f64,
) -> Option<Segment> {
    under(parts, nominal, factors, |body, attachment| {
        if body.breaks_away() {
            return None;
        }
        let mut found = None;
        let _ = walk(&body.velocity, attachment, |stretch| {
            if deflection_m >= stretch.to_m() {
                return ControlFlow::Continue(());
            }
            found = stretch.segment(&body.velocity, attachment);
            ControlFlow::Break(())
        });
        found.filter(|segment| deflection_m > segment.from_m)
    })
}

/// Body and attachment as the factors leave them.
#[inline]
fn under<T>(
    parts: &Parts,
    nominal: &Body,
    factors: &Factors,
    then: impl FnOnce(&Body, &Curve) -> T,
) -> T {
    let (mut changed_body, mut changed_attachment);
    let body = if factors.change_body() {
        let velocity = parts.hydraulic.without_knots();
        changed_body = Body { velocity, ..*nominal };
        changed_body.join(parts, factors);
        &changed_body
    } else {
        nominal
    };
    let attachment = if factors.change_attachment() {
        changed_attachment = parts.attachment.without_knots();
        attachment_under(&parts.attachment, factors, &mut changed_attachment);
        &changed_attachment
    } else {
        &parts.attachment
    };
    then(body, attachment)
}

/// Joins a body, velocity over force, with an attachment, deflection over force.
fn join_into(segments: &mut VecView<Segment>, body: &Curve, attachment: &Curve) {
    segments.clear();
    let _ = walk(body, attachment, |stretch| {
        if let Some(segment) = stretch.segment(body, attachment) {
            // Never full: `Law::check` has counted the knots.
            let _ = segments.push(segment);
        }
        ControlFlow::Continue(())
    });
}

/// Walks the joined law of a body and an attachment, rising, until `take` has had enough.
#[inline]
fn walk(
    body: &Curve,
    attachment: &Curve,
    mut take: impl FnMut(Stretch) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut last: Option<Point> = None;
    for (force_n, velocity, deflection) in merged(body, attachment) {
        let mut visit = |deflection_m: f64, velocity_m_per_s: f64| {
            let point = Point { deflection_m, force_n, velocity_m_per_s };
            if velocity_m_per_s == f64::NEG_INFINITY {
                return ControlFlow::Continue(());
            }
            match last.replace(point) {
                None => take(Stretch::Before(point)),
                Some(from) if deflection_m > from.deflection_m => {
                    take(Stretch::Between(from, point))
                }
                Some(_) => ControlFlow::Continue(()),
            }
        };
        if velocity.0 == f64::INFINITY {
            continue;
        }
        visit(deflection.0, velocity.0)?;
        if deflection.1 > deflection.0 && velocity.1 > velocity.0 {
            // Both free at once: the joint moves through its clearance, the piston waits.
            let waiting = 0.0_f64.max(velocity.0).min(velocity.1);
            visit(deflection.0, waiting)?;
            visit(deflection.1, waiting)?;
        }
        if velocity.1 < f64::INFINITY {
            visit(deflection.1, velocity.1)?;
        }
    }
    last.map_or(ControlFlow::Continue(()), |end| take(Stretch::Beyond(end)))
}

/// A stretch of the law whose slopes nobody has asked for yet.
enum Stretch {
    /// Everything before the first point.
    Before(Point),
    /// From one point to the next.
    Between(Point, Point),
    /// Everything beyond the last point.
    Beyond(Point),
}

impl Stretch {
    /// Where it ends, m.
    #[inline]
    fn to_m(&self) -> f64 {
        match self {
            Self::Before(to) | Self::Between(_, to) => to.deflection_m,
            Self::Beyond(_) => f64::INFINITY,
        }
    }

    /// Its segment; none beyond a cap of the force.
    #[inline]
    fn segment(&self, body: &Curve, attachment: &Curve) -> Option<Segment> {
        match *self {
            Self::Before(to) => {
                segment_at_end(to, body.slope_before(), attachment.slope_before(), -1.0)
            }
            Self::Between(from, to) => Some(segment_between(from, to)),
            Self::Beyond(from) => {
                segment_at_end(from, body.slope_after(), attachment.slope_after(), 1.0)
            }
        }
    }
}

#[inline]
fn segment_between(from: Point, to: Point) -> Segment {
    let length = to.deflection_m - from.deflection_m;
    let anchor = if from.deflection_m.abs() <= to.deflection_m.abs() { from } else { to };
    Segment {
        from_m: from.deflection_m,
        to_m: to.deflection_m,
        velocity_from: from.velocity_m_per_s,
        velocity_to: to.velocity_m_per_s,
        rate_per_s: (to.velocity_m_per_s - from.velocity_m_per_s) / length,
        stiffness_n_per_m: (to.force_n - from.force_n) / length,
        anchor,
        gains: Gains::NONE,
    }
}

/// The segment beyond the first or the last point, unless the force is capped there.
fn segment_at_end(at: Point, slope: f64, compliance: f64, side: f64) -> Option<Segment> {
    if slope.is_infinite() {
        return None;
    }
    let far = side * f64::INFINITY;
    let far_velocity = if slope > 0.0 { far } else { at.velocity_m_per_s };
    let (e, v) = (at.deflection_m, at.velocity_m_per_s);
    let ordered = |inner: f64, outer: f64| if side < 0.0 { (outer, inner) } else { (inner, outer) };
    let (from_m, to_m) = ordered(e, far);
    let (velocity_from, velocity_to) = ordered(v, far_velocity);
    Some(Segment {
        from_m,
        to_m,
        velocity_from,
        velocity_to,
        rate_per_s: slope / compliance,
        stiffness_n_per_m: 1.0 / compliance,
        anchor: at,
        gains: Gains::NONE,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::nominal::Nominal;

    fn joined(nominal: &Nominal, dry: Curve, factors: &Factors) -> Law {
        let (hydraulic, attachment) = (nominal.hydraulic(), nominal.attachment());
        let mut law = Law::empty();
        let parts = Parts { hydraulic, dry, attachment };
        law.join(&parts, &Body::nominal(&parts), factors);
        law
    }

    /// Force and piston velocity at a deflection.
    fn at(law: &Law, deflection_m: f64) -> (f64, f64) {
        let segment = law.sliding.iter().find(|segment| deflection_m < segment.to_m).unwrap();
        (segment.force(deflection_m), segment.velocity(deflection_m))
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-9), "{a} {b}");
    }

    #[test]
    fn nominal_law_has_its_five_segments() {
        let law = joined(&Nominal::NEW, Curve::ZERO, &Factors::NONE);
        assert_eq!(law.sliding.len(), 5);
        assert!(!law.breaks_away());
        // In the clearance, at 9 kN, at 26 kN.
        assert_eq!(at(&law, 0.05e-3), (0.0, 0.0));
        let (force, velocity) = at(&law, 0.1e-3 + 9e3 / 12.5e6);
        close(force, 9e3);
        close(velocity, 9e-3);
        let (force, velocity) = at(&law, -0.1e-3 - 26e3 / 12.5e6);
        close(force, -26e3);
        close(velocity, -0.118);
    }

    #[test]
    fn segments_join_without_a_hole() {
        let dry =
            Curve::through(&[Knot { x: 0.0, y: -300.0 }, Knot { x: 0.0, y: 300.0 }], 0.0, 0.0);
        for c2_n_s_per_m in [0.0, 80e3] {
            let nominal = Nominal { c2_n_s_per_m, ..Nominal::NEW };
            let law = joined(&nominal, dry.clone(), &Factors::NONE);
            for pair in law.sliding.windows(2) {
                assert_eq!(pair[0].to_m, pair[1].from_m);
                assert!(pair[0].velocity_to <= pair[1].velocity_from);
            }
            assert_eq!(law.sliding[0].from_m.is_finite(), c2_n_s_per_m == 0.0);
        }
    }

    #[test]
    fn every_factor_does_what_it_says() {
        let nominal = Nominal::NEW;
        let with = |factors: Factors| joined(&nominal, Curve::ZERO, &factors);
        let e = |force: f64| 0.1e-3 + force / 12.5e6;

        let law = with(Factors { force_gain: 0.5, ..Factors::NONE });
        close(at(&law, e(4.5e3)).1, 9e-3);
        close(at(&law, e(13e3)).1, 0.118);

        // Thinner oil: twice the velocity at the same force, the same relief force.
        let law = with(Factors { velocity_gain: 2.0, ..Factors::NONE });
        close(at(&law, e(9e3)).1, 18e-3);
        close(at(&law, e(26e3)).1, 0.236);

        let law = with(Factors { preload_n: 1e3, ..Factors::NONE });
        close(at(&law, e(10e3)).1, 9e-3);
        close(at(&law, e(1e3)).1, 0.0);
        close(at(&law, -e(8e3)).1, -9e-3);

        let law = with(Factors { compliance_gain: 2.0, ..Factors::NONE });
        let (force, velocity) = at(&law, 0.1e-3 + 2.0 * 9e3 / 12.5e6);
        close(force, 9e3);
        close(velocity, 9e-3);
        assert_eq!(at(&law, 0.09e-3).0, 0.0);

        let worn = Factors { added_half_clearance_m: 1e-3, ..Factors::NONE };
        let law = with(worn);
        close(at(&law, e(9e3) + 1e-3).0, 9e3);
        close(at(&law, -e(9e3) - 1e-3).0, -9e3);
        assert_eq!(at(&law, 1.09e-3).0, 0.0);
        let tight = Nominal { clearance_2a_m: 0.0, ..nominal };
        let law = joined(&tight, Curve::ZERO, &worn);
        assert_eq!(at(&law, 0.99e-3).0, 0.0);
        close(at(&law, 1e-3 + 9e3 / 12.5e6).0, 9e3);
    }

    #[test]
    fn slack_side_carries_dry_force_only() {
        let dry =
            Curve::through(&[Knot { x: 0.0, y: -300.0 }, Knot { x: 0.0, y: 300.0 }], 0.0, 0.0);
        let slack = Factors { slack: Some(Side::Negative), preload_n: 50.0, ..Factors::NONE };
        let law = joined(&Nominal::NEW, dry, &slack);
        // Tension as ever; in compression the force ends at friction and preload.
        close(at(&law, 0.1e-3 + 9.35e3 / 12.5e6).1, 9e-3);
        let (first, edge) = (law.sliding.first().unwrap(), -0.1e-3 - 250.0 / 12.5e6);
        close(first.from_m, edge);
        close(first.force(edge), -250.0);
    }

    #[test]
    fn force_is_read_from_the_attachment_as_it_is() {
        let (hydraulic, attachment) = (Nominal::NEW.hydraulic(), Nominal::NEW.attachment());
        let parts = Parts { hydraulic, dry: Curve::ZERO, attachment };
        let stiff = Factors { compliance_gain: 0.5, ..Factors::NONE };
        close(attachment_force_n(&parts, &Factors::NONE, 1.1e-3), 12.5e3);
        close(attachment_force_n(&parts, &stiff, -1.1e-3), -25e3);
        assert_eq!(attachment_force_n(&parts, &stiff, 0.05e-3), 0.0);
    }

    #[test]
    fn too_many_knots_are_refused() {
        let mut parts = Parts {
            hydraulic: Nominal::NEW.hydraulic(),
            dry: Curve::ZERO,
            attachment: Nominal::NEW.attachment(),
        };
        assert_eq!(Law::check(&parts), Ok(()));
        let mut soft = parts.clone();
        soft.attachment.add_line(-1.0 / 12.5e6);
        assert_eq!(Law::check(&soft), Err(DamperError::NotMonotone { law: "attachment" }));
        for i in 0..60 {
            let knot = Knot { x: f64::from(i), y: f64::from(i) };
            parts.dry = parts.dry.plus(&Curve::through(&[knot], 0.0, 0.0));
        }
        let full = DamperError::TooManyKnots { law: "body", limit: BODY_KNOTS };
        assert_eq!(Law::check(&parts), Err(full));
    }
}
