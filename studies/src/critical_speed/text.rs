//! Critical speeds as a table in print, with the conditions for which they hold.

use super::procedure::Procedure;
use super::study::Point;

/// The points as a table for a terminal, and under which conditions they hold.
pub fn text(points: &[Point], procedure: &Procedure) -> String {
    let mut rows = vec![heads(points)];
    rows.extend(points.iter().map(cells));
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<usize> = (0..columns).filter_map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        cells.collect::<Vec<_>>().join("   ")
    };
    let mut lines: Vec<String> = rows.iter().map(line).collect();
    let failures =
        points.iter().filter_map(|point| Some((point.index + 1, point.failure.as_ref()?)));
    lines.extend(failures.map(|(number, why)| format!("point {number}: {why}")));
    lines.push(String::new());
    lines.extend(conditions(points, procedure));
    lines.join("\n")
}

fn heads(points: &[Point]) -> Vec<String> {
    let Some(first) = points.first() else { return Vec::new() };
    let mut heads: Vec<String> = first.at.iter().map(|set| set.key.clone()).collect();
    if first.ascent.is_some() {
        heads.extend(["hunts from", "over seeds"].map(str::to_owned));
    }
    if first.fold.is_some() {
        heads.extend(["no cycle below", "mm", "Hz"].map(str::to_owned));
    }
    for linear in &first.linear {
        heads.extend([format!("linear at {} mm", 1e3 * linear.stroke_m), "Hz".to_owned()]);
    }
    heads
}

fn cells(point: &Point) -> Vec<String> {
    let mut cells: Vec<String> = point.at.iter().map(|set| format!("{:e}", set.value)).collect();
    if let Some(ascent) = &point.ascent {
        cells.extend([ascent.mean(), ascent.range()]);
    }
    if let Some(fold) = &point.fold {
        let last = fold.cycle.last().map(|point| point.motion);
        let amplitude_mm = last.and_then(|motion| motion.amplitude_m).map(|m| 1e3 * m);
        let frequency_hz = last.and_then(|motion| motion.frequency_hz);
        cells.extend([fold.dies.to_string(), or_dash(amplitude_mm), or_dash(frequency_hz)]);
    }
    for linear in &point.linear {
        cells.extend([linear.critical.to_string(), or_dash(linear.frequency_hz)]);
    }
    cells
}

fn or_dash(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.2}"))
}

/// What every critical speed holds for.
pub fn conditions(points: &[Point], procedure: &Procedure) -> Vec<String> {
    let spread = |of: fn(&Point) -> Option<f64>| {
        let values: Vec<f64> = points.iter().filter_map(of).collect();
        match crate::statistics::min_max(&values) {
            Some((low, high)) if high - low > 1e-6 => format!("{low:.3} to {high:.3}"),
            Some((low, _)) => format!("{low:.3}"),
            None => "-".to_owned(),
        }
    };
    let seeds = match (procedure.seeds.first(), procedure.seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(first), _) => first.to_string(),
        _ => "none".to_owned(),
    };
    let mut lines = vec![
        "speeds in km/h".to_owned(),
        format!(
            "equivalent conicity at 3 mm {}, friction {}",
            spread(|point| point.equivalent_conicity_at_3_mm),
            spread(|point| point.friction)
        ),
    ];
    if points.iter().any(|point| point.ascent.is_some()) {
        lines.push(format!(
            "hunts from: the first speed at which a wheelset moves by more than {} mm in the last {} s, \
             after {} m of class-6 track (wavelengths {} to {} m) and {} s of perfect track; wheelset {} \
             starts {} mm beside the middle; mean over seeds {seeds}",
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
    if points.iter().any(|point| point.fold.is_some()) {
        lines.push(format!(
            "no cycle below: the largest motion that stays at {} km/h followed down, {} s at each speed, \
             until no wheelset moves by {} mm; amplitude and frequency just before",
            procedure.to_kmh,
            procedure.hold_s,
            1e3 * procedure.alive_m
        ));
    }
    if points.iter().any(|point| !point.linear.is_empty()) {
        lines.push(
            "linear: the least damped mode of 0.3 to 15 Hz begins to grow, every damper as stiffness and \
             damping of the stroke"
                .to_owned(),
        );
    }
    lines
}
