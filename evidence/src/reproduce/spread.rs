//! The effect on critical speeds of inputs that are neither known nor fitted.
//!
//! Bogie yaw inertia, wheelbase and primary lateral stiffness of the SS9 are in no public source;
//! those of the analogue are used instead. Each is changed by its uncertainty, one at a time;
//! everything else, including the calibrated numbers, stays. A new calibration would compensate
//! part of the change. Two tracks are enough for a difference: the seeds spread by less than the
//! inputs.

use super::basis::Basis;
use super::critical_speeds::PUBLISHED;
use super::locomotive::Locomotive;
use super::row::{Figure, Row};
use crate::error::EvidenceError;
use firmware_core::vehicle::{Axle, Vehicle};
use rayon::prelude::*;
use report::{Cell, Plot, Table};
use scenario::setting::Setting;
use vehicle_studies::critical_speed::Ascent;
use vehicle_studies::critical_speed::Procedure;

/// An input and its relative uncertainty.
struct Input {
    name: &'static str,
    share: f64,
    change: Change,
}

enum Change {
    /// Numbers of the vehicle that are multiplied, by key.
    Keys(&'static [&'static str]),
    /// Distance of the outer wheelsets of a bogie from its middle one.
    Wheelbase,
}

/// Tracks of the first seeds.
const TRACKS: usize = 2;
/// Wheelsets of a bogie.
const PER_BOGIE: usize = 3;

const INPUTS: [Input; 3] = [
    Input {
        name: "bogie yaw inertia",
        share: 0.30,
        change: Change::Keys(&[
            "vehicle.body.bogie_front.yaw_inertia_kg_m2",
            "vehicle.body.bogie_rear.yaw_inertia_kg_m2",
        ]),
    },
    Input { name: "wheelbase", share: 0.07, change: Change::Wheelbase },
    Input {
        name: "primary lateral stiffness",
        share: 0.40,
        change: Change::Keys(&["vehicle.suspension.primary.stiffness_y_n_per_m"]),
    },
];

impl Input {
    fn settings(&self, vehicle: &Vehicle, factor: f64) -> Vec<Setting> {
        match self.change {
            Change::Keys(keys) => keys.iter().map(|key| Setting::times(*key, factor)).collect(),
            Change::Wheelbase => {
                let body = |axle: &Axle| vehicle.bodies.get(axle.body.index());
                let stations_m: Vec<f64> =
                    vehicle.axles.iter().filter_map(body).map(|body| body.station_m).collect();
                let moved = stations_m.chunks(PER_BOGIE).flat_map(|bogie| {
                    let middle_m = bogie[bogie.len() / 2];
                    bogie.iter().map(move |station_m| middle_m + factor * (station_m - middle_m))
                });
                let key = |index: usize| format!("vehicle.body.wheelset_{}.station_m", index + 1);
                moved.enumerate().map(|(index, to_m)| Setting::to(key(index), to_m)).collect()
            }
        }
    }
}

/// Critical speeds with every input at both ends of its range.
///
/// # Errors
/// The vehicle cannot be changed so, or does not run steadily.
pub(super) fn of_inputs(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let seeds = basis.procedure.seeds.iter().take(TRACKS).copied().collect();
    let procedure = &Procedure { seeds, ..basis.procedure.clone() };
    let basis = &Basis { procedure, ..basis.clone() };
    let ends: Vec<(&Input, f64)> = INPUTS
        .iter()
        .flat_map(|input| {
            [-1.0, 1.0].map(|side| (input, libm::round(1e3 + side * 1e3 * input.share) / 1e3))
        })
        .collect();
    let vehicle = &basis.locomotive.as_built().vehicle;
    let speeds: Result<Vec<Vec<Option<f64>>>, EvidenceError> = ends
        .par_iter()
        .map(|(input, factor)| {
            EvidenceError::check(basis.stop)?;
            let changed = Locomotive::load(basis.scenario, &input.settings(vehicle, *factor))?;
            speeds_kmh(&changed, basis)
        })
        .collect();
    let speeds = speeds?;
    let as_it_is = speeds_kmh(basis.locomotive, basis)?;
    let mut rows = Vec::new();
    for ((input, factor), speeds) in ends.iter().zip(&speeds) {
        for (((ke_n_per_m, clearance_2a_m, ..), speed), before) in
            PUBLISHED.iter().zip(speeds).zip(&as_it_is)
        {
            let at = [
                ("ke_n_per_m", *ke_n_per_m),
                ("clearance_2a_m", *clearance_2a_m),
                ("factor", *factor),
            ];
            let change = match (speed, before) {
                (Some(speed), Some(before)) => format!("{:+.1} km/h", speed - before),
                _ => "beyond the speed range".to_owned(),
            };
            rows.push(
                Row::new("10", "critical_speed_with_another_input", at, "km/h", *speed)
                    .note(format!("{} times {factor:.2}: {change}", input.name)),
            );
        }
    }
    Ok(Figure {
        number: "10",
        title: "Effect of unknown inputs on critical speeds",
        said: "no statement: the appendix with the inputs is not public",
        table: Some(compact(&as_it_is, &ends, &speeds)),
        plots: vec![drawn(&as_it_is, &ends, &speeds)],
        rows,
        ..Figure::default()
    })
}

fn speeds_kmh(
    locomotive: &Locomotive,
    basis: &Basis<'_>,
) -> Result<Vec<Option<f64>>, EvidenceError> {
    PUBLISHED
        .par_iter()
        .map(|(ke_n_per_m, clearance_2a_m, ..)| {
            let equipped = locomotive.with(*ke_n_per_m, *clearance_2a_m).until(basis.stop);
            Ok(Ascent::of(&equipped, basis.procedure)?.mean_kmh)
        })
        .collect()
}

/// A line for every end of every input: critical speeds of the published cases.
fn compact(as_it_is: &[Option<f64>], ends: &[(&Input, f64)], speeds: &[Vec<Option<f64>>]) -> Table {
    debug_assert!(ends.len() == speeds.len() && as_it_is.len() == PUBLISHED.len());
    let table = Table::new("Critical speeds with one input at an end of its range").text("input");
    let table = PUBLISHED.iter().fold(table, |table, (ke_n_per_m, clearance_2a_m, ..)| {
        let (ke, clearance) = (1e-6 * ke_n_per_m, 1e3 * clearance_2a_m);
        table.number(&format!("Ke {ke}, 2a {clearance}"), "km/h")
    });
    let line = |name: String, speeds: &[Option<f64>]| {
        let cells = speeds.iter().map(|speed| Cell::from(*speed));
        [Cell::from(name)].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let others = ends
        .iter()
        .zip(speeds)
        .map(|((input, factor), speeds)| line(format!("{} times {factor:.2}", input.name), speeds));
    table.rows([line("as it is".to_owned(), as_it_is)].into_iter().chain(others))
}

fn drawn(as_it_is: &[Option<f64>], ends: &[(&Input, f64)], speeds: &[Vec<Option<f64>>]) -> Plot {
    let numbers: Vec<f64> = (1..=PUBLISHED.len()).map(|number| number as f64).collect();
    let kmh = |speeds: &[Option<f64>]| -> Vec<f64> {
        speeds.iter().map(|speed| speed.unwrap_or(f64::NAN)).collect()
    };
    let published: Vec<f64> = PUBLISHED.iter().map(|(_, _, kmh, ..)| *kmh).collect();
    let mut plot = Plot::new("Critical speeds of the five published cases")
        .x("case", "")
        .y("critical speed", "km/h")
        .caption(
            "Bands from one end of an input to the other, two tracks. Cases: 1 Ke 3 MN/m, 2 Ke 12.5 MN/m, 3 Ke 15 MN/m, each at 2a = 0.2 mm; 4 2a = 1 mm, 5 2a = 8 mm, \
             both at Ke 12.5 MN/m.",
        );
    for pair in ends.chunks(2).zip(speeds.chunks(2)) {
        if let ([(input, _), _], [low, high]) = pair {
            let (low, high) = (kmh(low), kmh(high));
            let lower: Vec<f64> = low.iter().zip(&high).map(|(a, b)| a.min(*b)).collect();
            let upper: Vec<f64> = low.iter().zip(&high).map(|(a, b)| a.max(*b)).collect();
            let name = format!("{} +-{:.0} %", input.name, 100.0 * input.share);
            plot = plot.band(&name, &numbers, &lower, &upper);
        }
    }
    plot.points("ours", &numbers, &kmh(as_it_is)).scatter("the study", &numbers, &published)
}
