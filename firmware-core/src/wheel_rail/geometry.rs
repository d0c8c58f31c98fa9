//! What the off-line contact solution says about one lateral shift of one wheel on one rail.
//!
//! Wheel-local axes, the same for both sides of the track: `outward` from the track centre and
//! `down`. The wheel's flange is on its inner side, so a positive **shift** (the wheel moved
//! outward against the rail) brings the flange to the gauge face.

/// Rigid contact of one zone (tread or flange) at one lateral shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactGeometry {
    /// Downward displacement of the wheel at which this zone just touches (m). Zero for the zone
    /// that touches at zero shift; falls as the flange climbs.
    pub touch_m: f64,
    /// Tangent of the contact angle: `-d touch / d shift`. Positive pushes the wheel inward.
    pub slope: f64,
    /// Rolling radius at the contact less the nominal rolling radius (m).
    pub radius_deviation_m: f64,
    /// Outward distance of the contact from the wheel's tape circle (m).
    pub lateral_m: f64,
    /// Relative curvature across the rolling direction, wheel plus rail, convex positive (1/m).
    pub curvature_lateral_per_m: f64,
    /// Depth of the rail's centre of curvature below the wheel's tape circle (m), close to the
    /// transverse radius of the head: a roll of the wheel by `phi` (outward side down) acts like
    /// shifting it inward by `phi` times this.
    pub rail_radius_m: f64,
}

/// Number of rows of a contact table.
pub const TABLE_ROWS: usize = 257;

/// Shift of the first row (m), the wheel moved inward.
pub const TABLE_FIRST_SHIFT_M: f64 = -0.016;

/// Distance between rows (m).
pub const TABLE_STEP_M: f64 = 0.125e-3;

/// Both zones of a wheel on a rail over the whole range of lateral shift.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactZones {
    /// The running tread, up to the throat.
    pub tread: [ContactGeometry; TABLE_ROWS],
    /// The flange, from the throat.
    pub flange: [ContactGeometry; TABLE_ROWS],
}
