//! Cooperrider's bogie from the equations of the literature, apart from the vehicle code.
//!
//! Seven coordinates: lateral shift and yaw of both wheelsets, lateral shift, yaw and roll of the
//! frame (Kaas-Petersen, Acta Mechanica 61, 1986, 89-107):
//! ```text
//! mw q1'' = -A1 - 2 Fy1 - FT(q1)       Iw q2'' = -A2 - 2 a Fx1         (q3, q4: the rear wheelset)
//! mf q5'' = A1 + A3 - A5                If q6'' = b (A1 - A3) + A2 + A4 - A6
//! Ir q7'' = h1 (A1 + A3) + h2 A5 - A7
//! A1 = 2 k1 (q1 - q5 - b q6 - h1 q7)    A3 = 2 k1 (q3 - q5 + b q6 - h1 q7)
//! A2 = 2 k2 d1^2 (q2 - q6)              A5 = 2 D2 (q5' - h2 q7') + 2 k4 (q5 - h2 q7)
//! A6 = k6 q6 + D6 q6'                   A7 = 2 D1 d2^2 q7' + 2 k5 d2^2 q7 + 4 k3 d1^2 q7
//! xx = a q2'/v + lambda q1/r0           xy = q1'/v - q2
//! ```
//! Creep by Vermeulen and Johnson with `xr^2 = (xx/Psi)^2 + (xy/Phi)^2`; a flange of stiffness `k0`
//! beyond `delta`.

use nalgebra::{Complex, SMatrix, SVector};

/// Positions, then velocities.
pub(super) type State = SVector<f64, 14>;

/// The parameters that are printed differently in different places; the others stand in the
/// equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parameters {
    /// `G pi a b` (N).
    pub shear_force_n: f64,
    /// Longitudinal coefficient.
    pub psi: f64,
    /// Lateral coefficient.
    pub phi: f64,
    /// Damping of the frame's yaw, D6 (N m s).
    pub yaw_damping_n_m_s: f64,
}

impl Parameters {
    /// As printed.
    pub(super) const PRINTED: Self =
        Self { shear_force_n: 6.563e6, psi: 0.602_52, phi: 0.542_19, yaw_damping_n_m_s: 500.0 };

    /// Rates of all states at a speed (m/s).
    pub(super) fn rates(&self, state: &State, speed_m_per_s: f64) -> State {
        let q = state.fixed_rows::<7>(0);
        let u = state.fixed_rows::<7>(7);
        let (a, b, d1, d2, h1, h2) = (0.716, 1.074, 0.620, 0.680, 0.0762, 0.6584);
        let (k1, k2, k3, k4, k5, k6) = (1.823e6, 3.646e6, 3.646e6, 0.1823e6, 0.3333e6, 2.710e6);
        let (roll_damping, lateral_damping) = (20e3, 29.2e3);
        let a1 = 2.0 * k1 * (q[0] - q[4] - b * q[5] - h1 * q[6]);
        let a3 = 2.0 * k1 * (q[2] - q[4] + b * q[5] - h1 * q[6]);
        let a2 = 2.0 * k2 * d1 * d1 * (q[1] - q[5]);
        let a4 = 2.0 * k2 * d1 * d1 * (q[3] - q[5]);
        let a5 = 2.0 * lateral_damping * (u[4] - h2 * u[6]) + 2.0 * k4 * (q[4] - h2 * q[6]);
        let a6 = k6 * q[5] + self.yaw_damping_n_m_s * u[5];
        let a7 =
            2.0 * roll_damping * d2 * d2 * u[6] + (2.0 * k5 * d2 * d2 + 4.0 * k3 * d1 * d1) * q[6];
        let (mut wheelsets, links) = ([[0.0; 2]; 2], [[a1, a2], [a3, a4]]);
        for (number, (wheelset, [lateral, yaw])) in wheelsets.iter_mut().zip(links).enumerate() {
            let (shift, turn) = (2 * number, 2 * number + 1);
            let along = a * u[turn] / speed_m_per_s + 0.05 * q[shift] / 0.4572;
            let across = u[shift] / speed_m_per_s - q[turn];
            let [fx, fy] = self.creep_n(along, across);
            let flange = 14.6e6 * (q[shift].abs() - 9.1e-3).max(0.0) * q[shift].signum();
            *wheelset = [(-lateral - 2.0 * fy - flange) / 1022.0, (-yaw - 2.0 * a * fx) / 678.0];
        }
        let [[y1, t1], [y2, t2]] = wheelsets;
        let frame = [
            (a1 + a3 - a5) / 2918.0,
            (b * (a1 - a3) + a2 + a4 - a6) / 6780.0,
            (h1 * (a1 + a3) + h2 * a5 - a7) / 6780.0,
        ];
        let mut rates = State::zeros();
        rates.fixed_rows_mut::<7>(0).copy_from(&u);
        rates
            .fixed_rows_mut::<7>(7)
            .copy_from_slice(&[y1, t1, y2, t2, frame[0], frame[1], frame[2]]);
        rates
    }

    /// Longitudinal and lateral creep force of one wheel (N).
    fn creep_n(&self, along: f64, across: f64) -> [f64; 2] {
        const LIMIT_N: f64 = 1e4;
        let (x, y) = (along / self.psi, across / self.phi);
        let resultant = libm::hypot(x, y);
        if resultant == 0.0 {
            return [0.0; 2];
        }
        let u = self.shear_force_n * resultant / LIMIT_N;
        let share = if u < 3.0 { u - u * u / 3.0 + u * u * u / 27.0 } else { 1.0 };
        [x, y].map(|part| LIMIT_N * share * part / resultant)
    }

    /// The least damped eigenvalue of running in the middle (1/s).
    ///
    /// Creep at zero creepage is linear with the slope `G pi a b / Psi` and `/ Phi`: small
    /// creepages see `1 - u/3` of it, so the matrix is taken from two widths.
    pub(super) fn least_damped(&self, speed_m_per_s: f64) -> Complex<f64> {
        let matrix = |width: f64| {
            let mut matrix = SMatrix::<f64, 14, 14>::zeros();
            for (index, mut column) in matrix.column_iter_mut().enumerate() {
                let mut state = State::zeros();
                state[index] = width;
                // Odd in the state: one side is enough.
                column.copy_from(&(self.rates(&state, speed_m_per_s) / width));
            }
            matrix
        };
        let (narrow, wide) = (matrix(1e-9), matrix(2e-9));
        let linear = narrow * 2.0 - wide;
        let values = linear.complex_eigenvalues();
        let mut least = values[0];
        for value in values.iter().filter(|value| value.im >= 0.0) {
            if value.re > least.re || least.im < 0.0 {
                least = *value;
            }
        }
        least
    }

    /// Where small motions begin to grow (m/s), to 1e-5.
    pub(super) fn hopf_m_per_s(&self) -> f64 {
        let (mut stable, mut unstable) = (50.0, 90.0);
        while unstable - stable > 1e-5 {
            let middle = 0.5 * (stable + unstable);
            if self.least_damped(middle).re < 0.0 {
                stable = middle;
            } else {
                unstable = middle;
            }
        }
        stable
    }

    /// One step of the classical Runge-Kutta method.
    pub(super) fn step(&self, state: &State, speed_m_per_s: f64, step_s: f64) -> State {
        let rates = |state: &State| self.rates(state, speed_m_per_s);
        let first = rates(state);
        let second = rates(&(state + first * (0.5 * step_s)));
        let third = rates(&(state + second * (0.5 * step_s)));
        let fourth = rates(&(state + third * step_s));
        state + (first + (second + third) * 2.0 + fourth) * (step_s / 6.0)
    }
}
