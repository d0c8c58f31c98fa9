//! Small vibrations of a vehicle about steady running, from the accelerations that a step
//! evaluates.
//!
//! ```text
//! q'' = a(q, q')   ->   z' = [0 I; da/dq da/dq'] z
//! ```
//! with both Jacobians by central differences over bodies and rails. The creep laws bend at zero
//! creepage, `F = C xi (1 - |u|/3)`, which a difference sees in proportion to its width `h`; two
//! widths remove it: `2 D(h) - D(2h)`. A damper comes in as what it is for one frequency and
//! stroke, stiffness and damping at its place (`describing_function`).

pub use crate::describing_function::Impedance;
use firmware_core::lanes::Lanes;
use firmware_core::track::Track;
use firmware_core::vehicle::{
    COORDINATES, DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState,
};
use firmware_core::wheel_rail::table::ContactTable;
use nalgebra::{Complex, DMatrix, Schur};

/// Half width of the narrower differences (m, m/s, rad, rad/s).
const WIDTH: f64 = 1e-8;
/// Most sweeps of the eigenvalue solver.
const SWEEPS_MAX: usize = 10_000;
/// Accuracy of eigenvalues over the largest.
const ACCURACY: f64 = 1e-14;

/// What the damper of every slot does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impedances(pub [Impedance; DAMPER_SLOTS]);

impl DamperForces for Impedances {
    fn force_n(
        &mut self,
        slot: usize,
        _lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        _substep_s: f64,
    ) -> f64 {
        debug_assert!(slot < DAMPER_SLOTS, "slot {slot}");
        let own = self.0.get(slot).copied().unwrap_or_default();
        own.stiffness_n_per_m * extension_m + own.damping_n_s_per_m * rate_m_per_s
    }
}

/// A coordinate that moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// Body and coordinate.
    Body(usize, usize),
    /// Axle, side, and right or down.
    Rail(usize, usize, usize),
}

impl Coordinate {
    /// Those of the bodies alone: for small motions on rails that do not give way.
    pub fn of_bodies(vehicle: &Vehicle) -> Vec<Self> {
        let mut all = Vec::new();
        for (index, body) in vehicle.bodies.iter().enumerate() {
            let free = (0..COORDINATES).filter(|coordinate| body.free[*coordinate]);
            all.extend(free.map(|coordinate| Self::Body(index, coordinate)));
        }
        all
    }

    /// Those of the bodies, then those of the rails under the wheels.
    pub fn all(vehicle: &Vehicle) -> Vec<Self> {
        let mut all = Self::of_bodies(vehicle);
        for (number, axle) in vehicle.axles.iter().enumerate() {
            if axle.rail.is_some() {
                let ends = [(0, 0), (0, 1), (1, 0), (1, 1)];
                all.extend(ends.map(|(side, way)| Self::Rail(number, side, way)));
            }
        }
        all
    }

    pub(crate) fn position(self, state: &mut VehicleState) -> &mut f64 {
        match self {
            Self::Body(body, coordinate) => &mut state.position[body][coordinate].0[0],
            Self::Rail(axle, side, way) => &mut state.rail_position[axle][side][way].0[0],
        }
    }

    pub(crate) fn velocity(self, state: &mut VehicleState) -> &mut f64 {
        match self {
            Self::Body(body, coordinate) => &mut state.half_velocity[body][coordinate].0[0],
            Self::Rail(axle, side, way) => &mut state.rail_half_velocity[axle][side][way].0[0],
        }
    }

    pub(crate) fn acceleration(self, state: &VehicleState) -> f64 {
        match self {
            Self::Body(body, coordinate) => state.acceleration[body][coordinate].lane(0),
            Self::Rail(axle, side, way) => state.rail_acceleration[axle][side][way].lane(0),
        }
    }
}

/// Stiffness and damping over the masses: `-da/dq` and `-da/dq'`, in the order of `coordinates`.
#[derive(Debug, Clone, PartialEq)]
pub struct Jacobians {
    /// `-da/dq` (1/s2).
    pub stiffness: DMatrix<f64>,
    /// `-da/dq'` (1/s).
    pub damping: DMatrix<f64>,
}

impl Jacobians {
    /// About a state of steady running on perfect straight track.
    pub fn about(
        vehicle: &Vehicle,
        contact: Option<&ContactTable>,
        (state, speed_m_per_s): (&VehicleState, f64),
        dampers: Impedances,
        coordinates: &[Coordinate],
    ) -> Self {
        let track = Track::default();
        let running = Running {
            speed_m_per_s: Lanes([speed_m_per_s]),
            tracks: [&track],
            contact,
            substep_s: 0.0,
        };
        let accelerations = |change: &dyn Fn(&mut VehicleState)| -> Vec<f64> {
            let mut trial = state.clone();
            change(&mut trial);
            vehicle.evaluate(&mut trial, &running, &mut { dampers });
            coordinates.iter().map(|coordinate| coordinate.acceleration(&trial)).collect()
        };
        let matrix = |of: fn(Coordinate, &mut VehicleState) -> &mut f64| {
            let mut result = DMatrix::zeros(coordinates.len(), coordinates.len());
            for (mut column, place) in result.column_iter_mut().zip(coordinates) {
                let moved = |by: f64| accelerations(&|trial| *of(*place, trial) += by);
                let narrow = moved(WIDTH).into_iter().zip(moved(-WIDTH));
                let wide = moved(2.0 * WIDTH).into_iter().zip(moved(-2.0 * WIDTH));
                for (entry, (near, far)) in column.iter_mut().zip(narrow.zip(wide)) {
                    let slope = |(up, down): (f64, f64), width: f64| (up - down) / (2.0 * width);
                    *entry = slope(far, 2.0 * WIDTH) - 2.0 * slope(near, WIDTH);
                }
            }
            result
        };
        Self { stiffness: matrix(Coordinate::position), damping: matrix(Coordinate::velocity) }
    }

    /// Eigenvalues (1/s), the least damped first; none where the solver does not settle.
    pub fn eigenvalues(&self) -> Option<Vec<Complex<f64>>> {
        let count = self.stiffness.nrows();
        let mut first_order = DMatrix::zeros(2 * count, 2 * count);
        first_order.view_mut((0, count), (count, count)).fill_with_identity();
        first_order.view_mut((count, 0), (count, count)).copy_from(&-&self.stiffness);
        first_order.view_mut((count, count), (count, count)).copy_from(&-&self.damping);
        let schur = Schur::try_new(first_order, ACCURACY, SWEEPS_MAX)?;
        let mut values: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
        values.sort_by(|a, b| b.re.total_cmp(&a.re));
        Some(values)
    }
}
