//! What forces in a curve are held against.
//!
//! ```text
//! sum of Y    k1 (10 kN + P0/3)          EN 14363, after Prud'homme; P0 the static axle load
//!             half of it                 rms over 100 m around the frequency of an instability
//! Y/Q         0.8                        EN 14363 and, as Q/P, GB/T 5599-2019
//! dQ/Q0       0.65                       GB/T 5599-2019, up to 160 km/h
//! H           15 kN + P0/3               GB/T 5599-2019, lateral axle force
//! ```
//! On radii below 400 m GB/T 5599-2019 allows more than 0.8.

use serde::{Deserialize, Serialize};

/// Limit of Y/Q.
pub(super) const Y_OVER_Q: f64 = 0.8;
/// Limit of wheel unloading.
pub(super) const UNLOADING: f64 = 0.65;

/// The limits of a wheelset's forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AxleLimits {
    /// Static axle load (N).
    pub axle_load_n: f64,
    /// Of the sum of guiding forces (N).
    pub prudhomme_n: f64,
    /// Of its rms where the vehicle is unstable (N).
    pub stability_rms_n: f64,
    /// Of the lateral axle force of GB/T 5599-2019 (N).
    pub axle_force_gb_n: f64,
}

impl AxleLimits {
    /// Those of an axle load (N).
    ///
    /// ```
    /// use vehicle_studies::curve::AxleLimits;
    /// // The SS9, 21 t an axle: 78.7 and 83.7 kN.
    /// let limits = AxleLimits::of(206.0e3, 1.0);
    /// assert_eq!(limits.prudhomme_n.round(), 78_667.0);
    /// assert_eq!(limits.axle_force_gb_n.round(), 83_667.0);
    /// ```
    pub fn of(axle_load_n: f64, k1: f64) -> Self {
        let prudhomme_n = k1 * (10.0e3 + axle_load_n / 3.0);
        Self {
            axle_load_n,
            prudhomme_n,
            stability_rms_n: 0.5 * prudhomme_n,
            axle_force_gb_n: 15.0e3 + axle_load_n / 3.0,
        }
    }
}
