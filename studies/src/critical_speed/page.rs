//! The report of a study of critical speeds: what was found, over what was varied, and the hunting motions
//! behind it.

use super::ascent::Ascent;
use super::fold::Fold;
use super::procedure::Procedure;
use super::study::Point;
use super::text::conditions;
use report::{Cell, Plot, Report, Section, Table};

/// Bifurcation diagrams that are drawn, at most.
const DRAWN: usize = 6;

/// The report.
pub fn page(points: &[Point], procedure: &Procedure, title: &str, about: &[String]) -> Report {
    let mut report = Report::new(title).subtitle("Critical speed");
    for line in about {
        report = report.fact("vehicle", line);
    }
    let mut found = Section::new("Critical speeds").table(table(points));
    for line in conditions(points, procedure) {
        found = found.text(&line);
    }
    report = report.section(found);
    [over_keys(points), bifurcation(points, procedure)]
        .into_iter()
        .flatten()
        .fold(report, Report::section)
}

fn table(points: &[Point]) -> Table {
    let first = points.first();
    let mut table = Table::new("Critical speed, km/h");
    for set in first.map(|point| point.at.as_slice()).unwrap_or_default() {
        table = table.number(&set.key, "");
    }
    table = table.text("hunts from").text("range over seeds").text("no cycle below");
    for linear in first.map(|point| point.linear.as_slice()).unwrap_or_default() {
        let stroke_mm = 1e3 * linear.stroke_m;
        table = table.text(&format!("by eigenvalues at {stroke_mm} mm"));
    }
    let strokes = first.map_or(0, |point| point.linear.len());
    table.rows(points.iter().map(|point| {
        let mut row: Vec<Cell> = point.at.iter().map(|set| set.value.into()).collect();
        row.push(match (&point.failure, &point.ascent) {
            (Some(why), _) => why.clone().into(),
            (None, ascent) => ascent.as_ref().map(Ascent::mean).into(),
        });
        row.push(point.ascent.as_ref().map(Ascent::range).into());
        row.push(point.fold.as_ref().map(|fold| fold.dies.to_string()).into());
        let linear = (0..strokes).map(|index| point.linear.get(index));
        row.extend(linear.map(|linear| linear.map(|linear| linear.critical.to_string()).into()));
        row
    }))
}

/// Critical speed over what was varied: a line for one key, a map for two.
fn over_keys(points: &[Point]) -> Option<Section> {
    let keys: Vec<&str> = points.first()?.at.iter().map(|set| set.key.as_str()).collect();
    let values = |axis: usize| -> Vec<f64> {
        let mut values: Vec<f64> =
            points.iter().filter_map(|point| Some(point.at.get(axis)?.value)).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.dedup();
        values
    };
    let section = Section::new("Over what was varied");
    match keys[..] {
        [key] if points.len() > 1 => Some(section.plot(over_one(points, key, &values(0)))),
        [slow, quick] => {
            let (y, x) = (values(0), values(1));
            let (name, speeds) = plain_speeds(points);
            // Rows of the map are the slow key's values.
            let at = |slow: f64, quick: f64| {
                points
                    .iter()
                    .zip(&speeds)
                    .find(|(point, _)| point.at[0].value == slow && point.at[1].value == quick)
                    .map_or(f64::NAN, |(_, speed)| *speed)
            };
            let z: Vec<f64> = y.iter().flat_map(|y| x.iter().map(|x| at(*y, *x))).collect();
            let plot = Plot::new(&format!("Critical speed, {name}"))
                .x(quick, "")
                .y(slow, "")
                .map(name, "km/h", &x, &y, &z);
            Some(section.plot(plot))
        }
        _ => None,
    }
}

fn over_one(points: &[Point], key: &str, x: &[f64]) -> Plot {
    let at = |value: f64| points.iter().find(|point| point.at[0].value == value);
    let line = |of: &dyn Fn(&Point) -> Option<f64>| -> Vec<f64> {
        x.iter().map(|value| at(*value).and_then(of).unwrap_or(f64::NAN)).collect()
    };
    let mut plot = Plot::new("Critical speed").x(key, "").y("critical speed", "km/h");
    if points.iter().any(|point| point.ascent.is_some()) {
        let range =
            |end: usize| line(&|point| point.ascent.as_ref()?.range_kmh.map(|range| range[end]));
        plot = plot.band("range over seeds", x, &range(0), &range(1)).points(
            "hunts from, mean",
            x,
            &line(&|point| point.ascent.as_ref()?.mean_kmh),
        );
    }
    if points.iter().any(|point| point.fold.is_some()) {
        let dies = line(&|point| point.fold.as_ref()?.dies.kmh());
        plot = plot.points("no cycle below", x, &dies);
    }
    for index in 0..points.first().map_or(0, |point| point.linear.len()) {
        let stroke_mm = points.first().map_or(0.0, |point| 1e3 * point.linear[index].stroke_m);
        let speeds = line(&|point| point.linear.get(index)?.critical.kmh());
        plot = plot.dashed(&format!("eigenvalues, {stroke_mm} mm"), x, &speeds);
    }
    plot
}

/// One speed for every point, and which it is.
fn plain_speeds(points: &[Point]) -> (&'static str, Vec<f64>) {
    let ascent = |point: &Point| point.ascent.as_ref().and_then(|ascent| ascent.mean_kmh);
    let fold = |point: &Point| point.fold.as_ref().and_then(|fold| fold.dies.kmh());
    let linear = |point: &Point| point.linear.first().and_then(|linear| linear.critical.kmh());
    let all = |of: &dyn Fn(&Point) -> Option<f64>| -> Vec<f64> {
        points.iter().map(|point| of(point).unwrap_or(f64::NAN)).collect()
    };
    let has = |of: &dyn Fn(&Point) -> bool| points.iter().any(of);
    if has(&|point| point.ascent.is_some()) {
        ("hunts from", all(&ascent))
    } else if has(&|point| point.fold.is_some()) {
        ("no cycle below", all(&fold))
    } else {
        ("by eigenvalues", all(&linear))
    }
}

/// The hunting motions that were followed down.
fn bifurcation(points: &[Point], procedure: &Procedure) -> Option<Section> {
    let followed: Vec<(&Point, &Fold)> = points
        .iter()
        .filter_map(|point| Some((point, point.fold.as_ref()?)))
        .filter(|(_, fold)| !fold.cycle.is_empty())
        .collect();
    if followed.is_empty() {
        return None;
    }
    let mut plot = Plot::new("Limit cycles, followed down")
        .x("speed", "km/h")
        .y("lateral amplitude", "mm")
        .limit("counts as hunting", 1e3 * procedure.threshold_m)
        .caption(
            "Greatest lateral position of any wheelset. Between the lower end of a line and the speed \
             from which the vehicle hunts on irregular track it runs quietly or hunts, as it comes.",
        );
    for (point, fold) in followed.iter().take(DRAWN) {
        let name = match point.at.as_slice() {
            [] => "limit cycle".to_owned(),
            at => {
                let words = at.iter().map(|set| format!("{} {:e}", set.key, set.value));
                words.collect::<Vec<_>>().join(", ")
            }
        };
        let speeds: Vec<f64> = fold.cycle.iter().map(|point| point.kmh).collect();
        let amplitude_mm: Vec<f64> = fold
            .cycle
            .iter()
            .map(|point| point.motion.amplitude_m.map_or(f64::NAN, |m| 1e3 * m))
            .collect();
        plot = plot.points(&name, &speeds, &amplitude_mm);
    }
    let mut section = Section::new("Hunting motions").plot(plot);
    if followed.len() > DRAWN {
        let left = followed.len() - DRAWN;
        section = section.note(&format!("{left} more are in critical-speed.json."));
    }
    Some(section)
}
