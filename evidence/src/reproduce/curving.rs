//! Figures 18 and 19: the curve of 400 m with 0.12 m of cant at 80 km/h.
//!
//! Derailment coefficient is Y/Q of the outer wheel of wheelset 1, percentile 99.85; lateral shift
//! force the sum of guiding forces of wheelset 1, filtered as EN 14363 does; wear power that of all
//! patches. What the study calls a Bode plot of the shift force is drawn as amplitude density in
//! decibels.

use super::basis::Basis;
use super::locomotive::{KE_N_PER_M, dampers};
use super::row::{Figure, Row};
use crate::error::EvidenceError;
use rayon::prelude::*;
use report::Plot;
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use signal::statistics;
use std::slice;
use vehicle_studies::curve::{self, Curve};
use vehicle_studies::trip::Equipped;

/// The study's curve, next to its straight track.
const SCENARIO: &str = "ss9-curve-400m.toml";
/// Stiffness of figure 18 (N/m), at this clearance (m).
const STIFFNESS_N_PER_M: [f64; 5] = [3e6, 6e6, 9e6, 12e6, 15e6];
const STIFFNESS_AT_2A_M: f64 = 1e-3;
/// Clearance of figure 19 (m), at the good stiffness.
const CLEARANCES_2A_M: [f64; 5] = [0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3];
/// What the study draws in figure 19 (m).
const DRAWN_2A_M: [f64; 2] = [0.5e-3, 4e-3];

/// A passage of the curve with one set of dampers.
struct Passed {
    ke_n_per_m: f64,
    clearance_2a_m: f64,
    curve: Curve,
}

/// Figure 18.
///
/// # Errors
/// The vehicle does not run.
pub(super) fn over_stiffness(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let passed = passages(basis, &STIFFNESS_N_PER_M.map(|ke| (ke, STIFFNESS_AT_2A_M)))?;
    let x: Vec<f64> = passed.iter().map(|passed| 1e-6 * passed.ke_n_per_m).collect();
    Ok(Figure {
        number: "18",
        title: "Derailment coefficient and wear over effective stiffness, curve of 400 m",
        said: "derailment coefficient and wear power hardly change; the lateral force of wheelset 1 increases slightly \
               with Ke; 2a = 1 mm, 80 km/h",
        rows: rows("18", &passed),
        plots: drawn(&passed, &x, ("effective stiffness", "MN/m")).into(),
        ..Figure::default()
    })
}

/// Figure 19.
///
/// # Errors
/// The vehicle does not run.
pub(super) fn over_clearance(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let passed = passages(basis, &CLEARANCES_2A_M.map(|clearance| (KE_N_PER_M, clearance)))?;
    let x: Vec<f64> = passed.iter().map(|passed| 1e3 * passed.clearance_2a_m).collect();
    let mut plots: Vec<Plot> = drawn(&passed, &x, ("clearance 2a", "mm")).into();
    let mut bode = Plot::new("Lateral shift force of wheelset 1 in the full curve")
        .x("frequency", "Hz")
        .y("amplitude density over 1 N/sqrt(Hz)", "dB")
        .log_x();
    for passed in passed.iter().filter(|passed| DRAWN_2A_M.contains(&passed.clearance_2a_m)) {
        if let Some(spectrum) = &passed.curve.spectrum {
            let lines = spectrum.density.iter().enumerate().skip(1);
            let (hz, decibel): (Vec<f64>, Vec<f64>) = lines
                .map(|(line, density)| {
                    (line as f64 * spectrum.resolution_hz, 10.0 * libm::log10(*density))
                })
                .unzip();
            bode = bode.line(&format!("2a {} mm", 1e3 * passed.clearance_2a_m), &hz, &decibel);
        }
    }
    plots.push(bode);
    Ok(Figure {
        number: "19",
        title: "Lateral force of wheelset 1 over clearance, curve of 400 m",
        said: "the lateral force of wheelset 1 increases moderately with 2a, over the whole frequency range; \
               derailment coefficient and wear power hardly change; 80 km/h",
        rows: rows("19", &passed),
        plots,
        ..Figure::default()
    })
}

fn passages(basis: &Basis<'_>, each: &[(f64, f64)]) -> Result<Vec<Passed>, EvidenceError> {
    let scenario = basis.scenario.with_file_name(SCENARIO);
    let procedure =
        curve::Procedure { seeds: basis.procedure.seeds.clone(), ..curve::Procedure::default() };
    let relief_n = basis.locomotive.nominal().f_relief_n;
    each.par_iter()
        .map(|(ke_n_per_m, clearance_2a_m)| {
            EvidenceError::check(basis.stop)?;
            let relief = Setting::to("damper.f_relief_n", relief_n);
            let settings = [&dampers(*ke_n_per_m, *clearance_2a_m), slice::from_ref(&relief)];
            let overrides = Overrides { duration_s: None, ..Overrides::default() };
            let run = Run::load_with(&scenario, overrides, &settings.concat())?;
            let equipped = Equipped::of(&run)?.until(basis.stop);
            let curve = Curve::of(&run, &equipped, &procedure)?;
            Ok(Passed { ke_n_per_m: *ke_n_per_m, clearance_2a_m: *clearance_2a_m, curve })
        })
        .collect()
}

/// A quantity of a passage: name, unit, value in the full curve.
type Quantity = (&'static str, &'static str, fn(&Curve) -> Option<f64>);

const QUANTITIES: [Quantity; 4] = [
    ("derailment_coefficient_of_wheelset_1", "1", |curve| {
        Some(curve.full()?.wheelsets.first()?.outer.y_over_q.mean)
    }),
    ("lateral_shift_force_of_wheelset_1", "kN", |curve| {
        Some(1e-3 * curve.full()?.wheelsets.first()?.sum_n.mean)
    }),
    ("wear_power", "kW", |curve| Some(1e-3 * curve.full()?.wear_w.mean)),
    ("wheel_unloading_of_wheelset_1", "1", |curve| {
        Some(curve.full()?.wheelsets.first()?.inner.unloading.mean)
    }),
];

fn rows(figure: &'static str, passed: &[Passed]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (quantity, unit, of) in QUANTITIES {
        for passed in passed {
            let at = [
                ("ke_n_per_m", passed.ke_n_per_m),
                ("clearance_2a_m", passed.clearance_2a_m),
                ("speed_kmh", passed.curve.speed_kmh),
            ];
            rows.push(Row::new(figure, quantity, at, unit, of(&passed.curve)));
        }
    }
    for (quantity, change) in [
        (QUANTITIES[0], "change_of_derailment_coefficient"),
        (QUANTITIES[1], "change_of_lateral_shift_force"),
        (QUANTITIES[2], "change_of_wear_power"),
    ] {
        let values: Option<Vec<f64>> =
            passed.iter().map(|passed| quantity.2(&passed.curve)).collect();
        let ends = values.as_deref().and_then(|values| Some((*values.first()?, *values.last()?)));
        let percent = ends.map(|(first, last)| 100.0 * (last / first - 1.0));
        let range = values.as_deref().and_then(statistics::min_max);
        let spread = range.map_or(String::new(), |(low, high)| {
            format!(
                "change from the first to the last; all within {:.1} %",
                100.0 * (high / low - 1.0)
            )
        });
        rows.push(Row::new(figure, change, [], "%", percent).note(spread));
    }
    rows
}

fn drawn(passed: &[Passed], x: &[f64], (name, unit): (&str, &str)) -> [Plot; 3] {
    [0, 1, 2].map(|index| {
        let (quantity, of_unit, of) = QUANTITIES[index];
        let y: Vec<f64> =
            passed.iter().map(|passed| of(&passed.curve).unwrap_or(f64::NAN)).collect();
        let called = quantity.replace('_', " ");
        let unit_of_y = if of_unit == "1" { "" } else { of_unit };
        Plot::new(&called).x(name, unit).y(&called, unit_of_y).points("full curve", x, &y)
    })
}
