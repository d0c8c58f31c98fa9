//! EN 14363's way to call a vehicle unstable: guiding forces on irregular track.
//!
//! ```text
//! rms over 100 m of sum of Y, f0 +- 2 Hz   >   half of k1 (10 kN + P0/3)        for any wheelset
//! ```
//! f0 is the highest line of the force's spectrum between 1 and 10 Hz. The irregularity stays: the
//! force is what a measuring wheelset would see, and no limit cycle has to be there. k1 = 1.
//!
//! Limits: straight track, and 400 m of it behind a run-in.

use super::procedure::Procedure;
use crate::curve::{AxleLimits, Passed};
use crate::error::StudyError;
use crate::trip::{Equipped, START_M, Trip};
use firmware_core::track::{Layout, Track};
use scenario::irregularity::aar6;
use scenario::track::OwnedTrack;
use std::ops::Range;

/// Where the forces are judged (m): behind the fade-in of the irregularity and a run-in.
const JUDGED_M: Range<f64> = 200.0..600.0;
/// Track behind it, for filters and for the rear of the vehicle (m).
const BEHIND_M: f64 = 60.0;

/// The irregular track of a seed, rough from end to end.
pub(super) fn rough(procedure: &Procedure, seed: u64) -> OwnedTrack {
    let samples = aar6(&procedure.band(seed), 0.0, JUDGED_M.end + 2.0 * BEHIND_M);
    OwnedTrack { layout: Layout::tangent(), samples }
}

/// The greatest rms over its limit of any wheelset at a speed; above one it is unstable. None off
/// the track.
///
/// # Errors
/// No steady running, or a signal that cannot be filtered.
pub(super) fn greatest_over_limit(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
    track: &Track<'_>,
    kmh: f64,
) -> Result<Option<f64>, StudyError> {
    let speed_m_per_s = kmh / 3.6;
    let trip = Trip::new(equipped, track, speed_m_per_s, procedure.substeps);
    let duration_s = (JUDGED_M.end + BEHIND_M - START_M) / speed_m_per_s;
    let passed = Passed::over(&trip, speed_m_per_s, duration_s)?;
    if passed.signals.derailed {
        return Ok(None);
    }
    let forces = passed.forces(&JUDGED_M, false)?;
    let over_limit = forces.iter().zip(&passed.loads).map(|(axle, [left_n, right_n])| {
        let limit_n = AxleLimits::of(left_n + right_n, 1.0).stability_rms_n;
        axle.stability_rms_n.unwrap_or(0.0) / limit_n
    });
    Ok(Some(over_limit.fold(0.0, f64::max)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::run::{Overrides, Run};
    use std::path::Path;

    /// Greatest rms over its limit at a speed, the irregularity scaled.
    fn over_limit(kmh: f64, scale: f64) -> Option<f64> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
        let run = Run::load_with(&path, overrides, &[]).unwrap();
        let procedure = Procedure::default();
        let mut track = rough(&procedure, 1);
        for sample in &mut track.samples.samples {
            sample.alignment_m *= scale;
            sample.vertical_m *= scale;
            sample.cross_level_m *= scale;
            sample.gauge_m *= scale;
        }
        let equipped = Equipped::of(&run).unwrap();
        greatest_over_limit(&equipped, &procedure, &track.view(), kmh).unwrap()
    }

    #[test]
    fn a_locomotive_is_stable_when_slow_and_unstable_when_it_hunts() {
        let [slow, fast] = [120.0, 300.0].map(|kmh| over_limit(kmh, 1.0));
        println!("rms over limit: {slow:?} at 120, {fast:?} at 300 km/h");
        assert!((0.1..0.9).contains(&slow.unwrap()));
        // Its critical speed is 250 km/h; off the track is unstable too.
        assert!(fast.is_none_or(|over| over > 1.0));
    }

    #[test]
    fn forces_vanish_with_the_irregularity() {
        let [half, tenth] = [0.5, 0.1].map(|scale| over_limit(120.0, scale).unwrap());
        println!("rms over limit: {half} and {tenth}");
        assert!(tenth < 0.35 * half && tenth > 0.0, "{half} {tenth}");
    }
}
