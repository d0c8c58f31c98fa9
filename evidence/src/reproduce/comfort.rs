//! Figures 5 and 12 to 17: accelerations, spectra and ride indices over speed, stiffness and
//! clearance.
//!
//! Ride index is the Sperling index of GB 5599-85 at the worse end of the floor. A yaw damper lies
//! level and reaches vertical motion at second order only, so that the study's change of the
//! vertical index is not expected here.

use super::basis::Basis;
use super::locomotive::KE_N_PER_M;
use super::row::{Figure, Role, Row};
use super::running::{SPEED_KMH, run_with};
use crate::error::EvidenceError;
use rayon::prelude::*;
use report::Plot;
use vehicle_studies::ride;
use vehicle_studies::ride::Kind;
use vehicle_studies::ride::sperling::Direction;
use vehicle_studies::ride::{PlaceRide, PlaceSpectrum, Ride};
use vehicle_studies::trip::Equipped;

/// Speeds of figure 5 (km/h).
const SPEEDS_KMH: [f64; 6] = [80.0, 100.0, 120.0, 140.0, 160.0, 180.0];
/// Stiffness of figures 12 to 14 (N/m), at 2a = 1 mm.
const STIFFNESS_N_PER_M: [f64; 5] = [3e6, 6e6, 9e6, 12e6, 15e6];
const STIFFNESS_AT_2A_M: f64 = 1e-3;
/// Clearance of figures 15 to 17 (m), at the good stiffness.
const CLEARANCES_2A_M: [f64; 9] = [0.5e-3, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3];
/// Clearance at which the study's dampers just do not touch, and the range over which ride gets
/// worse (m).
const WORST_2A_M: f64 = 6e-3;
const FROM_2A_M: f64 = 1e-3;
/// A clearance in which no damper ever touches (m).
const NO_DAMPER_2A_M: f64 = 1.0;
/// Peaks of the bogie's lateral spectrum in the study (Hz).
const BOGIE_PEAKS_HZ: [f64; 2] = [3.2, 3.8];
/// Mean errors of the study's own model against its field test (%): lateral and vertical
/// acceleration, lateral and vertical ride index.
const FIELD_TEST: [(&str, f64); 4] = [
    ("study_against_field_test_lateral_acceleration", 10.12),
    ("study_against_field_test_vertical_acceleration", 14.83),
    ("study_against_field_test_lateral_ride_index", 6.58),
    ("study_against_field_test_vertical_ride_index", 1.44),
];

/// A ride and the conditions that it was under.
struct Ridden {
    at: Vec<(&'static str, f64)>,
    x: f64,
    ride: Ride,
}

/// Figure 5.
///
/// # Errors
/// The vehicle does not run.
pub(super) fn over_speed(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let nominal = basis.locomotive.nominal();
    let damper = (nominal.ke_n_per_m, nominal.clearance_2a_m);
    let rides = ridden(basis, &SPEEDS_KMH.map(|kmh| (damper, kmh, kmh)))?;
    let mut rows: Vec<Row> = rides.iter().flat_map(|ridden| ridden.rows("5")).collect();
    rows.extend(FIELD_TEST.map(|(quantity, percent)| {
        Row::new("5", quantity, [], "%", None).paper(percent, Role::Predicted).note(
            "the error of the study's model against its field test, whose record is not public",
        )
    }));
    Ok(Figure {
        number: "5",
        title: "Carbody accelerations and ride indices over speed",
        said: "accelerations and ride indices increase with speed; the study's own model differs from a field \
               test by 10.12 % (lateral) and 14.83 % (vertical) in acceleration, by 6.58 % and 1.44 % in ride index",
        plots: vec![rms(&rides, ("speed", "km/h")), indices(&rides, ("speed", "km/h"))],
        rows,
        ..Figure::default()
    })
}

/// Figures 12 to 14.
///
/// # Errors
/// The vehicle does not run.
pub(super) fn over_stiffness(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let rides = ridden(
        basis,
        &STIFFNESS_N_PER_M.map(|ke| ((ke, STIFFNESS_AT_2A_M), SPEED_KMH, 1e-6 * ke)),
    )?;
    let mut rows: Vec<Row> = rides.iter().flat_map(|ridden| ridden.rows("14")).collect();
    for ridden in &rides {
        rows.extend(bogie_rows(ridden));
    }
    let change =
        |direction| spread_percent(rides.iter().map(|ridden| index(&ridden.ride, direction)));
    rows.push(
        Row::new("14", "lateral_ride_index_change", [], "%", change(Direction::Lateral))
            .paper(3.5, Role::Predicted)
            .note("greatest minus smallest, relative to the smallest"),
    );
    rows.push(
        Row::new("14", "vertical_ride_index_change", [], "%", change(Direction::Vertical))
            .paper(0.0, Role::Predicted)
            .note("the study: no obvious influence"),
    );
    let x = ("effective stiffness", "MN/m");
    Ok(Figure {
        number: "12-14",
        title: "Bogie vibration, its spectrum and ride index over effective stiffness",
        said: "a stiffer damper reduces the lateral vibration of the bogie; of the peaks at 3.2 and 3.8 Hz the higher \
               one, at 3.8 Hz, falls with Ke; the vertical vibration does not change; the lateral index changes by about \
               3.5 % and is good, the vertical one is excellent; 2a = 1 mm, 160 km/h",
        plots: vec![
            spectra(&rides, "bogie", Direction::Lateral, "Ke", "MN/m"),
            spectra(&rides, "bogie", Direction::Vertical, "Ke", "MN/m"),
            indices(&rides, x),
        ],
        rows,
        ..Figure::default()
    })
}

/// Figures 15 to 17.
///
/// # Errors
/// The vehicle does not run.
pub(super) fn over_clearance(basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
    let mut asked: Vec<((f64, f64), f64, f64)> = CLEARANCES_2A_M
        .iter()
        .map(|clearance| ((KE_N_PER_M, *clearance), SPEED_KMH, 1e3 * clearance))
        .collect();
    asked.push(((KE_N_PER_M, NO_DAMPER_2A_M), SPEED_KMH, f64::NAN));
    let mut rides = ridden(basis, &asked)?;
    let without = rides.pop();
    let mut rows: Vec<Row> = rides.iter().flat_map(|ridden| ridden.rows("17")).collect();
    for (direction, quantity, percent) in [
        (Direction::Lateral, "lateral_ride_index_growth_from_1_to_6_mm", 9.2),
        (Direction::Vertical, "vertical_ride_index_growth_from_1_to_6_mm", 14.2),
    ] {
        let at = |clearance: f64| {
            let found = rides.iter().find(|ridden| (ridden.x - 1e3 * clearance).abs() < 1e-9);
            found.and_then(|ridden| index(&ridden.ride, direction))
        };
        let growth = at(FROM_2A_M).zip(at(WORST_2A_M)).map(|(from, to)| 100.0 * (to / from - 1.0));
        rows.push(Row::new("17", quantity, [], "%", growth).paper(percent, Role::Predicted));
    }
    if let Some(without) = &without {
        for direction in [Direction::Lateral, Direction::Vertical] {
            let quantity = match direction {
                Direction::Lateral => "lateral_ride_index_without_yaw_dampers",
                Direction::Vertical => "vertical_ride_index_without_yaw_dampers",
            };
            let at = [("speed_kmh", SPEED_KMH)];
            rows.push(
                Row::new("17", quantity, at, "1", index(&without.ride, direction))
                    .note("the limit for large clearances"),
            );
        }
    }
    let x = ("clearance 2a", "mm");
    Ok(Figure {
        number: "15-17",
        title: "Carbody vibration, its spectrum and ride index over clearance",
        said: "the ride index deteriorates by 9.2 % (lateral) and 14.2 % (vertical) from 1 to 6 mm and improves again \
               beyond; the main peak of the spectrum, at 3 to 4 Hz, grows with 2a; elsewhere the study states that \
               clearance hardly affects vertical vibration; Ke = 12.5 MN/m, 160 km/h",
        plots: vec![
            rms(&rides, x),
            spectra(&rides, "floor", Direction::Lateral, "2a", "mm"),
            indices(&rides, x),
        ],
        rows,
        ..Figure::default()
    })
}

/// Dampers (stiffness, clearance), speed (km/h) and the place on the plots' axis.
type Asked = ((f64, f64), f64, f64);

fn ridden(basis: &Basis<'_>, asked: &[Asked]) -> Result<Vec<Ridden>, EvidenceError> {
    let procedure =
        ride::Procedure { seeds: basis.procedure.seeds.clone(), ..ride::Procedure::default() };
    asked
        .par_iter()
        .map(|(damper, speed_kmh, x)| {
            let run = run_with(basis, *damper, *speed_kmh, &[])?;
            let equipped = Equipped::of(&run)?.until(basis.stop);
            let ride = Ride::of(&run, &equipped, &procedure)?;
            let (ke_n_per_m, clearance_2a_m) = *damper;
            let at = vec![
                ("ke_n_per_m", ke_n_per_m),
                ("clearance_2a_m", clearance_2a_m),
                ("speed_kmh", *speed_kmh),
            ];
            Ok(Ridden { at, x: *x, ride })
        })
        .collect()
}

impl Ridden {
    fn rows(&self, figure: &'static str) -> Vec<Row> {
        let mut rows = Vec::new();
        let rms = |place: &PlaceRide, direction| place.along(direction).rms_m_per_s2.mean;
        for (direction, acceleration, sperling) in [
            (Direction::Lateral, "carbody_lateral_rms", "lateral_ride_index"),
            (Direction::Vertical, "carbody_vertical_rms", "vertical_ride_index"),
        ] {
            let worst = self.ride.worst(|place| Some(rms(place, direction)));
            rows.push(Row::new(figure, acceleration, self.at.clone(), "m/s2", worst));
            let index = index(&self.ride, direction);
            let grade = index.map(|index| Kind::Locomotive.grade(index).name());
            rows.push(
                Row::new(figure, sperling, self.at.clone(), "1", index)
                    .note(grade.unwrap_or_default()),
            );
        }
        rows
    }
}

fn bogie_rows(ridden: &Ridden) -> Vec<Row> {
    let Some(bogie) = ridden.ride.bogies.first() else { return Vec::new() };
    let row = |figure, quantity, unit, ours: Option<f64>| {
        Row::new(figure, quantity, ridden.at.clone(), unit, ours)
    };
    let peak = bogie.lateral.peaks.first();
    let mut rows = vec![
        row("12", "bogie_lateral_rms", "m/s2", Some(bogie.lateral.rms_m_per_s2.mean)),
        row("12", "bogie_vertical_rms", "m/s2", Some(bogie.vertical.rms_m_per_s2.mean)),
        row("13", "bogie_lateral_main_peak_density", "(m/s2)2/Hz", peak.map(|peak| peak.density)),
    ];
    for (quantity, hz) in ["bogie_lateral_peak_near_3.2_hz", "bogie_lateral_peak_near_3.8_hz"]
        .into_iter()
        .zip(BOGIE_PEAKS_HZ)
    {
        let near = bogie.lateral.peaks.iter().map(|peak| peak.frequency_hz);
        let near = near.min_by(|a, b| (a - hz).abs().total_cmp(&(b - hz).abs()));
        rows.push(
            row("13", quantity, "Hz", near)
                .paper(hz, Role::Predicted)
                .note("the nearest of the three highest peaks"),
        );
    }
    rows
}

/// The worse end's Sperling index.
fn index(ride: &Ride, direction: Direction) -> Option<f64> {
    ride.worst(|place| Some(place.along(direction).sperling_1985?.mean))
}

fn spread_percent(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Option<Vec<f64>> = values.collect();
    let (low, high) = signal::statistics::min_max(&values?)?;
    Some(100.0 * (high / low - 1.0))
}

fn indices(rides: &[Ridden], (name, unit): (&str, &str)) -> Plot {
    let x: Vec<f64> = rides.iter().map(|ridden| ridden.x).collect();
    let values = |direction| -> Vec<f64> {
        rides.iter().map(|ridden| index(&ridden.ride, direction).unwrap_or(f64::NAN)).collect()
    };
    let [excellent, good, qualified] = Kind::Locomotive.sperling();
    Plot::new("Sperling index of the worse end of the floor")
        .x(name, unit)
        .y("ride index", "")
        .points("lateral", &x, &values(Direction::Lateral))
        .points("vertical", &x, &values(Direction::Vertical))
        .limit("excellent", excellent)
        .limit("good", good)
        .limit("qualified", qualified)
}

fn rms(rides: &[Ridden], (name, unit): (&str, &str)) -> Plot {
    let x: Vec<f64> = rides.iter().map(|ridden| ridden.x).collect();
    let values = |direction| -> Vec<f64> {
        let worst = |ridden: &Ridden| {
            ridden.ride.worst(|place| Some(place.along(direction).rms_m_per_s2.mean))
        };
        rides.iter().map(|ridden| worst(ridden).unwrap_or(f64::NAN)).collect()
    };
    Plot::new("Acceleration of the worse end of the floor")
        .x(name, unit)
        .y("rms acceleration", "m/s2")
        .points("lateral", &x, &values(Direction::Lateral))
        .points("vertical", &x, &values(Direction::Vertical))
}

fn spectra(rides: &[Ridden], place: &str, direction: Direction, name: &str, unit: &str) -> Plot {
    let way = match direction {
        Direction::Lateral => "lateral",
        Direction::Vertical => "vertical",
    };
    let what = if place == "bogie" { "front bogie" } else { "floor above the front bogie" };
    let mut plot = Plot::new(&format!("Spectrum of {way} acceleration, {what}"))
        .x("frequency", "Hz")
        .y("density", "(m/s2)2/Hz")
        .x_range(0.0..=10.0);
    for ridden in rides {
        let of = |spectrum: &&PlaceSpectrum| {
            spectrum.place.starts_with(place) && spectrum.direction == direction
        };
        if let Some(spectrum) = ridden.ride.spectra.iter().find(of) {
            let hz: Vec<f64> = (0..spectrum.density.len())
                .map(|line| line as f64 * ridden.ride.resolution_hz)
                .collect();
            plot = plot.line(&format!("{name} {} {unit}", ridden.x), &hz, &spectrum.density);
        }
    }
    plot
}
