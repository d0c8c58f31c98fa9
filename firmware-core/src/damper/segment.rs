//! A stretch of the joined law ([`super::law`]) on which everything is linear in the deflection.

use super::chain::Gains;
use super::curve::Side;

/// A stretch of the law between two deflections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Segment {
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
pub(super) struct Point {
    /// Deflection of the attachment, m.
    pub deflection_m: f64,
    /// Force, N.
    pub force_n: f64,
    /// Piston velocity, m/s.
    pub velocity_m_per_s: f64,
}

impl Segment {
    /// From one point to the next.
    #[inline]
    pub(super) fn between(from: Point, to: Point) -> Self {
        let length = to.deflection_m - from.deflection_m;
        let anchor = if from.deflection_m.abs() <= to.deflection_m.abs() { from } else { to };
        Self {
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

    /// Everything before the first point or beyond the last one, unless the force is capped there:
    /// velocity and deflection rise with force by `slope` and `compliance`.
    #[inline]
    pub(super) fn beyond(side: Side, at: Point, slope: f64, compliance: f64) -> Option<Self> {
        if slope.is_infinite() {
            return None;
        }
        let far_m = if side == Side::Negative { f64::NEG_INFINITY } else { f64::INFINITY };
        let far_velocity = if slope > 0.0 { far_m } else { at.velocity_m_per_s };
        let (e, v) = (at.deflection_m, at.velocity_m_per_s);
        let ordered = |inner: f64, outer: f64| {
            if side == Side::Negative { (outer, inner) } else { (inner, outer) }
        };
        let (from_m, to_m) = ordered(e, far_m);
        let (velocity_from, velocity_to) = ordered(v, far_velocity);
        Some(Self {
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

    /// Piston velocity at a deflection.
    #[inline]
    pub(super) fn velocity(&self, deflection_m: f64) -> f64 {
        self.anchor.velocity_m_per_s + self.rate_per_s * (deflection_m - self.anchor.deflection_m)
    }

    /// Force at a deflection.
    #[inline]
    pub(super) fn force(&self, deflection_m: f64) -> f64 {
        self.anchor.force_n + self.stiffness_n_per_m * (deflection_m - self.anchor.deflection_m)
    }
}
