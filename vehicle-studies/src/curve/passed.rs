//! One trip from steady running, with what every wheel did on it.

use super::forces::{AxleForces, Passage};
use crate::error::StudyError;
use crate::trip::signals::{Places, Signals, Wheels};
use crate::trip::{START_M, Trip};
use std::ops::Range;

/// A trip that was run, to its end or off the track.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Passed {
    /// Its signals, wheels among them.
    pub signals: Signals,
    /// Static loads of the wheels of every wheelset, left and right (N).
    pub loads: Vec<[f64; 2]>,
    speed_m_per_s: f64,
}

impl Passed {
    /// Runs for a time at the trip's speed.
    ///
    /// # Errors
    /// The vehicle does not run steadily, or the work is stopped.
    pub(crate) fn over(
        trip: &Trip<'_>,
        speed_m_per_s: f64,
        duration_s: f64,
    ) -> Result<Self, StudyError> {
        let mut state = trip.begin(&[])?;
        let axles = state.line.vehicle.wheels.iter().take(trip.vehicle().axles.len());
        let loads = axles.map(|[[left], [right]]| [-left.vertical_n, -right.vertical_n]).collect();
        let places = Places::wheelsets_of(trip.vehicle());
        let signals = Signals::of(trip, &mut state, duration_s, &places, Wheels::Recorded)?;
        Ok(Self { signals, loads, speed_m_per_s })
    }

    /// The forces of every wheelset on a stretch of track (m).
    ///
    /// # Errors
    /// A stretch that was not passed, or a signal that is not finite.
    pub(crate) fn forces(
        &self,
        stretch_m: &Range<f64>,
        right_hand: bool,
    ) -> Result<Vec<AxleForces>, StudyError> {
        let first_m = self.signals.distance_m.first().copied().unwrap_or(START_M);
        let axles = self.signals.wheelsets.iter().zip(&self.loads);
        let forces = axles.map(|(wheelset, static_n)| {
            let passage = Passage {
                wheelset,
                first_m: first_m + wheelset.station_m,
                speed_m_per_s: self.speed_m_per_s,
                static_n: *static_n,
                right_hand,
            };
            Ok(passage.forces(stretch_m)?)
        });
        forces.collect()
    }
}
