//! How stability is asked for, with every number that matters to the answer.

use scenario::irregularity::Band;
use serde::Serialize;

/// What counts as unstable over irregular track.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// A motion that stays on perfect track behind the irregular one: the study's.
    LimitCycle,
    /// Guiding forces on irregular track above EN 14363's limit.
    En14363,
}

/// A way to ask.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Procedure {
    /// What counts as unstable.
    pub criterion: Criterion,
    /// Lowest speed that is tried (km/h).
    pub from_kmh: f64,
    /// Highest speed that is tried (km/h).
    pub to_kmh: f64,
    /// Distance between speeds that are tried one after the other (km/h).
    pub step_kmh: f64,
    /// How closely a critical speed is met (km/h).
    pub resolution_kmh: f64,
    /// Wheelset that starts off the middle of the track, from 1 at the front.
    pub offset_wheelset: usize,
    /// How far it does (m).
    pub offset_m: f64,
    /// Length of irregular track (m).
    pub rough_m: f64,
    /// Wavelengths of the irregularity (m).
    pub wavelengths_m: [f64; 2],
    /// Time on perfect track behind it (s).
    pub smooth_s: f64,
    /// The last part of it, which is watched (s).
    pub watched_s: f64,
    /// Lateral motion of a wheelset that counts as hunting (m).
    pub threshold_m: f64,
    /// Time at each speed of a descent (s).
    pub hold_s: f64,
    /// Lateral motion below which a descent has lost its cycle (m).
    pub alive_m: f64,
    /// Seeds of the irregularity.
    pub seeds: Vec<u64>,
    /// Fewest substeps of a cycle of 1 ms.
    pub substeps: u32,
}

impl Default for Procedure {
    /// That of the study: 3 mm on wheelset 4, 300 m of class-6 track; threshold and time as in its
    /// reproduction by a reduced model.
    fn default() -> Self {
        Self {
            criterion: Criterion::LimitCycle,
            from_kmh: 100.0,
            to_kmh: 400.0,
            step_kmh: 5.0,
            resolution_kmh: 0.5,
            offset_wheelset: 4,
            offset_m: 3e-3,
            rough_m: 300.0,
            wavelengths_m: [1.0, 100.0],
            smooth_s: 14.0,
            watched_s: 2.0,
            threshold_m: 3e-3,
            hold_s: 12.0,
            alive_m: 1.5e-3,
            seeds: (1..=5).collect(),
            substeps: 2,
        }
    }
}

impl Procedure {
    /// The irregularity of a seed.
    pub fn band(&self, seed: u64) -> Band {
        let [shortest, longest] = self.wavelengths_m;
        Band { seed, shortest, longest, scale: 1.0 }
    }
}
