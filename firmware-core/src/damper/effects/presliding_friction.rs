//! Friction that gives way before it slides (Dahl), parallel to the whole damper.
//!
//! ```text
//! dz = F_0/x_d (dx - z/F_c |dx|)      F += z      F_c = F_0 (1 + g s) (1 + r exp(-(v/v_s)^2))
//! ```
//!
//! with s = sgn(dx). After a reversal the force runs over along an exponential of the travel and
//! reaches the capacity `F_c` after a few `x_d`; with an even capacity the stiffness at the
//! reversal is 2 `F_c`/`x_d`. No time and no frequency enter. Over a travel in one direction the
//! update is exact,
//!
//! ```text
//! z <- s F_c + (z - s F_c) exp(-|dx|/x_c)      x_c = x_d F_c/F_0
//! ```
//!
//! so that it does not depend on the step; a step in which the velocity reverses has two updates.
//! The capacity depends on the direction and falls with the speed; both are frozen in an update, at
//! its mean speed. z stays within the largest capacity, `F_0` (1 + |g|) (1 + r).
//!
//! The stiffness `F_0`/`x_d` of the contacts does not change with the capacity. So the friction
//! stores `x_d` z^2/(2 `F_0`) and dissipates z^2/`F_c` |dx| in every motion, whatever the capacity
//! does; with a constant `x_c` instead, small motions with unequal capacities would raise z for
//! nothing, and release it as work. A closed loop of the amplitude X with a constant capacity has
//! the area
//!
//! ```text
//! 4 F_c (X - x_d tanh(X/x_d))
//! ```
//!
//! Limits: parallel to the eyes, so that a soft bushing in series counts to `x_d`; no temperature.
//! A record fixes `x_d` if it is longer than about three samples of travel and shorter than a third
//! of the smallest stroke. Look-alikes: `seal_friction` (the limit of a short `x_d`), Ke with a
//! relief (the same with a corner), `rubber_hysteresis` (its loop changes with the frequency) and
//! `entrained_air` (softest at zero force). Source: P. R. Dahl, 1968, with the exponent one.

use super::draw::{Draw, between, decades};
use super::parameter::{Scale, effect_parameters};
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// Friction with an elastic travel before it slides.
    PreslidingFriction {
        capacity_n: Newton in 0.0 to 5.0, typical 0.1,
            "Friction force at high speed after a long travel, mean of both directions, N.";
        travel_m: Metre in 1e-4 to 3.0, typical 0.03,
            "Travel in which 63 % of a change of direction has happened at high speed, m.";
        direction_asymmetry: One in -0.95 to 0.95, typical 0.05,
            "Share by which the capacity is higher in extension and lower in compression.";
        low_speed_rise: One in 0.0 to 5.0, typical 0.1,
            "Capacity at very low speed over that at high speed, less one.";
        stribeck_m_per_s: MetrePerSecond in 1e-3 to 3.0, typical 0.1,
            "Speed at which 37 % of the rise at low speed remains, m/s.";
    }
}

impl PreslidingFriction {
    /// Capacity in a direction at a speed, as a share of that at high speed.
    fn capacity_share(&self, direction: f64, speed_m_per_s: f64) -> f64 {
        let u = speed_m_per_s / self.stribeck_m_per_s;
        let rise = 1.0 + self.low_speed_rise * libm::exp(-u * u);
        (1.0 + direction * self.direction_asymmetry) * rise
    }

    /// The force after a travel in one direction at a mean speed, N.
    ///
    /// ```
    /// use firmware_core::damper::effects::PreslidingFriction;
    /// let friction = PreslidingFriction {
    ///     capacity_n: 1000.0,
    ///     travel_m: 1e-3,
    ///     direction_asymmetry: 0.0,
    ///     low_speed_rise: 0.0,
    ///     stribeck_m_per_s: 0.01,
    /// };
    /// // A reversal from the full capacity: 1000 N (2 exp(-1) - 1) after the travel.
    /// let force_n = friction.after_n(1000.0, -1e-3, 0.05);
    /// assert!((force_n + 264.241).abs() < 1e-3);
    /// ```
    pub fn after_n(&self, force_n: f64, travel_m: f64, speed_m_per_s: f64) -> f64 {
        if travel_m == 0.0 {
            return force_n;
        }
        let direction = if travel_m < 0.0 { -1.0 } else { 1.0 };
        let share = self.capacity_share(direction, speed_m_per_s);
        let toward_n = direction * share * self.capacity_n;
        toward_n + (force_n - toward_n) * libm::exp(-travel_m.abs() / (share * self.travel_m))
    }
}

impl DamperEffect for PreslidingFriction {
    const NAME: &'static str = "presliding_friction";
    const PLACE: Place = Place::Parallel;
    const EQUATION: &'static str =
        "dz = F_0/x_d (dx - z/F_c |dx|), F_c = F_0 (1 + g sgn v) (1 + r exp(-(v/v_s)^2))";
    const SHOWN_BY: &'static str = "Slow triangles of three strokes from a third of x_d upwards, each at two speeds: a rounded reversal that depends on travel and not on time.";
    const NEEDS_RATE_HZ: f64 = 100.0;
    const DIRECTIONAL: bool = true;
    const STARTS: &'static [&'static [f64]] = &[
        &[0.1, 0.3, 0.0, 0.1, 0.1],
        &[0.1, 3e-3, 0.0, 0.1, 0.1],
        &[0.3, 1.0, 0.0, 0.1, 0.3],
        &[0.05, 0.03, 0.0, 1.0, 0.03],
    ];
    const STRONGEST: f64 = 2.0;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn output(&self, memory: &mut Memory, done: &Done, force_n: f64) -> f64 {
        let acceleration = done.acceleration_m_per_s2;
        let (end, step_s) = (done.end_velocity_m_per_s, done.step_s);
        let start = end - acceleration * step_s;
        let [z, ..] = memory;
        if start * end < 0.0 {
            // Each side of the reversal is a parabola from rest: its mean speed is half the end's.
            let before_s = step_s * (start / (start - end));
            for (mean, time_s) in [(0.5 * start, before_s), (0.5 * end, step_s - before_s)] {
                *z = self.after_n(*z, mean * time_s, mean);
            }
        } else {
            let mean = 0.5 * (start + end);
            *z = self.after_n(*z, mean * step_s, mean);
        }
        force_n + *z
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        let Scale { force_n, velocity_m_per_s: speed, displacement_m: stroke_m, .. } = draw.scale;
        let [a, b, c] = draw.shape;
        Self {
            capacity_n: strength * force_n,
            travel_m: stroke_m * decades(a, 3e-3, 0.3),
            direction_asymmetry: draw.sign * between(b, 0.0, 0.3),
            low_speed_rise: between(c, 0.0, 0.5),
            stribeck_m_per_s: 0.1 * speed,
        }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        let (f, v) = (nominal.f_relief_n, nominal.v_relief_m_per_s());
        Self {
            capacity_n: 0.05 * size * f,
            travel_m: 0.3 * nominal.scale().displacement_m,
            direction_asymmetry: 0.1,
            low_speed_rise: 0.3,
            stribeck_m_per_s: 0.3 * v,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion};

    const DAHL: PreslidingFriction = PreslidingFriction {
        capacity_n: 800.0,
        travel_m: 0.4e-3,
        direction_asymmetry: 0.0,
        low_speed_rise: 0.0,
        stribeck_m_per_s: 5e-3,
    };

    /// A damper in a clearance that it never leaves: the friction alone.
    fn alone(friction: PreslidingFriction) -> Damper {
        let nominal = Nominal { clearance_2a_m: 1.0, ..Nominal::NEW };
        Damper::new(nominal, &[friction.into()]).unwrap()
    }

    fn sine(time_s: f64) -> Motion {
        let (sin, cos) = libm::sincos(20.0 * time_s);
        Motion::new(3e-3 * sin, 60e-3 * cos)
    }

    #[test]
    fn loop_has_the_area_of_the_closed_form_at_any_amplitude_and_speed() {
        let damper = alone(DAHL);
        for amplitude_m in [0.05e-3, 0.4e-3, 5e-3] {
            let r = amplitude_m / DAHL.travel_m;
            let area = 4.0 * DAHL.capacity_n * (amplitude_m - DAHL.travel_m * libm::tanh(r));
            for quarter in [40_u32, 4_000] {
                let step_m = amplitude_m / f64::from(quarter);
                let mut state = DamperState::rest();
                let (mut x, mut work) = (0.0, 0.0);
                let cycles = 40;
                for i in 0..cycles * 4 * quarter {
                    let up = (i + quarter) / (2 * quarter) % 2 == 0;
                    let dx = if up { step_m } else { -step_m };
                    x += dx;
                    let before = state.force_n();
                    let after = damper.advance(&mut state, Motion::new(x, 0.0), 1e-3);
                    if i >= (cycles - 1) * 4 * quarter {
                        // The integral of z over dx from the change of z.
                        work += if up { 1.0 } else { -1.0 }
                            * (DAHL.capacity_n * dx - DAHL.travel_m * (after - before));
                    }
                }
                assert!((work / area - 1.0).abs() < 1e-8, "{amplitude_m} {quarter}: {work} {area}");
            }
        }
    }

    #[test]
    fn stiffness_at_a_reversal_is_twice_the_capacity_over_the_travel() {
        let damper = alone(DAHL);
        let mut state = DamperState::rest();
        damper.advance(&mut state, Motion::new(10e-3, 0.0), 1.0);
        assert!((state.force_n() - DAHL.capacity_n).abs() < 1e-6);
        let before = state.force_n();
        damper.advance(&mut state, Motion::new(10e-3 - 1e-9, 0.0), 1e-3);
        let stiffness = (before - state.force_n()) / 1e-9;
        assert!((stiffness / (2.0 * 800.0 / 0.4e-3) - 1.0).abs() < 1e-5, "{stiffness}");
    }

    #[test]
    fn one_step_is_as_good_as_many_across_a_reversal_too() {
        // A parabola that turns at 30 % of the step, whole and in a thousand parts.
        let (v0, a, h) = (0.03, -1.0, 0.1);
        let at = |t: f64| Motion::new(v0 * t + 0.5 * a * t * t, v0 + a * t);
        let start = Motion::new(-1e-3, v0);
        for friction in [DAHL, PreslidingFriction { direction_asymmetry: 0.4, ..DAHL }] {
            let damper = alone(friction);
            let mut whole = DamperState::starting(start);
            damper.advance(&mut whole, at(0.0), 1e-3);
            let mut parts = whole;
            let once = damper.advance(&mut whole, at(h), h);
            for i in 1..=1000 {
                let t = 1e-3 * h * f64::from(i);
                damper.advance(&mut parts, at(t), 1e-3 * h);
            }
            assert!((once - parts.force_n()).abs() < 1e-9 * 800.0, "{once} {}", parts.force_n());
        }
    }

    #[test]
    fn capacity_that_falls_with_speed_converges_with_the_square_of_the_step() {
        let damper = alone(PreslidingFriction { low_speed_rise: 0.6, ..DAHL });
        let forces = |every: u32| {
            let step_s = 0.1e-3 * f64::from(every);
            let mut state = DamperState::starting(sine(0.0));
            (1..=4000 / every)
                .map(|i| damper.advance(&mut state, sine(step_s * f64::from(i)), step_s))
                .enumerate()
                .filter(|(i, _)| (i + 1) % (40 / every) as usize == 0)
                .map(|(_, force)| force)
                .collect::<heapless::Vec<f64, 100>>()
        };
        let fine = forces(1);
        let worst = |every: u32| {
            let apart = forces(every).into_iter().zip(&fine).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max)
        };
        let (coarse, middle) = (worst(40), worst(10));
        assert!(middle < 0.2 * coarse && coarse < 0.02 * 800.0, "{coarse} {middle}");
    }

    #[test]
    fn every_motion_dissipates_whatever_the_capacity_does() {
        // The work is never less than what is stored: over a random walk, and over small motions
        // that are slow one way and fast the other, followed by a release.
        let friction = PreslidingFriction { direction_asymmetry: 0.5, low_speed_rise: 3.0, ..DAHL };
        let work_j = |z: f64, dx: f64, speed: f64| {
            let after = friction.after_n(z, dx, speed);
            let s = dx.signum();
            let share = friction.capacity_share(s, speed);
            // dz = F_0/x_d (dx - z/F_c |dx|): the integral of z over dx from the change of z.
            let work = s * share * (friction.capacity_n * dx - friction.travel_m * (after - z));
            (after, work)
        };
        let stored = |z: f64| 0.5 * friction.travel_m * z * z / friction.capacity_n;
        let (mut z, mut work, mut noise) = (0.0, 0.0, 1_u32);
        for i in 0..20_000_u32 {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let share = f64::from(noise) / f64::from(u32::MAX) - 0.5;
            let (dx, speed) = if i % 2000 < 1000 {
                (1e-3 * share, 0.02 * share.abs())
            } else if i % 2 == 0 {
                (1e-6, 0.0)
            } else {
                (-1e-6, 1.0)
            };
            let (after, more) = work_j(z, dx, speed);
            assert!(more >= stored(after) - stored(z) - 1e-12, "{i}: {more} J");
            (z, work) = (after, work + more);
            assert!(work >= stored(z) - 1e-9, "{i}: {work} J");
        }
    }

    #[test]
    fn force_stays_within_the_largest_capacity_for_any_motion() {
        let friction = PreslidingFriction {
            direction_asymmetry: -0.5,
            low_speed_rise: 2.0,
            stribeck_m_per_s: f64::MIN_POSITIVE,
            ..DAHL
        };
        for stribeck_m_per_s in [f64::MIN_POSITIVE, 1e-3, f64::MAX] {
            for travel_m in [f64::MIN_POSITIVE, 0.4e-3, f64::MAX] {
                let friction = PreslidingFriction { travel_m, stribeck_m_per_s, ..friction };
                let damper = alone(friction);
                let mut state = DamperState::rest();
                let mut noise = 7_u32;
                for i in 0..2000_i32 {
                    noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let share = f64::from(noise) / f64::from(u32::MAX) - 0.5;
                    let size = libm::pow(10.0, f64::from(i % 19 - 12));
                    damper.advance(&mut state, Motion::new(0.4 * share, size * share), 1e-3);
                    let force = state.force_n() - state.chain_force_n();
                    let most = 800.0 * 1.5 * 3.0;
                    assert!(force.abs() <= most * (1.0 + 1e-9), "{stribeck_m_per_s} {i}: {force}");
                }
            }
        }
    }

    #[test]
    fn each_direction_and_speed_has_its_capacity() {
        let friction = PreslidingFriction { direction_asymmetry: 0.3, low_speed_rise: 0.5, ..DAHL };
        let damper = alone(friction);
        for (speed, rise) in [(1e-9, 1.5), (5e-3, 1.0 + 0.5 / core::f64::consts::E), (0.1, 1.0)] {
            for (sign, share) in [(1.0, 1.3), (-1.0, 0.7)] {
                let mut state = DamperState::rest();
                // 100 travels at a constant speed, then back by a millionth of one.
                let step_m = sign * friction.travel_m;
                for i in 1..=100 {
                    let to = Motion::new(step_m * f64::from(i), 0.0);
                    damper.advance(&mut state, to, step_m.abs() / speed);
                }
                let capacity = 800.0 * share * rise;
                let force = state.force_n();
                assert!((force - sign * capacity * (1.0 - 1e-12)).abs() < 1e-6, "{speed}: {force}");
                let back = Motion::new(step_m * (100.0 - 1e-6), 0.0);
                let after = damper.advance(&mut state, back, 1e-6 * step_m.abs() / speed);
                // Both branches have the stiffness of the contacts: 1 + F_c of one over the other.
                let stiffness = (force - after) / (1e-6 * step_m);
                let expected = 800.0 / friction.travel_m * (1.0 + share / (2.0 - share));
                assert!((stiffness / expected - 1.0).abs() < 1e-4, "{speed}: {stiffness}");
            }
        }
    }

    #[test]
    fn short_travel_is_dry_friction_and_no_capacity_is_nothing() {
        let short = alone(PreslidingFriction { travel_m: 1e-9, ..DAHL });
        let none = alone(PreslidingFriction { capacity_n: 0.0, ..DAHL });
        let (mut a, mut b) = (DamperState::starting(sine(0.0)), DamperState::starting(sine(0.0)));
        for i in 1..=1000 {
            let motion = sine(1e-3 * f64::from(i));
            let force = short.advance(&mut a, motion, 1e-3);
            let expected = 800.0 * motion.velocity_m_per_s.signum();
            assert!(motion.velocity_m_per_s.abs() < 2e-3 || (force - expected).abs() < 1e-9);
            assert_eq!(none.advance(&mut b, motion, 1e-3), 0.0);
        }
    }

    #[test]
    fn force_is_continuous_in_every_parameter_up_to_its_bounds() {
        let scale = Scale {
            force_n: 18e3,
            velocity_m_per_s: 0.06,
            displacement_m: 3e-3,
            extension_m: 3e-3,
            compression_m: 3e-3,
        };
        let forces = |values: &[f64]| {
            let damper = alone(PreslidingFriction::from_values(values).unwrap());
            let mut state = DamperState::starting(sine(0.0));
            (1..=600)
                .map(|i| damper.advance(&mut state, sine(1e-3 * f64::from(i)), 1e-3))
                .collect::<heapless::Vec<f64, 600>>()
        };
        let rows = <PreslidingFriction as super::super::Table>::PARAMETERS;
        let usual: heapless::Vec<f64, 5> = rows.iter().map(|row| row.usual(&scale)).collect();
        for (i, row) in rows.iter().enumerate() {
            let (lower, upper) = row.bounds(&scale);
            for at in [lower, usual[i], upper] {
                let step = |share: f64| {
                    let by = 2e-3 * share * if at == 0.0 { usual[i] } else { at.abs() };
                    let by = if at == upper { -by } else { by };
                    let (mut here, mut there) = (usual.clone(), usual.clone());
                    (here[i], there[i]) = (at, at + by);
                    let (here, there) = (forces(&here), forces(&there));
                    let squares = here.iter().zip(&there).map(|(a, b)| (a - b) * (a - b));
                    crate::sqrt::sqrt(squares.sum::<f64>())
                };
                let (whole, half) = (step(1.0), step(0.5));
                assert!(whole > 0.0, "{} at {at}: flat", row.name);
                assert!((half / whole - 0.5).abs() < 0.05, "{} at {at}: {half} {whole}", row.name);
            }
        }
    }
}
