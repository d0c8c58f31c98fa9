//! The report of a study of critical speeds: what was found, over what was varied, and the hunting
//! motions behind it.

use super::answer::Point;
use super::fold::Fold;
use super::locus;
use super::procedure::Procedure;
use super::text::{conditions, table};
use crate::{over_keys, point_table};
use report::{Plot, Report, Section};
use scenario::setting::Setting;

/// Bifurcation diagrams that are drawn, at most.
const DRAWN: usize = 6;

/// The report, behind its title and facts.
pub(super) fn page(points: &[Point], procedure: &Procedure, report: Report) -> Report {
    let conditions = conditions(points, procedure);
    let found = point_table::section("Critical speeds", table(points), points, &conditions);
    let report = report.subtitle("Critical speed").section(found);
    [over_keys(points), bifurcation(points, procedure), locus::section(points)]
        .into_iter()
        .flatten()
        .fold(report, Report::section)
}

/// Critical speed over what was varied: a line for one key, a map for two.
fn over_keys(points: &[Point]) -> Option<Section> {
    let keys: Vec<String> = points.first()?.at.iter().map(Setting::called).collect();
    let section = Section::new("Over what was varied");
    match &keys[..] {
        [key] if points.len() > 1 => {
            Some(section.plot(over_one(points, key, &over_keys::values(points, 0))))
        }
        [slow, quick] => {
            let (name, speed) = plain_speed(points);
            let title = format!("Critical speed, {name}");
            let z = |point: &Point| speed(point).unwrap_or(f64::NAN);
            let keys = [slow.as_str(), quick];
            Some(section.plot(over_keys::over_two(&title, [name, "km/h"], keys, points, z)))
        }
        _ => None,
    }
}

fn over_one(points: &[Point], key: &str, x: &[f64]) -> Plot {
    let at = |value: f64| points.iter().find(|point| point.at[0].number() == value);
    let line = |of: &dyn Fn(&Point) -> Option<f64>| -> Vec<f64> {
        x.iter().map(|value| at(*value).and_then(of).unwrap_or(f64::NAN)).collect()
    };
    let mut plot = Plot::new("Critical speed").x(key, "").y("critical speed", "km/h");
    if points.iter().any(|point| point.answer.ascent.is_some()) {
        let range = |end: usize| {
            line(&|point| point.answer.ascent.as_ref()?.range_kmh.map(|range| range[end]))
        };
        plot = plot.band("range over seeds", x, &range(0), &range(1)).points(
            "hunts from, mean",
            x,
            &line(&|point| point.answer.ascent.as_ref()?.mean_kmh),
        );
    }
    if points.iter().any(|point| point.answer.fold.is_some()) {
        let dies = line(&|point| point.answer.fold.as_ref()?.dies.kmh());
        plot = plot.points("no cycle below", x, &dies);
    }
    let linear = points.first().map_or(&[][..], |point| &point.answer.linear);
    for (index, first) in linear.iter().enumerate() {
        let speeds = line(&|point| point.answer.linear.get(index)?.critical.kmh());
        plot = plot.dashed(&format!("eigenvalues, {}", first.stroke_in_words()), x, &speeds);
    }
    plot
}

/// One speed of a point, and which it is.
fn plain_speed(points: &[Point]) -> (&'static str, fn(&Point) -> Option<f64>) {
    let has = |of: fn(&Point) -> bool| points.iter().any(of);
    if has(|point| point.answer.ascent.is_some()) {
        ("hunts from", |point| point.answer.ascent.as_ref()?.mean_kmh)
    } else if has(|point| point.answer.fold.is_some()) {
        ("no cycle below", |point| point.answer.fold.as_ref()?.dies.kmh())
    } else {
        ("by eigenvalues", |point| point.answer.linear.first()?.critical.kmh())
    }
}

/// The hunting motions that were followed down.
fn bifurcation(points: &[Point], procedure: &Procedure) -> Option<Section> {
    let followed: Vec<(&Point, &Fold)> = points
        .iter()
        .filter_map(|point| Some((point, point.answer.fold.as_ref()?)))
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
        let name = point.in_words("limit cycle");
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
