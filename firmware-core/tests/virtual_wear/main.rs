//! Wear in software against wear in the joint of a damper: force and work over sines of 4 mm at
//! 3.5 Hz, on a rig that is late by whole cycles.

use firmware_core::command::Command;
use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
use firmware_core::virtual_wear::{
    LOOP_GAIN_MAX, Reading, VirtualWear, VirtualWearState, loop_gain,
};
use std::collections::VecDeque;
use std::sync::LazyLock;

const CYCLE_S: f64 = 1e-3;
const HZ: f64 = 3.5;
const STROKE_M: f64 = 4e-3;
/// Stiffness of the new damper and of its model.
const KE: f64 = 12.5e6;

/// The new damper.
static NEW: LazyLock<Damper> = LazyLock::new(|| damper(KE, 0.0, 0.0));

/// A damper of a stiffness with wear in series.
fn damper(ke_n_per_m: f64, clearance_2a_m: f64, compliance_m_per_n: f64) -> Damper {
    let ke_n_per_m = 1.0 / (1.0 / ke_n_per_m + compliance_m_per_n);
    let clearance_2a_m = Nominal::NEW.clearance_2a_m + clearance_2a_m;
    let nominal = Nominal { ke_n_per_m, clearance_2a_m, ..Nominal::NEW };
    let Ok(damper) = Damper::new(nominal, &[]) else { panic!("a damper") };
    damper
}

/// The vehicle's motion in a cycle.
fn motion(cycle: u32) -> Command {
    let omega = core::f64::consts::TAU * HZ;
    let (sin, cos) = libm::sincos(omega * f64::from(cycle) * CYCLE_S);
    Command { displacement_m: STROKE_M * sin, velocity_m_per_s: STROKE_M * omega * cos }
}

/// Forces over time and the work of the last cycles of the motion.
struct Behaviour {
    forces_n: Vec<f64>,
    work_j: f64,
}

fn behaviour(mut force_n: impl FnMut(u32) -> f64) -> Behaviour {
    let (begin, end) = (1429, 2857);
    let (mut forces_n, mut work_j) = (Vec::new(), 0.0);
    let mut last = (0.0, 0.0);
    for cycle in 0..end {
        let force_n = force_n(cycle);
        let x_m = motion(cycle).displacement_m;
        if cycle >= begin {
            forces_n.push(force_n);
            work_j += 0.5 * (force_n + last.0) * (x_m - last.1);
        }
        last = (force_n, x_m);
    }
    Behaviour { forces_n, work_j }
}

/// Behind a joint of its own.
fn physical(ke_n_per_m: f64, clearance_2a_m: f64, compliance_m_per_n: f64) -> Behaviour {
    let damper = damper(ke_n_per_m, clearance_2a_m, compliance_m_per_n);
    let mut state = DamperState::rest();
    behaviour(|cycle| {
        let Command { displacement_m, velocity_m_per_s } = motion(cycle);
        damper.advance(&mut state, Motion::new(displacement_m, velocity_m_per_s), CYCLE_S)
    })
}

/// Wear before a new damper, on a rig that is late by whole cycles, contacts rounded to an
/// acceleration (m/s2).
fn wear(
    (clearance_2a_m, compliance_m_per_n): (f64, f64),
    late: u8,
    most: f64,
) -> VirtualWear<'static> {
    let wear = VirtualWear {
        clearance_2a_m,
        compliance_m_per_n,
        specimen: &NEW,
        ahead_cycles: late,
        rounding_cycles: 0,
    };
    wear.rounded(most, CYCLE_S)
}

/// A damper of a stiffness on such a rig, whose measurements arrive or do not.
fn in_software(
    ke_n_per_m: f64,
    of_wear: (f64, f64),
    late: u8,
    most: f64,
    arrives: impl Fn(u32) -> bool,
) -> Behaviour {
    let wear = wear(of_wear, late, most);
    let on_rig = damper(ke_n_per_m, 0.0, 0.0);
    let (mut state, mut rig) = (VirtualWearState::default(), DamperState::rest());
    let mut way = VecDeque::from(vec![0.0; usize::from(late)]);
    let mut reading = None;
    behaviour(|cycle| {
        let ahead = wear.step(&mut state, motion(cycle), reading, CYCLE_S);
        way.push_back(ahead.displacement_m);
        let displacement_m = way.pop_front().unwrap_or(0.0);
        let force_n = on_rig.advance(&mut rig, Motion::new(displacement_m, 0.0), CYCLE_S);
        reading = arrives(cycle).then_some(Reading { displacement_m, force_n });
        force_n
    })
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    libm::sqrt(values.map(|value| value * value).sum::<f64>() / count)
}

/// Errors of force and work over those of the healthy damper.
fn errors(real: &Behaviour, soft: &Behaviour) -> (f64, f64) {
    let new = physical(KE, 0.0, 0.0);
    let off = rms(real.forces_n.iter().zip(&soft.forces_n).map(|(real, soft)| real - soft));
    (off / rms(new.forces_n.iter().copied()), (soft.work_j - real.work_j).abs() / new.work_j)
}

/// The worst errors over clearances and stiffnesses from 3 MN/m to that of the specimen.
fn worst(stiffer: f64, late: u8, acceleration_m_per_s2: f64) -> (f64, f64) {
    let (mut force, mut work) = (0.0_f64, 0.0_f64);
    for ke in [3e6, 6e6, KE] {
        for clearance_2a_m in [0.0, 1e-3, 2e-3, 4e-3, 6e-3, 8e-3] {
            let wear = (clearance_2a_m, 1.0 / ke - 1.0 / KE);
            let real = physical(stiffer * KE, wear.0, wear.1);
            let soft = in_software(stiffer * KE, wear, late, acceleration_m_per_s2, |_| true);
            let (of_force, of_work) = errors(&real, &soft);
            (force, work) = (force.max(of_force), work.max(of_work));
        }
    }
    println!("{stiffer} x, {late} ms, {acceleration_m_per_s2} m/s2: {force:.4} {work:.4}");
    (force, work)
}

#[test]
fn wear_before_a_damper_that_is_known_acts_like_wear_in_its_joint() {
    for late in [0, 1, 5, 15] {
        for (acceleration, most) in [(8.0, 0.01), (16.0, 0.004), (100.0, 0.004)] {
            let (force, work) = worst(1.0, late, acceleration);
            assert!(
                force < most && work < 0.006,
                "{late} ms, {acceleration} m/s2: {force}, {work}"
            );
        }
    }
}

#[test]
fn a_damper_that_is_a_fifth_stiffer_or_softer_than_its_model_stays_within_the_aim() {
    for stiffer in [0.8, 1.2] {
        for late in [1, 5] {
            let (force, work) = worst(stiffer, late, 16.0);
            assert!(force < 0.03 && work < 0.05, "{stiffer}, {late} ms: {force}, {work}");
        }
        // 15 ms late it leaves it, where play is small and the stiffness is half.
        let (force, work) = worst(stiffer, 15, 16.0);
        assert!((0.03..0.05).contains(&force) && work < 0.05, "{stiffer}: {force}, {work}");
    }
}

#[test]
fn lost_measurements_change_little() {
    // Every seventh cycle, and forty in a row once in a second.
    let arrives = |cycle: u32| !cycle.is_multiple_of(7) && cycle % 1000 > 40;
    let wear = (2e-3, 1.0 / 6e6 - 1.0 / KE);
    let real = physical(1.2 * KE, wear.0, wear.1);
    let whole = errors(&real, &in_software(1.2 * KE, wear, 5, 16.0, |_| true));
    let lossy = errors(&real, &in_software(1.2 * KE, wear, 5, 16.0, arrives));
    assert!(lossy.0 < whole.0 + 0.01 && lossy.1 < whole.1 + 0.01, "{lossy:?}, {whole:?}");
    // Without any the model alone is off by its stiffness.
    let blind = errors(&real, &in_software(1.2 * KE, wear, 5, 16.0, |_| false));
    assert!(blind.0 > 2.0 * whole.0, "{blind:?}, {whole:?}");
}

#[test]
fn without_wear_the_motion_passes() {
    let wear = wear((0.0, 0.0), 0, 1e4);
    let mut state = VirtualWearState::default();
    for cycle in 0..500 {
        let passed = wear.step(&mut state, motion(cycle), None, CYCLE_S);
        let off_m = passed.displacement_m - motion(cycle).displacement_m;
        assert!(off_m.abs() < 1e-12, "cycle {cycle}: {off_m} m");
    }
}

#[test]
fn a_rigid_joint_moves_the_damper_at_half_the_clearance_behind() {
    let wear = wear((4e-3, 0.0), 0, 1e4);
    let mut state = VirtualWearState::default();
    let mut at_m = |x_m: f64| {
        let still = Command { displacement_m: x_m, velocity_m_per_s: 0.0 };
        wear.step(&mut state, still, None, CYCLE_S).displacement_m
    };
    assert_eq!(at_m(1e-3), 0.0);
    assert_eq!(at_m(5e-3), 3e-3);
    // Back with a loaded spring: the flank stays in touch.
    assert_eq!(at_m(4.9e-3), 2.9e-3);
    // Far back: the gap is open, and the damper rests where its spring is without force.
    let rest_m = at_m(2e-3);
    assert!(rest_m > 0.0 && rest_m < 2.9e-3, "{rest_m} m");
}

#[test]
fn a_damper_that_is_three_times_as_stiff_is_beyond_the_loop_gain() {
    let compliance_m_per_n = 1.0 / 3e6 - 1.0 / KE;
    let wear = wear((0.0, compliance_m_per_n), 5, 16.0);
    let (rig, mut state) = (damper(3.0 * KE, 0.0, 0.0), VirtualWearState::default());
    let mut on_rig = DamperState::rest();
    for cycle in 0..1000 {
        // The ram follows the vehicle, as it does before its force acts.
        let Command { displacement_m, .. } = motion(cycle);
        let force_n = rig.advance(&mut on_rig, Motion::new(displacement_m, 0.0), CYCLE_S);
        wear.step(&mut state, motion(cycle), Some(Reading { displacement_m, force_n }), CYCLE_S);
    }
    let share = state.found(&wear).unwrap().mismatch;
    // At full stroke the relief limits both, so the forces differ less than the stiffnesses.
    assert!((0.1..2.0).contains(&share), "{share}");
    assert!(loop_gain(compliance_m_per_n, KE, 2.0) > LOOP_GAIN_MAX);
    assert!(loop_gain(compliance_m_per_n, KE, 0.2) < LOOP_GAIN_MAX);
}
