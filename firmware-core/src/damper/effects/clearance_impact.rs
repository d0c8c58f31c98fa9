//! The end mass strikes its seat when the clearance closes, and rings.
//!
//! ```text
//! m z'' + 2 zeta wn m z' + K z = 0      wn^2 = K/m      z' += w at each closing      F += K z
//! F(t) = sqrt(K m) / sqrt(1 - zeta^2) w exp(-zeta wn t) sin(wd t)        after one closing
//! ```
//!
//! w is the velocity of the eye against the piston at the instant at which the gap closes; the step
//! is cut there. The ringing is propagated exactly, so it does not depend on the step. Without a
//! clearance nothing strikes.
//!
//! Place: it begins in the attachment and is felt outside. Source: the free response of a mass on a
//! spring; impacts at reversal are reported in measured traces of worn dampers. Limits: the chain
//! does not feel the blow, the seat neither parts nor restitutes, and the slow return of a rubber
//! is left out of w. A record below 5 kHz cannot hold it.

use super::draw::{Draw, between, decades};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// Ringing of the end mass after each closing of the gap.
    ClearanceImpact {
        end_mass_kg: Kilogram in 0.0 to 100.0, typical 0.0001, "Mass that strikes, kg.";
        seat_n_per_m: NewtonPerMetre in 0.0 to 1e6, typical 20.0,
            "Stiffness of the seat that it strikes, N/m.";
        damping_ratio: One in 0.0 to 10.0, typical 0.1, "Damping ratio of the ringing.";
    }
}

/// A gap counts as open from this share of the clearance, so that a joint that rests on its edge
/// does not open and close.
const PARTED: f64 = 1e-6;

/// Exact propagation of a free mass on a spring.
fn ring(z: f64, rate: f64, wn: f64, zeta: f64, time_s: f64) -> (f64, f64) {
    let wt = wn * time_s;
    // exp(-zeta wt) times c(t), and times wn s(t), the two solutions that start at one and at zero.
    let (even, odd) = if zeta < 1.0 {
        let share = crate::sqrt::sqrt((1.0 - zeta) * (1.0 + zeta));
        let decay = libm::exp(-zeta * wt);
        (decay * libm::cos(share * wt), decay * libm::sin(share * wt) / share)
    } else if zeta > 1.0 {
        let share = crate::sqrt::sqrt((zeta - 1.0) * (zeta + 1.0));
        // The slow root without the loss of digits of zeta - share.
        let slow = libm::exp(-wt / (zeta + share));
        let fast = libm::exp(-wt * (zeta + share));
        (0.5 * (slow + fast), 0.5 * (slow - fast) / share)
    } else {
        let decay = libm::exp(-wt);
        (decay, decay * wt)
    };
    let end = z * (even + zeta * odd) + rate / wn * odd;
    let end_rate = rate * (even - zeta * odd) - wn * z * odd;
    (end, end_rate)
}

impl DamperEffect for ClearanceImpact {
    const NAME: &'static str = "clearance_impact";
    const PLACE: Place = Place::Attachment;
    const EQUATION: &'static str = "F += sqrt(K m) w exp(-zeta wn t) sin(wd t) / sqrt(1 - zeta^2)";
    const SHOWN_BY: &'static str = "Sines well beyond the clearance at three speeds, sampled at 5 kHz or more behind a filter above 1 kHz.";
    const NEEDS_RATE_HZ: f64 = 5000.0;
    const SWITCHES: bool = true;
    const STARTS: &'static [&'static [f64]] = &[&[0.0001, 5.0, 0.1], &[0.0001, 100.0, 0.1]];
    const STRONGEST: f64 = 0.05;
    const IN_HYDRAULIC_MODEL: bool = false;

    /// In contact on one side: how far it is from parting. Free: how far from either side.
    fn margin(&self, memory: &Memory, done: &Done) -> f64 {
        let [_, _, side, _] = *memory;
        let half_m = done.half_clearance_m;
        if half_m <= 0.0 {
            f64::INFINITY
        } else if side == 0.0 {
            half_m - done.deflection_m.abs()
        } else {
            side * done.deflection_m - half_m * (1.0 - PARTED)
        }
    }

    fn remember(&self, _nominal: &Nominal, memory: &mut Memory, done: &Done) {
        let switched = self.margin(memory, done) < 0.0;
        let [z_m, rate_m_per_s, side, _] = memory;
        let wn = crate::sqrt::sqrt(self.seat_n_per_m / self.end_mass_kg);
        if *z_m != 0.0 || *rate_m_per_s != 0.0 {
            (*z_m, *rate_m_per_s) = ring(*z_m, *rate_m_per_s, wn, self.damping_ratio, done.step_s);
        }
        if switched && *side != 0.0 {
            *side = 0.0;
        } else if switched {
            *side = 1.0_f64.copysign(done.deflection_m);
            if wn > 0.0 && wn < f64::INFINITY {
                *rate_m_per_s += done.end_velocity_m_per_s - done.piston_velocity_m_per_s;
            }
        }
    }

    fn output(&self, memory: &mut Memory, _done: &Done, force_n: f64) -> f64 {
        let [z_m, ..] = *memory;
        force_n + self.seat_n_per_m * z_m
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, displacement_m: stroke_m, .. } = draw.scale;
        let [a, b, _] = draw.shape;
        let natural_kg = force_n * stroke_m / (speed * speed);
        Self {
            end_mass_kg: strength * natural_kg,
            seat_n_per_m: force_n / stroke_m * decades(a, 5.0, 60.0),
            damping_ratio: between(b, 0.05, 0.2),
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
        let ring_per_s = 2.0 * core::f64::consts::PI * 150.0;
        let impedance = 0.05 * size * f / v;
        Self {
            end_mass_kg: impedance / ring_per_s,
            seat_n_per_m: impedance * ring_per_s,
            damping_ratio: 0.15,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    const BLOW: ClearanceImpact =
        ClearanceImpact { end_mass_kg: 20.0, seat_n_per_m: 1e8, damping_ratio: 0.1 };

    /// Force per closing velocity over the time since, N s/m.
    type Response = fn(f64) -> f64;

    fn worn(clearance_2a_m: f64, blow: ClearanceImpact) -> Damper {
        Damper::new(Nominal { clearance_2a_m, ..Nominal::NEW }, &[blow.into()]).unwrap()
    }

    #[test]
    fn one_closing_rings_as_its_formula_at_any_step() {
        // From mid-gap at 70 mm/s: the gap of 1.5 mm closes after 21.43 ms.
        let (w, half_m) = (70e-3, 1.5e-3);
        let formulas: [(f64, Response); 3] = [
            (0.1, |t| {
                let (wn, wd) = (crate::sqrt::sqrt(5e6), crate::sqrt::sqrt(5e6 * 0.99));
                crate::sqrt::sqrt(2e9 / 0.99) * libm::exp(-0.1 * wn * t) * libm::sin(wd * t)
            }),
            (1.0, |t| 1e8 * t * libm::exp(-crate::sqrt::sqrt(5e6) * t)),
            (2.0, |t| {
                let (wn, wq) = (crate::sqrt::sqrt(5e6), crate::sqrt::sqrt(5e6 * 3.0));
                crate::sqrt::sqrt(2e9 / 3.0) * libm::exp(-2.0 * wn * t) * libm::sinh(wq * t)
            }),
        ];
        for (damping_ratio, formula) in formulas {
            let damper = worn(2.0 * half_m, ClearanceImpact { damping_ratio, ..BLOW });
            for step_s in [1e-5, 2e-4, 1e-3, 4.7e-3] {
                let mut state = DamperState::starting(Motion::new(0.0, w));
                for i in 1..=(0.04 / step_s) as u32 {
                    let t = f64::from(i) * step_s;
                    let force = damper.advance(&mut state, Motion::new(w * t, w), step_s);
                    let since = t - half_m / w;
                    let expected = if since > 0.0 { w * formula(since) } else { 0.0 };
                    let added = force - state.chain_force_n();
                    // The piston already creeps at the far side of the cut.
                    let miss = (added - expected).abs();
                    assert!(miss < 2e-4, "{damping_ratio} {step_s} {t}: {added} {expected}");
                }
            }
        }
    }

    #[test]
    fn a_quarter_of_the_mass_strikes_with_half_the_force_twice_as_fast() {
        // Undamped: peak sqrt(K m) w, first a quarter period after the closing.
        for (end_mass_kg, peak_n) in [(20.0, 3130.495), (5.0, 1565.248)] {
            let blow = ClearanceImpact { end_mass_kg, damping_ratio: 0.0, ..BLOW };
            let damper = worn(1e-3, blow);
            let mut state = DamperState::starting(Motion::new(0.0, 70e-3));
            let (mut largest, mut at_s) = (0.0, 0.0);
            for i in 1..=10_000 {
                let t = 1e-6 * f64::from(i);
                let added = damper.advance(&mut state, Motion::new(70e-3 * t, 70e-3), 1e-6)
                    - state.chain_force_n();
                if t < 0.5e-3 / 70e-3 + 1e-3 && added > largest {
                    (largest, at_s) = (added, t - 0.5e-3 / 70e-3);
                }
            }
            assert!((largest / peak_n - 1.0).abs() < 1e-5, "{largest}");
            let quarter_s = 0.5 * core::f64::consts::PI * crate::sqrt::sqrt(end_mass_kg / 1e8);
            assert!((at_s - quarter_s).abs() < 2e-6, "{at_s}");
        }
    }

    #[test]
    fn both_sides_strike_and_a_mirrored_motion_mirrors_the_blows() {
        let damper = worn(1e-3, BLOW);
        let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
        let mut struck = [false; 2];
        for i in 1..=2000 {
            let t = 2e-4 * f64::from(i);
            let (x, v) = (3.46e-3 * libm::sin(22.0 * t), 76e-3 * libm::cos(22.0 * t));
            let force = damper.advance(&mut a, Motion::new(x, v), 2e-4);
            assert_eq!(force, -damper.advance(&mut b, Motion::new(-x, -v), 2e-4));
            let added = force - a.chain_force_n();
            struck[0] |= added > 1500.0 && v > 0.0;
            struck[1] |= added < -1500.0 && v < 0.0;
        }
        assert_eq!(struck, [true; 2]);
    }

    #[test]
    fn nothing_strikes_without_a_gap_or_without_mass() {
        let massless = ClearanceImpact { end_mass_kg: 0.0, ..BLOW };
        for (gap, blow) in [(0.0, BLOW), (1e-3, massless)] {
            let damper = worn(gap, blow);
            let mut state = DamperState::rest();
            for i in 1..=500 {
                let t = 1e-3 * f64::from(i);
                let motion = Motion::new(3e-3 * libm::sin(22.0 * t), 66e-3 * libm::cos(22.0 * t));
                let force = damper.advance(&mut state, motion, 1e-3);
                assert_eq!(force, state.chain_force_n());
            }
        }
    }
}
