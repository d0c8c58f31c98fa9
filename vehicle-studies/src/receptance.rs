//! What a force at a damper's place does to a vehicle about steady running.
//!
//! Every damper is a dashpot `Ce` and a spring `Ke` in series, which is exact at all frequencies as
//! long as its relief valve is shut and its clearance is taken up:
//!
//! ```text
//! q' = v      v' = a(q, v) - B f      lambda f' + f = Ce x'      x' = E v
//! G(s) = sum of R_i / (s - p_i)       extension of a slot over a force that extends it
//! ```
//! Poles come from the real Schur form `T` of the whole system. A residue is the mean of
//! `(s - p) G(s)` over a circle around its pole, `G` by back substitution with `T`; what lies
//! outside of the circle falls out of the mean as `(r / d)^n` with its distance `d` and `n` points.
//! `G` has all dampers in it; without that of its own slot it is
//! `H = G / (1 - G K)` with `K = s Ce / (1 + s lambda)`. Where one force acts in several slots, `G`
//! is needed between them too.
//!
//! Limits: linear. Poles that are closer than a millionth of their size, such as those of two equal
//! wheelsets, are one.

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
/// Accuracy of eigenvalues over the largest; the solver does not settle at 1e-14.
const ACCURACY: f64 = 1e-12;
/// Poles nearer than this, over their size, are one.
const TOGETHER: f64 = 1e-6;
/// Radius of a circle over the distance to the next pole.
const RADIUS: f64 = 0.3;
/// Points on a circle.
const POINTS: usize = 16;
/// Frequencies of hunting lie between these (Hz).
const HUNTING_HZ: [f64; 2] = [0.3, 15.0];
/// A mode counts as hunting if a damper sees this share of what it sees of the strongest one: the
/// peak of its receptance, `|R| / |Re p|`.
const SEEN: f64 = 0.5;

/// A pole with its residues at every damper slot. One off the real axis stands for its conjugate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// The pole (1/s), its imaginary part not negative.
    pub pole: Complex<f64>,
    /// Residues of the extension over an extending force of the same slot (m/(N s)).
    pub residues: [Complex<f64>; DAMPER_SLOTS],
    /// The same between slots: the extension of the first index over a force of the second.
    pub cross: [[Complex<f64>; DAMPER_SLOTS]; DAMPER_SLOTS],
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

/// The least damped oscillation that a damper sees: of smallest damping ratio between 0.3 and 15
/// Hz.
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
            tracks: [&track],
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
        let (basis, triangle) = Schur::try_new(self.matrix.clone(), ACCURACY, SWEEPS_MAX)?.unpack();
        let turned = |vectors: &[DVector<f64>]| -> Vec<DVector<f64>> {
            vectors.iter().map(|vector| basis.tr_mul(vector)).collect()
        };
        let (extension, force) = (turned(&self.extension), turned(&self.force));
        let poles = poles(&triangle);
        let mut resonances = Vec::new();
        for (number, pole) in poles.iter().enumerate() {
            let near = |other: &Complex<f64>| (other - pole).norm() <= TOGETHER * pole.norm();
            let together: Vec<Complex<f64>> = poles.iter().copied().filter(near).collect();
            if poles.iter().take(number).any(near) {
                continue;
            }
            let mut centre = together.iter().sum::<Complex<f64>>() / together.len() as f64;
            if centre.im.abs() <= TOGETHER * centre.norm() {
                centre.im = 0.0;
            }
            if centre.im < 0.0 {
                continue;
            }
            let others = poles.iter().filter(|other| !near(other));
            let gap = others.map(|other| (other - centre).norm()).fold(f64::INFINITY, f64::min);
            let radius = RADIUS * gap.min(centre.norm());
            let mut cross = [[Complex::default(); DAMPER_SLOTS]; DAMPER_SLOTS];
            for point in 0..POINTS {
                let angle = TAU * (point as f64 + 0.5) / POINTS as f64;
                let way = Complex::from_polar(radius, angle);
                for (of, force) in force.iter().enumerate() {
                    let state = solved(&triangle, centre + way, force);
                    for (residues, shown) in cross.iter_mut().zip(&extension) {
                        let seen: Complex<f64> =
                            shown.iter().zip(&state).map(|(shown, state)| state * *shown).sum();
                        residues[of] += seen * way / POINTS as f64;
                    }
                }
            }
            let residues = std::array::from_fn(|slot| cross[slot][slot]);
            resonances.push(Resonance { pole: centre, residues, cross });
        }
        Some(resonances)
    }
}

/// The eigenvalues of a quasi-triangular matrix, in the order of its diagonal.
fn poles(triangle: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let order = triangle.nrows();
    let (mut poles, mut row) = (Vec::with_capacity(order), 0);
    while row < order {
        if row + 1 == order || triangle[(row + 1, row)] == 0.0 {
            poles.push(Complex::new(triangle[(row, row)], 0.0));
            row += 1;
            continue;
        }
        let [a, b, c, d] = block(triangle, row);
        let (half, product) = (0.5 * (a + d), a * d - b * c);
        let root = Complex::new(half * half - product, 0.0).sqrt();
        poles.extend([root + half, -root + half]);
        row += 2;
    }
    poles
}

/// The two-by-two block on the diagonal that begins in a row.
fn block(triangle: &DMatrix<f64>, row: usize) -> [f64; 4] {
    let of = |down: usize, right: usize| triangle[(row + down, row + right)];
    [of(0, 0), of(0, 1), of(1, 0), of(1, 1)]
}

/// `(s I - T)^-1 f` for a quasi-triangular `T`, by back substitution.
fn solved(triangle: &DMatrix<f64>, s: Complex<f64>, force: &DVector<f64>) -> Vec<Complex<f64>> {
    let order = triangle.nrows();
    let mut state = vec![Complex::default(); order];
    let known = |state: &[Complex<f64>], row: usize, from: usize| {
        let behind = (from..order).map(|column| state[column] * triangle[(row, column)]);
        behind.sum::<Complex<f64>>() + force[row]
    };
    let mut end = order;
    while end > 0 {
        let last = end - 1;
        if last == 0 || triangle[(last, last - 1)] == 0.0 {
            state[last] = known(&state, last, end) / (s - triangle[(last, last)]);
            end -= 1;
            continue;
        }
        let first = last - 1;
        let [a, b, c, d] = block(triangle, first);
        let (upper, lower) = (known(&state, first, end), known(&state, last, end));
        let determinant = (s - a) * (s - d) - b * c;
        state[first] = (upper * (s - d) + lower * b) / determinant;
        state[last] = (lower * (s - a) + upper * c) / determinant;
        end -= 2;
    }
    state
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
        assert!((2.0..5.0).contains(&slow.0) && (2.0..6.0).contains(&fast.0), "{slow:?} {fast:?}");
        assert!(fast.1 < slow.1, "{slow:?} {fast:?}");
    }
}
