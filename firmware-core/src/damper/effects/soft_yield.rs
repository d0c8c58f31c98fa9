//! A yield force with a soft knee, inboard: at low speed the damper takes a force that hardly
//! depends on the speed.
//!
//! ```text
//! F += F_y tanh(v/v_y)
//! ```
//!
//! It is parallel to the hydraulic force, without a memory, and scales with it: oil that warms, the
//! bore, and an asymmetry act on both. A valve whose spring is preloaded behind a small bleed, a
//! magnetorheological fluid, and a friction that sets in with the speed have this shape. At the
//! origin the slope is `F_y`/`v_y`, above Ce, and from twice `v_y` on the force stands at `F_y`.
//!
//! Nine straight pieces per side with the least largest deviation: the force is off by at most 0.21
//! % of `F_y`, and 0.12 % in the mean square; the slope at zero is 2.1 % low. Their places scale
//! with `v_y` and their forces with `F_y`, so that the force is continuous in both. `v_y` below a
//! millionth of the velocity scale of the nominal damper counts as that millionth: dry friction
//! without a breakaway force.
//!
//! Limits: no memory of the motion (see `presliding_friction`), the same yield force at every
//! position. Look-alikes: `second_valve_stage` with a ratio below one has a sharp knee at a force,
//! `seal_friction` sticks at rest, and a lower relief force takes part of `F_y`: the sum of both is
//! known better than each. They differ in how the force over velocity bends between 0.3 and 2
//! `v_y`.

use super::draw::{Draw, decades};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Place};
use crate::damper::curve::{Curve, Knot};
use crate::damper::nominal::Nominal;
use crate::damper::parts::Parts;

effect_parameters! {
    /// A yield force that is reached softly.
    SoftYield {
        yield_n: Newton in 0.0 to 5.0, typical 0.2, "Force that is reached beyond the knee, N.";
        knee_m_per_s: MetrePerSecond in 1e-3 to 3.0, typical 0.2,
            "Velocity at which 76 % of the yield force is reached, m/s.";
    }
}

/// The polygon through zero that is nearest to tanh(x) on the positive side.
const TANH: [(f64, f64); 9] = [
    (0.296_656, 0.290_333_4),
    (0.522_199, 0.481_478_8),
    (0.730_919, 0.625_711_0),
    (0.945_238, 0.739_702_9),
    (1.181_107, 0.829_883_7),
    (1.458_792, 0.899_501_3),
    (1.814_835, 0.950_404_4),
    (2.339_867, 0.983_691_2),
    (3.434_152, 1.0),
];

/// Least velocity of the knee over that of the nominal damper.
const LEAST_KNEE: f64 = 1e-6;

impl DamperEffect for SoftYield {
    const NAME: &'static str = "soft_yield";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "F += F_y tanh(v/v_y)";
    const SHOWN_BY: &'static str =
        "Triangles at five speeds between 0.3 and 2 times the speed of the knee.";
    const STARTS: &'static [&'static [f64]] = &[&[0.2, 0.05], &[0.5, 0.5], &[0.2, 0.01]];
    const STRONGEST: f64 = 2.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
        if self.yield_n == 0.0 {
            return;
        }
        let least = LEAST_KNEE * nominal.scale().velocity_m_per_s;
        let knee = self.knee_m_per_s.max(least);
        let mut above = [Knot { x: 0.0, y: 0.0 }; TANH.len() + 1];
        for (knot, (x, y)) in above.iter_mut().skip(1).zip(TANH) {
            *knot = Knot { x: knee * x, y: self.yield_n * y };
        }
        parts.hydraulic = parts.hydraulic.plus(&Curve::odd(&above, 0.0));
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, .. } = draw.scale;
        let [a, ..] = draw.shape;
        Self { yield_n: strength * force_n, knee_m_per_s: speed * decades(a, 0.03, 0.5) }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
        Self { yield_n: 0.1 * size * f, knee_m_per_s: 0.5 * v }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    fn damper(yield_n: f64, knee_m_per_s: f64) -> Damper {
        Damper::new(Nominal::NEW, &[SoftYield { yield_n, knee_m_per_s }.into()]).unwrap()
    }

    #[test]
    fn force_is_that_of_the_equation_to_a_share_of_the_yield_force() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        for knee in [1e-4, 4e-3, 0.3] {
            let damper = damper(5e3, knee);
            let (mut worst, mut square) = (0.0_f64, 0.0);
            for i in 1..=6000 {
                let v = knee * f64::from(i) / 1000.0;
                let added = damper.steady_force_n(v) - plain.steady_force_n(v);
                let miss = added / 5e3 - libm::tanh(v / knee);
                worst = worst.max(miss.abs());
                square += miss * miss / 6000.0;
                assert_eq!(damper.steady_force_n(-v), -damper.steady_force_n(v));
            }
            assert!(
                worst < 2.1e-3 && crate::sqrt::sqrt(square) < 1.2e-3,
                "{knee}: {worst} {square}"
            );
        }
    }

    #[test]
    fn held_force_decays_through_the_knee_by_the_closed_form() {
        // F = F_y tanh(v/v_y) alone, held: F' = -Ke v_y artanh(F/F_y). Its time from F_0 to F is an
        // integral of 1/artanh, taken by Simpson's rule.
        let nominal = Nominal {
            ce_n_s_per_m: 1e-3,
            clearance_2a_m: 0.0,
            f_relief_n: f64::INFINITY,
            ..Nominal::NEW
        };
        let (yield_n, knee) = (6e3, 5e-3);
        let soft = SoftYield { yield_n, knee_m_per_s: knee };
        let damper = Damper::new(nominal, &[soft.into()]).unwrap();
        let held = Motion::new(0.4e-3, 0.0);
        let mut state = DamperState::rest();
        damper.advance(&mut state, held, 1e-9);
        let start = state.force_n() / yield_n;
        let time_s = |to: f64| {
            let pieces = 2000;
            let step = (start - to) / f64::from(pieces);
            let sum: f64 = (0..=pieces)
                .map(|i| {
                    let weight = match i {
                        0 => 1.0,
                        i if i == pieces => 1.0,
                        i if i % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    weight / libm::atanh(to + step * f64::from(i))
                })
                .sum();
            yield_n / (nominal.ke_n_per_m * knee) * sum * step / 3.0
        };
        for i in 1..=300 {
            let force = damper.advance(&mut state, held, 1e-3);
            let expected_s = 1e-3 * f64::from(i);
            let miss_s = time_s(force / yield_n) - expected_s;
            // At low speed the slope of the polygon is 2.1 % low.
            assert!(miss_s.abs() < 0.022 * expected_s, "{i}: {force} N, {miss_s} s");
        }
    }

    #[test]
    fn no_yield_is_the_nominal_damper_and_little_of_it_is_near() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        assert_eq!(damper(0.0, 0.01).steady_force_n(0.004), plain.steady_force_n(0.004));
        for v in [1e-6, 0.004, 0.018, 0.1] {
            let little = damper(1e-9, 0.01).steady_force_n(v) - plain.steady_force_n(v);
            assert!(little.abs() <= 2e-9, "{v}: {little}");
        }
    }

    #[test]
    fn sharp_knee_is_dry_friction() {
        use crate::damper::effects::SealFriction;
        let seal = SealFriction { coulomb_n: 900.0, breakaway_ratio: 1.0, stribeck_m_per_s: 0.0 };
        let seal = Damper::new(Nominal::NEW, &[seal.into()]).unwrap();
        for knee in [1e-9, 1e-300] {
            let damper = damper(900.0, knee);
            for v in [-0.1, -1e-5, 1e-5, 2e-3, 0.1] {
                let miss = damper.steady_force_n(v) - seal.steady_force_n(v);
                assert!(miss.abs() < 1e-6, "{knee} {v}: {miss}");
            }
        }
    }

    #[test]
    fn force_is_continuous_in_both_parameters_up_to_their_bounds() {
        let motion = |i: u32| {
            let (sin, cos) = libm::sincos(0.022 * f64::from(i));
            Motion::new(3e-3 * sin, 66e-3 * cos)
        };
        let forces = |yield_n: f64, knee: f64| {
            let damper = damper(yield_n, knee).prepared(1e-3);
            let mut state = DamperState::starting(motion(0));
            (1..=600)
                .map(|i| damper.advance(&mut state, motion(i), 1e-3))
                .collect::<heapless::Vec<f64, 600>>()
        };
        let apart = |a: &[f64], b: &[f64]| {
            crate::sqrt::sqrt(a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / 600.0)
        };
        // Half of the step changes half as much, down to the lower bound and up to the upper one.
        let scale = Nominal::NEW.scale();
        let [(_, most), (least, widest)] =
            [0, 1].map(|i| <SoftYield as super::super::Table>::PARAMETERS[i].bounds(&scale));
        for (yield_n, knee) in
            [(1e-3, 4e-3), (3e3, least), (3e3, 4e-3), (3e3, widest), (most, 4e-3)]
        {
            let here = forces(yield_n, knee);
            for (more_n, wider) in [(1.01, 1.0), (1.0, 1.01)] {
                let step = |share: f64| {
                    let (y, k) = (1.0 + share * (more_n - 1.0), 1.0 + share * (wider - 1.0));
                    apart(&forces(y * yield_n, k * knee), &here)
                };
                let (whole, half) = (step(1.0), step(0.5));
                assert!(whole > 0.0, "{yield_n} {knee}: flat");
                assert!((half / whole - 0.5).abs() < 0.05, "{yield_n} {knee}: {half} {whole}");
            }
        }
    }
}
