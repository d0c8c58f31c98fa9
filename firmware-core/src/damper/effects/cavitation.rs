//! A chamber that refills too slowly: a void on one side of the piston.
//!
//! ```text
//! L' = s v_p - V        L >= 0, grows from zero when s v_p > V
//! F_h = 0                 while L > 0 and s v_p < 0
//! ```
//!
//! The valve that refills the chamber behind the piston keeps up with a velocity V. Moving faster
//! in the direction s, the piston leaves a void of the length L behind. When it comes back, the
//! void carries nothing until it is gone, then the oil column takes up the force in a step. Dry
//! friction and preload stay. While the piston moves in the direction s the other chamber works as
//! ever.
//!
//! V carries the side in its sign: positive for a void made in extension, negative for one made in
//! compression. With |V| above every velocity there is no void.
//!
//! Source: a reduction of the pressure floor with a void volume of chamber models. Limits: the
//! refill velocity is constant (its valve sees the same vacuum whatever the speed), and the void
//! neither compresses gas nor dissolves it.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place, Slow};
use crate::damper::curve::Side;
use crate::damper::nominal::Nominal;
use crate::damper::parts::Factors;
use crate::damper::{Done, Instant};

effect_parameters! {
    /// A void on one side.
    Cavitation {
        refill_m_per_s: MetrePerSecond in -100.0 to 100.0, typical 0.3,
            "Velocity up to which the chamber refills, m/s; above zero for a void made in extension, below for one made in compression.";
    }
}

/// The void has a length and the law is slack.
const OPEN: f64 = 1.0;

impl Cavitation {
    /// Direction in which the void is made.
    fn direction(self) -> f64 {
        if self.refill_m_per_s < 0.0 { -1.0 } else { 1.0 }
    }

    /// Length of the void at the end of a piece, unbounded below.
    fn void_m(self, void_m: f64, done: &Done) -> f64 {
        void_m + self.direction() * done.piston_travel_m - self.refill_m_per_s.abs() * done.step_s
    }
}

impl DamperEffect for Cavitation {
    const NAME: &'static str = "cavitation";
    const PLACE: Place = Place::Inboard;
    const EQUATION: &'static str = "L' = s v_p - V >= 0, F_h = 0 while L > 0 and s v_p < 0";
    const SHOWN_BY: &'static str = "Fast large sines and their repetition slower or with more gas pressure, direction declared.";
    const DIRECTIONAL: bool = true;
    const SLOW: Slow = Slow::Body;
    const SWITCHES: bool = true;
    const STARTS: &'static [&'static [f64]] = &[&[-0.3], &[0.05], &[-0.05]];
    const STRONGEST: f64 = 6.0;
    const IN_HYDRAULIC_MODEL: bool = true;

    fn slow(&self, _at: &Instant, memory: &Memory, factors: &mut Factors) {
        let [_, open, ..] = *memory;
        if open == OPEN {
            let extends = self.direction() > 0.0;
            factors.slack = Some(if extends { Side::Negative } else { Side::Positive });
        }
    }

    fn margin(&self, memory: &Memory, done: &Done) -> f64 {
        let [void_m, open, ..] = *memory;
        if open == OPEN {
            self.void_m(void_m, done)
        } else {
            self.refill_m_per_s.abs() - self.direction() * done.piston_velocity_m_per_s
        }
    }

    fn remember(&self, _nominal: &Nominal, memory: &mut Memory, done: &Done) {
        let switched = self.margin(memory, done) < 0.0;
        let [void_m, open, ..] = memory;
        if *open == OPEN {
            *void_m = self.void_m(*void_m, done);
        }
        if switched {
            *void_m = 0.0;
            *open = OPEN - *open;
        }
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let speed = draw.scale.velocity_m_per_s;
        Self { refill_m_per_s: draw.sign * speed * libm::exp(-strength) }
    }

    fn in_service(nominal: &Nominal, _size: f64) -> Self {
        Self { refill_m_per_s: 0.4 * nominal.v_relief_m_per_s() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::effects::SealFriction;
    use crate::damper::{Damper, DamperState, Effect, Motion};

    /// A dashpot on a nearly rigid attachment.
    const STIFF: Nominal = Nominal {
        ce_n_s_per_m: 1e5,
        ke_n_per_m: 1e10,
        clearance_2a_m: 0.0,
        f_relief_n: f64::INFINITY,
        c2_n_s_per_m: 0.0,
    };

    /// Triangles of 60 mm/s over 12 mm: 0.2 s out, 0.2 s back; straight within every step.
    fn triangle(time_s: f64) -> f64 {
        let phase = time_s / 0.2 - 2.0 * libm::floor(time_s / 0.4);
        12e-3 * (1.0 - (1.0 - phase).abs())
    }

    fn forces(effects: &[Effect], step_s: f64, check: impl Fn(f64, f64)) {
        let damper = Damper::new(STIFF, effects).unwrap();
        let mut state = DamperState::rest();
        for i in 1..=(1.2 / step_s) as u32 {
            let t = f64::from(i) * step_s;
            let force = damper.advance(&mut state, Motion::new(triangle(t), 0.0), step_s);
            check(t, force);
        }
    }

    #[test]
    fn void_closes_after_its_length_is_refilled() {
        // Out at 60 mm/s against 20 mm/s of refill: 8 mm; back: gone after 8/(60 + 20) s = 0.1 s.
        for step_s in [1e-3, 3.1e-3, 0.1e-3] {
            for (sign, refill_m_per_s) in [(1.0, 20e-3), (-1.0, -20e-3)] {
                let void = Cavitation { refill_m_per_s };
                forces(&[void.into()], step_s, |t, force| {
                    let phase = t - 0.4 * libm::floor(t / 0.4);
                    // Made in the first half of the period and felt in the second, or the reverse.
                    let slack = if sign > 0.0 { 0.2..0.3 } else { 0.0..0.1 };
                    let first = sign < 0.0 && t < 0.3;
                    let near =
                        |corner: f64| phase > corner - 1e-9 && phase < corner + 1.01 * step_s;
                    if [0.0, 0.1, 0.2, 0.3, 0.4].into_iter().any(near) {
                        return;
                    }
                    let full = if phase < 0.2 { 6e3 } else { -6e3 };
                    let expected = if slack.contains(&phase) && !first { 0.0 } else { full };
                    assert!((force - expected).abs() < 1.0, "{step_s} {sign} {t}: {force}");
                });
            }
        }
    }

    #[test]
    fn friction_stays_in_the_void() {
        let seal = SealFriction { coulomb_n: 300.0, breakaway_ratio: 1.0, stribeck_m_per_s: 0.0 };
        let void = Cavitation { refill_m_per_s: 20e-3 };
        forces(&[seal.into(), void.into()], 1e-3, |t, force| {
            let phase = t - 0.4 * libm::floor(t / 0.4);
            if phase > 0.21 && phase < 0.29 {
                assert!((force + 300.0).abs() < 1e-6, "{t}: {force}");
            }
        });
    }

    #[test]
    fn fast_refill_leaves_no_void() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        for refill_m_per_s in [0.08, -0.08] {
            let void = Cavitation { refill_m_per_s };
            let damper = Damper::new(Nominal::NEW, &[void.into()]).unwrap();
            let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
            for i in 1..=1000 {
                let t = 1e-3 * f64::from(i);
                let motion = Motion::new(3e-3 * libm::sin(22.0 * t), 66e-3 * libm::cos(22.0 * t));
                let force = plain.advance(&mut a, motion, 1e-3);
                assert_eq!(damper.advance(&mut b, motion, 1e-3), force);
            }
        }
    }
}
