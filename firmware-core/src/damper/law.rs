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

use heapless::{Vec, VecView};

use super::chain::Gains;
use super::curve::{CURVE_KNOTS, Curve, Knot, Side, merged};
use super::error::DamperError;
use super::parts::{Body, Factors, Parts};
use super::segment::{Point, Segment};

/// Most knots of hydraulic and dry law together.
pub(super) const BODY_KNOTS: usize = CURVE_KNOTS - 1;

/// Most knots of the attachment; wear may split the one at zero.
pub(super) const ATTACHMENT_KNOTS: usize = CURVE_KNOTS - 1;

/// How many segments the law of a chain holds: one behind every knot, one before the first, two
/// where clearance and friction are free at once.
pub(super) const LAW_SEGMENTS: usize = BODY_KNOTS + ATTACHMENT_KNOTS + 4;

/// How many segments the law of a piston at rest holds.
pub(super) const RESTING_SEGMENTS: usize = ATTACHMENT_KNOTS + 6;

/// The joined law of a chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Law {
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
    pub(super) fn empty() -> Self {
        Self {
            sliding: Vec::new(),
            resting: Vec::new(),
            rest_from_m: 0.0,
            rest_to_m: 0.0,
            step_s: 0.0,
        }
    }

    /// Joins the parts under the given factors, in place; `nominal` is their body without any.
    /// Bounded by the number of knots.
    pub(super) fn join(&mut self, parts: &Parts, nominal: &Body, factors: &Factors) {
        let changed;
        let body = if factors.change_body() {
            changed = nominal.under(parts, factors);
            &changed
        } else {
            nominal
        };
        self.step_s = 0.0;
        self.resting.clear();
        parts.with_attachment(factors, |attachment| {
            join_into(&mut self.sliding, &body.velocity, attachment);
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
    pub(super) fn prepare(&mut self, step_s: f64) {
        debug_assert!(!self.sliding.is_empty(), "a law that has not been joined");
        for segment in self.sliding.iter_mut().chain(self.resting.iter_mut()) {
            segment.gains = Gains::over(segment.rate_per_s, step_s);
        }
        self.step_s = step_s;
    }

    /// True when the piston has a law of its own at rest.
    #[inline]
    pub(super) fn breaks_away(&self) -> bool {
        !self.resting.is_empty()
    }

    /// Refuses parts that the tables cannot hold or that do not rise.
    ///
    /// # Errors
    /// [`DamperError::TooManyKnots`], [`DamperError::NotMonotone`].
    pub(super) fn check(parts: &Parts) -> Result<(), DamperError> {
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

/// Deflection at a force, on the far side of a step.
fn outer(attachment: &Curve, force_n: f64) -> f64 {
    let knots = attachment.knots().iter().filter(|knot| knot.x == force_n);
    let far = knots.fold(None, |far: Option<f64>, knot| {
        Some(far.map_or(knot.y, |y| if knot.y.abs() > y.abs() { knot.y } else { y }))
    });
    far.unwrap_or_else(|| attachment.at(force_n))
}

/// Joins a body, velocity over force, with an attachment, deflection over force.
fn join_into(segments: &mut VecView<Segment>, body: &Curve, attachment: &Curve) {
    segments.clear();
    // Never full: `Law::check` has counted the knots.
    let mut add = |segment: Option<Segment>| {
        if let Some(segment) = segment {
            let full = segments.push(segment).is_err();
            debug_assert!(!full, "a law of more segments than its parts have knots");
        }
    };
    let mut last: Option<Point> = None;
    for (force_n, velocity, deflection) in merged(body, attachment) {
        let mut visit = |deflection_m: f64, velocity_m_per_s: f64| {
            if velocity_m_per_s == f64::NEG_INFINITY {
                return;
            }
            let point = Point { deflection_m, force_n, velocity_m_per_s };
            match last.replace(point) {
                None => {
                    let (slope, compliance) = (body.slope_before(), attachment.slope_before());
                    add(Segment::beyond(Side::Negative, point, slope, compliance));
                }
                Some(from) if deflection_m > from.deflection_m => {
                    add(Some(Segment::between(from, point)));
                }
                Some(_) => {}
            }
        };
        if velocity.0 == f64::INFINITY {
            continue;
        }
        visit(deflection.0, velocity.0);
        if deflection.1 > deflection.0 && velocity.1 > velocity.0 {
            // Both free at once: the joint moves through its clearance, the piston waits.
            let waiting = 0.0_f64.max(velocity.0).min(velocity.1);
            visit(deflection.0, waiting);
            visit(deflection.1, waiting);
        }
        if velocity.1 < f64::INFINITY {
            visit(deflection.1, velocity.1);
        }
    }
    if let Some(end) = last {
        let (slope, compliance) = (body.slope_after(), attachment.slope_after());
        add(Segment::beyond(Side::Positive, end, slope, compliance));
    }
}

#[cfg(test)]
mod tests {
    use super::super::parts::attachment_force_n;
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
