//! Critical speeds as a table in print, with the conditions for which they hold.

use super::answer::Point;
use super::procedure::{Criterion, Procedure};
use crate::over_seeds::seeds_in_words;
use crate::text_table::{pace, table};
use scenario::setting::Setting;

/// The points as a table for a terminal, and under which conditions they hold.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    let mut rows = vec![heads(points)];
    rows.extend(points.iter().map(cells));
    let mut lines = table(&rows, points);
    lines.push(String::new());
    lines.extend(conditions(points, procedure));
    lines.extend(pace(points));
    lines.join("\n")
}

fn heads(points: &[Point]) -> Vec<String> {
    let Some(first) = points.first() else { return Vec::new() };
    let mut heads: Vec<String> = first.at.iter().map(Setting::called).collect();
    if first.answer.ascent.is_some() {
        heads.extend(["hunts from", "over seeds"].map(str::to_owned));
    }
    if first.answer.fold.is_some() {
        heads.extend(["no cycle below", "mm", "Hz"].map(str::to_owned));
    }
    for linear in &first.answer.linear {
        heads.extend([format!("linear, {}", linear.stroke_in_words()), "Hz".to_owned()]);
    }
    heads
}

fn cells(point: &Point) -> Vec<String> {
    let mut cells: Vec<String> = point.values_in_words();
    if let Some(ascent) = &point.answer.ascent {
        cells.extend([ascent.mean(), ascent.range()]);
    }
    if let Some(fold) = &point.answer.fold {
        let last = fold.cycle.last().map(|point| point.motion);
        let amplitude_mm = last.and_then(|motion| motion.amplitude_m).map(|m| 1e3 * m);
        let frequency_hz = last.and_then(|motion| motion.frequency_hz);
        cells.extend([fold.dies.to_string(), or_dash(amplitude_mm), or_dash(frequency_hz)]);
    }
    for linear in &point.answer.linear {
        cells.extend([linear.critical.to_string(), or_dash(linear.frequency_hz)]);
    }
    cells
}

fn or_dash(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.2}"))
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
    let mut lines = vec![
        "speeds in km/h".to_owned(),
        format!(
            "equivalent conicity at 3 mm {}, friction {}",
            spread(|point| point.answer.equivalent_conicity_at_3_mm),
            spread(|point| point.answer.friction)
        ),
    ];
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
