//! Wear in software: clearance and softness in series with a healthy damper on a rig.
//!
//! A clearance `2a` in series is a play: the rig follows the vehicle's displacement only where it
//! pushes against one end of the gap, `x_rig` kept within `x - a .. x + a`. A soft mounting takes its
//! share `F c` of the displacement, with the force of the last cycle. Both are exact for slow motion;
//! the loop's latency adds to them like to any other displacement.

/// Parameters of the wear.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VirtualWear {
    /// Extra total clearance (m).
    pub clearance_2a_m: f64,
    /// Extra series compliance (m/N).
    pub compliance_m_per_n: f64,
}

/// Where the play stands (m).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VirtualWearState {
    inner_m: f64,
}

impl VirtualWear {
    /// Displacement for the rig (m) and whether it moves with the vehicle's.
    ///
    /// ```
    /// use firmware_core::compensation::{VirtualWear, VirtualWearState};
    /// let wear = VirtualWear { clearance_2a_m: 4e-3, compliance_m_per_n: 0.0 };
    /// let mut state = VirtualWearState::default();
    /// assert_eq!(wear.displacement_m(&mut state, 1e-3, 0.0), (0.0, false));
    /// assert_eq!(wear.displacement_m(&mut state, 5e-3, 0.0), (3e-3, true));
    /// assert_eq!(wear.displacement_m(&mut state, 2e-3, 0.0), (3e-3, false));
    /// ```
    pub fn displacement_m(
        &self,
        state: &mut VirtualWearState,
        extension_m: f64,
        force_n: f64,
    ) -> (f64, bool) {
        let half_m = 0.5 * self.clearance_2a_m;
        let kept = state.inner_m.max(extension_m - half_m).min(extension_m + half_m);
        let moves = kept != state.inner_m || half_m == 0.0;
        state.inner_m = kept;
        (kept - force_n * self.compliance_m_per_n, moves)
    }
}
