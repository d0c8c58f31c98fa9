//! The residual over every coordinate.

use super::prefix::{Prefixed, quantity};
use super::words::{percent, probability};
use crate::identify::Identification;
use crate::residual::ResidualAnalysis;
use crate::residual::coordinates::Coordinate;
use crate::residual::maps::CoordinateMap;
use report::{Cell, Plot, Section, Table};

/// Least share that a map has to explain to be marked, and largest probability of that by chance.
const LEAST_SHARE: f64 = 0.01;
const LARGEST_P: f64 = 1e-3;

/// The residual of the refitted model.
pub(super) fn section(identification: &Identification) -> Section {
    let left = &identification.residual_before;
    let mut section = Section::new("The residual of the refitted model").text(&format!(
        "The residual of all fitted tests, {} rms, is averaged over each coordinate in bins of \
         equal content, separately for the two branches of the motion. A model that lacks \
         nothing leaves flat lines. The share is the part of the squared residual that the curve \
         of some tests explains on the others: below zero it is chance.",
        quantity(left.rms_n, "N")
    ));
    section = match strongest(left) {
        Some(map) => section.text(&format!(
            "It depends most on {}: the curve explains {} of the squared residual on left-out \
             tests.",
            name_of(map.coordinate).0,
            percent(map.share)
        )),
        None => section.text("No coordinate explains more of it than chance."),
    };
    section = section.plots(plots(identification, left, None)).table(shares(left, None));
    if let Some(part) = &identification.result.unexplained_before {
        section = section.note(&format!("Structure before any effect: {}.", part.description));
    }
    section
}

/// The map that explains most, if it explains anything.
pub(super) fn strongest(left: &ResidualAnalysis) -> Option<&CoordinateMap> {
    let questions = left.maps.len() as f64;
    left.maps.iter().find(|map| map.share > LEAST_SHARE && map.p_value * questions < LARGEST_P)
}

/// One plot per coordinate, the residual of an earlier model in grey behind it.
pub(super) fn plots(
    identification: &Identification,
    left: &ResidualAnalysis,
    before: Option<&ResidualAnalysis>,
) -> Vec<Plot> {
    let declared = identification.train.tests.iter().all(|test| test.record.direction_declared);
    // The same scale everywhere, and never so fine that noise looks like a shape.
    let all = left.maps.iter().chain(before.into_iter().flat_map(|before| &before.maps));
    let means = all.flat_map(|map| map.upper_n.iter().chain(&map.lower_n).flatten());
    let floor = left.noise.floor_n.or(left.noise.at_least_n).unwrap_or(0.0);
    let (low, high) = means.fold((-floor, floor), |(l, h): (f64, f64), m| (l.min(*m), h.max(*m)));
    let force = Prefixed::for_size("N", high.max(-low));
    let margin = 0.06 * force.value(high - low);
    let (low, high) = (force.value(low) - margin, force.value(high) + margin);
    let marked = strongest(left).map(|map| map.coordinate);
    let each = left.maps.iter().map(|map| {
        let (name, unit) = name_of(map.coordinate);
        let x = Prefixed::for_all(unit, &map.centres);
        let (upper, lower) = branches(map.coordinate, declared);
        let is_marked = marked == Some(map.coordinate);
        let mut plot = Plot::new(&format!(
            "Residual over {name}{}",
            if is_marked { ": explains most" } else { "" }
        ))
        .palette(&[upper, lower])
        .x(name, &x.unit)
        .y("mean residual", &force.unit)
        .height_px(280)
        .caption(&caption(map));
        if low < high {
            plot = plot.y_range(low..=high);
        }
        let earlier = before
            .and_then(|before| before.maps.iter().find(|other| other.coordinate == map.coordinate));
        if let Some(earlier) = earlier {
            for values in [&earlier.upper_n, &earlier.lower_n] {
                let (at, mean) = present(&earlier.centres, values);
                plot = plot.backdrop("before", &x.values(&at), &force.values(&mean));
            }
        }
        for (branch, values) in [(upper, &map.upper_n), (lower, &map.lower_n)] {
            let (at, mean) = present(&map.centres, values);
            plot = plot.points(branch, &x.values(&at), &force.values(&mean));
        }
        if is_marked { plot.marked() } else { plot }
    });
    each.collect()
}

fn caption(map: &CoordinateMap) -> String {
    let by_chance = probability(map.p_value);
    if map.share <= 0.0 {
        return format!("Explains nothing on left-out tests ({by_chance}).");
    }
    format!(
        "Explains {} of the squared residual on left-out tests: {} rms, {by_chance}.",
        percent(map.share),
        quantity(map.rms_n, "N")
    )
}

/// Shares of all coordinates.
pub(super) fn shares(left: &ResidualAnalysis, before: Option<&ResidualAnalysis>) -> Table {
    let mut table =
        Table::new("The part that each coordinate explains on left-out tests").text("coordinate");
    if before.is_some() {
        table = table.number_with_digits("before: share", "%", 3).number_with_digits("rms", "N", 3);
    }
    table = table
        .number_with_digits(if before.is_some() { "after: share" } else { "share" }, "%", 3)
        .number_with_digits("rms", "N", 3)
        .number_with_digits("probability by chance", "", 2);
    for map in &left.maps {
        let mut row = vec![Cell::from(name_of(map.coordinate).0)];
        if let Some(before) = before {
            let earlier = before.maps.iter().find(|other| other.coordinate == map.coordinate);
            row.push(earlier.map(|earlier| 100.0 * earlier.share).into());
            row.push(earlier.map(|earlier| earlier.rms_n).into());
        }
        row.extend([
            Cell::from(100.0 * map.share),
            map.rms_n.into(),
            if map.p_value < 1e-6 { "< 1e-6".into() } else { map.p_value.into() },
        ]);
        table = table.row(row);
    }
    table
}

/// Bins that have a mean.
pub(super) fn present(centres: &[f64], means: &[Option<f64>]) -> (Vec<f64>, Vec<f64>) {
    centres.iter().zip(means).filter_map(|(at, mean)| Some((*at, (*mean)?))).unzip()
}

/// Name and SI unit.
pub(super) fn name_of(coordinate: Coordinate) -> (&'static str, &'static str) {
    match coordinate {
        Coordinate::Displacement => ("displacement", "m"),
        Coordinate::DashpotVelocity => ("dashpot velocity", "m/s"),
        Coordinate::Force => ("simulated force", "N"),
        Coordinate::TimeSinceReversal => ("time since reversal", "s"),
        Coordinate::Time => ("time in the test", "s"),
        Coordinate::Temperature => ("temperature", "°C"),
    }
}

/// What the upper and the lower branch are.
pub(super) fn branches(coordinate: Coordinate, declared: bool) -> (&'static str, &'static str) {
    match (coordinate, declared) {
        (Coordinate::Time | Coordinate::Temperature, true) => ("in tension", "in compression"),
        (Coordinate::Time | Coordinate::Temperature, false) => {
            ("force to side A", "force to side B")
        }
        (_, true) => ("extending", "compressing"),
        (_, false) => ("moving to side A", "moving to side B"),
    }
}
