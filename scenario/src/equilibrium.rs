//! The vehicle at rest, or running steadily on perfect track: all accelerations zero.
//!
//! Newton's method on the very function that a step evaluates: unknown are the positions of all
//! free coordinates and rails, and for a wheelset's pitch its rate (where it stands does not
//! matter). The Jacobian is taken by central differences.

use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{COORDINATES, PITCH, Running, VERTICAL, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{DMatrix, DVector};

/// A solved equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The state, ready to run from.
    pub state: VehicleState,
    /// Largest acceleration of any coordinate (m/s2, rad/s2).
    pub residual_m_per_s2: f64,
}

/// Why no equilibrium was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoEquilibrium {
    /// Largest acceleration that was left (m/s2, rad/s2).
    pub residual_m_per_s2: f64,
}

impl std::fmt::Display for NoEquilibrium {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "no equilibrium: {} m/s2 left; is a body without support?",
            self.residual_m_per_s2
        )
    }
}

impl std::error::Error for NoEquilibrium {}

/// Newton gives up after this many iterations.
const ITERATIONS_MAX: usize = 60;

/// Good enough (m/s2); ten times below what the tests demand.
const RESIDUAL_M_PER_S2: f64 = 1e-9;

/// At rest: creep is off, whatever the creep law.
///
/// # Errors
/// Newton's method does not converge.
pub fn at_rest(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
) -> Result<Equilibrium, NoEquilibrium> {
    let mut still = vehicle.clone();
    for axle in &mut still.axles {
        axle.wheel.friction = 0.0;
    }
    solve(&still, contact, 1.0, false, VehicleState::default())
}

/// Running at a steady speed (m/s) on perfect straight track.
///
/// # Errors
/// Newton's method does not converge.
pub fn running(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    speed_m_per_s: f64,
) -> Result<Equilibrium, NoEquilibrium> {
    let rest = at_rest(vehicle, contact)?;
    solve(vehicle, contact, speed_m_per_s, true, rest.state)
}

/// One unknown.
#[derive(Clone, Copy)]
enum Unknown {
    Position(usize, usize),
    PitchRate(usize),
    Rail(usize, usize, usize),
}

fn unknowns(vehicle: &Vehicle, rolling: bool) -> Vec<Unknown> {
    let mut list = Vec::new();
    for (index, body) in vehicle.bodies.iter().enumerate() {
        for coordinate in 0..COORDINATES {
            let spins = body.rolling_radius_m.is_some() && coordinate == PITCH;
            match (body.free[coordinate], spins) {
                (true, false) => list.push(Unknown::Position(index, coordinate)),
                (true, true) if rolling => list.push(Unknown::PitchRate(index)),
                _ => {}
            }
        }
    }
    for (index, axle) in vehicle.axles.iter().enumerate() {
        if axle.rail.is_some() {
            for side in 0..2 {
                for direction in 0..2 {
                    list.push(Unknown::Rail(index, side, direction));
                }
            }
        }
    }
    list
}

fn unknown_of(state: &mut VehicleState, unknown: Unknown) -> &mut f64 {
    match unknown {
        Unknown::Position(body, coordinate) => &mut state.position[body][coordinate].0[0],
        Unknown::PitchRate(body) => &mut state.half_velocity[body][PITCH].0[0],
        Unknown::Rail(axle, side, direction) => {
            &mut state.rail_position[axle][side][direction].0[0]
        }
    }
}

fn acceleration_of(state: &VehicleState, unknown: Unknown) -> f64 {
    match unknown {
        Unknown::Position(body, coordinate) => state.acceleration[body][coordinate].0[0],
        Unknown::PitchRate(body) => state.acceleration[body][PITCH].0[0],
        Unknown::Rail(axle, side, direction) => state.rail_acceleration[axle][side][direction].0[0],
    }
}

fn solve(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    speed_m_per_s: f64,
    rolling: bool,
    start: VehicleState,
) -> Result<Equilibrium, NoEquilibrium> {
    let track = Track::default();
    let list = unknowns(vehicle, rolling);
    let running = Running {
        speed_m_per_s: Lanes([speed_m_per_s]),
        tracks: [&track],
        contact,
        substep_s: 0.0,
    };
    let mut state = start;
    if state == VehicleState::default() {
        // Press every wheel into its rail, so that the contact has a slope.
        for (body, pose) in vehicle.bodies.iter().zip(&mut state.position) {
            if body.free[VERTICAL] {
                pose[VERTICAL] = Lanes([1e-4]);
            }
        }
    }
    let residual = |state: &mut VehicleState| {
        vehicle.evaluate(state, &running, &mut ());
        DVector::from_iterator(list.len(), list.iter().map(|u| acceleration_of(state, *u)))
    };
    let mut left = residual(&mut state);
    for _ in 0..ITERATIONS_MAX {
        if left.amax() < RESIDUAL_M_PER_S2 {
            break;
        }
        let mut jacobian = DMatrix::zeros(list.len(), list.len());
        for (column, unknown) in list.iter().enumerate() {
            let step = 1e-7;
            let moved = |by: f64| {
                let mut trial = state.clone();
                *unknown_of(&mut trial, *unknown) += by;
                residual(&mut trial)
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            jacobian.set_column(column, &slope);
        }
        let Some(change) = jacobian.lu().solve(&left) else { break };
        // Halve the step until it helps.
        let mut share = 1.0;
        let mut best: Option<(f64, VehicleState, DVector<f64>)> = None;
        for _ in 0..12 {
            let mut trial = state.clone();
            for (unknown, value) in list.iter().zip(&change) {
                *unknown_of(&mut trial, *unknown) -= share * value;
            }
            let after = residual(&mut trial);
            let size = after.amax();
            if size.is_finite() && best.as_ref().is_none_or(|(least, ..)| size < *least) {
                best = Some((size, trial, after));
            }
            if size < 0.5 * left.amax() {
                break;
            }
            share *= 0.5;
        }
        let Some((size, trial, after)) = best else { break };
        let stuck = size >= left.amax();
        if stuck {
            break;
        }
        state = trial;
        left = after;
    }
    let residual_m_per_s2 = left.amax();
    if residual_m_per_s2 < 1e-6 {
        Ok(Equilibrium { state, residual_m_per_s2 })
    } else {
        Err(NoEquilibrium { residual_m_per_s2 })
    }
}
