//! The parts of a chain, and what slow states make of them for one step.
//!
//! Hydraulic and dry force act side by side on the piston and make its body; body and attachment
//! stand in series. Joined they are the [law](super::law) of the chain.

use super::curve::{Curve, Knot, Side};

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
    /// Hands on the attachment as the factors leave it, uncopied where they leave it as it is.
    #[inline]
    pub(super) fn with_attachment<T>(
        &self,
        factors: &Factors,
        then: impl FnOnce(&Curve) -> T,
    ) -> T {
        if !factors.change_attachment() {
            return then(&self.attachment);
        }
        let mut changed = self.attachment.without_knots();
        attachment_under(&self.attachment, factors, &mut changed);
        then(&changed)
    }

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
    pub(super) fn change_body(&self) -> bool {
        self.force_gain != 1.0
            || self.velocity_gain != 1.0
            || self.preload_n != 0.0
            || self.slack.is_some()
    }
}

/// Hydraulic and dry force of a piston as one law that never falls.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    /// Velocity of the piston over force.
    pub(super) velocity: Curve,
    /// Forces between which a resting piston stays.
    pub(super) breakaway_n: [f64; 2],
    /// Forces between which a sliding piston comes to rest.
    pub(super) rest_n: [f64; 2],
    /// True when the hydraulic force, with a knot at zero velocity, is all there is.
    pub(super) is_hydraulic: bool,
}

impl Body {
    /// The body of nominal parts.
    pub(super) fn nominal(parts: &Parts) -> Self {
        let velocity = parts.hydraulic.without_knots();
        let knot_at_zero = parts.hydraulic.knots().iter().any(|knot| knot.x == 0.0);
        let is_hydraulic = parts.dry.is_zero() && knot_at_zero;
        let mut body = Self { velocity, breakaway_n: [0.0; 2], rest_n: [0.0; 2], is_hydraulic };
        body.join(parts, &Factors::NONE);
        body
    }

    /// The body under the given factors.
    #[inline]
    pub(super) fn under(&self, parts: &Parts, factors: &Factors) -> Self {
        let mut changed = Self { velocity: parts.hydraulic.without_knots(), ..*self };
        changed.join(parts, factors);
        changed
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
    pub(super) fn breaks_away(&self) -> bool {
        let ([breakaway_from, breakaway_to], [rest_from, rest_to]) =
            (self.breakaway_n, self.rest_n);
        breakaway_from < rest_from || breakaway_to > rest_to
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
