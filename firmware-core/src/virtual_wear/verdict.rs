//! Whether wear is accepted: is the loop over the mismatch stable, and what is the force off?
//!
//! With the damper's stiffness `K` at short notice, that of its model `K_m` and the joint's `K_v`,
//! a change of `dF` moves the eye by `-dF / (K_v + K_m)`, and the rig answers with
//!
//! ```text
//! dF -> (K - K_m) * (-1 / (K_v + K_m)) dF        L = |K - K_m| / (K_v + K_m)
//! ```
//! The rig's own response and the low-pass make it less. So `L < 1` is stable whatever the delay
//! (small-gain theorem); [`LOOP_GAIN_MAX`] leaves a gain margin of 2. A rigid joint moves the eye
//! with the vehicle, and `L` is zero.
//!
//! Stable is not exact. What the force is off from that of a [worn damper](super::reference) under
//! the vehicle's own motion is compared with the force of the healthy one, both rms. Beyond
//! [`FORCE_ERROR_MAX`] a better model of the damper is needed, a rig that follows better, or less
//! delay.

use super::VirtualWear;

/// Most loop gain that is accepted.
pub const LOOP_GAIN_MAX: f64 = 0.5;
/// Most error of the force that is accepted, over the force of the healthy damper. The aim is 3 %,
/// and the error is found in a second or two.
pub const FORCE_ERROR_MAX: f64 = 0.025;
/// Share of the healthy damper's force below which a mismatch is small, whatever the model's is.
const LEAST_SHARE: f64 = 0.1;

/// What a damper on a rig makes of the wear before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WearFound {
    /// The force of the damper less that of its model, over the latter or a tenth of the healthy
    /// damper's, both rms.
    pub mismatch: f64,
    /// Gain of the loop over the mismatch.
    pub loop_gain: f64,
    /// Error of the force, over that of the healthy damper.
    pub force_error: f64,
}

impl WearFound {
    /// From the sizes of the mismatch and of the model's force, what the force is off, and the
    /// force of the healthy damper (N).
    pub(super) fn of(
        wear: &VirtualWear<'_>,
        (difference_n, model_n): (f64, f64),
        error_n: f64,
        healthy_n: f64,
    ) -> Self {
        debug_assert!(healthy_n > 0.0, "{healthy_n} N");
        let (compliance, stiffness) = (wear.compliance_m_per_n, wear.specimen.nominal().ke_n_per_m);
        let mismatch = difference_n / model_n.max(LEAST_SHARE * healthy_n);
        Self {
            mismatch,
            loop_gain: loop_gain(compliance, stiffness, mismatch),
            force_error: error_n / healthy_n,
        }
    }

    /// Whether a run takes it.
    pub fn is_accepted(&self) -> bool {
        self.loop_gain <= LOOP_GAIN_MAX && self.force_error <= FORCE_ERROR_MAX
    }
}

/// The loop gain of a joint before a damper of a stiffness (N/m) whose model is off by a share.
///
/// ```
/// use firmware_core::virtual_wear::loop_gain;
/// // From 12.5 MN/m to 3 MN/m, with a damper that is 20 % stiffer than its model.
/// let compliance = 1.0 / 3.0e6 - 1.0 / 12.5e6;
/// assert!((loop_gain(compliance, 12.5e6, 0.2) - 0.152).abs() < 1e-3);
/// ```
pub fn loop_gain(compliance_m_per_n: f64, model_n_per_m: f64, share: f64) -> f64 {
    debug_assert!(compliance_m_per_n >= 0.0 && model_n_per_m > 0.0 && share >= 0.0);
    // Both numerator and denominator over K_v.
    let softness = compliance_m_per_n * model_n_per_m;
    share * softness / (1.0 + softness)
}
