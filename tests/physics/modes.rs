//! Small vibrations of a vehicle about a state, from the accelerations that a step evaluates.
//!
//! ```text
//! q'' = a(q, q')   ->   z' = [0 I; da/dq da/dq'] z
//! ```
//! with both Jacobians by central differences. The creep laws bend at zero creepage, `F = C xi
//! (1 - |u|/3)`, which a difference sees in proportion to its width `h`; two widths remove it:
//! `2 D(h) - D(2h)`.

use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{COORDINATES, Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{Complex, DMatrix, Schur};

/// Half width of the narrower differences (m, m/s, rad, rad/s).
const WIDTH: f64 = 1e-8;

/// Changes a coordinate, or its velocity, of a body.
type Change<'a> = &'a dyn Fn(&mut VehicleState, (usize, usize), f64);

/// Body and coordinate of every free coordinate.
pub(crate) fn free_coordinates(vehicle: &Vehicle) -> Vec<(usize, usize)> {
    let all = |body| (0..COORDINATES).map(move |coordinate| (body, coordinate));
    let free = |&(body, coordinate): &(usize, usize)| vehicle.bodies[body].free[coordinate];
    (0..vehicle.bodies.len()).flat_map(all).filter(free).collect()
}

/// Stiffness and damping matrices over the masses: `-da/dq` and `-da/dq'`, rails held still.
pub(crate) fn jacobians(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    state: &VehicleState,
    speed_m_per_s: f64,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let track = Track::default();
    let running =
        Running { speed_m_per_s: Lanes([speed_m_per_s]), track: &track, contact, substep_s: 0.0 };
    let list = free_coordinates(vehicle);
    let accelerations = |trial: &mut VehicleState| -> Vec<f64> {
        vehicle.evaluate(trial, &running, &mut ());
        list.iter().map(|(body, coordinate)| trial.acceleration[*body][*coordinate].0[0]).collect()
    };
    let matrix = |change: Change<'_>| {
        let mut result = DMatrix::zeros(list.len(), list.len());
        for (column, place) in list.iter().enumerate() {
            let moved = |by: f64| {
                let mut trial = state.clone();
                change(&mut trial, *place, by);
                accelerations(&mut trial)
            };
            let narrow = moved(WIDTH).into_iter().zip(moved(-WIDTH));
            let wide = moved(2.0 * WIDTH).into_iter().zip(moved(-2.0 * WIDTH));
            for (row, (near, far)) in narrow.zip(wide).enumerate() {
                let slope = |(up, down): (f64, f64), width: f64| (up - down) / (2.0 * width);
                result[(row, column)] = slope(far, 2.0 * WIDTH) - 2.0 * slope(near, WIDTH);
            }
        }
        result
    };
    let stiffness =
        matrix(&|state, (body, coordinate), by| state.position[body][coordinate].0[0] += by);
    let damping =
        matrix(&|state, (body, coordinate), by| state.half_velocity[body][coordinate].0[0] += by);
    (stiffness, damping)
}

/// Eigenvalues (1/s) of the motion about a state, the least damped first.
pub(crate) fn eigenvalues(
    vehicle: &Vehicle,
    contact: Option<&ContactTable>,
    state: &VehicleState,
    speed_m_per_s: f64,
) -> Vec<Complex<f64>> {
    let (stiffness, damping) = jacobians(vehicle, contact, state, speed_m_per_s);
    let count = stiffness.nrows();
    let mut first_order = DMatrix::zeros(2 * count, 2 * count);
    first_order.view_mut((0, count), (count, count)).fill_with_identity();
    first_order.view_mut((count, 0), (count, count)).copy_from(&-stiffness);
    first_order.view_mut((count, count), (count, count)).copy_from(&-damping);
    // A bounded number of sweeps: the plain call does not end when one value refuses to settle.
    let schur = Schur::try_new(first_order, 1e-14, 10_000).expect("eigenvalues settle");
    let mut values: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
    values.sort_by(|a, b| b.re.total_cmp(&a.re));
    values
}
