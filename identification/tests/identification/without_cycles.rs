//! Records of random motion, where no cycle repeats: the noise floor is unknown, and the verdict
//! must come from the residual itself.

use crate::support::{SERIES, names};
use identification::result::{IdentifyResult, Verdict};
use identification::{Control, Question, identify};
use measurement::{Measurement, Series};
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::protocol::{Test, service};
use virtual_bench::bench_visit::sensors::{Channel, Coloured, Sensors};
use virtual_bench::bench_visit::{NullGenerator, record};
use virtual_bench::series_model::SeriesModel;

/// White noise of the load cell, N.
const NOISE_N: f64 = 60.0;

fn sensors() -> Sensors {
    let of_range = Sensors::of_range(50e3, 0.05);
    Sensors {
        rate_hz: 500.0,
        anti_alias_hz: None,
        force: Channel { noise: NOISE_N, ..of_range.force },
        ..of_range
    }
}

/// Random motion of 3 mm rms, a test for each seed of its motion, with noises of their own.
fn records(model: SeriesModel, sensors: &Sensors, seeds: &[u64]) -> Vec<Measurement> {
    let specimen = NullGenerator { model, outside: Vec::new() };
    let each = seeds.iter().enumerate().map(|(index, seed)| {
        let motion = service(3e-3, 0.3, 4.0, 24, *seed);
        let test = Test::new(format!("random-{index}"), motion, 12.0);
        record(&specimen, &test, sensors, 70 + index as u64).measurement().unwrap()
    });
    each.collect()
}

fn result_of(mut train: Vec<Measurement>) -> IdentifyResult {
    let holdout = vec![train.pop().unwrap()];
    let question = Question {
        train,
        holdout,
        datasheet: None,
        empirical: false,
        thorough: false,
        notes: Vec::new(),
    };
    let found = identify(question, Control::QUIET).unwrap();
    println!("{}: {:?} {:?}", found.result.sentence(), found.result.questions, names(&found));
    found.result
}

#[test]
fn a_clean_damper_is_clean_though_its_noise_floor_is_unknown() {
    // A wide clearance turns a micrometre of displacement noise into noise that grows with the
    // force.
    let worn = SeriesModel { clearance_2a_m: 4e-3, ..SERIES };
    for (model, coloured) in
        [(worn, None), (SERIES, Some(Coloured { level_n: 60.0, rho_per_ms: 0.95 }))]
    {
        let sensors = Sensors { coloured, ..sensors() };
        let result = result_of(records(model, &sensors, &[1, 2, 3, 4, 5]));
        assert_eq!(result.verdict, Verdict::NoMissingEffect, "{result:?}");
        assert_eq!(result.noise_floor_n, None);
        if coloured.is_none() {
            let at_least_n = result.noise_at_least_n.unwrap();
            assert!((at_least_n / NOISE_N - 1.0).abs() < 0.3, "{at_least_n}");
            assert!(result.noise_floor_method.contains("white"));
        }
    }
}

/// The whole force is 12 % larger or smaller, switching at random times.
fn switched(tests: &mut [Measurement]) {
    for (index, test) in tests.iter_mut().enumerate() {
        let mut state = 0x9e37 + index as u64;
        let (mut gain, mut until) = (1.0, 0);
        let second = 1.0 / test.step_s;
        for (n, force_n) in test.force_n.iter_mut().enumerate() {
            if n >= until {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                gain = if state >> 63 == 0 { 1.12 } else { 0.88 };
                let share = 0.3 + 0.7 * (state >> 33) as f64 / f64::from(1_u32 << 30) / 2.0;
                until = n + (share * second) as usize;
            }
            *force_n *= gain;
        }
    }
}

fn is_called_a_hidden_input(result: IdentifyResult) {
    assert!(result.effects.is_empty(), "{:?}", result.effects);
    assert_eq!(result.verdict, Verdict::Unexplained);
    assert_eq!(result.noise_floor_n, None);
    let part = result.unexplained.unwrap();
    assert!(part.description.contains("a valve that switches"), "{part:?}");
    assert_eq!(part.coordinate, "size_of_the_force");
}

#[test]
fn a_valve_that_switches_at_random_was_called_clean() {
    let mut tests = records(SERIES, &sensors(), &[1, 2, 3, 4, 5]);
    switched(&mut tests);
    is_called_a_hidden_input(result_of(tests));
}

/// The difference between cycles is the switching, and was taken for the noise floor.
#[test]
fn a_valve_that_switches_hid_behind_its_own_cycles() {
    let mut tests = records(SERIES, &sensors(), &[1, 2, 3, 4]);
    let specimen = NullGenerator { model: SERIES, outside: Vec::new() };
    let sine = Test::new("sine", Excitation::sine(6e-3, 1.0), 9.0);
    tests.insert(0, record(&specimen, &sine, &sensors(), 90).measurement().unwrap());
    switched(&mut tests);
    is_called_a_hidden_input(result_of(tests));
}

#[test]
fn the_same_motion_twice_shows_the_noise_floor() {
    let result = result_of(records(SERIES, &sensors(), &[1, 1, 2, 2, 3]));
    let floor_n = result.noise_floor_n.unwrap();
    assert!((floor_n / NOISE_N - 1.0).abs() < 0.3, "{floor_n}");
    assert_eq!(result.verdict, Verdict::NoMissingEffect);
    assert!(result.noise_floor_method.contains("same motion"));
}

#[test]
fn another_power_of_speed_is_not_called_clean() {
    let mut tests = records(SERIES, &sensors(), &[1, 2, 3, 4, 5]);
    for test in &mut tests {
        let speed = test.velocity_m_per_s.clone();
        for (force_n, v) in test.force_n.iter_mut().zip(speed) {
            *force_n += 5e3 * v.signum() * libm::pow(v.abs() / 0.1, 0.3);
        }
    }
    let result = result_of(tests);
    assert_ne!(result.verdict, Verdict::NoMissingEffect);
    assert_ne!(result.verdict, Verdict::NotJudged);
}

/// A stiff damper turns jitter of the clock into noise of the model, of which a mass cancels a
/// part.
#[test]
fn jitter_of_the_clock_was_named_a_moving_mass() {
    let exact = Sensors::exact(5000.0);
    let mut state = 0x51ed_u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
    };
    let tests = records(SERIES, &exact, &[1, 2, 3, 4, 5]).into_iter().map(|fine| {
        // At 250 Hz, each sample up to 0.5 ms early or late; noise of 30 N.
        let places: Vec<usize> = (1..fine.len() / 20 - 1)
            .map(|n| (20 * n).saturating_add_signed((5.0 * uniform()).round() as isize))
            .collect();
        let x = places.iter().map(|at| fine.displacement_m[*at]).collect();
        let f = places.iter().map(|at| fine.force_n[*at] + 104.0 * uniform()).collect();
        Measurement::from_series(Series::sampled(&fine.name, 250.0, x, f)).unwrap()
    });
    let result = result_of(tests.collect());
    assert!(result.effects.is_empty(), "{:?}", result.effects);
}
