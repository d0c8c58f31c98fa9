//! Wear in software: clearance and softness in series with a healthy damper on a rig.
//!
//! A clearance `2a` in series passes motion only while its flanks touch: the rig follows the
//! vehicle at distance `a` behind, through the reversal too, until the measured force has fallen to
//! zero; then it rests while the gap is crossed, and is taken along again at the other flank. (A
//! plain backlash would rest at every reversal and carry force through an open gap.) Zero force
//! means less than [`VirtualWear::contact_force_n`], which stands above the noise of the load cell.
//!
//! A soft mounting takes its share `F c` of the displacement, with the force of the last cycle.
//! That is a feedback with the gain `Ke c`: it needs `Ke c` well below one.

/// Parameters of the wear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualWear {
    /// Extra total clearance (m).
    pub clearance_2a_m: f64,
    /// Extra series compliance (m/N).
    pub compliance_m_per_n: f64,
    /// Force below which the flanks have parted (N).
    pub contact_force_n: f64,
}

/// Four times the noise of a good load cell (N).
const CONTACT_FORCE_N: f64 = 20.0;

impl Default for VirtualWear {
    fn default() -> Self {
        Self { clearance_2a_m: 0.0, compliance_m_per_n: 0.0, contact_force_n: CONTACT_FORCE_N }
    }
}

/// Which flanks of the gap touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Flank {
    #[default]
    Neither,
    Extension,
    Compression,
}

/// Where the gap stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VirtualWearState {
    inner_m: f64,
    flank: Flank,
}

impl VirtualWear {
    /// Displacement for the rig (m) and whether it moves with the vehicle's, from the vehicle's
    /// extension and the measured force.
    ///
    /// ```
    /// use firmware_core::compensation::{VirtualWear, VirtualWearState};
    /// let wear = VirtualWear { clearance_2a_m: 4e-3, ..VirtualWear::default() };
    /// let mut state = VirtualWearState::default();
    /// assert_eq!(wear.displacement_m(&mut state, 1e-3, 0.0), (0.0, false));
    /// assert_eq!(wear.displacement_m(&mut state, 5e-3, 0.0), (3e-3, true));
    /// // Back with a loaded spring: still in touch. Unloaded: the gap opens.
    /// assert_eq!(wear.displacement_m(&mut state, 4e-3, 900.0), (2e-3, true));
    /// assert_eq!(wear.displacement_m(&mut state, 3e-3, 0.0), (2e-3, false));
    /// ```
    pub fn displacement_m(
        &self,
        state: &mut VirtualWearState,
        extension_m: f64,
        force_n: f64,
    ) -> (f64, bool) {
        debug_assert!(self.clearance_2a_m >= 0.0, "clearance of {} m", self.clearance_2a_m);
        debug_assert!(self.contact_force_n >= 0.0, "contact at {} N", self.contact_force_n);
        let half_m = 0.5 * self.clearance_2a_m;
        let (pulled_m, pushed_m) = (extension_m - half_m, extension_m + half_m);
        let loaded = match state.flank {
            Flank::Extension => force_n > self.contact_force_n,
            Flank::Compression => force_n < -self.contact_force_n,
            Flank::Neither => false,
        };
        state.flank = if pulled_m > state.inner_m {
            Flank::Extension
        } else if pushed_m < state.inner_m {
            Flank::Compression
        } else if loaded {
            state.flank
        } else {
            Flank::Neither
        };
        match state.flank {
            Flank::Extension => state.inner_m = pulled_m,
            Flank::Compression => state.inner_m = pushed_m,
            Flank::Neither => {}
        }
        let moves = state.flank != Flank::Neither || half_m == 0.0;
        if half_m == 0.0 {
            state.inner_m = extension_m;
        }
        // A displacement that is no number passes: it is the state of a diverged model.
        debug_assert!(
            !(state.inner_m < pulled_m || state.inner_m > pushed_m),
            "the inner eye is outside of its clearance"
        );
        (state.inner_m - force_n * self.compliance_m_per_n, moves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    /// Work per cycle, and the share of time without force, of a damper behind a wear.
    fn behaviour(clearance_2a_m: f64, wear: VirtualWear, hz: f64) -> (f64, f64) {
        let damper = Damper::new(Nominal { clearance_2a_m, ..Nominal::NEW }, &[]).unwrap();
        let (mut state, mut gap) = (DamperState::rest(), VirtualWearState::default());
        let (step_s, cycles) = (1e-3, 8.0);
        let omega = core::f64::consts::TAU * hz;
        let steps = (cycles / hz / step_s) as u32;
        let (mut force, mut work, mut idle, mut last) = (0.0, 0.0, 0, 0.0);
        for k in 0..steps {
            let (sin, cos) = libm::sincos(omega * f64::from(k) * step_s);
            let extension = 4e-3 * sin;
            let (inner, moves) = wear.displacement_m(&mut gap, extension, force);
            let rate = if moves { 4e-3 * omega * cos } else { 0.0 };
            let before = force;
            force = damper.advance(&mut state, Motion::new(inner, rate), step_s);
            if k > steps / 2 {
                work += 0.5 * (force + before) * (extension - last);
                idle += u32::from(force.abs() < 200.0);
            }
            last = extension;
        }
        (work / (0.5 * cycles), f64::from(idle) / f64::from(steps / 2))
    }

    #[test]
    fn a_clearance_in_software_acts_like_one_in_the_damper() {
        for hz in [0.5, 2.0, 3.5] {
            let (real_work, real_idle) = behaviour(4e-3, VirtualWear::default(), hz);
            let wear = VirtualWear { clearance_2a_m: 3.8e-3, ..VirtualWear::default() };
            let (work, idle) = behaviour(0.2e-3, wear, hz);
            assert!((work / real_work - 1.0).abs() < 0.05, "{hz} Hz: {work} J, real {real_work} J");
            assert!((idle - real_idle).abs() < 0.04, "{hz} Hz: idle {idle}, real {real_idle}");
        }
    }

    #[test]
    fn without_wear_the_displacement_passes() {
        let (wear, mut state) = (VirtualWear::default(), VirtualWearState::default());
        for extension in [0.0, 1e-3, -2e-3, 5e-4] {
            assert_eq!(wear.displacement_m(&mut state, extension, 1e4), (extension, true));
        }
    }
}
