//! What a force at a damper's place does to a vehicle about steady running.
//!
//! Every damper is a dashpot `Ce` and a spring `Ke` in series, which is exact at all frequencies as
//! long as its relief valve is shut and its clearance is taken up:
//!
//! ```text
//! q' = v      v' = a(q, v) - B f      lambda f' + f = Ce x'      x' = E v
//! G(s) = sum of R_i / (s - p_i)       extension of a slot over a force that extends it
//! ```
//! Poles and residues come from the Schur form of the whole system: its eigenvectors by back
//! substitution. `G` has all dampers in it; without that of its own slot it is
//! `H = G / (1 - G K)` with `K = s Ce / (1 + s lambda)`.
//!
//! Limits: linear. A pole that is met twice has one vector only where its vectors differ; such
//! poles (two equal wheelsets) are damped well and far from hunting.

use crate::modes::{Coordinate, Impedances, Jacobians};
use firmware_core::damper::Nominal;
use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{Complex, DMatrix, DVector, Schur};
use std::f64::consts::TAU;

/// Force at which the accelerations are compared (N).
const FORCE_N: f64 = 1e3;
/// Half width of differences of kinematics, which are linear (m, m/s).
const WIDTH: f64 = 1e-6;
/// Unit of a damper's force in the system (N), so that its entries are of a size.
const UNIT_N: f64 = 1e6;
/// Most sweeps of the eigenvalue solver.
const SWEEPS_MAX: usize = 10_000;
/// Accuracy of eigenvalues over the largest.
const ACCURACY: f64 = 1e-14;
/// Frequencies of hunting lie between these (Hz).
const HUNTING_HZ: [f64; 2] = [0.3, 15.0];
/// A mode counts as hunting if a damper sees this share of what it sees of the strongest one.
const SEEN: f64 = 0.05;

/// A pole with its residues at every damper slot. One off the real axis stands for its conjugate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// The pole (1/s), its imaginary part not negative.
    pub pole: Complex<f64>,
    /// Residues of the extension over an extending force (m/(N s)).
    pub residues: [Complex<f64>; DAMPER_SLOTS],
}

/// A vehicle in which every damper is `Ce` and `Ke` in series.
#[derive(Debug, Clone, PartialEq)]
struct System {
    matrix: DMatrix<f64>,
    /// Extension of each slot.
    extension: Vec<DVector<f64>>,
    /// What an extending force at each slot does.
    force: Vec<DVector<f64>>,
}

/// The resonances of a vehicle about a state of steady running; none where the solver does not
/// settle.
pub fn resonances(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    about: (&VehicleState, f64),
    dampers: &[Nominal],
) -> Option<Vec<Resonance>> {
    System::about(vehicle, contact, about, dampers).resonances()
}

/// The least damped oscillation that a damper sees: of smallest damping ratio between 0.3 and 15 Hz.
pub fn hunting(resonances: &[Resonance]) -> Option<&Resonance> {
    let [low, high] = HUNTING_HZ;
    let seen = |one: &Resonance| {
        let most = one.residues.iter().map(|residue| residue.norm()).fold(0.0, f64::max);
        most / one.pole.re.abs().max(f64::MIN_POSITIVE)
    };
    let in_range = |one: &&Resonance| (low..high).contains(&(one.pole.norm() / TAU));
    let oscillates = |one: &&Resonance| one.pole.im > 0.0;
    let candidates = || resonances.iter().filter(in_range).filter(oscillates);
    let strongest = candidates().map(seen).fold(0.0, f64::max);
    candidates()
        .filter(|one| seen(one) >= SEEN * strongest)
        .min_by(|a, b| damping_ratio(a.pole).total_cmp(&damping_ratio(b.pole)))
}

/// The damping ratio of a pole; negative where its motion grows.
pub fn damping_ratio(pole: Complex<f64>) -> f64 {
    -pole.re / pole.norm()
}

/// One slot with a constant force.
struct Constant {
    slot: usize,
    force_n: f64,
}

impl DamperForces for Constant {
    fn force_n(&mut self, slot: usize, _lane: usize, _x: f64, _v: f64, _step_s: f64) -> f64 {
        if slot == self.slot { self.force_n } else { 0.0 }
    }
}

impl System {
    fn about(
        vehicle: &Vehicle,
        contact: Option<&ContactTable>,
        (state, speed_m_per_s): (&VehicleState, f64),
        dampers: &[Nominal],
    ) -> Self {
        debug_assert!(dampers.len() <= vehicle.dampers.len(), "a damper without a mount");
        let coordinates = Coordinate::all(vehicle);
        let about = (state, speed_m_per_s);
        let bare = Jacobians::about(vehicle, contact, about, Impedances::default(), &coordinates);
        let track = Track::default();
        let running = Running {
            speed_m_per_s: Lanes([speed_m_per_s]),
            track: &track,
            contact,
            substep_s: 0.0,
        };
        let (count, slots) = (coordinates.len(), dampers.len());
        let order = 2 * count + slots;
        let mut matrix = DMatrix::zeros(order, order);
        matrix.view_mut((0, count), (count, count)).fill_with_identity();
        matrix.view_mut((count, 0), (count, count)).copy_from(&-bare.stiffness);
        matrix.view_mut((count, count), (count, count)).copy_from(&-bare.damping);
        let motions = |place: Coordinate, of: fn(Coordinate, &mut VehicleState) -> &mut f64| {
            let moved = |by: f64| {
                let mut trial = state.clone();
                *of(place, &mut trial) += by;
                vehicle.damper_motions(&trial, &running)
            };
            let (up, down) = (moved(WIDTH), moved(-WIDTH));
            move |slot: usize| {
                let [(x_up, v_up), (x_down, v_down)] = [up, down].map(|all| all[slot]);
                let slope =
                    |up: Lanes<1>, down: Lanes<1>| (up.lane(0) - down.lane(0)) / (2.0 * WIDTH);
                (slope(x_up, x_down), slope(v_up, v_down))
            }
        };
        let mut extension = vec![DVector::zeros(order); slots];
        for (number, place) in coordinates.iter().enumerate() {
            let by_position = motions(*place, Coordinate::position);
            let by_velocity = motions(*place, Coordinate::velocity);
            for (slot, damper) in dampers.iter().enumerate() {
                let (x, rate) = by_position(slot);
                extension[slot][number] = x;
                let stiffness = damper.ke_n_per_m / UNIT_N;
                let row = 2 * count + slot;
                matrix[(row, number)] = stiffness * rate;
                matrix[(row, count + number)] = stiffness * by_velocity(slot).1;
            }
        }
        let accelerations = |slot: usize, force_n: f64| -> Vec<f64> {
            let mut trial = state.clone();
            vehicle.evaluate(&mut trial, &running, &mut Constant { slot, force_n });
            coordinates.iter().map(|place| place.acceleration(&trial)).collect()
        };
        let mut force = vec![DVector::zeros(order); slots];
        for (slot, damper) in dampers.iter().enumerate() {
            let column = 2 * count + slot;
            let tension = accelerations(slot, FORCE_N).into_iter();
            for (number, (up, down)) in tension.zip(accelerations(slot, -FORCE_N)).enumerate() {
                let per_n = (up - down) / (2.0 * FORCE_N);
                matrix[(count + number, column)] = per_n * UNIT_N;
                force[slot][count + number] = -per_n;
            }
            matrix[(column, column)] = -damper.ke_n_per_m / damper.ce_n_s_per_m;
        }
        Self { matrix, extension, force }
    }

    fn resonances(&self) -> Option<Vec<Resonance>> {
        let complex = |value: f64| Complex::new(value, 0.0);
        let order = self.matrix.nrows();
        let (basis, triangle) =
            Schur::try_new(self.matrix.map(complex), ACCURACY, SWEEPS_MAX)?.unpack();
        let least = 1e-13 * triangle.norm();
        let mut vectors = DMatrix::<Complex<f64>>::identity(order, order);
        for pole in 0..order {
            for row in (0..pole).rev() {
                let known = (row + 1..=pole).map(|k| triangle[(row, k)] * vectors[(k, pole)]);
                let sum: Complex<f64> = known.sum();
                let gap = triangle[(pole, pole)] - triangle[(row, row)];
                let gap = if gap.norm() < least { complex(least) } else { gap };
                vectors[(row, pole)] = sum / gap;
            }
        }
        let seen = &basis * &vectors;
        let mut residues = vec![[Complex::default(); DAMPER_SLOTS]; order];
        for (slot, (extension, force)) in self.extension.iter().zip(&self.force).enumerate() {
            let shown = seen.tr_mul(&extension.map(complex));
            let excited = basis.adjoint() * force.map(complex);
            let excited = vectors.solve_upper_triangular(&excited)?;
            for (residue, (shown, excited)) in
                residues.iter_mut().zip(shown.iter().zip(excited.iter()))
            {
                residue[slot] = shown * excited;
            }
        }
        let poles = (0..order).map(|pole| triangle[(pole, pole)]);
        let all = poles.zip(residues).map(|(pole, residues)| Resonance { pole, residues });
        // A real pole has rounding of either sign.
        let is_real = |pole: Complex<f64>| pole.im.abs() <= 1e-9 * pole.norm();
        let upper = all.filter(|one| is_real(one.pole) || one.pole.im > 0.0).map(|mut one| {
            if is_real(one.pole) {
                one.pole.im = 0.0;
            }
            one
        });
        Some(upper.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trip::Equipped;
    use scenario::equilibrium;
    use scenario::run::{Overrides, Run};
    use std::path::Path;

    /// The locomotive at a speed (km/h).
    fn locomotive(kmh: f64) -> System {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let run = Run::load(&path, Overrides::default()).unwrap();
        let equipped = Equipped::of(&run).unwrap();
        let dampers: Vec<Nominal> =
            equipped.dampers.iter().map(|damper| *damper.nominal()).collect();
        let steady = equilibrium::running(&equipped.vehicle, equipped.table(), kmh / 3.6).unwrap();
        let about = (&steady.state, kmh / 3.6);
        System::about(&equipped.vehicle, equipped.table(), about, &dampers)
    }

    #[test]
    fn poles_and_residues_give_what_the_system_gives() {
        let system = locomotive(160.0);
        let found = system.resonances().unwrap();
        let order = system.matrix.nrows();
        for hz in [0.5, 3.3, 12.0, 80.0, 300.0] {
            let s = Complex::new(0.0, TAU * hz);
            let shifted = DMatrix::identity(order, order) * s
                - system.matrix.map(|value| Complex::new(value, 0.0));
            let force = system.force[1].map(|value| Complex::new(value, 0.0));
            let state = shifted.lu().solve(&force).unwrap();
            let extension = system.extension[1].map(|value| Complex::new(value, 0.0));
            let direct = extension.dot(&state);
            let by_poles: Complex<f64> = found
                .iter()
                .map(|one| {
                    let own = one.residues[1] / (s - one.pole);
                    let other = one.residues[1].conj() / (s - one.pole.conj());
                    if one.pole.im == 0.0 { own } else { own + other }
                })
                .sum();
            let off = (by_poles - direct).norm() / direct.norm();
            assert!(off < 1e-5, "{hz} Hz: {direct} {by_poles}");
        }
    }

    #[test]
    fn the_locomotive_hunts_between_two_and_five_hertz_and_less_damped_when_faster() {
        let at = |kmh: f64| {
            let found = locomotive(kmh).resonances().unwrap();
            let hunting = hunting(&found).unwrap();
            (hunting.pole.norm() / TAU, damping_ratio(hunting.pole))
        };
        let (slow, fast) = (at(160.0), at(240.0));
        println!("160 km/h: {slow:?}, 240 km/h: {fast:?}");
        assert!((2.0..5.0).contains(&slow.0) && (2.0..6.0).contains(&fast.0), "{slow:?} {fast:?}");
        assert!(fast.1 < slow.1, "{slow:?} {fast:?}");
    }
}
