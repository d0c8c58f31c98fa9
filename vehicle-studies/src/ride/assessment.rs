//! The ride of one vehicle over the tracks of several seeds.
//!
//! ```text
//! N_MV = 6 sqrt(a_y95^2 + a_z95^2)      95th percentiles of Wd- and Wb-weighted rms over 5 s, m/s2
//! ```
//! (EN 12299, mean comfort on the floor; its longitudinal share is zero here.) The Sperling index
//! is the mean over a track's windows, then over tracks. Peaks are the greatest after a low-pass of
//! 40 Hz. Spectra are Welch's with segments of 8.192 s, averaged over tracks.

use super::procedure::Procedure;
use super::shake::{Group, PlaceShaken, Shaken};
use super::sperling::Direction;
use super::vibration::{PlaceRide, PlaceSpectrum};
use crate::error::StudyError;
use crate::trip::signals::{Places, Signals, Wheels};
use crate::trip::track::Roughness;
use crate::trip::{Equipped, START_M, Trip};
use firmware_core::track::Layout;
use rayon::prelude::*;
use scenario::run::Run;
use scenario::track::OwnedTrack;
use serde::{Deserialize, Serialize};
use signal::spectrum::Spectrum;

/// Spectra are kept up to here (Hz).
const SPECTRA_TO_HZ: f64 = 20.0;

/// How a vehicle rides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ride {
    /// Running speed (km/h).
    pub speed_kmh: f64,
    /// The tracks.
    pub track: Roughness,
    /// The floor above the bogies from the front, then above the middle.
    pub floor: Vec<PlaceRide>,
    /// The bogie frames.
    pub bogies: Vec<PlaceRide>,
    /// Distance between the lines of the spectra (Hz).
    pub resolution_hz: f64,
    /// Spectra of the first place on the floor and of the first bogie.
    pub spectra: Vec<PlaceSpectrum>,
}

impl Ride {
    /// The vehicle of a run rides on the tracks of all seeds.
    ///
    /// # Errors
    /// No steady running, a track that the vehicle leaves, a section too short; the work is
    /// stopped.
    pub fn of(
        run: &Run,
        equipped: &Equipped<'_>,
        procedure: &Procedure,
    ) -> Result<Self, StudyError> {
        let places = Places::of(run, procedure.floor_height_m);
        let track = Roughness::of(run, &procedure.seeds);
        let duration_s = procedure.run_in_s + procedure.section_s;
        let end_m = START_M + run.speed_m_per_s * duration_s + 30.0;
        let tracks = track.tracks(run, &Layout::tangent(), end_m);
        let on_track = |(number, track): (usize, &OwnedTrack)| -> Result<Signals, StudyError> {
            let track = track.view();
            let trip = Trip::new(equipped, &track, run.speed_m_per_s, run.substeps);
            let mut state = trip.begin(&[])?;
            let signals = Signals::of(&trip, &mut state, duration_s, &places, Wheels::LeftOut)?;
            if signals.derailed {
                let at_m = signals.distance_m.last().copied().unwrap_or_default();
                return Err(StudyError::OffTheTrack(at_m).on_track(number + 1));
            }
            Ok(signals)
        };
        let shaken = |numbered| {
            let signals = on_track(numbered)?;
            Ok(Shaken::of(&signals, procedure.run_in_s)?)
        };
        let shaken: Result<Vec<Shaken>, StudyError> =
            tracks.par_iter().enumerate().map(shaken).collect();
        Self::over(&shaken?, run, track).ok_or(StudyError::NoTrack)
    }

    fn over(tracks: &[Shaken], run: &Run, track: Roughness) -> Option<Self> {
        let first = tracks.first()?;
        let [floor, bogies]: [Group; 2] = [|track| &track.floor, |track| &track.bogies];
        let places = |of: Group| -> Vec<PlaceRide> {
            let at = |index: usize| {
                let all: Vec<&PlaceShaken> =
                    tracks.iter().filter_map(|track| of(track).get(index)).collect();
                PlaceShaken::over(&all)
            };
            (0..of(first).len()).filter_map(at).collect()
        };
        let mut spectra = Vec::new();
        let mut resolution_hz = 0.0;
        for of in [floor, bogies] {
            for direction in [Direction::Lateral, Direction::Vertical] {
                let of_all: Vec<Spectrum> = tracks
                    .iter()
                    .filter_map(|track| Some(of(track).first()?.along(direction).spectrum.clone()))
                    .collect();
                let Some(mean) = Spectrum::mean(&of_all) else { continue };
                resolution_hz = mean.resolution_hz;
                let lines = mean.lines().take_while(|(hz, _)| *hz <= SPECTRA_TO_HZ);
                spectra.push(PlaceSpectrum {
                    place: of(first).first()?.place.clone(),
                    direction,
                    density: lines.map(|(_, density)| density).collect(),
                });
            }
        }
        Some(Self {
            speed_kmh: 3.6 * run.speed_m_per_s,
            track,
            floor: places(floor),
            bogies: places(bogies),
            resolution_hz,
            spectra,
        })
    }

    /// The floor above the bogies, or above the middle of a vehicle without any.
    pub fn ends(&self) -> &[PlaceRide] {
        match self.floor.as_slice() {
            [ends @ .., _] if !ends.is_empty() => ends,
            all => all,
        }
    }

    /// The greatest of a quantity over the ends of the floor.
    pub fn worst(&self, of: impl Fn(&PlaceRide) -> Option<f64>) -> Option<f64> {
        self.ends().iter().filter_map(of).reduce(f64::max)
    }
}
