//! Figures 9 and 11: the lateral excursion of wheelset 4 behind the rough beginning of a track.
//!
//! The study states: the wheelset comes to rest from 160 to 240 km/h, oscillates with constant
//! amplitude at 250 km/h, and its motion grows with worn-out dampers (a = 4 mm).

use super::basis::Basis;
use super::locomotive::{CLEARANCE_2A_M, KE_N_PER_M};
use super::row::{Figure, Role, Row};
use crate::error::EvidenceError;
use firmware_core::track::Track;
use rayon::prelude::*;
use report::Plot;
use scenario::run::CYCLE_S;
use scenario::track::OwnedTrack;
use signal::statistics;
use vehicle_studies::critical_speed::Hunting;
use vehicle_studies::critical_speed::Procedure;
use vehicle_studies::critical_speed::{offset_wheelset, set_off};
use vehicle_studies::trip::track::rough_start;
use vehicle_studies::trip::{Equipped, lateral_m};

/// Speeds of figure 9 (km/h).
const SPEEDS_KMH: [f64; 13] =
    [160.0, 170.0, 180.0, 190.0, 200.0, 210.0, 220.0, 230.0, 240.0, 250.0, 260.0, 270.0, 280.0];
/// Highest speed at which the wheelset of the study comes to rest, and the speed at which it hunts
/// (km/h).
const QUIET_KMH: f64 = 240.0;
const HUNTS_KMH: f64 = 250.0;
/// Clearance 2a of figure 11 (m).
const SUSPENDED_2A_M: f64 = 8e-3;
/// Speeds of figure 11 (km/h): below and above the critical speed that the study gives.
const WORN_KMH: [f64; 3] = [160.0, 180.0, 200.0];
/// One sample in so many is drawn.
const DRAWN_EVERY: usize = 10;

/// The wheelset's excursion on one track.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Excursion {
    /// Speed (km/h).
    pub kmh: f64,
    /// Lateral position, every control cycle (m).
    pub lateral_m: Vec<f64>,
    /// The motion over the time that is watched; without amplitude off the track.
    pub motion: Hunting,
}

impl Excursion {
    /// Runs over a track with a rough beginning at a speed (km/h).
    ///
    /// # Errors
    /// The vehicle does not run steadily.
    pub(super) fn of(
        equipped: &Equipped<'_>,
        procedure: &Procedure,
        track: &Track<'_>,
        kmh: f64,
    ) -> Result<Self, EvidenceError> {
        let Some(wheelset) = offset_wheelset(equipped, procedure) else {
            return Ok(Self { kmh, lateral_m: Vec::new(), motion: Hunting::DERAILED });
        };
        let (trip, mut state, duration_s) = set_off(equipped, procedure, track, kmh)?;
        let mut lateral = Vec::new();
        let on_track =
            trip.go(&mut state, duration_s, |state| lateral.push(lateral_m(state, wheelset)))?;
        let watched = (procedure.watched_s / CYCLE_S) as usize;
        let end = lateral.get(lateral.len().saturating_sub(watched)..).unwrap_or_default();
        let motion = Hunting::of(end);
        let amplitude_m = motion.amplitude_m.filter(|_| on_track);
        Ok(Self { kmh, lateral_m: lateral, motion: Hunting { amplitude_m, ..motion } })
    }
}

/// Figure 9.
///
/// # Errors
/// The vehicle does not run steadily.
pub(super) fn with_speed(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let procedure = basis.procedure;
    let equipped = basis.equipped(KE_N_PER_M, CLEARANCE_2A_M);
    let found = excursions(&equipped, procedure, &SPEEDS_KMH)?;
    let mut rows = Vec::new();
    for at_speed in &found {
        rows.extend(rows_of("9", at_speed, (KE_N_PER_M, CLEARANCE_2A_M), procedure));
    }
    let kmh: Vec<f64> = found.iter().filter_map(|runs| Some(runs.first()?.kmh)).collect();
    let mut amplitude = Plot::new("Lateral excursion of wheelset 4 at the end of the run")
        .x("speed", "km/h")
        .y("greatest lateral position", "mm")
        .limit("threshold of hunting", 1e3 * procedure.threshold_m)
        .at("the study", HUNTS_KMH);
    for (index, seed) in procedure.seeds.iter().enumerate() {
        let of_seed: Vec<f64> = found
            .iter()
            .map(|runs| {
                runs.get(index).and_then(|run| run.motion.amplitude_m).map_or(f64::NAN, |m| 1e3 * m)
            })
            .collect();
        amplitude = amplitude.points(&format!("track {seed}"), &kmh, &of_seed);
    }
    let shown = found.iter().filter(|runs| {
        runs.first().is_some_and(|run| [QUIET_KMH, HUNTS_KMH, 260.0].contains(&run.kmh))
    });
    Ok(Figure {
        number: "9",
        title: "Wheelset 4 over speed, damper in good condition",
        said: "the wheelset comes to rest from 160 to 240 km/h and oscillates with constant amplitude, abruptly, at \
               250 km/h; Ke = 12.5 MN/m, 2a = 0.2 mm",
        rows,
        plots: vec![amplitude, histories(shown)],
        ..Figure::default()
    })
}

/// Figure 11.
///
/// # Errors
/// The vehicle does not run steadily.
pub(super) fn suspended(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let procedure = basis.procedure;
    let equipped = basis.equipped(KE_N_PER_M, SUSPENDED_2A_M);
    let found = excursions(&equipped, procedure, &WORN_KMH)?;
    let rows = found
        .iter()
        .flat_map(|at_speed| rows_of("11", at_speed, (KE_N_PER_M, SUSPENDED_2A_M), procedure));
    Ok(Figure {
        number: "11",
        title: "Wheelset 4 with worn-out dampers, a = 4 mm",
        said: "the lateral vibration of wheelset 4 grows, since the dampers move within their clearance",
        rows: rows.collect(),
        plots: vec![histories(found.iter())],
        ..Figure::default()
    })
}

fn excursions(
    equipped: &Equipped<'_>,
    procedure: &Procedure,
    speeds_kmh: &[f64],
) -> Result<Vec<Vec<Excursion>>, EvidenceError> {
    let tracks: Vec<OwnedTrack> = procedure
        .seeds
        .iter()
        .map(|seed| rough_start(&procedure.band(*seed), procedure.rough_m))
        .collect();
    let over =
        |track: &OwnedTrack, kmh: f64| Excursion::of(equipped, procedure, &track.view(), kmh);
    speeds_kmh
        .par_iter()
        .map(|kmh| tracks.iter().map(|track| over(track, *kmh)).collect())
        .collect()
}

fn rows_of(
    figure: &'static str,
    runs: &[Excursion],
    (ke_n_per_m, clearance_2a_m): (f64, f64),
    procedure: &Procedure,
) -> Vec<Row> {
    let Some(kmh) = runs.first().map(|run| run.kmh) else { return Vec::new() };
    let at =
        || [("ke_n_per_m", ke_n_per_m), ("clearance_2a_m", clearance_2a_m), ("speed_kmh", kmh)];
    let amplitudes_mm: Vec<f64> =
        runs.iter().filter_map(|run| run.motion.amplitude_m).map(|m| 1e3 * m).collect();
    let beyond = |run: &&Excursion| run.motion.is_beyond(procedure.threshold_m);
    let hunting = runs.iter().filter(beyond).count();
    let share = hunting as f64 / runs.len().max(1) as f64;
    let mut hunts =
        Row::new(figure, "share_of_tracks_that_leave_it_hunting", at(), "1", Some(share))
            .note(format!("{hunting} of {} tracks", runs.len()));
    // What the figure says in words, as a number. The edge of figure 9 is what relief was
    // calibrated on.
    if figure == "9" {
        let said = f64::from(u8::from(kmh >= HUNTS_KMH));
        let role =
            if (QUIET_KMH..=HUNTS_KMH).contains(&kmh) { Role::Calibrated } else { Role::Predicted };
        if kmh <= HUNTS_KMH {
            hunts = hunts.paper(said, role);
            hunts.relative_error = None;
        }
    }
    let amplitude = (amplitudes_mm.len() == runs.len()).then(|| statistics::mean(&amplitudes_mm));
    let mut rows = vec![
        hunts,
        Row::new(figure, "lateral_amplitude_of_wheelset_4", at(), "mm", amplitude)
            .note("greatest position in the last 2 s, mean over tracks"),
    ];
    let swinging: Vec<f64> =
        runs.iter().filter(beyond).filter_map(|run| run.motion.frequency_hz).collect();
    if !swinging.is_empty() {
        let frequency_hz = statistics::mean(&swinging);
        rows.push(Row::new(figure, "limit_cycle_frequency", at(), "Hz", Some(frequency_hz)));
    }
    rows
}

fn histories<'a>(found: impl Iterator<Item = &'a Vec<Excursion>>) -> Plot {
    let mut plot = Plot::new("Lateral position of wheelset 4")
        .x("time", "s")
        .y("lateral position", "mm")
        .caption("300 m of irregular track, then perfect track; the first seed.");
    for runs in found {
        if let Some(run) = runs.first() {
            let (time_s, lateral_mm): (Vec<f64>, Vec<f64>) = run
                .lateral_m
                .iter()
                .enumerate()
                .step_by(DRAWN_EVERY)
                .map(|(index, y)| ((index + 1) as f64 * CYCLE_S, 1e3 * y))
                .unzip();
            plot = plot.line(&format!("{:.0} km/h", run.kmh), &time_s, &lateral_mm);
        }
    }
    plot
}
