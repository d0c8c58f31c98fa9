//! The curving of one vehicle over the tracks of several seeds.
//!
//! ```text
//! a_q = v^2/R - g h/1.5 m            unbalanced, outward; cant deficiency = 1.5 m a_q/g
//! ```

use super::forces::AxleForces;
use super::limits::AxleLimits;
use super::passed::Passed;
use super::procedure::Procedure;
use super::sections::{Part, Section, sections};
use super::wheelset::{WheelCurve, WheelsetCurve};
use crate::error::StudyError;
use crate::over_seeds::OverSeeds;
use crate::trip::track::Roughness;
use crate::trip::{Equipped, START_M, Trip};
use firmware_core::vehicle::GRAVITY_M_PER_S2;
use rayon::prelude::*;
use scenario::run::Run;
use scenario::track::{OwnedTrack, RAIL_SPACING_M};
use serde::{Deserialize, Serialize};
use signal::spectrum::Spectrum;

/// The spectrum is kept up to here (Hz).
const SPECTRUM_TO_HZ: f64 = 50.0;
/// Track behind the last transition that the last wheelset still runs on (m).
const BEHIND_M: f64 = 10.0;

/// How a vehicle goes through a curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Running speed (km/h).
    pub speed_kmh: f64,
    /// Radius of the full curve (m).
    pub radius_m: f64,
    /// `left` or `right`.
    pub direction: String,
    /// Height of the outer rail over the inner one (m).
    pub cant_m: f64,
    /// Unbalanced acceleration, outward (m/s2).
    pub unbalanced_m_per_s2: f64,
    /// Cant that is lacking (m).
    pub cant_deficiency_m: f64,
    /// Straight track before it: the run-in (m).
    pub lead_in_m: f64,
    /// The irregularity.
    pub track: Roughness,
    /// What forces are held against, wheelset by wheelset.
    pub limits: Vec<AxleLimits>,
    /// Entry, full curve and exit.
    pub sections: Vec<SectionCurve>,
    /// Spectrum of the sum of guiding forces of the first wheelset in the full curve.
    pub spectrum: Option<ForceSpectrum>,
}

/// A section of the curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SectionCurve {
    /// Where it is.
    pub section: Section,
    /// The wheelsets, from the front.
    pub wheelsets: Vec<WheelsetCurve>,
    /// Mean power lost in all patches of the vehicle (W).
    pub wear_w: OverSeeds,
}

/// A spectrum of force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceSpectrum {
    /// Distance between lines (Hz).
    pub resolution_hz: f64,
    /// Density at multiples of it, from zero (N2/Hz).
    pub density: Vec<f64>,
}

impl Curve {
    /// The vehicle of a run goes through the curve on the tracks of all seeds.
    ///
    /// # Errors
    /// No curve, no steady running, a track that the vehicle leaves; the work is stopped.
    pub fn of(
        run: &Run,
        equipped: &Equipped<'_>,
        procedure: &Procedure,
    ) -> Result<Self, StudyError> {
        let layout = &run.track.layout;
        let sections = sections(layout);
        let full = sections.iter().find(|section| section.part == Part::Curve);
        let full = full.ok_or(StudyError::NoCurve)?;
        let place = layout.at(0.5 * (full.from_m + full.to_m));
        let sign = libm::copysign(1.0, place.curvature_per_m);
        let centripetal = run.speed_m_per_s * run.speed_m_per_s * place.curvature_per_m;
        let unbalanced_m_per_s2 = sign * (centripetal - GRAVITY_M_PER_S2 * place.cant_rad);
        let duration_s = duration_s(run);
        let track = Roughness::of(run, &procedure.seeds);
        let tracks = track.tracks(run, layout, START_M + run.speed_m_per_s * duration_s + 30.0);
        let through = |(number, track): (usize, &OwnedTrack)| {
            passed(run, equipped, track, duration_s)
                .map_err(|why| why.on_track(number + 1))
                .and_then(|passed| on_track(passed, &sections, sign > 0.0))
        };
        let found: Result<Vec<OnTrack>, StudyError> =
            tracks.par_iter().enumerate().map(through).collect();
        let found = found?;
        let loads = found.first().map(|on| on.loads.as_slice()).unwrap_or_default();
        let limits =
            loads.iter().map(|pair| AxleLimits::of(pair[0] + pair[1], procedure.k1)).collect();
        let by_section = sections.iter().enumerate().filter_map(|(number, section)| {
            let axles: Vec<&[AxleForces]> =
                found.iter().map(|on| on.sections[number].as_slice()).collect();
            SectionCurve::over(*section, &axles)
        });
        let first_axles: Vec<Spectrum> = found
            .iter()
            .filter_map(|on| {
                let number = sections.iter().position(|section| section == full)?;
                on.sections[number].first()?.spectrum.clone()
            })
            .collect();
        let spectrum = Spectrum::mean(&first_axles).map(|mean| ForceSpectrum {
            resolution_hz: mean.resolution_hz,
            density: mean
                .lines()
                .take_while(|(hz, _)| *hz <= SPECTRUM_TO_HZ)
                .map(|l| l.1)
                .collect(),
        });
        Ok(Self {
            speed_kmh: 3.6 * run.speed_m_per_s,
            radius_m: 1.0 / place.curvature_per_m.abs(),
            direction: if sign > 0.0 { "right" } else { "left" }.to_owned(),
            cant_m: sign * place.cant_rad * RAIL_SPACING_M,
            unbalanced_m_per_s2,
            cant_deficiency_m: unbalanced_m_per_s2 / GRAVITY_M_PER_S2 * RAIL_SPACING_M,
            lead_in_m: sections.first().map_or(0.0, |section| section.from_m),
            track,
            limits,
            sections: by_section.collect(),
            spectrum,
        })
    }

    /// The full curve.
    pub fn full(&self) -> Option<&SectionCurve> {
        self.sections.iter().find(|section| section.section.part == Part::Curve)
    }
}

/// How long a vehicle runs until its last wheelset is behind the curve (s).
pub(super) fn duration_s(run: &Run) -> f64 {
    let stations = run
        .vehicle
        .axles
        .iter()
        .filter_map(|axle| Some(run.vehicle.bodies.get(axle.body.index())?.station_m));
    let rear_m = stations.fold(0.0, f64::min);
    (run.track.layout.end_m() + BEHIND_M - rear_m - START_M) / run.speed_m_per_s
}

/// What one track did.
struct OnTrack {
    /// Static loads of the wheels of every wheelset, left and right (N).
    loads: Vec<[f64; 2]>,
    /// Forces by section and wheelset.
    sections: Vec<Vec<AxleForces>>,
}

fn passed(
    run: &Run,
    equipped: &Equipped<'_>,
    track: &OwnedTrack,
    duration_s: f64,
) -> Result<Passed, StudyError> {
    let track = track.view();
    let trip = Trip::new(equipped, &track, run.speed_m_per_s, run.substeps);
    let passed = Passed::over(&trip, run.speed_m_per_s, duration_s)?;
    if passed.signals.derailed {
        let at_m = passed.signals.distance_m.last().copied().unwrap_or_default();
        return Err(StudyError::OffTheTrack(at_m));
    }
    Ok(passed)
}

fn on_track(passed: Passed, sections: &[Section], right_hand: bool) -> Result<OnTrack, StudyError> {
    let of = |section: &Section| passed.forces(&(section.from_m..section.to_m), right_hand);
    let found: Result<Vec<_>, StudyError> = sections.iter().map(of).collect();
    Ok(OnTrack { sections: found?, loads: passed.loads })
}

impl SectionCurve {
    /// A quantity of the wheelset where its mean over seeds is greatest.
    pub fn worst(&self, of: impl Fn(&WheelsetCurve) -> Option<OverSeeds>) -> Option<OverSeeds> {
        self.wheelsets.iter().filter_map(of).max_by(|a, b| a.mean.total_cmp(&b.mean))
    }

    /// A quantity of the wheel where its mean over seeds is greatest.
    pub fn worst_wheel(&self, of: impl Fn(&WheelCurve) -> OverSeeds) -> Option<OverSeeds> {
        let wheels = self.wheelsets.iter().flat_map(|wheelset| [&wheelset.outer, &wheelset.inner]);
        wheels.map(of).max_by(|a, b| a.mean.total_cmp(&b.mean))
    }

    /// From the wheelsets of every track.
    fn over(section: Section, tracks: &[&[AxleForces]]) -> Option<Self> {
        let axles = tracks.first()?.len();
        let wheelset = |number: usize| {
            let axle: Vec<&AxleForces> =
                tracks.iter().filter_map(|axles| axles.get(number)).collect();
            WheelsetCurve::over(&axle)
        };
        let wear_w = tracks.iter().map(|axles| {
            axles.iter().flat_map(|axle| &axle.wheels).map(|wheel| wheel.wear_w).sum::<f64>()
        });
        Some(Self {
            section,
            wheelsets: (0..axles).filter_map(wheelset).collect(),
            wear_w: OverSeeds::of(wear_w)?,
        })
    }
}
