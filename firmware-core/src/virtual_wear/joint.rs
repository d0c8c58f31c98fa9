//! The joint in balance with the damper behind it.
//!
//! ```text
//! F > 0:   w = x - a - c F(w)       pulled
//! F < 0:   w = x + a - c F(w)       pushed
//! else:    F(w) = 0                 within the gap, the damper is without force
//! ```
//! `F` rises with `w`, so exactly one of the three holds. The root is found by the Illinois variant
//! of regula falsi (M. Dowell and P. Jarratt, 1971) in a bracket, in a bounded number of steps.

/// Steps of the search after its bracket.
const STEPS: u32 = 6;
/// Where it may end before (m).
const TOLERANCE_M: f64 = 1e-10;

/// Play and softness in series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) half_clearance_m: f64,
    pub(super) compliance_m_per_n: f64,
}

impl Joint {
    /// Where the damper's eye stands (m) with the vehicle's at `x_m`, from where it stood and the
    /// stiffness (N/m) that it has at short notice.
    pub(super) fn balance(
        &self,
        x_m: f64,
        from_m: f64,
        stiffness_n_per_m: f64,
        force_n: impl Fn(f64) -> f64,
    ) -> f64 {
        debug_assert!(stiffness_n_per_m > 0.0, "{stiffness_n_per_m} N/m");
        let (pulled_m, pushed_m) = (x_m - self.half_clearance_m, x_m + self.half_clearance_m);
        let soft = |force_n: f64| self.compliance_m_per_n * force_n;
        let pull_n = force_n(pulled_m);
        if pull_n > 0.0 {
            let distance_m = |w_m: f64| w_m + soft(force_n(w_m)) - pulled_m;
            return root(distance_m, pulled_m - soft(pull_n), pulled_m);
        }
        let push_n = force_n(pushed_m);
        if push_n < 0.0 {
            let distance_m = |w_m: f64| w_m + soft(force_n(w_m)) - pushed_m;
            return root(distance_m, pushed_m, pushed_m - soft(push_n));
        }
        let distance_m = |w_m: f64| force_n(w_m) / stiffness_n_per_m;
        // A damper in a gap moves little: the bracket is near to where it stands.
        let near_m = from_m.max(pulled_m).min(pushed_m);
        let off_m = distance_m(near_m);
        let beyond_m = (near_m - 2.0 * off_m).max(pulled_m).min(pushed_m);
        let is_across = distance_m(beyond_m) * off_m <= 0.0;
        match (off_m > 0.0, is_across) {
            (true, true) => root(distance_m, beyond_m, near_m),
            (true, false) => root(distance_m, pulled_m, beyond_m),
            (false, true) => root(distance_m, near_m, beyond_m),
            (false, false) => root(distance_m, beyond_m, pushed_m),
        }
    }
}

/// The root of a rising function between two places, of which the first is not above it.
fn root(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut below, mut above) = (value(low), value(high));
    for _ in 0..STEPS {
        if below >= -TOLERANCE_M {
            return low;
        }
        if above <= TOLERANCE_M {
            return high;
        }
        let middle = low + (high - low) * (-below / (above - below));
        let found = value(middle);
        if found.abs() <= TOLERANCE_M {
            return middle;
        }
        // An end that stays counts half: the other one then moves as well.
        if found > 0.0 {
            (high, above) = (middle, found);
            below *= 0.5;
        } else {
            (low, below) = (middle, found);
            above *= 0.5;
        }
    }
    if -below < above { low } else { high }
}
