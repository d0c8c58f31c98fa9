//! Properties that hold for every damper: work is dissipated, the clearance carries no force, a
//! symmetric damper is odd to the bit, a state can be kept and restored, nothing diverges.

use crate::reference::{EXCITATIONS, rms, simulate};
use crate::sizes::{catalogue_at, effects_at};
use firmware_core::damper::effects::{
    Cavitation, PositionDependentDamping, PreslidingFriction, RubberHysteresis, SealFriction,
};
use firmware_core::damper::{Damper, DamperError, DamperState, Effect, Motion, Nominal};

/// Numbers from 0 to 1 (xorshift64*), enough to scatter parameters.
struct Scatter(u64);

impl Scatter {
    fn seeded(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between `low` and `high`, evenly in the logarithm.
    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.next())
    }

    /// A damper between 25 N and 2 MN.
    fn nominal(&mut self) -> Nominal {
        let f_relief_n = self.log(25.0, 2e6);
        let ce_n_s_per_m = f_relief_n / self.log(2e-3, 0.2);
        Nominal {
            ce_n_s_per_m,
            ke_n_per_m: f_relief_n / self.log(1e-5, 3e-3),
            clearance_2a_m: if self.next() < 0.3 { 0.0 } else { self.log(1e-5, 3e-3) },
            f_relief_n,
            c2_n_s_per_m: if self.next() < 0.2 { 0.0 } else { ce_n_s_per_m * self.log(1e-3, 1.0) },
        }
    }
}

/// Friction, asymmetry, position, rubber.
const FIRST: [&str; 4] =
    ["seal_friction", "asymmetric_damping", "position_dependent_damping", "rubber_hysteresis"];
/// Valves, yield, gas, air, stiffening, fixture, stroke, foam, wear, warm oil.
const INSIDE: [&str; 12] = [
    "quadratic_orifice",
    "orifice_leakage",
    "second_valve_stage",
    "soft_yield",
    "temperature_fade",
    "gas_preload",
    "stiffening_attachment",
    "entrained_air",
    "fixture_compliance",
    "stroke_dependent_stiffness",
    "aeration_memory",
    "clearance_growth",
];
/// Blows, mass, stops, friction between the eyes, the sensor.
const OUTSIDE: [&str; 6] = [
    "clearance_impact",
    "moving_mass",
    "bump_stop",
    "presliding_friction",
    "force_offset",
    "sensor_delay",
];

/// A void made in extension, with all that acts outside of the chain.
fn void_and_outside(nominal: &Nominal) -> Vec<Effect> {
    let refill_m_per_s = 0.4 * nominal.v_relief_m_per_s();
    let mut effects: Vec<Effect> = vec![Cavitation { refill_m_per_s }.into()];
    effects.extend(effects_at(OUTSIDE, nominal, 1.0));
    effects
}

/// No effect, each, each pair, all.
fn combinations(effects: &[Effect]) -> Vec<Vec<Effect>> {
    let mut all = vec![vec![], effects.to_vec()];
    for (i, &a) in effects.iter().enumerate() {
        all.push(vec![a]);
        all.extend(effects[i + 1..].iter().map(|&b| vec![a, b]));
    }
    all
}

#[test]
fn work_is_dissipated_and_force_stays_bounded() {
    for seed in 1..=25 {
        let mut scatter = Scatter::seeded(seed);
        let nominal = scatter.nominal();
        let size = 3.0 * scatter.next();
        let amplitude = scatter.log(1e-3, 20e-3);
        let w = scatter.log(1.0, 60.0);
        let per_cycle = (6.3 / w / 1e-3) as u32;
        for effects in combinations(&effects_at(FIRST, &nominal, size)) {
            let damper = Damper::new(nominal, &effects).unwrap();
            let mut state = DamperState::starting(Motion::new(0.0, amplitude * w));
            let step_s = 2.0 * std::f64::consts::PI / w / f64::from(per_cycle);
            let (mut work, mut last, mut largest) = (0.0, 0.0, 0.0_f64);
            for i in 1..=6 * per_cycle {
                let t = f64::from(i) * step_s;
                let motion =
                    Motion::new(amplitude * libm::sin(w * t), amplitude * w * libm::cos(w * t));
                let before = state.motion().displacement_m;
                let force = damper.advance(&mut state, motion, step_s);
                assert!(force.is_finite());
                if i > 4 * per_cycle {
                    work += 0.5 * (force + last) * (motion.displacement_m - before);
                }
                largest = largest.max(force.abs());
                last = force;
            }
            let names: Vec<_> = effects.iter().map(Effect::name).collect();
            let context = format!("seed {seed}, {nominal:?}, {names:?}");
            let steady = damper.steady_force_n(amplitude * w);
            assert!(work >= -1e-9 * largest * amplitude, "{context}: {work} J");
            assert!(largest <= 8.0 * steady, "{context}: {largest} N over {steady} N");
            assert_eq!(state.fallbacks(), 0, "{context}");
        }
    }
}

#[test]
fn symmetric_dampers_are_odd_to_the_bit() {
    for seed in 1..=20 {
        let mut scatter = Scatter::seeded(seed);
        let nominal = scatter.nominal();
        let [friction, _, _, rubber] = effects_at(FIRST, &nominal, 1.0);
        let folded: Effect = SealFriction {
            coulomb_n: 0.03 * nominal.f_relief_n,
            breakaway_ratio: 2.0,
            stribeck_m_per_s: 1e-3 * nominal.v_relief_m_per_s(),
        }
        .into();
        let bore: Effect =
            PositionDependentDamping { gradient_per_m: 0.0, curvature_per_m2: 900.0 }.into();
        let [impact, mass, .., delay] = effects_at(OUTSIDE, &nominal, 1.0);
        let [quadratic, leak, stage, soft, fade, _, stiffening, air, fixture, _, foam, wear] =
            effects_at(INSIDE, &nominal, 1.0);
        let rubbing: Effect = PreslidingFriction {
            capacity_n: 0.1 * nominal.f_relief_n,
            travel_m: 1e-4,
            direction_asymmetry: 0.0,
            low_speed_rise: 0.5,
            stribeck_m_per_s: 1e-3,
        }
        .into();
        let sets = [
            vec![],
            vec![friction],
            vec![rubber],
            vec![bore],
            vec![folded, rubber, bore],
            vec![impact, mass, delay],
            vec![quadratic, leak, stage, fade],
            vec![stiffening, rubber, air, fixture],
            vec![stage, air, foam, wear],
            vec![soft, rubbing],
        ];
        for effects in sets {
            let damper = Damper::new(nominal, &effects).unwrap().prepared(1e-3);
            let (mut left, mut right) = (DamperState::rest(), DamperState::rest());
            let (mut x, mut v) = (0.0, 0.0);
            for step in 0..2000 {
                v += 0.02 * (scatter.next() - 0.5) - 0.01 * v - 0.5 * x;
                x += 1e-3 * v;
                let a = damper.advance(&mut left, Motion::new(x, v), 1e-3);
                let b = damper.advance(&mut right, Motion::new(-x, -v), 1e-3);
                assert!(a == -b, "seed {seed}, step {step}: {a} {b}");
            }
        }
    }
}

#[test]
fn clearance_carries_no_force() {
    let damper = Damper::new(Nominal { clearance_2a_m: 4e-3, ..Nominal::NEW }, &[]).unwrap();
    let mut state = DamperState::rest();
    for i in 0..5000 {
        let t = f64::from(i) * 1e-3;
        let motion = Motion::new(1.999e-3 * libm::sin(9.0 * t), 0.018 * libm::cos(9.0 * t));
        assert_eq!(damper.advance(&mut state, motion, 1e-3), 0.0);
        assert!(state.piston_m().abs() < 1e-15);
    }
}

#[test]
fn held_damper_relaxes_to_its_dry_friction() {
    // Held after a stroke, the dashpot empties the spring with Ce/Ke = 80 ms; friction keeps a
    // rest.
    let friction = SealFriction { coulomb_n: 500.0, breakaway_ratio: 1.2, stribeck_m_per_s: 1e-3 };
    for (effects, rest_n) in [(vec![], 0.0), (vec![friction.into()], 600.0)] {
        let damper = Damper::new(Nominal::NEW, &effects).unwrap();
        let mut state = DamperState::rest();
        damper.advance(&mut state, Motion::new(1e-3, 0.0), 1e-2);
        let mut force_n = 0.0;
        for _ in 0..5000 {
            force_n = damper.advance(&mut state, Motion::new(1e-3, 0.0), 1e-3);
        }
        assert!((force_n - rest_n).abs() < 1e-6, "{force_n}");
    }
}

#[test]
fn hard_cap_agrees_with_ever_smaller_steps() {
    let nominal = Nominal { c2_n_s_per_m: 0.0, ..Nominal::NEW };
    for effects in combinations(&effects_at(FIRST, &nominal, 1.0)) {
        let damper = Damper::new(nominal, &effects).unwrap();
        for excitation in &EXCITATIONS {
            let fine: Vec<f64> =
                simulate(&damper, excitation, 20).into_iter().skip(49).step_by(50).collect();
            let coarse = simulate(&damper, excitation, 1000);
            let miss: Vec<f64> = fine.iter().zip(&coarse).map(|(a, b)| a - b).collect();
            let error = rms(&miss) / rms(&fine);
            let names: Vec<_> = effects.iter().map(Effect::name).collect();
            assert!(error < 5e-4, "{} {names:?}: {error}", excitation.name);
        }
    }
}

#[test]
fn state_is_kept_restored_and_split() {
    let effects = effects_at(FIRST, &Nominal::NEW, 1.0);
    let damper = Damper::new(Nominal::NEW, &effects).unwrap();
    let prepared = damper.clone().prepared(1e-3);
    let at = |i: u32| EXCITATIONS[3].motion(f64::from(i) * 1e-3);
    let mut state = DamperState::starting(at(0));
    let mut other = state;
    for i in 1..=400 {
        damper.advance(&mut state, at(i), 1e-3);
        prepared.advance(&mut other, at(i), 1e-3);
        assert_eq!(state, other);
    }
    let kept = state;
    let ahead: Vec<f64> = (401..800).map(|i| damper.advance(&mut state, at(i), 1e-3)).collect();
    let mut restored = kept;
    let again: Vec<f64> = (401..800).map(|i| damper.advance(&mut restored, at(i), 1e-3)).collect();
    assert_eq!(ahead, again);
}

#[test]
fn late_and_switching_dampers_are_kept_and_restored() {
    let damper = Damper::new(Nominal::NEW, &void_and_outside(&Nominal::NEW)).unwrap();
    let prepared = damper.clone().prepared(1e-3);
    for excitation in &EXCITATIONS {
        let at = |i: u32| excitation.motion(f64::from(i) * 1e-3);
        let mut state = DamperState::starting(at(0));
        let mut other = state;
        for i in 1..=333 {
            damper.advance(&mut state, at(i), 1e-3);
            prepared.advance(&mut other, at(i), 1e-3);
            assert_eq!(state, other);
        }
        let mut kept = state;
        let ahead: Vec<f64> = (334..700).map(|i| damper.advance(&mut state, at(i), 1e-3)).collect();
        let again: Vec<f64> = (334..700).map(|i| damper.advance(&mut kept, at(i), 1e-3)).collect();
        assert_eq!(ahead, again);
        assert_eq!(state, kept);
    }
}

#[test]
fn no_effect_generates_energy() {
    for seed in 1..=25 {
        let mut scatter = Scatter::seeded(seed);
        let nominal = scatter.nominal();
        let amplitude = scatter.log(1e-3, 20e-3);
        let w = scatter.log(1.0, 60.0);
        let per_cycle = (6.3 / w / 1e-3) as u32;
        let mut effects = void_and_outside(&nominal);
        // A delayed force generates energy where the damper acts as a spring; this is expected.
        effects.pop();
        let mut sets = combinations(&effects);
        sets.extend(effects_at(INSIDE, &nominal, 1.0).map(|effect| vec![effect]));
        for effects in sets {
            let damper = Damper::new(nominal, &effects).unwrap();
            let mut state = DamperState::starting(Motion::new(0.0, amplitude * w));
            let step_s = 2.0 * std::f64::consts::PI / w / f64::from(per_cycle);
            let (mut work, mut last, mut largest) = (0.0, 0.0, 0.0_f64);
            for i in 1..=6 * per_cycle {
                let t = f64::from(i) * step_s;
                let motion =
                    Motion::new(amplitude * libm::sin(w * t), amplitude * w * libm::cos(w * t));
                let before = state.motion().displacement_m;
                let force = damper.advance(&mut state, motion, step_s);
                if i > 4 * per_cycle {
                    work += 0.5 * (force + last) * (motion.displacement_m - before);
                }
                largest = largest.max(force.abs());
                last = force;
            }
            let names: Vec<_> = effects.iter().map(Effect::name).collect();
            let context = format!("seed {seed}, {nominal:?}, {names:?}");
            assert!(work >= -1e-4 * largest * amplitude, "{context}: {work} J");
            assert_eq!(state.fallbacks(), 0, "{context}");
        }
    }
}

#[test]
fn order_of_effects_does_not_matter() {
    let mut effects = effects_at(FIRST, &Nominal::NEW, 1.0);
    let forward = Damper::new(Nominal::NEW, &effects).unwrap();
    effects.reverse();
    assert_eq!(forward, Damper::new(Nominal::NEW, &effects).unwrap());
}

#[test]
fn senseless_steps_move_nothing() {
    let damper = Damper::new(Nominal::NEW, &[]).unwrap();
    let mut state = DamperState::rest();
    let force_n = damper.advance(&mut state, Motion::new(1e-3, 0.0), 1e-3);
    let before = state;
    let bad =
        [(f64::NAN, 0.0, 1e-3), (0.0, f64::INFINITY, 1e-3), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)];
    for (x, v, step_s) in bad {
        assert_eq!(damper.advance(&mut state, Motion::new(x, v), step_s), force_n);
    }
    assert_eq!(state.fallbacks(), 4);
    assert_eq!(state.motion(), before.motion());
    assert_eq!(state.piston_m(), before.piston_m());
}

#[test]
fn absurd_motion_stays_bounded_and_finite() {
    let inside = effects_at(FIRST, &Nominal::NEW, 1.0);
    let mut sets = combinations(&inside);
    sets.extend(combinations(&void_and_outside(&Nominal::NEW)));
    for effects in sets {
        let damper = Damper::new(Nominal::NEW, &effects).unwrap();
        let mut state = DamperState::rest();
        let mut scatter = Scatter::seeded(77);
        for _ in 0..3000 {
            let x = 2.0 * (scatter.next() - 0.5) * scatter.log(1e-9, 10.0);
            let v = 2.0 * (scatter.next() - 0.5) * scatter.log(1e-9, 1e4);
            let step_s = scatter.log(1e-6, 10.0);
            assert!(damper.advance(&mut state, Motion::new(x, v), step_s).is_finite());
        }
    }
}

#[test]
fn every_three_effects_fit_together() {
    // No three are refused without a reason; what the tables cannot hold is refused by name
    // (`law`).
    let viscous = Nominal { f_relief_n: f64::INFINITY, ..Nominal::NEW };
    let capped = Nominal { c2_n_s_per_m: 0.0, clearance_2a_m: 0.0, ..Nominal::NEW };
    for nominal in [Nominal::NEW, viscous, capped] {
        for size in [1.0, 3.0] {
            let effects = catalogue_at(&Nominal::NEW, size);
            for (i, a) in effects.iter().enumerate() {
                for (j, b) in effects.iter().enumerate().skip(i + 1) {
                    for c in &effects[j + 1..] {
                        let names = [a.name(), b.name(), c.name()];
                        assert!(Damper::new(nominal, &[*a, *b, *c]).is_ok(), "{names:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn every_pair_stays_finite_in_absurd_motion() {
    let effects = catalogue_at(&Nominal::NEW, 3.0);
    for (i, a) in effects.iter().enumerate() {
        for b in &effects[i + 1..] {
            let damper = Damper::new(Nominal::NEW, &[*a, *b]).unwrap();
            let mut state = DamperState::rest();
            let mut scatter = Scatter::seeded(91);
            for _ in 0..200 {
                let x = 2.0 * (scatter.next() - 0.5) * scatter.log(1e-9, 10.0);
                let v = 2.0 * (scatter.next() - 0.5) * scatter.log(1e-9, 1e4);
                let step_s = scatter.log(1e-6, 10.0);
                let force = damper.advance(&mut state, Motion::new(x, v), step_s);
                assert!(force.is_finite(), "{} {}", a.name(), b.name());
            }
        }
    }
}

#[test]
fn impossible_dampers_are_refused_by_name() {
    let rubber: Effect =
        RubberHysteresis { dynamic_stiffening: 0.2, relaxation_time_s: 5e-3 }.into();
    assert_eq!(
        Damper::new(Nominal::NEW, &[rubber, rubber]),
        Err(DamperError::RepeatedEffect { effect: "rubber_hysteresis" })
    );
    let bad: Effect = RubberHysteresis { dynamic_stiffening: 0.2, relaxation_time_s: -1.0 }.into();
    let error = Damper::new(Nominal::NEW, &[bad]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "rubber_hysteresis: relaxation_time_s = -1 is outside 0.00001 to 100"
    );
}

#[test]
fn endless_events_end_in_the_counted_fallback() {
    // Stick-slip hundreds of times within one step of ten seconds.
    let oil = Nominal { ce_n_s_per_m: 1e4, clearance_2a_m: 0.0, ..Nominal::NEW };
    let seal = SealFriction { coulomb_n: 400.0, breakaway_ratio: 1.5, stribeck_m_per_s: 1e-3 };
    let damper = Damper::new(oil, &[seal.into()]).unwrap();
    let mut state = DamperState::starting(Motion::new(0.0, 1e-4));
    let force_n = damper.advance(&mut state, Motion::new(1e-3, 1e-4), 10.0);
    assert_eq!(state.fallbacks(), 1);
    assert!((400.0..=600.0).contains(&force_n), "{force_n}");
}
