//! Force in, motion out: records of a body whose law is known, from integrators that share nothing
//! with the product.

use identification::on_mass::{
    OnMass, OnMassControl, OnMassQuestion, OnMassVerdict, identify_on_mass, on_mass_page,
};
use measurement::body_record::{BodyRecord, BodyStart, InterSample, OnMass as Drive, Output};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;
use std::path::PathBuf;

const RATE_HZ: f64 = 750.0;
const PERIOD: usize = 300;
/// Runge-Kutta steps per sample.
const STEPS: u32 = 40;
const MASS_KG: f64 = 2.0;
const K0: f64 = 5e4;
const C0: f64 = 40.0;

/// A multisine of 7.5 to 150 Hz, N.
fn multisine(seed: u64, rms_n: f64) -> impl Fn(f64) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let length_s = PERIOD as f64 / RATE_HZ;
    let tones: Vec<(f64, f64)> =
        (3..=60).map(|line| (TAU * f64::from(line) / length_s, TAU * draw(&mut random))).collect();
    let size = rms_n * libm::sqrt(2.0 / tones.len() as f64);
    let at = |t: f64| tones.iter().map(|(omega, phase)| size * libm::cos(omega * t + phase)).sum();
    // Of one period, at every time that a Runge-Kutta step looks at.
    let places = 2 * STEPS as usize * PERIOD;
    let place_s = length_s / places as f64;
    let table: Vec<f64> = (0..places).map(|place| at(place as f64 * place_s)).collect();
    move |t: f64| table[(t / place_s).round() as usize % places]
}

/// Uniform in 0 to 1.
fn draw(random: &mut ChaCha8Rng) -> f64 {
    f64::from(random.next_u32()) / f64::from(u32::MAX)
}

/// Normal with a standard deviation of one.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| draw(random)).sum::<f64>() - 6.0
}

/// The motion at every sample under `force`, by the classical Runge-Kutta method with [`STEPS`] per
/// sample. `law` gives the rate of the internal force `z`, and what is added to it.
fn motion(
    force: &dyn Fn(f64) -> f64,
    samples: usize,
    law: &dyn Fn(f64, f64, f64) -> (f64, f64),
    output: Output,
) -> Vec<f64> {
    let h = 1.0 / (RATE_HZ * f64::from(STEPS));
    let rates = |t: f64, [y, v, z]: [f64; 3]| {
        let (rate, added) = law(y, v, z);
        [v, (force(t) - K0 * y - C0 * v - z - added) / MASS_KG, rate]
    };
    let moved = |s: [f64; 3], r: [f64; 3], h: f64| std::array::from_fn(|n| s[n] + h * r[n]);
    let mut state = [0.0; 3];
    let mut all = Vec::with_capacity(samples);
    for sample in 0..samples {
        all.push(match output {
            Output::Displacement => state[0],
            Output::Acceleration => rates(sample as f64 / RATE_HZ, state)[1],
        });
        for step in 0..STEPS {
            let t = sample as f64 / RATE_HZ + h * f64::from(step);
            let k1 = rates(t, state);
            let k2 = rates(t + 0.5 * h, moved(state, k1, 0.5 * h));
            let k3 = rates(t + 0.5 * h, moved(state, k2, 0.5 * h));
            let k4 = rates(t + h, moved(state, k3, h));
            let mean = std::array::from_fn(|n| (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]) / 6.0);
            state = moved(state, mean, h);
        }
    }
    all
}

/// A periodic record of `periods` periods after eight that settle, with noise.
fn record(
    name: &str,
    seed: u64,
    periods: usize,
    noise_m: f64,
    law: &dyn Fn(f64, f64, f64) -> (f64, f64),
) -> BodyRecord {
    let force = multisine(seed, 60.0);
    let settle = 8 * PERIOD;
    let samples = settle + periods * PERIOD;
    let mut random = ChaCha8Rng::seed_from_u64(100 + seed);
    let clean = motion(&force, samples, law, Output::Displacement);
    BodyRecord {
        name: name.to_owned(),
        file: PathBuf::from(format!("{name}.csv")),
        step_s: 1.0 / RATE_HZ,
        force_n: (settle..samples).map(|n| force(n as f64 / RATE_HZ)).collect(),
        output: Output::Displacement,
        motion: clean[settle..].iter().map(|y| y + noise_m * normal(&mut random)).collect(),
        drive: Drive {
            inter_sample: InterSample::BandLimited,
            start: Some(BodyStart::Periodic),
            period_samples: Some(PERIOD),
        },
        repairs: Vec::new(),
    }
}

fn identified(law: &dyn Fn(f64, f64, f64) -> (f64, f64)) -> OnMass {
    let question = OnMassQuestion {
        train: vec![record("train", 1, 4, 5e-6, law)],
        holdout: vec![record("test", 2, 1, 0.0, law)],
        datasheet: None,
        notes: Vec::new(),
    };
    identify_on_mass(&question, OnMassControl::QUIET).unwrap()
}

fn gain_of(found: &OnMass, law: &str) -> f64 {
    let first = &found.result.rounds[0];
    let row = first.candidates.iter().find(|row| row.name == law).unwrap();
    row.gain.or(row.fitted_gain).unwrap()
}

#[test]
fn hysteresis_is_named_from_a_linear_body_and_dry_friction_is_not() {
    let (a, b1, b2) = (5e4, 800.0, -1100.0);
    let law = |_: f64, v: f64, z: f64| (a * v - b1 * v.abs() * z - b2 * v * z.abs(), 0.0);
    let found = identified(&law);
    let result = &found.result;
    let names: Vec<&str> = result.laws.iter().map(|law| law.name).collect();
    assert_eq!(names, ["bouc_wen"], "{}", found.summary());
    assert_eq!(result.verdict, OnMassVerdict::EffectsFound, "{}", found.summary());
    for (name, truth) in [("a_n_per_m", a), ("b1_per_m", b1), ("b2_per_m", b2)] {
        let value = result.laws[0].parameters[name].value;
        assert!((value / truth - 1.0).abs() < 0.05, "{name} = {value}");
    }
    assert!(result.laws[0].remark.as_deref().unwrap().contains("not passive"));
    assert!((result.body["mass_kg"].value / MASS_KG - 1.0).abs() < 5e-3, "{:?}", result.body);
    // Four periods averaged: the noise of a single one over two.
    let floor = result.noise_floor.unwrap();
    assert!((floor / 2.5e-6 - 1.0).abs() < 0.1, "{floor}");
    let test = result.per_record.iter().find(|row| row.role == "holdout").unwrap();
    let (first, kept) = (test.first_rms.unwrap(), test.kept_rms.unwrap());
    assert!(kept < 0.02 * first && kept < floor, "{first} {kept}");
    assert!(gain_of(&found, "dry_friction") < 0.01, "{:?}", result.rounds[0]);
    let html = on_mass_page(&found).to_html().unwrap();
    assert!(html.contains("bouc_wen") && html.contains("Candidates of motion"));
    assert_eq!(found.predictions().count(), 2);
    assert_eq!(found.model_text(), None);
}

#[test]
fn a_linear_body_is_found_from_its_acceleration() {
    let linear = |_: f64, _: f64, _: f64| (0.0, 0.0);
    let mut train = record("train", 1, 3, 0.0, &linear);
    let settle = 8 * PERIOD;
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let clean = motion(&multisine(1, 60.0), settle + 3 * PERIOD, &linear, Output::Acceleration);
    train.motion = clean[settle..].iter().map(|a| a + 0.1 * normal(&mut random)).collect();
    train.output = Output::Acceleration;
    let question = OnMassQuestion {
        train: vec![train],
        holdout: Vec::new(),
        datasheet: None,
        notes: Vec::new(),
    };
    let found = identify_on_mass(&question, OnMassControl::QUIET).unwrap();
    let result = &found.result;
    assert_eq!(result.verdict, OnMassVerdict::NoMissingEffect, "{}", found.summary());
    assert_eq!((result.unit, result.output), ("m/s2", "acceleration"));
    for (name, truth) in [("mass_kg", MASS_KG), ("k0_n_per_m", K0), ("c0_n_s_per_m", C0)] {
        let miss = (result.body[name].value - truth).abs();
        assert!(miss < 5.0 * result.body[name].std.unwrap() + 1e-3 * truth, "{}", found.summary());
    }
}

#[test]
fn a_linear_body_misses_nothing() {
    let found = identified(&|_, _, _| (0.0, 0.0));
    let result = &found.result;
    assert_eq!(result.verdict, OnMassVerdict::NoMissingEffect, "{}", found.summary());
    assert!(result.laws.is_empty() && result.cut.is_empty(), "{}", found.summary());
    let test = result.per_record.iter().find(|row| row.role == "holdout").unwrap();
    assert!(test.kept_rms.unwrap() < 2e-6, "{}", found.summary());
    for (name, truth) in [("mass_kg", MASS_KG), ("k0_n_per_m", K0), ("c0_n_s_per_m", C0)] {
        let found = &result.body[name];
        let miss = (found.value - truth).abs();
        assert!(miss < 5.0 * found.std.unwrap() + 1e-3 * truth, "{name}: {found:?}");
    }
}

/// A record of a linear body under half as much force again that the record does not hold.
fn with_hidden_force(name: &str, seed: u64) -> BodyRecord {
    let linear = |_: f64, _: f64, _: f64| (0.0, 0.0);
    let mut known = record(name, seed, 4, 5e-6, &linear);
    let hidden = record("hidden", seed + 50, 4, 0.0, &linear);
    for (motion, more) in known.motion.iter_mut().zip(&hidden.motion) {
        *motion += 0.5 * more;
    }
    known
}

#[test]
fn an_input_that_was_not_recorded_is_unexplained_and_no_law_passes_the_hold_out() {
    let question = OnMassQuestion {
        train: vec![with_hidden_force("train", 1)],
        holdout: vec![with_hidden_force("test", 2)],
        datasheet: None,
        notes: Vec::new(),
    };
    let found = identify_on_mass(&question, OnMassControl::QUIET).unwrap();
    assert_eq!(found.result.verdict, OnMassVerdict::Unexplained, "{}", found.summary());
    assert!(found.result.unexplained.as_ref().unwrap().rms > 5e-5, "{}", found.summary());
}

/// A mass of 200 kg that falls onto a damper at 0.8 m/s: clearance, stiffness, dashpot with relief.
/// Runge-Kutta for the body, the dashpot's own displacement as third state.
fn drop_record(name: &str, speed_m_per_s: f64) -> BodyRecord {
    let (ce, ke, clearance, relief, c2) = (2e4, 3e6, 1e-3, 6e3, 3e3);
    let (mass, weight) = (200.0, 200.0 * 9.81);
    let spring = |e: f64| {
        let half = 0.5 * clearance;
        ke * if e > half {
            e - half
        } else if e < -half {
            e + half
        } else {
            0.0
        }
    };
    let dashpot = |f: f64| {
        let beyond = f.abs() - relief;
        if beyond > 0.0 { f.signum() * (relief / ce + beyond / c2) } else { f / ce }
    };
    // A light spring carries the weight in the end.
    let k0 = 4e4;
    let rates = |[y, v, p]: [f64; 3]| {
        let force = spring(y - p);
        [v, (weight - k0 * y - force) / mass, dashpot(force)]
    };
    let moved = |s: [f64; 3], r: [f64; 3], h: f64| std::array::from_fn(|n| s[n] + h * r[n]);
    let (rate_hz, samples, steps) = (1000.0, 400, 50);
    let h = 1.0 / (rate_hz * f64::from(steps));
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut state = [0.0, speed_m_per_s, 0.0];
    let mut motion = Vec::new();
    for _ in 0..samples {
        motion.push(state[0] + 2e-6 * normal(&mut random));
        for _ in 0..steps {
            let k1 = rates(state);
            let k2 = rates(moved(state, k1, 0.5 * h));
            let k3 = rates(moved(state, k2, 0.5 * h));
            let k4 = rates(moved(state, k3, h));
            let mean = std::array::from_fn(|n| (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]) / 6.0);
            state = moved(state, mean, h);
        }
    }
    BodyRecord {
        name: name.to_owned(),
        file: PathBuf::from(format!("{name}.csv")),
        step_s: 1.0 / rate_hz,
        force_n: vec![weight; samples],
        output: Output::Displacement,
        motion,
        drive: Drive { start: Some(BodyStart::Moving), ..Drive::default() },
        repairs: Vec::new(),
    }
}

#[test]
fn a_drop_tower_gives_the_damper_back() {
    let sheet = firmware_core::damper::Nominal {
        ce_n_s_per_m: 2.4e4,
        ke_n_per_m: 2.5e6,
        clearance_2a_m: 0.5e-3,
        f_relief_n: 5e3,
        c2_n_s_per_m: 4e3,
    };
    let question = OnMassQuestion {
        train: vec![drop_record("drop-0.8", 0.8), drop_record("drop-0.3", 0.3)],
        holdout: vec![drop_record("drop-0.5", 0.5)],
        datasheet: Some(sheet),
        notes: Vec::new(),
    };
    let found = identify_on_mass(&question, OnMassControl::QUIET).unwrap();
    let result = &found.result;
    assert!(result.laws[0].given && result.laws.len() == 1, "{}", found.summary());
    // Nothing repeats itself: no noise floor, and the program says so.
    assert_eq!(result.noise_floor, None);
    assert_eq!(result.verdict, OnMassVerdict::NotJudged, "{}", found.summary());
    // Within four standard deviations, and these are small.
    let truth = [
        ("ce_n_s_per_m", 2e4, 0.02),
        ("ke_n_per_m", 3e6, 0.02),
        ("clearance_2a_m", 1e-3, 0.05),
        ("f_relief_n", 6e3, 0.02),
        ("c2_n_s_per_m", 3e3, 0.1),
    ];
    for (name, truth, share) in truth {
        let found_value = &result.laws[0].parameters[name];
        let (miss, std) = ((found_value.value - truth).abs(), found_value.std.unwrap());
        assert!(miss < 4.0 * std && std < share * truth, "{name}\n{}", found.summary());
    }
    let test = result.per_record.iter().find(|row| row.role == "holdout").unwrap();
    assert!(test.kept_rms.unwrap() < 1e-5, "{}", found.summary());
    assert!(found.model_text().unwrap().contains("ce_n_s_per_m"));
}
