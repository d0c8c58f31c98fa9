//! Figures 10a and 10b: critical speed over effective stiffness and over clearance.
//!
//! The procedure is the study's (3 mm on wheelset 4, irregular track), with what it leaves open
//! stated: the irregularity ends after 300 m, and what still moves by the threshold 14 s later
//! hunts. The speed below which no hunting stays bounds it without seed and threshold.

use super::basis::Basis;
use super::locomotive::{CLEARANCE_2A_M, KE_N_PER_M};
use super::null_models::{constant_kmh, line_kmh};
use super::row::{Figure, Role, Row};
use crate::error::EvidenceError;
use rayon::prelude::*;
use report::Plot;
use vehicle_studies::critical_speed::Ascent;
use vehicle_studies::critical_speed::Fold;

/// Stiffness at the small clearance (N/m).
const STIFFNESS_N_PER_M: [f64; 6] = [3e6, 6e6, 9e6, 12e6, KE_N_PER_M, 15e6];
/// Clearance 2a at the good stiffness (m).
const CLEARANCES_2A_M: [f64; 8] = [1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3];

/// A critical speed of the study: stiffness (N/m), clearance 2a (m), speed (km/h), how far a model
/// without the maker's data can be expected to be (km/h), what ours could know.
type Published = (f64, f64, f64, f64, Role);

/// Critical speeds that the study's text gives.
pub(super) const PUBLISHED: [Published; 5] = [
    (3e6, CLEARANCE_2A_M, 212.0, 12.0, Role::Calibrated),
    (KE_N_PER_M, CLEARANCE_2A_M, 250.0, 10.0, Role::Calibrated),
    (15e6, CLEARANCE_2A_M, 260.0, 10.0, Role::Informed),
    (KE_N_PER_M, 1e-3, 250.0, 10.0, Role::Informed),
    (KE_N_PER_M, 8e-3, 170.0, 15.0, Role::Calibrated),
];

/// What was found with one set of dampers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// Stiffness (N/m).
    pub ke_n_per_m: f64,
    /// Clearance 2a (m).
    pub clearance_2a_m: f64,
    /// Over irregular track.
    pub ascent: Ascent,
    /// Down the limit cycle.
    pub fold: Fold,
}

impl Found {
    /// Asks for one set of dampers.
    ///
    /// # Errors
    /// The vehicle does not run steadily.
    pub(super) fn of(
        basis: &Basis<'_>,
        (ke_n_per_m, clearance_2a_m): (f64, f64),
    ) -> Result<Self, EvidenceError> {
        let equipped = basis.equipped(ke_n_per_m, clearance_2a_m);
        let ascent = Ascent::of(&equipped, basis.procedure)?;
        let fold = Fold::of(&equipped, basis.procedure)?;
        Ok(Self { ke_n_per_m, clearance_2a_m, ascent, fold })
    }

    fn rows(&self, figure: &'static str) -> Vec<Row> {
        let at = [("ke_n_per_m", self.ke_n_per_m), ("clearance_2a_m", self.clearance_2a_m)];
        let seeds = self.ascent.seeds.len();
        let mut note = format!("{} over {seeds} seeds", self.ascent.range());
        let mut row = Row::new(figure, "critical_speed", at, "km/h", self.ascent.mean_kmh);
        if let Some((_, _, kmh, band_kmh, role)) = published(self.ke_n_per_m, self.clearance_2a_m) {
            let away = |ours: Option<f64>| {
                ours.map_or("beyond the range".to_owned(), |ours| format!("{:+.1}", ours - kmh))
            };
            let (constant, line) = (constant_kmh(), line_kmh(self.ke_n_per_m, self.clearance_2a_m));
            note = format!(
                "{note}; {} km/h, band {band_kmh:.0}; a constant {}, a line {}",
                away(self.ascent.mean_kmh),
                away(Some(constant)),
                away(Some(line))
            );
            row = row.paper(kmh, role);
        }
        let dies = Row::new(figure, "no_limit_cycle_below", at, "km/h", self.fold.dies.kmh())
            .note(format!("{} km/h, without seed and threshold", self.fold.dies));
        let mut rows = vec![row.note(note), dies];
        if let Some(last) = self.fold.cycle.last() {
            let motion = last.motion;
            let amplitude_mm = motion.amplitude_m.map(|m| 1e3 * m);
            rows.push(Row::new(figure, "limit_cycle_amplitude_at_its_end", at, "mm", amplitude_mm));
            let frequency_hz = motion.frequency_hz;
            rows.push(Row::new(figure, "limit_cycle_frequency_at_its_end", at, "Hz", frequency_hz));
        }
        rows
    }
}

fn published(ke_n_per_m: f64, clearance_2a_m: f64) -> Option<Published> {
    PUBLISHED.into_iter().find(|(ke, clearance, ..)| {
        (ke - ke_n_per_m).abs() < 1.0 && (clearance - clearance_2a_m).abs() < 1e-9
    })
}

/// Figure 10a.
///
/// # Errors
/// The vehicle does not run steadily.
pub(super) fn over_stiffness(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let found = all(basis, STIFFNESS_N_PER_M.map(|ke| (ke, CLEARANCE_2A_M)))?;
    let x: Vec<f64> = found.iter().map(|found| 1e-6 * found.ke_n_per_m).collect();
    Ok(Figure {
        number: "10a",
        title: "Critical speed over effective stiffness",
        said: "the critical speed rises from 212 km/h at 3 MN/m to 260 km/h at 15 MN/m, with 2a = 0.2 mm",
        plots: vec![drawn(&found, &x, ("effective stiffness", "MN/m"), |ke, clearance| {
            (clearance == CLEARANCE_2A_M).then_some(1e-6 * ke)
        })],
        rows: found.iter().flat_map(|found| found.rows("10a")).collect(),
        ..Figure::default()
    })
}

/// Figure 10b.
///
/// # Errors
/// The vehicle does not run steadily.
pub(super) fn over_clearance(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let found = all(basis, CLEARANCES_2A_M.map(|clearance| (KE_N_PER_M, clearance)))?;
    let x: Vec<f64> = found.iter().map(|found| 1e3 * found.clearance_2a_m).collect();
    Ok(Figure {
        number: "10b",
        title: "Critical speed over clearance",
        said: "the critical speed falls from 250 km/h at 2a = 1 mm to 170 km/h at 8 mm, with Ke = 12.5 MN/m",
        plots: vec![drawn(&found, &x, ("clearance 2a", "mm"), |ke, clearance| {
            (ke == KE_N_PER_M && clearance >= CLEARANCES_2A_M[0]).then_some(1e3 * clearance)
        })],
        rows: found.iter().flat_map(|found| found.rows("10b")).collect(),
        ..Figure::default()
    })
}

fn all<const N: usize>(
    basis: &Basis<'_>,
    dampers: [(f64, f64); N],
) -> Result<Vec<Found>, EvidenceError> {
    dampers.par_iter().map(|damper| Found::of(basis, *damper)).collect()
}

fn drawn(
    found: &[Found],
    x: &[f64],
    (name, unit): (&str, &str),
    place: impl Fn(f64, f64) -> Option<f64>,
) -> Plot {
    let range = |end: usize| -> Vec<f64> {
        found.iter().map(|found| found.ascent.range_kmh.map_or(f64::NAN, |r| r[end])).collect()
    };
    let mean: Vec<f64> =
        found.iter().map(|found| found.ascent.mean_kmh.unwrap_or(f64::NAN)).collect();
    let dies: Vec<f64> =
        found.iter().map(|found| found.fold.dies.kmh().unwrap_or(f64::NAN)).collect();
    let (paper_x, paper_y): (Vec<f64>, Vec<f64>) = PUBLISHED
        .iter()
        .filter_map(|(ke, clearance, kmh, ..)| Some((place(*ke, *clearance)?, *kmh)))
        .unzip();
    let line: Vec<f64> =
        found.iter().map(|found| line_kmh(found.ke_n_per_m, found.clearance_2a_m)).collect();
    Plot::new("Critical speed")
        .x(name, unit)
        .y("critical speed", "km/h")
        .band("over seeds", x, &range(0), &range(1))
        .points("hunts from", x, &mean)
        .dashed("no cycle below", x, &dies)
        .dashed("line through the calibrated speeds", x, &line)
        .scatter("the study", &paper_x, &paper_y)
}
