//! Ring-downs: how fast a motion of a certain size dies at one speed.
//!
//! ```text
//! ln |p[i]| = c - d t[i]        p[i]: extremes of the half cycles of a damper's extension
//!                               d:    decay rate (1/s), by least squares
//! ```
//! A short sine of alignment sets the vehicle swinging, and it rings down on the perfect track
//! behind it. The half cycles whose extremes lie in a window of amplitudes count, from the first
//! below its upper end to the last above its lower end. A clearance and a relief valve make the
//! damping depend on the amplitude, so a decay rate belongs to its window.

use crate::critical_speed::{burst, burst_s, burst_track};
use crate::error::StudyError;
use crate::trip::{Equipped, Trip};
use scenario::run::CYCLE_S;
use serde::Serialize;
use signal::statistics::HalfCycles;

/// Fewest substeps of a cycle.
const SUBSTEPS: u32 = 2;
/// Fewest half cycles in the window.
const HALF_CYCLES_MIN: usize = 4;
/// Half cycles at the start that the other modes have a part in.
const SKIPPED: usize = 2;
/// Motion that does not count as a half cycle, as a share of the lower end of the window.
const DEAD_BAND: f64 = 0.2;

/// How a vehicle is let ring down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Release {
    /// Amplitude of the alignment that sets it swinging (m).
    pub burst_m: f64,
    /// Frequency at which it passes (Hz).
    pub burst_hz: f64,
    /// Amplitudes of the extension that count (m): lower and upper end.
    pub window_m: [f64; 2],
    /// Time for which it is watched behind that (s).
    pub watched_s: f64,
    /// The most that a ram may move from the middle (m); a ring-down beyond it does not count.
    pub stroke_limit_m: f64,
}

/// One ring-down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RingDown {
    /// Speed (km/h).
    pub kmh: f64,
    /// Decay rate (1/s); negative where the motion grows.
    pub decay_per_s: f64,
    /// Frequency (Hz).
    pub frequency_hz: f64,
    /// Half cycles that it is found from.
    pub half_cycles: usize,
    /// The most that a ram moved from the middle (m).
    pub largest_stroke_m: f64,
}

impl RingDown {
    /// The ring-down at a speed (km/h); none where too few half cycles lie in the window, or where
    /// a ram reached its limit.
    ///
    /// # Errors
    /// No steady running, or the work is stopped.
    pub fn of(
        equipped: &Equipped<'_>,
        release: &Release,
        kmh: f64,
    ) -> Result<Option<Self>, StudyError> {
        let speed_m_per_s = kmh / 3.6;
        let samples = burst(speed_m_per_s / release.burst_hz, release.burst_m);
        let track = burst_track(&samples);
        let trip = Trip::new(equipped, &track, speed_m_per_s, SUBSTEPS);
        let mut state = trip.begin(&[])?;
        let set_off_s = burst_s(release.burst_hz, speed_m_per_s);
        let (mut extension_m, mut largest_m) = (Vec::new(), 0.0_f64);
        let on_track = trip.go_with_rigs(&mut state, set_off_s + release.watched_s, |state| {
            let motions = trip.damper_motions(&state.line);
            let first_m = motions.first().map_or(0.0, |motion| motion.displacement_m);
            extension_m.push(first_m);
            for reading in state.readings().flatten() {
                largest_m = largest_m.max(reading.ram_displacement_m.abs());
            }
            if equipped.rigs.is_none() {
                largest_m = largest_m.max(first_m.abs());
            }
        })?;
        if !on_track || largest_m > release.stroke_limit_m {
            return Ok(None);
        }
        let behind = (set_off_s / CYCLE_S) as usize;
        let behind_m = extension_m.get(behind..).unwrap_or_default();
        Ok(Self::seen(behind_m, release, (kmh, largest_m)))
    }

    /// That of an extension from cycle to cycle (m).
    fn seen(extension_m: &[f64], release: &Release, (kmh, largest_m): (f64, f64)) -> Option<Self> {
        let [low_m, high_m] = release.window_m;
        let mut halves = HalfCycles::new(0.0, DEAD_BAND * low_m);
        let found = extension_m.iter().filter_map(|x| halves.push(*x)).skip(SKIPPED);
        let counted = found
            .skip_while(|half| half.extreme.abs() > high_m)
            .take_while(|half| half.extreme.abs() >= low_m);
        let points: Vec<(f64, f64)> = counted
            .map(|half| (0.5 * (half.start + half.end) * CYCLE_S, libm::log(half.extreme.abs())))
            .collect();
        if points.len() < HALF_CYCLES_MIN {
            return None;
        }
        let count = points.len() as f64;
        let middle = points.iter().fold((0.0, 0.0), |(t, y), one| (t + one.0, y + one.1));
        let (t_mean, y_mean) = (middle.0 / count, middle.1 / count);
        let of = |f: fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|(t, y)| f(t - t_mean, y - y_mean)).sum()
        };
        let (first_s, last_s) = (points.first()?.0, points.last()?.0);
        Some(Self {
            kmh,
            decay_per_s: -of(|t, y| t * y) / of(|t, _| t * t),
            frequency_hz: 0.5 * (count - 1.0) / (last_s - first_s),
            half_cycles: points.len(),
            largest_stroke_m: largest_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RELEASE: Release = Release {
        burst_m: 0.0,
        burst_hz: 3.3,
        window_m: [0.5e-3, 2e-3],
        watched_s: 6.0,
        stroke_limit_m: 1.0,
    };

    fn fading(decay_per_s: f64, hz: f64) -> Vec<f64> {
        let at = |n: u32| {
            let t = f64::from(n) * CYCLE_S;
            4e-3 * libm::exp(-decay_per_s * t) * libm::cos(TAU * hz * t)
        };
        (0..10_000).map(at).collect()
    }

    #[test]
    fn the_decay_rate_of_a_damped_sine_is_found_within_the_window() {
        for (decay_per_s, hz) in [(1.0, 3.3), (0.3, 3.3), (2.5, 4.0)] {
            let found = RingDown::seen(&fading(decay_per_s, hz), &RELEASE, (200.0, 0.0)).unwrap();
            // From 2 mm to 0.5 mm, a quarter, in half cycles.
            let expected = libm::log(4.0) / decay_per_s * 2.0 * hz;
            assert!((found.half_cycles as f64 - expected).abs() <= 1.5, "{found:?} {expected}");
            assert!((found.decay_per_s / decay_per_s - 1.0).abs() < 5e-3, "{found:?}");
            assert!((found.frequency_hz / hz - 1.0).abs() < 5e-3, "{found:?}");
        }
    }

    #[test]
    fn what_never_comes_into_the_window_has_no_decay_rate() {
        assert_eq!(RingDown::seen(&fading(0.0, 3.3), &RELEASE, (200.0, 0.0)), None);
        assert_eq!(RingDown::seen(&fading(20.0, 3.3), &RELEASE, (200.0, 0.0)), None);
        assert_eq!(RingDown::seen(&[], &RELEASE, (200.0, 0.0)), None);
    }
}
