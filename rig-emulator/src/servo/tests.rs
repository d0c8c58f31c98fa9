//! The servo rig against closed forms, its energy balance, and half of its substep.

use super::*;
use crate::emulator::{AT_REST_M_PER_S, Emulator};
use crate::{DECELERATION_M_PER_S2, Reference};
use firmware_core::damper::effects::{MovingMass, TemperatureFade};
use firmware_core::damper::{Damper, HeatBalance, Nominal};
use scenario::rig::{Drive, RigFile, RigKind};
use scenario::source::Source;
use std::f64::consts::TAU;
use std::path::Path;

const PERIOD_S: f64 = 1e-3;

/// The acceleration that host and rig agree on by default, m/s2.
const AGREED_M_PER_S2: f64 = 20.0;

/// The servo rig by its defaults, without noise.
fn usual() -> (RigSetup, ServoSetup) {
    let file = RigFile { kind: Some(RigKind::Servo), ..RigFile::default() };
    let setup = file.build(&Source::from_text(Path::new("rig.toml"), "")).unwrap();
    let Drive::Servo(drive) = setup.drive else { panic!("a servo rig") };
    (RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, ..setup }, drive)
}

/// The same without what costs pressure, and with a dashpot in the place of the damper.
fn lossless(ce_n_s_per_m: f64) -> (RigSetup, ServoSetup) {
    let (setup, drive) = usual();
    let nominal = Nominal {
        ce_n_s_per_m,
        ke_n_per_m: 10e6,
        clearance_2a_m: 0.0,
        f_relief_n: f64::INFINITY,
        c2_n_s_per_m: 0.0,
    };
    let drive = ServoSetup { friction_n_s_per_m: 0.0, leakage_m3_per_s_pa: 0.0, ..drive };
    (RigSetup { damper: Damper::new(nominal, &[]).unwrap(), ..setup }, drive)
}

/// A dashpot that costs next to nothing.
const FREE_N_S_PER_M: f64 = 1e-3;

/// A servo with its mechanics and its memory, at rest at a displacement.
fn at_rest(servo: &Servo, ram_m: f64) -> (Mechanics, ServoState) {
    (Mechanics::resting_at(ram_m), servo.resting_at(ram_m))
}

fn follow(displacement_m: f64, velocity_m_per_s: f64) -> Target {
    Target::Follow(Reference { displacement_m, velocity_m_per_s })
}

/// The command of a sine at a time, that begins without a jolt over its first second.
fn sine(hz: f64, amplitude_m: f64, t: f64) -> Target {
    let (swell, rate) = if t < 1.0 { (t, 1.0) } else { (1.0, 0.0) };
    let (s, c) = (libm::sin(TAU * hz * t), libm::cos(TAU * hz * t));
    follow(amplitude_m * swell * s, amplitude_m * (swell * TAU * hz * c + rate * s))
}

#[test]
fn ram_and_end_mass_ring_on_the_oil_at_their_natural_frequency() {
    let (setup, drive) = lossless(FREE_N_S_PER_M);
    let damper = Damper::new(Nominal { ke_n_per_m: 1.0, ..*setup.damper.nominal() }, &[]).unwrap();
    let setup = RigSetup { damper, ..setup };
    // The valve stays closed.
    let drive = ServoSetup {
        feed_forward: 0.0,
        controller_gain_per_s: 1e-12,
        fixture_damping_ratio: 0.0,
        ..drive
    };
    let servo = Servo::new(&setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    own.pressure_pa = 0.1e6;
    let middle_m = own.pressure_pa / (servo.oil_pa_per_m3 * drive.area_m2);
    let (mut crossings, mut first_s, mut last_s) = (0, 0.0, 0.0);
    for step in 1..=16_000_u32 {
        let before_m = at.ram.displacement_m - middle_m;
        servo.substep(&mut at, &mut own, &mut Limits::default());
        let now_m = at.ram.displacement_m - middle_m;
        if before_m < 0.0 && now_m >= 0.0 {
            last_s = (f64::from(step) - now_m / (now_m - before_m)) * servo.step_s;
            first_s = if crossings == 0 { last_s } else { first_s };
            crossings += 1;
        }
    }
    let found_hz = f64::from(crossings - 1) / (last_s - first_s);
    // (K + k - m_r w^2)(k - m_e w^2) = k^2, the lower root.
    let (k, m_r, m_e) = (servo.fixture_n_per_m, drive.ram_mass_kg, drive.end_mass_kg);
    let oil = drive.oil_stiffness_n_per_m();
    let (a, b, c) = (m_r * m_e, -(oil + k) * m_e - k * m_r, oil * k);
    let expected_hz = ((-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)).sqrt() / TAU;
    println!("oil column {found_hz:.3} Hz, closed form {expected_hz:.3} Hz");
    assert!((found_hz / expected_hz - 1.0).abs() < 0.02, "{found_hz} Hz, {expected_hz} Hz");
    // Another bulk modulus is far outside of that.
    assert!(expected_hz > 100.0 && crossings > 50);
}

/// The distance to a ramp after two thirds of a second.
fn behind_ramp_m((setup, drive): (RigSetup, ServoSetup), speed_m_per_s: f64) -> f64 {
    let servo = Servo::new(&setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    let cycles = 700_u32;
    for cycle in 0..cycles {
        let x = speed_m_per_s * PERIOD_S * f64::from(cycle);
        servo.cycle(&mut at, &mut own, follow(x, speed_m_per_s));
    }
    speed_m_per_s * PERIOD_S * f64::from(cycles) - at.ram.displacement_m
}

#[test]
fn on_a_ramp_it_lags_by_what_the_feed_forward_leaves() {
    let speed_m_per_s = 0.08;
    for (gain, share) in [(100.0, 0.9), (50.0, 0.5), (100.0, 0.0), (80.0, 1.0)] {
        let (setup, drive) = lossless(FREE_N_S_PER_M);
        let drive = ServoSetup { controller_gain_per_s: gain, feed_forward: share, ..drive };
        let found_m = behind_ramp_m((setup, drive), speed_m_per_s);
        let expected_m = (1.0 - share) / gain * speed_m_per_s;
        println!("gain {gain} 1/s, feed-forward {share}: {:.3} um behind", found_m * 1e6);
        assert!((found_m - expected_m).abs() < 1e-8 + 1e-3 * expected_m, "{found_m} m");
    }
}

#[test]
fn under_load_it_lags_by_the_flow_that_the_valve_then_lacks() {
    let speed_m_per_s = 0.08;
    let (setup, drive) = lossless(250e3);
    let force_n = 250e3 * speed_m_per_s;
    let share = (1.0 - force_n / drive.area_m2 / drive.supply_pa).sqrt();
    let expected_m = (1.0 / share - drive.feed_forward) / drive.controller_gain_per_s;
    let found_m = behind_ramp_m((setup, drive), speed_m_per_s);
    assert!((found_m / (expected_m * speed_m_per_s) - 1.0).abs() < 0.01, "{found_m} m");
}

/// The speed that the ram reaches with the valve open.
fn open_m_per_s(setup: &RigSetup, drive: ServoSetup) -> f64 {
    let servo = Servo::new(setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, -0.09);
    let mut limits = Limits::default();
    while at.ram.displacement_m < 0.06 {
        limits = servo.cycle(&mut at, &mut own, follow(0.1, 0.0));
    }
    assert!(limits.rate && !limits.stroke, "the spool is at its end: {limits:?}");
    at.ram.velocity_m_per_s
}

#[test]
fn speed_ends_at_the_flow_and_falls_under_load_as_the_root_says() {
    // From far away the controller opens the valve fully.
    let opened = |(setup, drive): (RigSetup, ServoSetup)| {
        (setup, ServoSetup { controller_gain_per_s: 1000.0, ..drive })
    };
    let (setup, drive) = opened(lossless(FREE_N_S_PER_M));
    let free_m_per_s = open_m_per_s(&setup, drive);
    println!("no load: {free_m_per_s:.4} m/s, Q/A {:.4} m/s", drive.no_load_speed_m_per_s());
    assert!((free_m_per_s / 0.6 - 1.0).abs() < 0.01, "{free_m_per_s} m/s");
    // The pump gives its flow whatever the pressure is, so friction has to end the ringing.
    let weak = ServoSetup { pump_flow_m3_per_s: 0.9e-3, friction_n_s_per_m: 5e3, ..drive };
    let pumped_m_per_s = open_m_per_s(&setup, weak);
    assert!((pumped_m_per_s / 0.3 - 1.0).abs() < 0.01, "{pumped_m_per_s} m/s");

    let ce_n_s_per_m = 60e3;
    let (setup, drive) = opened(lossless(ce_n_s_per_m));
    let loaded_m_per_s = open_m_per_s(&setup, drive);
    // (A v / Qn)^2 = 1 - c v / (A ps)
    let q = ce_n_s_per_m / (drive.area_m2 * drive.supply_pa);
    let p = (drive.area_m2 / drive.rated_flow_m3_per_s).powi(2);
    let expected_m_per_s = (-q + (q * q + 4.0 * p).sqrt()) / (2.0 * p);
    println!("under load: {loaded_m_per_s:.4} m/s, closed form {expected_m_per_s:.4} m/s");
    assert!((loaded_m_per_s / expected_m_per_s - 1.0).abs() < 0.01, "{loaded_m_per_s} m/s");
    assert!(loaded_m_per_s < 0.8 * free_m_per_s);
}

#[test]
fn the_load_cell_feels_the_inertia_of_the_end_mass() {
    let (setup, drive) = usual();
    let drive = ServoSetup { end_mass_kg: 50.0, ..drive };
    let servo = Servo::new(&setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    let hz = 10.0;
    let mut sums = [[0.0; 2]; 2];
    for cycle in 0..3000_u32 {
        servo.cycle(&mut at, &mut own, sine(hz, 1e-3, f64::from(cycle) * PERIOD_S));
        if cycle >= 2000 {
            let angle = TAU * hz * f64::from(cycle + 1) * PERIOD_S;
            for (sum, value) in sums.iter_mut().zip([at.load_cell_n - at.force_n, at.eyes_m]) {
                sum[0] += value * libm::sin(angle) / 500.0;
                sum[1] += value * libm::cos(angle) / 500.0;
            }
        }
    }
    let [error_n, eyes_m] = sums.map(|[s, c]| libm::hypot(s, c));
    let expected_n = drive.end_mass_kg * (TAU * hz).powi(2) * eyes_m;
    println!("error of the load cell {error_n:.2} N, m w^2 x {expected_n:.2} N");
    assert!((error_n / expected_n - 1.0).abs() < 0.02, "{error_n} N, {expected_n} N");
    // It is against the displacement: an accelerated mass looks like a negative spring.
    let along = sums[0][0] * sums[1][0] + sums[0][1] * sums[1][1];
    assert!(along < -0.99 * error_n * eyes_m);
}

#[test]
fn a_moving_mass_of_the_damper_is_an_end_mass() {
    let (setup, drive) = usual();
    let mass = MovingMass { mass_kg: 25.0 };
    let heavy = Damper::new(*setup.damper.nominal(), &[mass.into()]).unwrap();
    let with_effect = Servo::new(&RigSetup { damper: heavy, ..setup.clone() }, drive, PERIOD_S);
    let heavier = ServoSetup { end_mass_kg: drive.end_mass_kg + 25.0, ..drive };
    let with_mass = Servo::new(&setup, heavier, PERIOD_S);
    let run = |servo: &Servo| {
        let (mut at, mut own) = at_rest(servo, 0.0);
        for cycle in 0..300_u32 {
            servo.cycle(&mut at, &mut own, sine(5.0, 3e-3, f64::from(cycle) * PERIOD_S));
        }
        at.load_cell_n
    };
    assert_eq!(run(&with_effect).to_bits(), run(&with_mass).to_bits());
    assert_ne!(run(&with_effect).to_bits(), run(&Servo::new(&setup, drive, PERIOD_S)).to_bits());
}

#[test]
fn the_work_of_the_oil_is_dissipated_or_stored() {
    let (setup, drive) = usual();
    let servo = Servo::new(&setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    let stored_j = |at: &Mechanics, own: &ServoState| {
        let bent_m = at.ram.displacement_m - at.eyes_m;
        let [ram, end] = own.velocities;
        own.pressure_pa.powi(2) / (2.0 * servo.oil_pa_per_m3)
            + 0.5 * servo.fixture_n_per_m * bent_m * bent_m
            + 0.5 * (drive.ram_mass_kg * ram * ram + servo.end_mass_kg * end * end)
    };
    let (mut supplied_j, mut lost_j, mut in_damper_j) = (0.0, 0.0, 0.0);
    let mut start_j = 0.0;
    let cycles = 3000_u32;
    for cycle in 0..cycles {
        if cycle == 1000 {
            (supplied_j, lost_j, in_damper_j) = (0.0, 0.0, 0.0);
            start_j = stored_j(&at, &own);
        }
        let Target::Follow(reference) = sine(3.0, 4e-3, f64::from(cycle) * PERIOD_S) else {
            unreachable!("a sine is followed")
        };
        for substep in 0..servo.substeps {
            let now = reference.after(f64::from(substep) * servo.step_s);
            own.reference = servo.guide.kept_within(now);
            let (before, own_before) = (at, own);
            servo.substep(&mut at, &mut own, &mut Limits::default());
            // Over the substep: opening and pressure in its middle, velocities as they stand.
            let opening = 0.5 * (own_before.spool.opening + own.spool.opening);
            let pressure_pa = 0.5 * (own_before.pressure_pa + own.pressure_pa);
            let flow = servo.valve.flow_m3_per_s(opening, pressure_pa);
            supplied_j += pressure_pa * flow * servo.step_s;
            let [ram, end] = own.velocities;
            lost_j += servo.step_s
                * (drive.leakage_m3_per_s_pa * pressure_pa * pressure_pa
                    + drive.friction_n_s_per_m * ram * ram
                    + servo.fixture_n_s_per_m * (ram - end) * (ram - end));
            in_damper_j += 0.5 * (before.force_n + at.force_n) * (at.eyes_m - before.eyes_m);
        }
    }
    let accounted_j = lost_j + in_damper_j + stored_j(&at, &own) - start_j;
    println!(
        "supplied {supplied_j:.3} J, damper {in_damper_j:.3} J, leakage and friction {lost_j:.3} J, \
         off by {:.4} %",
        100.0 * (supplied_j / accounted_j - 1.0)
    );
    assert!((supplied_j / accounted_j - 1.0).abs() < 0.01, "{supplied_j} J, {accounted_j} J");
    // Each share is far above the tolerance.
    assert!(in_damper_j > 0.5 * supplied_j && lost_j > 0.05 * supplied_j);
}

/// Ram (um) and load cell (N) over a second of a run with so many substeps.
fn with_substeps(substeps: u32) -> Vec<[f64; 2]> {
    let (setup, drive) = usual();
    let servo = Servo::with_substeps(&setup, drive, PERIOD_S, substeps);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    let shown = |cycle: u32| {
        servo.cycle(&mut at, &mut own, sine(3.5, 3.46e-3, f64::from(cycle) * PERIOD_S));
        [at.ram.displacement_m * 1e6, at.load_cell_n]
    };
    (0..1000).map(shown).collect()
}

#[test]
fn half_the_substep_changes_next_to_nothing() {
    let worst = |one: &[[f64; 2]], other: &[[f64; 2]]| {
        one.iter().zip(other).fold([0.0_f64; 2], |[x, f], (a, b)| {
            [x.max((a[0] - b[0]).abs()), f.max((a[1] - b[1]).abs())]
        })
    };
    let [usual, half, quarter] = [32, 64, 128].map(with_substeps);
    let (coarse, fine) = (worst(&usual, &half), worst(&half, &quarter));
    println!("1/32 to 1/64 ms: {coarse:?}; 1/64 to 1/128 ms: {fine:?} (um, N)");
    let peak_n = usual.iter().fold(0.0_f64, |peak, [_, force]| peak.max(force.abs()));
    assert!(coarse[0] < 5.0, "{} um of 3.46 mm", coarse[0]);
    assert!(coarse[1] < 0.01 * peak_n, "{} N of {peak_n} N", coarse[1]);
    assert!(fine[0] < 0.7 * coarse[0] && fine[1] < 0.7 * coarse[1], "it converges");
}

#[test]
fn the_same_run_has_the_same_bits() {
    let (setup, drive) = usual();
    let setup = RigSetup { force_noise_n: 20.0, drive: Drive::Servo(drive), ..setup };
    let run = |rig: Emulator| {
        let mut state = rig.start();
        let cycles = 0..500_u32;
        let readings = cycles.map(|cycle| {
            rig.cycle(&mut state, sine(3.5, 3e-3, f64::from(cycle) * PERIOD_S)).force_n.to_bits()
        });
        (readings.collect::<Vec<_>>(), state)
    };
    let once = run(Emulator::new(&setup, PERIOD_S, 1));
    assert_eq!(once, run(Emulator::new(&setup, PERIOD_S, 1)));
    assert_eq!(once, run(Emulator::new(&setup, 0.4e-3, 1).with_period(PERIOD_S)));
    assert_ne!(once, run(Emulator::new(&RigSetup { seed: 2, ..setup }, PERIOD_S, 1)));
}

#[test]
fn it_stops_within_the_agreed_acceleration_and_rests() {
    for speed_m_per_s in [0.08, -0.08, 0.02] {
        let (setup, drive) = usual();
        let setup = RigSetup { drive: Drive::Servo(drive), ..setup };
        let rig = Emulator::new(&setup, PERIOD_S, 0);
        let mut state = rig.start();
        for cycle in 0..300_u32 {
            let x = speed_m_per_s * PERIOD_S * f64::from(cycle);
            rig.cycle(&mut state, follow(x, speed_m_per_s));
        }
        assert!(!rig.is_at_rest(&state));
        let (start_m, mut before) = (state.ram().displacement_m, state.ram().velocity_m_per_s);
        assert!((before / speed_m_per_s - 1.0).abs() < 0.01, "{before} m/s");
        let (mut hardest, mut cycles) = (0.0_f64, 0);
        while !rig.is_at_rest(&state) && cycles < 500 {
            rig.cycle(&mut state, Target::Hold);
            hardest = hardest.max((state.ram().velocity_m_per_s - before).abs() / PERIOD_S);
            before = state.ram().velocity_m_per_s;
            cycles += 1;
        }
        let way_m = (state.ram().displacement_m - start_m).abs();
        println!(
            "from {speed_m_per_s} m/s: {hardest:.2} m/s2 at most, at rest after {cycles} ms and \
             {:.3} mm",
            way_m * 1e3
        );
        assert!(hardest <= AGREED_M_PER_S2, "{hardest} m/s2");
        assert!(hardest > 0.5 * DECELERATION_M_PER_S2 || speed_m_per_s.abs() < 0.05);
        assert!(cycles <= 200, "{cycles} ms");
        // It stays there, while the damper relaxes.
        for _ in 0..2000 {
            rig.cycle(&mut state, Target::Hold);
        }
        assert!(rig.is_at_rest(&state));
        assert!(state.ram().velocity_m_per_s.abs() < 0.01 * AT_REST_M_PER_S);
    }
}

#[test]
fn it_stands_still_without_a_damper_too() {
    let (setup, drive) = usual();
    let (free, _) = lossless(FREE_N_S_PER_M);
    let setup = RigSetup { damper: free.damper, ..setup };
    let servo = Servo::new(&setup, drive, PERIOD_S);
    let (mut at, mut own) = at_rest(&servo, 0.0);
    let mut furthest_m = 0.0_f64;
    for _ in 0..500 {
        servo.cycle(&mut at, &mut own, follow(1e-3, 0.0));
        furthest_m = furthest_m.max(at.ram.displacement_m);
    }
    assert!((at.ram.displacement_m - 1e-3).abs() < 1e-8, "{} m", at.ram.displacement_m);
    assert!(furthest_m < 1.3e-3, "{furthest_m} m after a step of 1 mm");
}

#[test]
fn it_centres_and_its_end_stops_hold() {
    let (setup, drive) = usual();
    let setup = RigSetup { drive: Drive::Servo(drive), ..setup };
    let rig = Emulator::new(&setup, PERIOD_S, 0);
    let mut state = rig.start_at(-5e-3);
    for _ in 0..3000 {
        rig.cycle(&mut state, Target::Centre);
        assert!(state.ram().velocity_m_per_s < 8e-3, "{:?}", state.ram());
    }
    assert!(state.ram().displacement_m.abs() < 50e-6 && rig.is_at_rest(&state), "{state:?}");
    let mut stroke = false;
    for _ in 0..1000 {
        let reading = rig.cycle(&mut state, follow(0.3, 5.0));
        stroke |= reading.limits.stroke;
        assert!(state.ram().displacement_m <= setup.stroke_m);
    }
    assert!(stroke && setup.stroke_m - state.ram().displacement_m < 0.5e-3, "{:?}", state.ram());
}

#[test]
fn the_damper_warms_by_its_work_and_fades_if_it_can() {
    let (setup, drive) = usual();
    let heat = HeatBalance { capacity_j_per_k: 100.0, cooling_w_per_k: 0.0 };
    let drive = ServoSetup { heat, ..drive };
    let run = |damper: Damper| {
        let servo = Servo::new(&RigSetup { damper, ..setup.clone() }, drive, PERIOD_S);
        let (mut at, mut own) = at_rest(&servo, 0.0);
        let mut work_j = 0.0;
        let mut peak_n = 0.0_f64;
        for cycle in 0..5000_u32 {
            let (eyes_m, force_n) = (at.eyes_m, at.force_n);
            servo.cycle(&mut at, &mut own, sine(2.0, 4e-3, f64::from(cycle) * PERIOD_S));
            work_j += 0.5 * (force_n + at.force_n) * (at.eyes_m - eyes_m);
            if cycle >= 4000 {
                peak_n = peak_n.max(at.force_n);
            }
        }
        (work_j / 100.0, own.temperature_degc() - 20.0, peak_n)
    };
    let nominal = *setup.damper.nominal();
    let (expected_k, warmer_k, cold_n) = run(setup.damper.clone());
    println!("{warmer_k:.3} K by {expected_k:.3} K of work");
    assert!(warmer_k > 1.0 && (warmer_k / expected_k - 1.0).abs() < 0.01, "{warmer_k} K");
    let oil =
        TemperatureFade { fade_per_k: 0.02, heat_capacity_j_per_k: 1e9, cooling_w_per_k: 0.0 };
    let (_, warmer_k, warm_n) = run(Damper::new(nominal, &[oil.into()]).unwrap());
    assert!(warmer_k > 1.0 && warm_n < cold_n, "{warm_n} N after {warmer_k} K, {cold_n} N cold");
}
