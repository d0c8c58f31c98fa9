//! Critical speeds as a table, with the conditions for which they hold.

use super::answer::Point;
use super::ascent::Ascent;
use super::linear::LinearSpeed;
use super::procedure::{Criterion, Procedure};
use crate::over_seeds::seeds_in_words;
use crate::point_table::{self, key_cells, keyed};
use report::Table;

/// The points as text for a terminal, and under which conditions they hold.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    point_table::text(&[table(points)], points, &conditions(points, procedure))
}

/// The points as a table, with the columns that some point has an entry for.
pub(super) fn table(points: &[Point]) -> Table {
    let strokes: Vec<String> = points
        .iter()
        .max_by_key(|point| point.answer.linear.len())
        .map(|point| point.answer.linear.iter().map(LinearSpeed::stroke_in_words).collect())
        .unwrap_or_default();
    let ascent = points.iter().any(|point| point.answer.ascent.is_some());
    let fold = points.iter().any(|point| point.answer.fold.is_some());
    let mut table = keyed("Critical speed", points);
    if ascent {
        table = table.written("hunts from", "km/h").written("over seeds", "km/h");
    }
    if fold {
        table = table.written("no cycle below", "km/h").fixed("amplitude", "mm", 2).fixed(
            "frequency",
            "Hz",
            2,
        );
    }
    for stroke in &strokes {
        let head = format!("linear, {stroke}, unstable from");
        table = table.written(&head, "km/h").fixed("frequency", "Hz", 2);
    }
    table.rows(points.iter().map(|point| {
        let found = &point.answer;
        let mut row = key_cells(point);
        if ascent {
            row.push(found.ascent.as_ref().map(Ascent::mean).into());
            row.push(found.ascent.as_ref().map(Ascent::range).into());
        }
        if fold {
            let last = found.fold.as_ref().and_then(|fold| Some(fold.cycle.last()?.motion));
            row.push(found.fold.as_ref().map(|fold| fold.dies.to_string()).into());
            row.push(last.and_then(|motion| Some(1e3 * motion.amplitude_m?)).into());
            row.push(last.and_then(|motion| motion.frequency_hz).into());
        }
        for index in 0..strokes.len() {
            let linear = found.linear.get(index);
            row.push(linear.map(|linear| linear.critical.to_string()).into());
            row.push(linear.and_then(|linear| linear.frequency_hz).into());
        }
        row
    }))
}

/// What every critical speed holds for.
pub(super) fn conditions(points: &[Point], procedure: &Procedure) -> Vec<String> {
    let spread = |of: fn(&Point) -> Option<f64>| {
        let values: Vec<f64> = points.iter().filter_map(of).collect();
        match signal::statistics::min_max(&values) {
            Some((low, high)) if high - low > 1e-6 => format!("{low:.3} to {high:.3}"),
            Some((low, _)) => format!("{low:.3}"),
            None => "-".to_owned(),
        }
    };
    let seeds = seeds_in_words(&procedure.seeds);
    let mut lines = vec![format!(
        "equivalent conicity at 3 mm {}, friction {}",
        spread(|point| point.answer.equivalent_conicity_at_3_mm),
        spread(|point| point.answer.friction)
    )];
    let over_track = points.iter().any(|point| point.answer.ascent.is_some());
    if over_track && procedure.criterion == Criterion::En14363 {
        lines.push(format!(
            "hunts from: the first speed at which the sum of guiding forces of a wheelset, within 2 Hz of its \
             highest line, has an rms over 100 m above half of 10 kN + P0/3 (EN 14363), on class-6 track \
             (wavelengths {} to {} m); mean over seeds {seeds}",
            procedure.wavelengths_m[0], procedure.wavelengths_m[1],
        ));
    } else if over_track {
        lines.push(format!(
            "hunts from: the first speed at which a wheelset moves by more than {} mm in the last {} s, \
             after {} m of class-6 track (wavelengths {} to {} m) and {} s of perfect track; wheelset {} \
             starts {} mm off the middle; mean over seeds {seeds}",
            1e3 * procedure.threshold_m,
            procedure.watched_s,
            procedure.rough_m,
            procedure.wavelengths_m[0],
            procedure.wavelengths_m[1],
            procedure.smooth_s,
            procedure.offset_wheelset,
            1e3 * procedure.offset_m
        ));
    }
    if points.iter().any(|point| point.answer.fold.is_some()) {
        lines.push(format!(
            "no cycle below: the largest motion that stays at {} km/h followed down, {} s at each speed, \
             until no wheelset moves by {} mm; amplitude and frequency just before",
            procedure.to_kmh,
            procedure.hold_s,
            1e3 * procedure.alive_m
        ));
    }
    if points.iter().any(|point| !point.answer.linear.is_empty()) {
        lines.push(
            "linear: the least damped mode of 0.3 to 15 Hz begins to grow, every damper as stiffness and \
             damping of the stroke"
                .to_owned(),
        );
    }
    lines
}
