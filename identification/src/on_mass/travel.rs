//! Hysteresis of Bouc and Wen with exponent 1, exact in travel: there is no time step in it.
//!
//! ```text
//! z' = A v - B1 |v| z - B2 v |z|      dz/dx = A - g z,   g = B1 sgn(dx) + B2 sgn(z)
//! ```
//!
//! Between two changes of sign of `z` this is linear in the travel `x`, and its solution is an
//! exponential. The law is passive for `B1 >= |B2|`. It has a capacity `A / (B1 + B2)` only where
//! `B1 + B2 > 0`; without one the force grows without limit. Pre-sliding friction of Dahl is the
//! case `A = F_c / x_d`, `B1 = 1 / x_d`, `B2 = 0`.

/// The three coefficients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Travel {
    /// Stiffness at zero force, N/m.
    pub(super) stiffness_n_per_m: f64,
    /// Decay per travel, 1/m.
    pub(super) b1: f64,
    /// Difference between loading and unloading, 1/m.
    pub(super) b2: f64,
}

impl Travel {
    /// The force after a travel, N, and its change per change of that travel, N/m.
    pub(super) fn after(&self, force_n: f64, travel_m: f64) -> (f64, f64) {
        if travel_m == 0.0 {
            // The slope of the branch on which the force stands, forward.
            return (force_n, self.stiffness_n_per_m - self.decay(1.0, force_n) * force_n);
        }
        let way = travel_m.signum();
        // At zero force the branch is that of the sign which the force takes next.
        let side = if force_n == 0.0 { way * self.stiffness_n_per_m } else { force_n };
        let decay = self.decay(way, side);
        let end = along(self.stiffness_n_per_m, decay, force_n, travel_m);
        if end * side >= 0.0 || force_n == 0.0 {
            return (end, self.stiffness_n_per_m - decay * end);
        }
        // Through zero: the travel up to there, and the rest on the other branch.
        let to_zero = if (decay * force_n / self.stiffness_n_per_m).abs() < 1e-12 {
            -force_n / self.stiffness_n_per_m
        } else {
            libm::log1p(-decay * force_n / self.stiffness_n_per_m) / decay
        };
        let rest = travel_m - to_zero;
        let other = self.decay(way, -side);
        let end = along(self.stiffness_n_per_m, other, 0.0, rest);
        (end, self.stiffness_n_per_m - other * end)
    }

    fn decay(&self, way: f64, side: f64) -> f64 {
        self.b1 * way + self.b2 * if side < 0.0 { -1.0 } else { 1.0 }
    }
}

/// The solution of `dz/dx = a - g z` after the travel `x`.
fn along(a: f64, g: f64, z: f64, x: f64) -> f64 {
    let gx = g * x;
    // (1 - exp(-gx)) / g, whose series is exact to 1e-17 where |gx| < 0.01.
    let gain = if gx.abs() < 1e-2 {
        x * (1.0
            - gx * (0.5
                - gx * (1.0 / 6.0
                    - gx * (1.0 / 24.0 - gx * (1.0 / 120.0 - gx * (1.0 / 720.0 - gx / 5040.0))))))
    } else {
        -libm::expm1(-gx) / g
    };
    z + gain * (a - g * z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_long_travel_is_many_short_ones() {
        // By forward Euler in a million steps; B1 + B2 < 0 included.
        for (b1, b2) in [(800.0, -1100.5), (800.0, 300.0), (500.0, 0.0), (0.0, 0.0)] {
            let law = Travel { stiffness_n_per_m: 5e4, b1, b2 };
            for (start, travel) in [(0.0, 1e-3), (20.0, -2e-3), (-30.0, 1.5e-3), (25.0, 4e-4)] {
                let steps = 1_000_000;
                let dx = travel / f64::from(steps);
                let mut z: f64 = start;
                for _ in 0..steps {
                    let g = b1 * dx.signum() + b2 * if z < 0.0 { -1.0 } else { 1.0 };
                    z += dx * (5e4 - g * z);
                }
                let (end, slope) = law.after(start, travel);
                assert!((end - z).abs() < 2e-4, "{b1} {b2} {start} {travel}: {end} {z}");
                let there = law.after(start, travel * (1.0 + 1e-6)).0;
                let numeric = (there - end) / (travel * 1e-6);
                assert!((slope / numeric - 1.0).abs() < 1e-4, "{slope} {numeric}");
            }
        }
    }

    #[test]
    fn friction_of_dahl_stays_within_its_capacity() {
        let (capacity, length) = (100.0, 1e-3);
        let law = Travel { stiffness_n_per_m: capacity / length, b1: 1.0 / length, b2: 0.0 };
        let end = law.after(-capacity, 2e-3).0;
        let exact = capacity - 2.0 * capacity * libm::exp(-2.0);
        assert!((end - exact).abs() < 1e-10, "{end} {exact}");
        assert!(law.after(end, 1.0).0 <= capacity * (1.0 + 1e-12));
    }
}
