//! The report of a study of ride: indices with their grades over what was varied, spectra.

use super::answer::{Point, RideAnswer};
use super::assessment::Ride;
use super::grade::{Grade, Kind, LOCOMOTIVE_PEAK_M_PER_S2, MEAN_COMFORT};
use super::procedure::Procedure;
use super::sperling::Direction;
use super::text::{conditions, table, worst_sperling};
use super::vibration::{PlaceRide, Vibration};
use crate::over_keys::{self, Line};
use crate::over_seeds::OverSeeds;
use crate::point_table;
use report::{Plot, Report, Section, Table};

/// Points whose spectra are drawn, at most.
const DRAWN: usize = 8;
const DIRECTIONS: [Direction; 2] = [Direction::Lateral, Direction::Vertical];

/// The report, behind its title and facts.
pub(super) fn page(points: &[Point], procedure: &Procedure, report: Report) -> Report {
    let table = table(points, procedure);
    let found = point_table::section("Ride", table, points, &conditions(points, procedure));
    let mut report = report.subtitle("Ride").section(found);
    let plots = over_what_was_varied(points, procedure);
    if !plots.is_empty() {
        report = report.section(Section::new("Over what was varied").plots(plots));
    }
    // With no answer at all there is nothing to draw.
    if points.iter().any(|point| point.answer.ride.is_some()) {
        report = report.section(spectra(points)).section(places(points));
    }
    report
}

fn over_what_was_varied(points: &[Point], procedure: &Procedure) -> Vec<Plot> {
    let graded = |ends: [f64; 3]| -> Vec<(&str, f64)> {
        Grade::BOUNDED.iter().map(|grade| grade.name()).zip(ends).collect()
    };
    let mut plots = Vec::new();
    for direction in DIRECTIONS {
        let over = move |found: &RideAnswer| worst_sperling(found.ride.as_ref()?, direction);
        let later = move |found: &RideAnswer| {
            let index = |place: &PlaceRide| Some(place.along(direction).sperling_2019?.mean);
            found.ride.as_ref()?.worst(index)
        };
        plots.extend(over_keys::plot(
            &format!("Sperling index, {}", direction.name()),
            ["Sperling index", ""],
            points,
            &[
                Line {
                    name: "GB 5599-85, 20 s",
                    of: &|found| Some(over(found)?.mean),
                    range: Some(&|found| over(found).map(ends)),
                },
                Line { name: "GB/T 5599-2019, 5 s", of: &later, range: None },
            ],
            &graded(procedure.kind.sperling()),
        ));
    }
    plots.extend(over_keys::plot(
        "Mean comfort of EN 12299",
        ["N_MV", ""],
        points,
        &[Line {
            name: "N_MV",
            of: &|found| found.ride.as_ref()?.worst(|place| place.n_mv),
            range: None,
        }],
        &MEAN_COMFORT.map(|(end, word)| (word, end)),
    ));
    for (direction, limits) in DIRECTIONS.into_iter().zip(LOCOMOTIVE_PEAK_M_PER_S2) {
        let of = move |of: fn(&Vibration) -> f64| {
            move |found: &RideAnswer| {
                found.ride.as_ref()?.worst(|place| Some(of(place.along(direction))))
            }
        };
        let limits = if procedure.kind == Kind::Locomotive { graded(limits) } else { Vec::new() };
        plots.extend(over_keys::plot(
            &format!("Acceleration of the floor, {}", direction.name()),
            ["acceleration", "m/s2"],
            points,
            &[
                Line {
                    name: "greatest of all seeds",
                    of: &of(|vibration| vibration.peak_m_per_s2.highest),
                    range: None,
                },
                Line { name: "rms", of: &of(|vibration| vibration.rms_m_per_s2.mean), range: None },
            ],
            &limits,
        ));
    }
    plots
}

fn ends(over: OverSeeds) -> [f64; 2] {
    [over.lowest, over.highest]
}

/// Spectra of the first floor place and bogie, a line for each of the first points.
fn spectra(points: &[Point]) -> Section {
    let rides: Vec<(&Point, &Ride)> =
        points.iter().filter_map(|point| Some((point, point.answer.ride.as_ref()?))).collect();
    let mut section = Section::new("Spectra of acceleration");
    let Some((_, first)) = rides.first() else { return section };
    for (number, of) in first.spectra.iter().enumerate() {
        let mut plot = Plot::new(&format!("{}, {}", of.place, of.direction.name()))
            .x("frequency", "Hz")
            .y("density", "(m/s2)2/Hz")
            .log_y();
        for (point, ride) in rides.iter().take(DRAWN) {
            let Some(spectrum) = ride.spectra.get(number) else { continue };
            // The first lines are what the window smears of the mean.
            let lines = spectrum.density.iter().enumerate().skip(2).filter(|(_, d)| **d > 0.0);
            let (hz, density): (Vec<f64>, Vec<f64>) =
                lines.map(|(line, d)| (line as f64 * ride.resolution_hz, *d)).unzip();
            plot = plot.line(&point.in_words("density"), &hz, &density);
        }
        section = section.plot(plot);
    }
    if rides.len() > DRAWN {
        section = section.note(&format!("{} more are in ride.json.", rides.len() - DRAWN));
    }
    section
}

/// Every place of the first point.
fn places(points: &[Point]) -> Section {
    let mut table = Table::new("All places at the first point")
        .text("place")
        .text("direction")
        .number_with_digits("W, 20 s", "", 3)
        .number_with_digits("W, 5 s", "", 3)
        .number_with_digits("rms", "m/s2", 3)
        .number_with_digits("greatest", "m/s2", 3)
        .number_with_digits("weighted, 95 %", "m/s2", 3)
        .text("peaks, Hz");
    let first = points.iter().find_map(|point| point.answer.ride.as_ref());
    let all = first.map(|ride| ride.floor.iter().chain(&ride.bogies));
    for place in all.into_iter().flatten() {
        for direction in DIRECTIONS {
            let vibration = place.along(direction);
            let peaks = vibration.peaks.iter().map(|peak| format!("{:.2}", peak.frequency_hz));
            table = table.row([
                place.place.clone().into(),
                direction.name().into(),
                vibration.sperling_1985.map(|over| over.mean).into(),
                vibration.sperling_2019.map(|over| over.mean).into(),
                vibration.rms_m_per_s2.mean.into(),
                vibration.peak_m_per_s2.highest.into(),
                vibration.weighted_p95_m_per_s2.into(),
                peaks.collect::<Vec<_>>().join(", ").into(),
            ]);
        }
    }
    Section::new("Places").table(table)
}
