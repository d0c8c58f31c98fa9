//! A command on the rig alone: the vehicle's motion is given, and nothing comes back to it.

use super::recording::{DamperRecord, Recording, held_work_j};
use super::regime::Regime;
use firmware_core::command::Command;
use firmware_core::compensation::{Answer, Compensator};
use rig_emulator::{Emulator, Reading, Reference, Target};
use scenario::rig::RigSetup;
use scenario::run::CYCLE_S;

/// What a rig makes of a command for a wanted motion, cycle by cycle.
pub(super) fn commanded(
    rig: &RigSetup,
    regime: Regime,
    wanted: &[Command],
    command: &[Command],
) -> Recording {
    debug_assert_eq!(wanted.len(), command.len(), "a command for another motion");
    let mut commands = command.iter().copied();
    driven(rig, regime, wanted, |_, _| commands.next().unwrap_or_default()).0
}

/// The command of a compensator of ours for a wanted motion, with the answers of the rig, and what
/// the rig makes of it.
pub(super) fn compensated(
    rig: &RigSetup,
    regime: Regime,
    wanted: &[Command],
    compensator: &Compensator,
) -> (Recording, Vec<Command>) {
    let mut state = compensator.start();
    driven(rig, regime, wanted, |wanted, answer| {
        let command = compensator.step(&mut state, wanted, answer, CYCLE_S);
        state.sent(command);
        command
    })
}

fn driven(
    rig: &RigSetup,
    regime: Regime,
    wanted: &[Command],
    mut command: impl FnMut(Command, Option<Answer>) -> Command,
) -> (Recording, Vec<Command>) {
    let emulator = Emulator::new(rig, CYCLE_S, 0);
    let (mut state, mut reading) = (emulator.start(), None);
    let (mut measured_m, mut forces_n, mut commands) = (Vec::new(), Vec::new(), Vec::new());
    for wanted in wanted {
        let answer = reading.map(|Reading { displacement_m, force_n, .. }| Answer {
            displacement_m,
            force_n,
            age_cycles: 0,
        });
        let command = command(*wanted, answer);
        let reference = Reference {
            displacement_m: command.displacement_m,
            velocity_m_per_s: command.velocity_m_per_s,
        };
        let now = emulator.cycle(&mut state, Target::Follow(reference));
        measured_m.push(now.displacement_m);
        forces_n.push(now.force_n);
        commands.push(command);
        reading = Some(now);
    }
    let work_j = held_work_j(wanted, &forces_n);
    let damper = DamperRecord { wanted: wanted.to_vec(), measured_m, work_j };
    (Recording::of_one(damper, regime), commands)
}

#[cfg(test)]
mod tests {
    use super::super::errors::Errors;
    use super::super::recording::modelled_work_j;
    use super::*;
    use firmware_core::compensation::damping_energy_lost;
    use firmware_core::damper::{Damper, Nominal};
    use firmware_core::line::KNOWN_DELAY_CYCLES;
    use scenario::rig::RigFile;
    use std::f64::consts::TAU;

    const HZ: f64 = 3.5;
    /// A Maxwell element: no clearance, a relief valve that stays shut.
    const MAXWELL: Nominal = Nominal { clearance_2a_m: 0.0, f_relief_n: 1e9, ..Nominal::NEW };

    fn sine() -> Vec<Command> {
        let at = |cycle: usize| {
            let omega = TAU * HZ;
            let (sin, cos) = libm::sincos(omega * CYCLE_S * cycle as f64);
            Command { displacement_m: 4e-3 * sin, velocity_m_per_s: 4e-3 * omega * cos }
        };
        (0..Regime::Hunting.cycles()).map(at).collect()
    }

    /// A rig whose force is late by so much (s), and nothing else.
    fn late(delay_s: f64, nominal: Nominal) -> RigSetup {
        let damper = Damper::new(nominal, &[]).unwrap();
        let rig = RigFile::default_setup().unwrap();
        let rig = RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, damper, ..rig };
        rig.late_by(delay_s - KNOWN_DELAY_CYCLES * CYCLE_S).unwrap()
    }

    /// The errors of a command that is the wanted motion.
    fn identity(rig: &RigSetup) -> Errors {
        let wanted = sine();
        let found = commanded(rig, Regime::Hunting, &wanted, &wanted);
        let damper = DamperRecord {
            measured_m: wanted.iter().map(|at| at.displacement_m).collect(),
            work_j: modelled_work_j(&rig.damper, &wanted),
            wanted,
        };
        let modelled = Recording::of_one(damper, Regime::Hunting);
        Errors::of(&found.observed(HZ).unwrap(), &modelled.observed(HZ).unwrap())
    }

    #[test]
    fn a_rig_whose_force_is_not_late_scores_zero() {
        for nominal in [MAXWELL, Nominal::NEW, Nominal { clearance_2a_m: 4e-3, ..Nominal::NEW }] {
            let found = identity(&late(0.0, nominal));
            // The lag of half a cycle takes 6e-5 of the stroke.
            assert!(found.stroke_percent.abs() < 0.02, "{nominal:?}: {found:?}");
            assert!(found.phase_deg.abs() < 0.02, "{nominal:?}: {found:?}");
            assert!(found.work_percent.abs() < 0.1, "{nominal:?}: {found:?}");
        }
    }

    #[test]
    fn a_pure_delay_costs_a_maxwell_element_what_the_formula_says() {
        let relaxation_s = MAXWELL.ce_n_s_per_m / MAXWELL.ke_n_per_m;
        for delay_s in [1e-3, 2e-3, 5e-3, 10e-3, 15e-3] {
            let found = identity(&late(delay_s, MAXWELL));
            let lost = 100.0 * damping_energy_lost(delay_s, HZ, relaxation_s);
            // Percentage points.
            assert!((found.work_percent + lost).abs() < 0.2, "{delay_s}: {found:?}, {lost} %");
            let degrees = (TAU * HZ * delay_s).to_degrees();
            assert!((found.phase_deg + degrees).abs() < 0.02, "{delay_s}: {found:?}");
            assert!(found.stroke_percent.abs() < 0.02, "{delay_s}: {found:?}");
        }
    }

    #[test]
    fn a_compensator_that_knows_a_pure_delay_takes_it_away() {
        use firmware_core::compensation::Feedforward;
        let rig = late(5e-3, MAXWELL);
        let wanted = sine();
        let polynomial = Feedforward::polynomial(3, 5.5e-3);
        let compensator = Compensator::Feedforward(polynomial.with_known_delay(-0.5e-3));
        let (own, command) = compensated(&rig, Regime::Hunting, &wanted, &compensator);
        let again = commanded(&rig, Regime::Hunting, &wanted, &command);
        assert_eq!(own, again);
        let (own, late) = (own.observed(HZ).unwrap(), identity(&rig));
        assert!(own.phase_deg.abs() < 0.1 && late.phase_deg < -6.0, "{own:?} {late:?}");
    }
}
