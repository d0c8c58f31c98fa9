//! The frame: three floors, modal damping, the ground moving below.

use crate::case::Case;
use nalgebra::{Matrix3, SymmetricEigen};
use rig_emulator::benchmark_plant::Specimen;

/// Number of floors.
pub(crate) const FLOORS: usize = 3;
/// Stiffness of the whole frame, N/m.
const STIFFNESS_N_PER_M: Matrix3<f64> = Matrix3::new(
    26_054_883.879_604,
    -23_133_938.877_108,
    5_937_035.463_339,
    -23_133_938.877_108,
    32_560_774.186_38,
    -14_419_970.777_237,
    5_937_035.463_339,
    -14_419_970.777_237,
    9_267_275.506_224,
);

/// Displacements of the floors relative to the ground, then their velocities.
pub(crate) type Motion = [f64; 2 * FLOORS];

/// A frame, or the part of it that is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Structure {
    mass_kg: [f64; FLOORS],
    /// Mass that the ground accelerates. The mass of the specimen stays in it: the specimen has no
    /// ground of its own.
    loaded_mass_kg: f64,
    damping_n_s_per_m: [[f64; FLOORS]; FLOORS],
    stiffness_n_per_m: [[f64; FLOORS]; FLOORS],
}

impl Structure {
    /// The whole frame of a case.
    pub(crate) fn whole(case: Case) -> Self {
        let mass_kg = case.floor_mass_kg;
        let modes = SymmetricEigen::new(STIFFNESS_N_PER_M / mass_kg);
        // Equal masses: the modes are orthonormal, and each has the mass of a floor.
        let damping = modes.eigenvalues.map(|square| 2.0 * case.damping_ratio * square.sqrt());
        let shapes = modes.eigenvectors;
        let damping = shapes * Matrix3::from_diagonal(&damping) * shapes.transpose() * mass_kg;
        Self {
            mass_kg: [mass_kg; FLOORS],
            loaded_mass_kg: mass_kg,
            damping_n_s_per_m: rows(&damping),
            stiffness_n_per_m: rows(&STIFFNESS_N_PER_M),
        }
    }

    /// The frame without a specimen at its first floor.
    pub(crate) fn without(mut self, specimen: &Specimen) -> Self {
        self.mass_kg[0] -= specimen.mass_kg;
        self.damping_n_s_per_m[0][0] -= specimen.damping_n_s_per_m;
        self.stiffness_n_per_m[0][0] -= specimen.stiffness_n_per_m;
        self
    }

    /// Derivative of the motion, with the acceleration of the ground and a force that the specimen
    /// exerts against the first floor.
    pub(crate) fn slope(&self, motion: &Motion, ground_m_per_s2: f64, force_n: f64) -> Motion {
        let [x0, x1, x2, v0, v1, v2] = *motion;
        let load_n = self.loaded_mass_kg * ground_m_per_s2;
        let acceleration = |floor: usize, external_n: f64| {
            let [k0, k1, k2] = self.stiffness_n_per_m[floor];
            let [c0, c1, c2] = self.damping_n_s_per_m[floor];
            let inner_n = k0 * x0 + k1 * x1 + k2 * x2 + c0 * v0 + c1 * v1 + c2 * v2;
            -(inner_n + external_n + load_n) / self.mass_kg[floor]
        };
        [v0, v1, v2, acceleration(0, force_n), acceleration(1, 0.0), acceleration(2, 0.0)]
    }
}

/// A matrix as arrays of its rows.
fn rows(matrix: &Matrix3<f64>) -> [[f64; FLOORS]; FLOORS] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::CASES;
    use std::f64::consts::TAU;

    #[test]
    fn natural_frequencies_are_the_published_ones() {
        for (case, expected_hz) in CASES.into_iter().zip([
            [3.612, 15.997, 38.086],
            [3.444, 15.252, 36.314],
            [3.168, 14.030, 33.404],
            [3.612, 15.997, 38.086],
        ]) {
            let modes = SymmetricEigen::new(STIFFNESS_N_PER_M / case.floor_mass_kg);
            let mut found_hz: Vec<f64> =
                modes.eigenvalues.iter().map(|square| square.sqrt() / TAU).collect();
            found_hz.sort_by(f64::total_cmp);
            for (found, expected) in found_hz.iter().zip(expected_hz) {
                assert!((found - expected).abs() < 1e-3, "case {}: {found}", case.number);
            }
        }
    }

    #[test]
    fn free_motion_decays_with_the_damping_ratio_of_its_mode() {
        let case = CASES[1];
        let modes = SymmetricEigen::new(STIFFNESS_N_PER_M / case.floor_mass_kg);
        let whole = Structure::whole(case);
        for mode in 0..FLOORS {
            let shape = modes.eigenvectors.column(mode);
            let motion = [0.0, 0.0, 0.0, shape[0], shape[1], shape[2]];
            let slope = whole.slope(&motion, 0.0, 0.0);
            let expected = -2.0 * case.damping_ratio * modes.eigenvalues[mode].sqrt();
            for floor in 0..FLOORS {
                assert!((slope[3 + floor] - expected * shape[floor]).abs() < 1e-9);
            }
        }
    }
}
