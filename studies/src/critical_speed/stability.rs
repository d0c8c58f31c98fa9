//! EN 14363's way to call a vehicle unstable: guiding forces on irregular track.
//!
//! ```text
//! rms over 100 m of sum of Y, f0 +- 2 Hz   >   half of k1 (10 kN + P0/3)        for any wheelset
//! ```
//! f0 is the highest line of the force's spectrum between 1 and 10 Hz. The irregularity stays: the force is
//! what a measuring wheelset would see, and no limit cycle has to be there. k1 = 1.
//!
//! Limits: straight track, and 400 m of it behind a run-in.

use super::procedure::Procedure;
use crate::curve::limits::AxleLimits;
use crate::curve::passed::Passed;
use crate::curve::sections::{Part, Section};
use crate::study::Busy;
use crate::trip::{Equipped, START_M, Trip};
use firmware_core::track::{Layout, Track};
use scenario::irregularity::aar6;
use scenario::track::OwnedTrack;

/// Where the forces are judged (m): behind the fade-in of the irregularity and a run-in.
const JUDGED_M: [f64; 2] = [200.0, 600.0];
/// Track behind it, for filters and for the rear of the vehicle (m).
const BEHIND_M: f64 = 60.0;

/// The irregular track of a seed, rough from end to end.
pub fn rough(procedure: &Procedure, seed: u64) -> OwnedTrack {
    let samples = aar6(&procedure.band(seed), 0.0, JUDGED_M[1] + 2.0 * BEHIND_M);
    OwnedTrack { layout: Layout::tangent(), samples }
}

/// The greatest rms over its limit of any wheelset at a speed; above one it is unstable. None off the track.
///
/// # Errors
/// In one line: no steady running, or a signal that cannot be filtered.
pub fn greatest_over_limit(
    equipped: &Equipped,
    procedure: &Procedure,
    track: &Track<'_>,
    kmh: f64,
) -> Result<Option<f64>, String> {
    let speed_m_per_s = kmh / 3.6;
    let trip = Trip::new(equipped, track, speed_m_per_s, procedure.substeps);
    let duration_s = (JUDGED_M[1] + BEHIND_M - START_M) / speed_m_per_s;
    let passed = Passed::over(&trip, speed_m_per_s, duration_s, &Busy::default())?;
    if passed.signals.derailed {
        return Ok(None);
    }
    // A section of a curve to the eyes of the filter; the track is straight.
    let section = Section { part: Part::Curve, from_m: JUDGED_M[0], to_m: JUDGED_M[1] };
    let forces = passed.forces(&section, false)?;
    let over_limit = forces.iter().zip(&passed.loads).map(|(axle, [left_n, right_n])| {
        let limit_n = AxleLimits::of(left_n + right_n, 1.0).stability_rms_n;
        axle.stability_rms_n.unwrap_or(0.0) / limit_n
    });
    Ok(Some(over_limit.fold(0.0, f64::max)))
}
