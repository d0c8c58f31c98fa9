//! Between eye and rod: seats with clearance, and rubber with a fast branch.
//!
//! ```text
//! x - x_p = d + dz^-1(F)          seat: F = Ks dz(e_s, a)
//! F = K0 d + K1 (d - z)         z' = (d - z)/tau         rubber, standard linear solid
//! ```
//!
//! Over an implicit stage of length g the branch is closed by itself, `z = (z_0 + g/tau d)/(1 +
//! g/tau)`, so that the force is a straight line of the deflection outside the clearance.

/// Seats and rubber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attachment {
    /// Stiffness of the seats Ks, N/m.
    pub seat_n_per_m: f64,
    /// Total clearance 2a, m.
    pub clearance_2a_m: f64,
    /// Static stiffness of the rubber K0, N/m.
    pub rubber_n_per_m: f64,
    /// Stiffness of its fast branch K1, N/m.
    pub branch_n_per_m: f64,
    /// Relaxation time of the branch, s.
    pub branch_s: f64,
}

/// Force and stiffness at a deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// Force, N.
    pub force_n: f64,
    /// Its change per deflection, N/m.
    pub stiffness_n_per_m: f64,
    /// Deflection of the rubber d, m.
    pub rubber_m: f64,
}

impl Attachment {
    /// The force at a deflection between eye and rod, the branch having relaxed from `branch_m`
    /// over `stage_s`.
    pub fn pull(&self, deflection_m: f64, branch_m: f64, stage_s: f64) -> Pull {
        debug_assert!(stage_s > 0.0 && self.branch_s > 0.0, "{stage_s} s, {self:?}");
        let share = 1.0 / (1.0 + stage_s / self.branch_s);
        let rubber = self.rubber_n_per_m + share * self.branch_n_per_m;
        // Without force the rubber rests where its branch holds it.
        let rest_m = share * self.branch_n_per_m * branch_m / rubber;
        let a = 0.5 * self.clearance_2a_m;
        let from_rest = deflection_m - rest_m;
        let strain = from_rest - from_rest.clamp(-a, a);
        if strain == 0.0 {
            return Pull { force_n: 0.0, stiffness_n_per_m: 0.0, rubber_m: rest_m };
        }
        let stiffness = 1.0 / (1.0 / rubber + 1.0 / self.seat_n_per_m);
        let force = stiffness * strain;
        Pull { force_n: force, stiffness_n_per_m: stiffness, rubber_m: rest_m + force / rubber }
    }

    /// Static stiffness outside the clearance, N/m.
    pub fn static_n_per_m(&self) -> f64 {
        1.0 / (1.0 / self.rubber_n_per_m + 1.0 / self.seat_n_per_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATTACHMENT: Attachment = Attachment {
        seat_n_per_m: 100e6,
        clearance_2a_m: 0.4e-3,
        rubber_n_per_m: 40e6,
        branch_n_per_m: 10e6,
        branch_s: 5e-3,
    };

    #[test]
    fn slow_pulls_feel_the_static_stiffness_and_fast_ones_the_branch_too() {
        let slow = ATTACHMENT.pull(1.2e-3, 0.0, 1e3);
        assert!((slow.force_n / (1e-3 * ATTACHMENT.static_n_per_m()) - 1.0).abs() < 1e-5);
        let fast = ATTACHMENT.pull(1.2e-3, 0.0, 1e-9);
        let stiffness = 1.0 / (1.0 / 50e6 + 1.0 / 100e6);
        assert!((fast.force_n / (1e-3 * stiffness) - 1.0).abs() < 1e-5);
        assert_eq!(ATTACHMENT.pull(0.19e-3, 0.0, 1e-5).force_n, 0.0);
    }

    #[test]
    fn the_parts_carry_the_same_force() {
        let (stage, branch) = (2e-3, 0.1e-3);
        for deflection in [-1e-3, 0.5e-3, 2e-3] {
            let pull = ATTACHMENT.pull(deflection, branch, stage);
            let g = stage / ATTACHMENT.branch_s;
            let z = (branch + g * pull.rubber_m) / (1.0 + g);
            let rubber = 40e6 * pull.rubber_m + 10e6 * (pull.rubber_m - z);
            let seat = pull.force_n / 100e6 + libm::copysign(0.2e-3, pull.force_n);
            assert!((rubber - pull.force_n).abs() < 1e-6, "{deflection}");
            assert!((pull.rubber_m + seat - deflection).abs() < 1e-12, "{deflection}");
        }
    }
}
