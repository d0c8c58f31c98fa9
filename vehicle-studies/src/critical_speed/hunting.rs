//! Is it hunting? The lateral motion of the wheelsets over the last seconds of a run.

use crate::error::StudyError;
use crate::trip::signals::{Places, Signals, Wheels};
use crate::trip::{Trip, TripState};
use scenario::run::CYCLE_S;
use serde::{Deserialize, Serialize};
use signal::statistics;

/// Motion around which half cycles are not counted, as a share of the amplitude.
const DEAD_BAND: f64 = 0.2;

/// The motion that a run ended in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hunting {
    /// Greatest lateral position of any wheelset (m); none where it left the track.
    pub amplitude_m: Option<f64>,
    /// Frequency of the wheelset that moves most, by zero crossings (Hz).
    pub frequency_hz: Option<f64>,
}

impl Hunting {
    /// Off the track.
    pub const DERAILED: Self = Self { amplitude_m: None, frequency_hz: None };

    /// The motion of a wheelset that stayed on the track, from its lateral position at every
    /// control cycle (m).
    pub fn of(lateral_m: &[f64]) -> Self {
        let amplitude_m = greatest(lateral_m);
        let dead_band_m = DEAD_BAND * amplitude_m;
        let frequency_hz = statistics::zero_crossing_hz(lateral_m, 1.0 / CYCLE_S, dead_band_m);
        Self { amplitude_m: Some(amplitude_m), frequency_hz }
    }

    /// True when it moves by more than a threshold (m), or has left the track.
    pub fn is_beyond(&self, threshold_m: f64) -> bool {
        self.amplitude_m.is_none_or(|amplitude_m| amplitude_m > threshold_m)
    }
}

/// Runs on, and evaluates the last `watched_s` of `duration_s`.
///
/// # Errors
/// The trip is stopped.
pub(super) fn after(
    trip: &Trip<'_>,
    state: &mut TripState,
    [duration_s, watched_s]: [f64; 2],
) -> Result<Hunting, StudyError> {
    debug_assert!((0.0..=duration_s).contains(&watched_s), "{watched_s} s of {duration_s} s");
    if !trip.record(state, duration_s - watched_s, &mut None)? {
        return Ok(Hunting::DERAILED);
    }
    let places = Places::wheelsets_of(trip.vehicle());
    let watched = Signals::of(trip, state, watched_s, &places, Wheels::LeftOut)?;
    if watched.derailed {
        return Ok(Hunting::DERAILED);
    }
    let seen = watched.wheelsets.iter().map(|wheelset| &wheelset.lateral_m);
    let most = seen.max_by(|a, b| greatest(a).total_cmp(&greatest(b)));
    let still = Hunting { amplitude_m: Some(0.0), frequency_hz: None };
    Ok(most.map_or(still, |values| Hunting::of(values)))
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, y| most.max(y.abs()))
}
