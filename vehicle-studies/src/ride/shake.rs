//! What one track does to the places of a vehicle, and all tracks together.

use super::sperling::{self, Direction, WINDOW_1985_S, WINDOW_2019_S};
use super::vibration::{Peak, PlaceRide, Vibration};
use super::weighting::Weighting;
use crate::over_seeds::OverSeeds;
use crate::trip::signals::{Acceleration, RATE_HZ, Signals};
use signal::SignalError;
use signal::guiding_force::low_pass;
use signal::spectrum::Spectrum;
use signal::statistics;

/// Length of EN 12299's blocks (s).
const BLOCK_S: f64 = 5.0;
/// Segments of spectra (s).
const SEGMENT_S: f64 = 8.192;
/// Where peaks of spectra are looked for (Hz), and how many are reported.
const PEAKS: ([f64; 2], usize) = ([0.5, 20.0], 3);
/// Low-pass of peak accelerations (Hz).
const PEAK_CORNER_HZ: f64 = 40.0;

/// All places on one track.
pub(super) struct Shaken {
    pub(super) floor: Vec<PlaceShaken>,
    pub(super) bogies: Vec<PlaceShaken>,
}

/// The floor or the bogies of a track.
pub(super) type Group = fn(&Shaken) -> &[PlaceShaken];

/// One place on one track.
pub(super) struct PlaceShaken {
    pub(super) place: String,
    lateral: Shake,
    vertical: Shake,
}

/// One place in one direction on one track.
pub(super) struct Shake {
    rms_m_per_s2: f64,
    peak_m_per_s2: f64,
    pub(super) spectrum: Spectrum,
    /// On the floor: indices by windows of 20 s and of 5 s, weighted rms of blocks.
    comfort: Option<[Vec<f64>; 3]>,
}

impl Shaken {
    pub(super) fn of(signals: &Signals, run_in_s: f64) -> Result<Self, SignalError> {
        let from = libm::round(run_in_s * RATE_HZ) as usize;
        let places = |places: &[Acceleration], floor: bool| -> Result<Vec<_>, SignalError> {
            let shaken = |place: &Acceleration| {
                let along = |values: &[f64], direction| Shake::of(values, from, direction, floor);
                Ok(PlaceShaken {
                    place: place.name.clone(),
                    lateral: along(&place.lateral_m_per_s2, Direction::Lateral)?,
                    vertical: along(&place.vertical_m_per_s2, Direction::Vertical)?,
                })
            };
            places.iter().map(shaken).collect()
        };
        Ok(Self { floor: places(&signals.floor, true)?, bogies: places(&signals.bogies, false)? })
    }
}

impl Shake {
    /// Of a whole trip, the run-in up to the sample `from` included, so that filters have settled
    /// there.
    fn of(
        values: &[f64],
        from: usize,
        direction: Direction,
        floor: bool,
    ) -> Result<Self, SignalError> {
        let counted = values.get(from..).unwrap_or_default();
        let passed = low_pass(values, RATE_HZ, PEAK_CORNER_HZ)?;
        let peak = passed.iter().skip(from).fold(0.0, |most: f64, value| most.max(value.abs()));
        let comfort = if floor {
            let weighting = match direction {
                Direction::Lateral => Weighting::WD,
                Direction::Vertical => Weighting::WB,
            };
            let weighted = weighting.apply(values, RATE_HZ)?;
            let block = libm::round(BLOCK_S * RATE_HZ) as usize;
            let blocks = weighted.get(from..).unwrap_or_default().chunks_exact(block);
            Some([
                sperling::windows(counted, RATE_HZ, WINDOW_1985_S, direction)?,
                sperling::windows(counted, RATE_HZ, WINDOW_2019_S, direction)?,
                blocks.map(statistics::rms).collect(),
            ])
        } else {
            None
        };
        Ok(Self {
            rms_m_per_s2: statistics::rms(counted),
            peak_m_per_s2: peak,
            spectrum: Spectrum::welch(counted, RATE_HZ, SEGMENT_S)?,
            comfort,
        })
    }

    fn over(tracks: &[&Self]) -> Option<Vibration> {
        let comfort = |which: usize| {
            tracks.iter().filter_map(move |shake| Some(shake.comfort.as_ref()?[which].as_slice()))
        };
        let sperling = |which: usize| OverSeeds::of(comfort(which).map(statistics::mean));
        let blocks: Vec<f64> = comfort(2).flatten().copied().collect();
        let spectra: Vec<Spectrum> = tracks.iter().map(|shake| shake.spectrum.clone()).collect();
        let ([from_hz, to_hz], most) = PEAKS;
        let peaks = Spectrum::mean(&spectra)?.peaks(from_hz, to_hz, most).into_iter();
        Some(Vibration {
            rms_m_per_s2: OverSeeds::of(tracks.iter().map(|shake| shake.rms_m_per_s2))?,
            peak_m_per_s2: OverSeeds::of(tracks.iter().map(|shake| shake.peak_m_per_s2))?,
            sperling_1985: sperling(0),
            sperling_2019: sperling(1),
            weighted_p95_m_per_s2: statistics::percentile(&blocks, 0.95),
            peaks: peaks.map(|(frequency_hz, density)| Peak { frequency_hz, density }).collect(),
        })
    }
}

impl PlaceShaken {
    pub(super) fn along(&self, direction: Direction) -> &Shake {
        match direction {
            Direction::Lateral => &self.lateral,
            Direction::Vertical => &self.vertical,
        }
    }

    /// The ride of a place from all tracks.
    pub(super) fn over(tracks: &[&Self]) -> Option<PlaceRide> {
        let along = |direction| {
            let shakes: Vec<&Shake> = tracks.iter().map(|track| track.along(direction)).collect();
            Shake::over(&shakes)
        };
        let (lateral, vertical) = (along(Direction::Lateral)?, along(Direction::Vertical)?);
        let n_mv = lateral
            .weighted_p95_m_per_s2
            .zip(vertical.weighted_p95_m_per_s2)
            .map(|(lateral, vertical)| 6.0 * libm::hypot(lateral, vertical));
        Some(PlaceRide { place: tracks.first()?.place.clone(), lateral, vertical, n_mv })
    }
}
