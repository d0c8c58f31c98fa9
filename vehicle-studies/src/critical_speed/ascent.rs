//! From which speed on does irregular track throw the vehicle into a hunting that stays?
//!
//! At every speed anew: one wheelset 3 mm off the middle, 300 m of class-6 track, then perfect
//! track; hunting is what moves by more than the threshold after 14 s of it. With the irregularity
//! kept on there is no clear threshold: it moves the wheelsets by as much as a small limit cycle.

use super::bracket::{Critical, first_unstable};
use super::hunting::{Hunting, after};
use super::procedure::{Criterion, Procedure};
use super::stability;
use crate::error::StudyError;
use crate::trip::track::rough_start;
use crate::trip::{Equipped, Trip, TripState};
use firmware_core::track::Track;
use firmware_core::vehicle::BodyId;
use rayon::prelude::*;
use scenario::equilibrium::NoEquilibrium;
use serde::{Deserialize, Serialize};

/// The critical speed on one track.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnTrack {
    /// Seed of the track.
    pub seed: u64,
    /// From where the vehicle hunts.
    pub critical: Critical,
}

/// The critical speed of a vehicle over several tracks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ascent {
    /// The critical speed on the track of each seed.
    pub seeds: Vec<OnTrack>,
    /// Mean of those inside the range, where all are (km/h).
    pub mean_kmh: Option<f64>,
    /// Lowest and highest of them (km/h).
    pub range_kmh: Option<[f64; 2]>,
}

impl Ascent {
    /// Asks on the tracks of all seeds.
    ///
    /// # Errors
    /// The vehicle does not run steadily at some speed, or the work is stopped.
    pub fn of(equipped: &Equipped<'_>, procedure: &Procedure) -> Result<Self, StudyError> {
        let seeds: Result<Vec<OnTrack>, StudyError> = procedure
            .seeds
            .par_iter()
            .map(|&seed| Ok(OnTrack { seed, critical: critical(equipped, procedure, seed)? }))
            .collect();
        let seeds = seeds?;
        let inside: Option<Vec<f64>> = seeds.iter().map(|on| on.critical.kmh()).collect();
        let inside = inside.filter(|speeds| !speeds.is_empty());
        Ok(Self {
            mean_kmh: inside.as_deref().map(signal::statistics::mean),
            range_kmh: inside
                .as_deref()
                .and_then(signal::statistics::min_max)
                .map(|(low, high)| [low, high]),
            seeds,
        })
    }

    /// The mean in words, or on which side of the range the seeds lie.
    pub fn mean(&self) -> String {
        let alike = |first: &OnTrack| self.seeds.iter().all(|on| on.critical == first.critical);
        match (self.mean_kmh, self.seeds.first().filter(|first| alike(first))) {
            (Some(mean), _) => format!("{mean:.1}"),
            (None, Some(first)) => first.critical.to_string(),
            (None, None) => "-".to_owned(),
        }
    }

    /// Lowest and highest in words.
    pub fn range(&self) -> String {
        if let Some([low, high]) = self.range_kmh {
            return format!("{low:.1} to {high:.1}");
        }
        let each = self.seeds.iter().map(|on| on.critical.to_string());
        each.collect::<Vec<_>>().join(" ")
    }
}

fn critical(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
    seed: u64,
) -> Result<Critical, StudyError> {
    let Procedure { from_kmh, to_kmh, step_kmh, resolution_kmh, .. } = *procedure;
    let track = match procedure.criterion {
        Criterion::LimitCycle => rough_start(&procedure.band(seed), procedure.rough_m),
        Criterion::En14363 => stability::rough(procedure, seed),
    };
    let track = track.view();
    let unstable = |kmh: f64| -> Result<bool, StudyError> {
        Ok(match procedure.criterion {
            Criterion::LimitCycle => {
                settled(equipped, procedure, &track, kmh)?.is_beyond(procedure.threshold_m)
            }
            Criterion::En14363 => stability::greatest_over_limit(equipped, procedure, &track, kmh)?
                .is_none_or(|over| over > 1.0),
        })
    };
    first_unstable([from_kmh, to_kmh], step_kmh, resolution_kmh, unstable)
}

/// The residual motion at one speed (km/h) after the rough beginning of a track.
fn settled(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
    track: &Track<'_>,
    kmh: f64,
) -> Result<Hunting, StudyError> {
    let (trip, mut state, duration_s) = set_off(equipped, procedure, track, kmh)?;
    after(&trip, &mut state, [duration_s, procedure.watched_s])
}

/// The wheelset that starts off the middle of the track, the last of a vehicle with fewer.
pub fn offset_wheelset(equipped: &Equipped<'_>, procedure: &Procedure) -> Option<BodyId> {
    let number = procedure.offset_wheelset.min(equipped.vehicle.axles.len());
    number.checked_sub(1).and_then(|number| equipped.wheelset(number))
}

/// A trip at one speed (km/h) with that wheelset off the middle, its state, and how long it
/// takes over the rough beginning and the perfect track behind it (s).
///
/// # Errors
/// The vehicle does not run steadily.
pub fn set_off<'a>(
    equipped: &'a Equipped<'a>,
    procedure: &Procedure,
    track: &'a Track<'a>,
    kmh: f64,
) -> Result<(Trip<'a>, TripState, f64), NoEquilibrium> {
    let speed_m_per_s = kmh / 3.6;
    let trip = Trip::new(equipped, track, speed_m_per_s, procedure.substeps);
    let moved = offset_wheelset(equipped, procedure).map(|body| (body, procedure.offset_m));
    let state = trip.begin(moved.as_slice())?;
    Ok((trip, state, procedure.rough_m / speed_m_per_s + procedure.smooth_s))
}
