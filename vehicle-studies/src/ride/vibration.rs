//! Vibration of the places of a vehicle, over the tracks of several seeds.

use super::sperling::Direction;
use crate::over_seeds::OverSeeds;
use serde::{Deserialize, Serialize};

/// A place and how it is shaken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceRide {
    /// What it is called.
    pub place: String,
    /// To the sides.
    pub lateral: Vibration,
    /// Up and down.
    pub vertical: Vibration,
    /// Mean comfort of EN 12299, on the floor.
    pub n_mv: Option<f64>,
}

/// Vibration of a place in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Vibration {
    /// Root of the mean square (m/s2).
    pub rms_m_per_s2: OverSeeds,
    /// Greatest acceleration (m/s2).
    pub peak_m_per_s2: OverSeeds,
    /// Sperling index with windows of 20 s; on the floor.
    pub sperling_1985: Option<OverSeeds>,
    /// Sperling index with windows of 5 s; on the floor.
    pub sperling_2019: Option<OverSeeds>,
    /// 95th percentile of weighted rms over 5 s (m/s2); on the floor.
    pub weighted_p95_m_per_s2: Option<f64>,
    /// The highest peaks of the spectrum, the highest first.
    pub peaks: Vec<Peak>,
}

/// A peak of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Its frequency (Hz).
    pub frequency_hz: f64,
    /// Its density ((m/s2)2/Hz).
    pub density: f64,
}

/// A spectrum of acceleration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaceSpectrum {
    /// The place.
    pub place: String,
    /// The direction.
    pub direction: Direction,
    /// Density at multiples of the resolution, from zero ((m/s2)2/Hz).
    pub density: Vec<f64>,
}

impl PlaceRide {
    /// Its vibration in a direction.
    pub const fn along(&self, direction: Direction) -> &Vibration {
        match direction {
            Direction::Lateral => &self.lateral,
            Direction::Vertical => &self.vertical,
        }
    }
}
