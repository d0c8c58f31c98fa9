//! Dry friction of the rod seal, inboard, with breakaway.
//!
//! ```text
//! |F_s| <= r Fc                          at rest
//! F_s = sgn(v) (Fc + (r - 1) Fc <1 - |v|/v_s>)     sliding, <> zero below zero
//! ```
//!
//! a straight-line Stribeck curve from the breakaway force r Fc down to the Coulomb force Fc. The
//! piston sticks: at rest its velocity is exactly zero. Where friction falls faster than the
//! hydraulic force rises, the sum falls after breakaway; the piston then jumps to the velocity at
//! which the sum carries the force again, and comes to rest at the lowest sum. Sitting inside the
//! attachment, the friction is filtered by it.
//!
//! Limits: no dependence on pressure, and no inertia during the jump.

use super::draw::{Draw, between};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Place};
use crate::damper::curve::{Curve, Knot};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;

effect_parameters! {
    /// Coulomb friction with breakaway.
    SealFriction {
        coulomb_n: Newton in 0.0 to 1.0, typical 0.02, "Friction force while sliding, N.";
        breakaway_ratio: One in 1.0 to 10.0, typical 1.3, "Breakaway force over sliding force.";
        stribeck_m_per_s: MetrePerSecond in 0.0 to 1.0, typical 0.05,
            "Velocity at which friction has fallen to the sliding force, m/s.";
    }
}

impl DamperEffect for SealFriction {
    const NAME: &'static str = "seal_friction";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F += sgn(v) Fc (1 + (r - 1) max(0, 1 - |v|/v_s)), sticking";
    const SHOWN_BY: &'static str = "Slow triangles (1 to 5 mm/s) at two strokes: a step at the reversal that no speed changes.";
    const STARTS: &'static [&'static [f64]] = &[&[0.02, 1.0, 0.05], &[0.02, 1.5, 0.3]];
    const STRONGEST: f64 = 0.6;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        let breakaway_n = self.coulomb_n * self.breakaway_ratio;
        // A step down needs some width; a millionth of the relief velocity is none.
        let least = 1e-6 * nominal.scale().velocity_m_per_s;
        let v = self.stribeck_m_per_s.max(least);
        let knots = [
            Knot { x: -v, y: -self.coulomb_n },
            Knot { x: 0.0, y: -breakaway_n },
            Knot { x: 0.0, y: breakaway_n },
            Knot { x: v, y: self.coulomb_n },
        ];
        parts.dry = parts.dry.plus(&Curve::through(&knots, 0.0, 0.0));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, .. } = draw.scale;
        let [a, b, _] = draw.shape;
        Self {
            coulomb_n: strength * force_n,
            breakaway_ratio: between(a, 1.0, 1.6),
            stribeck_m_per_s: speed * between(b, 0.02, 0.1),
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
        Self { coulomb_n: 0.03 * size * f, breakaway_ratio: 1.5, stribeck_m_per_s: 0.1 * v }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    /// Almost no oil, an almost rigid attachment.
    const DRY: Nominal = Nominal {
        ce_n_s_per_m: 1e-3,
        ke_n_per_m: 1e9,
        clearance_2a_m: 0.0,
        f_relief_n: f64::INFINITY,
        c2_n_s_per_m: 0.0,
    };

    fn friction(coulomb_n: f64, breakaway_ratio: f64, stribeck_m_per_s: f64) -> SealFriction {
        SealFriction { coulomb_n, breakaway_ratio, stribeck_m_per_s }
    }

    #[test]
    fn loop_area_is_four_times_force_times_amplitude_at_any_speed() {
        let (coulomb_n, amplitude_m) = (500.0, 10e-3);
        let damper = Damper::new(DRY, &[friction(coulomb_n, 1.0, 0.0).into()]).unwrap();
        // The corners of the loop are cut off by the spring: 4 Fc (X - Fc/Ke).
        let area = 4.0 * coulomb_n * (amplitude_m - coulomb_n / DRY.ke_n_per_m);
        for quarter in [500, 5_000] {
            let velocity = amplitude_m / (f64::from(quarter) * 1e-3);
            let mut state = DamperState::rest();
            let (mut x, mut work) = (0.0, 0.0);
            for i in 0..8 * quarter {
                let direction = if (i + quarter) / (2 * quarter) % 2 == 0 { 1.0 } else { -1.0 };
                x += direction * velocity * 1e-3;
                // Straight motion with a corner: the step's mean velocity at both its ends.
                let before = state.force_n();
                let force = damper.advance(&mut state, Motion::new(x, 0.0), 1e-3);
                if i >= 4 * quarter {
                    work += 0.5 * (before + force) * direction * velocity * 1e-3;
                }
            }
            // Two steps per cycle hold a corner that the trapezoidal rule cuts.
            let cut = 2.0 * coulomb_n * velocity * 1e-3;
            assert!((work - area).abs() <= cut, "{quarter}: {work} {area}");
        }
    }

    #[test]
    fn piston_sticks_until_breakaway() {
        let damper = Damper::new(Nominal::NEW, &[friction(400.0, 1.5, 2e-3).into()]).unwrap();
        let mut state = DamperState::rest();
        let a = 0.5 * Nominal::NEW.clearance_2a_m;
        for i in 1..=1000 {
            let force = 599.0 * f64::from(i) / 1000.0;
            let x = a + force / Nominal::NEW.ke_n_per_m;
            let read = damper.advance(&mut state, Motion::new(x, 0.0), 1e-3);
            assert!((read - force).abs() < 1e-6, "{read} {force}");
        }
        assert!(state.piston_m().abs() < 1e-15);
    }

    #[test]
    fn slides_at_coulomb_force_plus_oil() {
        let damper = Damper::new(Nominal::NEW, &[friction(400.0, 1.5, 2e-3).into()]).unwrap();
        let mut state = DamperState::starting(Motion::new(0.0, 5e-3));
        for i in 1..=2000 {
            let x = 5e-6 * f64::from(i);
            damper.advance(&mut state, Motion::new(x, 5e-3), 1e-3);
        }
        assert!((state.force_n() - (400.0 + 1e6 * 5e-3)).abs() < 1e-6);
    }

    #[test]
    fn slow_drag_is_a_saw_between_breakaway_and_sliding_force() {
        // A seal whose friction falls faster than the oil rises: stick-slip with amplitude (r - 1)
        // Fc.
        let oil = Nominal { ce_n_s_per_m: 1e4, clearance_2a_m: 0.0, ..Nominal::NEW };
        let damper = Damper::new(oil, &[friction(400.0, 1.5, 1e-3).into()]).unwrap();
        let mut state = DamperState::rest();
        let (mut low, mut high, mut breakaways) = (f64::INFINITY, 0.0_f64, 0);
        let mut last = 0.0;
        for i in 1..=20_000 {
            // 10 um/s, so that a rise of 200 N takes 1.6 s.
            let motion = Motion::new(1e-8 * f64::from(i), 1e-5);
            let force = damper.advance(&mut state, motion, 1e-3);
            if i > 6_000 {
                low = low.min(force);
                high = high.max(force);
                breakaways += i32::from(last > 500.0 && force <= 500.0);
            }
            last = force;
        }
        // The piston comes to rest where oil and seal together are lowest: 400 N + Ce v_s.
        assert!((low - 410.0).abs() < 1.0 && (high - 600.0).abs() < 1.0, "{low} {high}");
        let period_s = (600.0 - 410.0) / (Nominal::NEW.ke_n_per_m * 1e-5);
        assert!((f64::from(breakaways) - 14.0 / period_s).abs() < 2.0, "{breakaways}");
    }
}
