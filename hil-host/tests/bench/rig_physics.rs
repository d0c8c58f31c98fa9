//! The emulated rig's physics: delay, limits, deceleration, fixture, noise.

use crate::support::host::{motion, setup};
use crate::support::rig::quiet;
use firmware_core::damper::{Damper, Nominal};
use hil_host::rig::{DECELERATION_M_PER_S2, Emulator, Reading, Reference, Target};
use scenario::rig::{RigFile, RigSetup};
use std::path::Path;

const PERIOD_S: f64 = 1e-3;
const OMEGA: f64 = core::f64::consts::TAU * 3.5;

fn file(name: &str) -> RigSetup {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/rigs");
    RigFile::load(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn follow(displacement_m: f64, velocity_m_per_s: f64) -> Target {
    Target::Follow(Reference { displacement_m, velocity_m_per_s })
}

/// Readings of a run at 3.5 Hz, with or without velocity in the command.
fn sine(setup: &RigSetup, cycles: u32, with_velocity: bool) -> Vec<Reading> {
    let rig = Emulator::new(setup, PERIOD_S, 0);
    let mut state = rig.start();
    (0..cycles)
        .map(|cycle| {
            let (x, v) = motion(f64::from(cycle) * PERIOD_S);
            rig.cycle(&mut state, follow(x, if with_velocity { v } else { 0.0 }))
        })
        .collect()
}

/// The delay of the ram after the instant that a command refers to, from the phase over the last
/// seven periods. A cycle's reading is taken at its end.
fn delay_s(setup: &RigSetup, with_velocity: bool) -> f64 {
    let (settling, measured) = (2000_u32, 2000_u32);
    let readings = sine(setup, settling + measured, with_velocity);
    let (mut along, mut across) = (0.0, 0.0);
    for (cycle, reading) in (1_u32..).zip(&readings).skip(settling as usize) {
        let angle = OMEGA * f64::from(cycle) * PERIOD_S;
        along += reading.ram_displacement_m * libm::sin(angle);
        across += reading.ram_displacement_m * libm::cos(angle);
    }
    -libm::atan2(across, along) / OMEGA
}

#[test]
fn the_default_rig_lags_by_half_a_millisecond_and_by_one_at_most() {
    let delay = delay_s(&setup(), true);
    assert!((delay - 0.5e-3).abs() < 0.01e-3, "{delay} s");
    assert!(delay <= 1e-3);
    // A command without velocity is held for its cycle: that cycle, and the remaining lag.
    let left = libm::exp(-2.0);
    let held = 1e-3 * (1.0 + left / (1.0 - left));
    let delay = delay_s(&setup(), false);
    assert!((delay - held).abs() < 0.01e-3, "{delay} s, expected {held} s");
}

#[test]
fn the_files_of_both_rigs_load_and_are_as_fast_as_they_say() {
    let laboratory = file("laboratory-rig.toml");
    // All but its damper, which has the relief force that the SS9 scenarios are calibrated to.
    let damper = laboratory.damper.clone();
    assert_eq!(laboratory, RigSetup { damper, ..setup() }, "the file writes out the defaults");
    assert_eq!(laboratory.damper.nominal().f_relief_n, 11.1e3);
    let slow = file("slow-rig.toml");
    let delay = delay_s(&slow, true);
    assert!((delay - 10e-3).abs() < 0.1e-3, "{delay} s");
    assert!(slow.stroke_m >= 0.1);
}

#[test]
fn pure_delay_is_whole_cycles() {
    let direct = sine(&quiet(), 400, true);
    for cycles in [1_u16, 7, 64] {
        let late = sine(&RigSetup { delay_cycles: cycles, ..quiet() }, 400, true);
        for (late, direct) in late[usize::from(cycles)..].iter().zip(&direct) {
            assert_eq!(
                (late.force_n, late.displacement_m),
                (direct.force_n, direct.displacement_m)
            );
        }
    }
}

#[test]
fn stroke_and_rate_hold_whatever_is_commanded() {
    let setup = RigSetup { rate_m_per_s: 0.25, ..quiet() };
    let rig = Emulator::new(&setup, PERIOD_S, 0);
    let mut state = rig.start();
    let (mut stroke, mut rate) = (false, false);
    let mut before_m = 0.0;
    for cycle in 0..4000_u32 {
        // Steps of 0.4 m to and fro with absurd velocities, between them the ram has time to
        // arrive.
        let side = if cycle / 1000 % 2 == 0 { 1.0 } else { -1.0 };
        let reading = rig.cycle(&mut state, follow(0.2 * side, 50.0 * side));
        stroke |= reading.limits.stroke;
        rate |= reading.limits.rate;
        let ram = state.ram();
        assert!(ram.displacement_m.abs() <= setup.stroke_m);
        assert!(ram.velocity_m_per_s.abs() <= setup.rate_m_per_s);
        let travel = (ram.displacement_m - before_m).abs();
        assert!(travel <= setup.rate_m_per_s * PERIOD_S * (1.0 + 1e-12), "{travel} m");
        before_m = ram.displacement_m;
    }
    assert!(stroke && rate);
    assert_eq!(state.ram().displacement_m, -setup.stroke_m);
}

#[test]
fn it_comes_to_rest_without_a_jump_of_velocity() {
    let rig = Emulator::new(&quiet(), PERIOD_S, 0);
    for cycles in [1_u32, 40, 72, 143, 286, 300] {
        let mut state = rig.start();
        for cycle in 0..cycles {
            let (x, v) = motion(f64::from(cycle) * PERIOD_S);
            rig.cycle(&mut state, follow(x, v));
        }
        let (start, mut before) = (state.ram(), state.ram().velocity_m_per_s);
        let mut rest_after = 0;
        while state.ram().velocity_m_per_s != 0.0 {
            rig.cycle(&mut state, Target::Hold);
            let change = (state.ram().velocity_m_per_s - before).abs();
            assert!(change <= DECELERATION_M_PER_S2 * PERIOD_S + 1e-12, "{change} m/s in a cycle");
            before = state.ram().velocity_m_per_s;
            rest_after += 1;
            assert!(rest_after <= 9, "76 mm/s take 7.6 ms");
        }
        let path = (state.ram().displacement_m - start.displacement_m).abs();
        let needed = start.velocity_m_per_s.powi(2) / (2.0 * DECELERATION_M_PER_S2);
        assert!((path - needed).abs() < 2e-6, "{path} m, {needed} m by v^2/2a");
        let held = state.ram();
        rig.cycle(&mut state, Target::Hold);
        assert_eq!(state.ram(), held);
    }
}

/// A fixture in series with the damper's own stiffness is one softer spring, exactly.
#[test]
fn a_fixture_in_series_acts_as_a_softer_damper() {
    for fixture_n_per_m in [100.0e6, 12.5e6, 2.0e6] {
        let fixture = RigSetup { fixture_m_per_n: 1.0 / fixture_n_per_m, ..quiet() };
        let ke = 1.0 / (1.0 / Nominal::NEW.ke_n_per_m + fixture.fixture_m_per_n);
        let damper = Damper::new(Nominal { ke_n_per_m: ke, ..Nominal::NEW }, &[]).unwrap();
        let softer = RigSetup { damper, ..quiet() };
        let (one, other) = (sine(&fixture, 1000, true), sine(&softer, 1000, true));
        let peak = other.iter().fold(0.0_f64, |peak, reading| peak.max(reading.force_n.abs()));
        for (one, other) in one.iter().zip(&other) {
            let off = (one.force_n - other.force_n).abs();
            assert!(off < 2e-3 * peak, "{off} N of {peak} N at {fixture_n_per_m} N/m");
            // Ram and eyes differ by what the force pulls.
            let pulled = one.ram_displacement_m - one.force_n * fixture.fixture_m_per_n;
            assert!((one.displacement_m - pulled).abs() < 1e-11);
        }
    }
}

#[test]
fn the_sensors_add_their_noise_and_nothing_else() {
    let cycles = 20_000_u32;
    let rig = Emulator::new(&setup(), PERIOD_S, 1);
    let mut state = rig.start();
    let (mut force, mut eyes, mut ram) = (0.0, 0.0, 0.0);
    for _ in 0..cycles {
        let reading = rig.cycle(&mut state, Target::Hold);
        force += reading.force_n.powi(2) / f64::from(cycles);
        eyes += reading.displacement_m.powi(2) / f64::from(cycles);
        ram += reading.ram_displacement_m.powi(2) / f64::from(cycles);
    }
    // Standard error of an rms over 20,000: 0.5 %.
    assert!((libm::sqrt(force) / 5.0 - 1.0).abs() < 0.02, "{} N", libm::sqrt(force));
    assert!((libm::sqrt(eyes) / 0.2e-6 - 1.0).abs() < 0.02, "{} m", libm::sqrt(eyes));
    assert!((libm::sqrt(ram) / 0.2e-6 - 1.0).abs() < 0.02, "{} m", libm::sqrt(ram));
    // The same motion without noise differs by the noise alone.
    let (noisy, clean) = (sine(&setup(), 300, true), sine(&quiet(), 300, true));
    for (noisy, clean) in noisy.iter().zip(&clean) {
        assert!((noisy.force_n - clean.force_n).abs() < 5.0 * 6.0);
    }
}

#[test]
fn the_force_is_that_of_the_damper_alone() {
    let readings = sine(&quiet(), 2000, true);
    let peak = readings.iter().skip(1000).map(|reading| reading.force_n).fold(0.0, f64::max);
    // At 76 mm/s the relief is open: 18 kN and 80 kN s/m beyond 18 mm/s, less what the joint takes.
    let steady = setup().damper.steady_force_n(3.46e-3 * OMEGA);
    assert!(peak < steady && peak > 0.9 * steady, "{peak} N, {steady} N at rest");
    let work: f64 = readings
        .windows(2)
        .skip(1000)
        .map(|pair| {
            let mean = 0.5 * (pair[0].force_n + pair[1].force_n);
            mean * (pair[1].displacement_m - pair[0].displacement_m)
        })
        .sum();
    assert!(work > 0.0, "a damper takes energy: {work} J");
}
