//! The scores, as they are written.

use super::condition::Condition;
use super::data_sheet::DataSheet;
use super::errors::Errors;
use super::from_below::FromBelow;
use super::question::Question;
use crate::critical_speed::Critical;
use serde::Serialize;

/// What every result is of.
pub const RESULT_OF: &str = "emulated rig";

/// All scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Version of the form.
    pub format: u32,
    /// What the scores are of: an emulated rig.
    pub result_of: &'static str,
    /// The scenario.
    pub scenario: String,
    /// What was asked.
    pub question: Question,
    /// The vehicle with all dampers modelled.
    pub dampers: Vec<Modelled>,
    /// The scores, damper by damper and compensator by compensator.
    pub scores: Vec<Score>,
    /// Critical speeds that were never reached.
    pub from_below: Vec<Below>,
    /// What is asked of the scores.
    pub aims: Vec<Aim>,
}

/// The vehicle with all dampers modelled: what the scores are compared with.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Modelled {
    /// The state of the dampers.
    pub damper: Condition,
    /// Over the track.
    pub track: Size,
    /// In the limit cycle.
    pub hunting: Size,
    /// Frequency of the limit cycle (Hz).
    pub hunting_hz: f64,
    /// How the nominal rig answers with this damper mounted.
    pub data_sheet: DataSheet,
    /// The critical speed; none where it was not asked for.
    pub critical: Option<Critical>,
    /// By how much one per cent more damping moves it (km/h).
    pub kmh_per_percent_of_damping: Option<f64>,
}

/// The size of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Size {
    /// Speed (km/h).
    pub kmh: f64,
    /// Work of all dampers per cycle of hunting (J).
    pub work_j: f64,
    /// Stroke, half the travel (m).
    pub stroke_m: f64,
}

/// The score of a compensator with one damper and one dead time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// The state of the dampers.
    pub damper: Condition,
    /// The compensator.
    pub compensator: &'static str,
    /// Dead time of the rig (ms).
    pub dead_time_ms: u16,
    /// On the nominal rig; none where the motion was lost.
    pub nominal: InRegimes<Option<Errors>>,
    /// The critical speed on the nominal rig; none where it was not asked for.
    pub critical: Option<Critical>,
    /// How far it is off that of the all-model run (km/h); none where either is not in the range.
    pub critical_error_kmh: Option<f64>,
    /// Over the perturbed rigs; none where they were not asked for.
    pub perturbed: Option<InRegimes<Spread>>,
}

/// One thing per regime.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InRegimes<T> {
    /// Over the track.
    pub track: T,
    /// In the limit cycle.
    pub hunting: T,
}

/// Sizes of errors over several rigs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Rigs on which the motion was lost; the others count.
    pub lost: u64,
    /// Means of the sizes; none where all are lost.
    pub mean: Option<Errors>,
    /// The largest sizes.
    pub worst: Option<Errors>,
}

/// A critical speed from below.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Below {
    /// The state of the dampers.
    pub damper: Condition,
    /// The compensator; none for modelled dampers.
    pub compensator: Option<&'static str>,
    /// Dead time of the rig (ms); none for modelled dampers.
    pub dead_time_ms: Option<u16>,
    /// What was found.
    #[serde(flatten)]
    pub found: FromBelow,
}

/// What is asked of the scores of one compensator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Aim {
    /// The criterion.
    pub criterion: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Over what the worst is taken.
    pub over: &'static str,
    /// The compensator that it is asked of.
    pub compensator: &'static str,
    /// The largest size that was found; none where a motion was lost.
    pub found: Option<f64>,
    /// Where it was found.
    pub place: String,
    /// The most that is asked.
    pub most: f64,
    /// Whether it is met.
    pub is_met: bool,
}

impl Spread {
    /// Of the errors on every rig.
    pub(super) fn of(each: &[Option<Errors>]) -> Self {
        let found: Vec<Errors> = each.iter().flatten().copied().collect();
        let lost = (each.len() - found.len()) as u64;
        let over = |fold: fn(&[f64]) -> f64| {
            let column = |of: fn(&Errors) -> f64| -> f64 {
                fold(&found.iter().map(|one| of(one).abs()).collect::<Vec<f64>>())
            };
            (!found.is_empty()).then(|| Errors {
                work_percent: column(|one| one.work_percent),
                stroke_percent: column(|one| one.stroke_percent),
                phase_deg: column(|one| one.phase_deg),
            })
        };
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        Self { lost, mean: over(signal::statistics::mean), worst: over(largest) }
    }
}
