//! Curving as a table in print, with the conditions for which it holds.

use super::answer::Point;
use super::assessment::{Curve, SectionCurve};
use super::limits::{UNLOADING, Y_OVER_Q};
use super::procedure::Procedure;
use super::wheelset::{WheelCurve, WheelsetCurve};
use crate::over_seeds::OverSeeds;
use crate::text_table::{pace, table};
use scenario::setting::Setting;

/// The points as a table for a terminal, and under which conditions they hold. A single point is
/// listed wheelset by wheelset as well.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    let mut rows = vec![heads(points)];
    rows.extend(points.iter().flat_map(cells));
    let mut lines = table(&rows, points);
    lines.push(String::new());
    if let [Point { answer, .. }] = points
        && let Some(full) = answer.curve.as_ref().and_then(Curve::full)
    {
        lines.extend(table(&wheelsets(full), points));
        lines.push(String::new());
    }
    lines.extend(conditions(points, procedure));
    lines.extend(pace(points));
    lines.join("\n")
}

fn heads(points: &[Point]) -> Vec<String> {
    let keys = points.first().map(|point| point.at.as_slice()).unwrap_or_default();
    let mut heads: Vec<String> = keys.iter().map(Setting::called).collect();
    heads.extend(
        [
            "section",
            "sum Y kN",
            "seeds",
            "Y/Q",
            "Y qst kN",
            "rms sum Y kN",
            "Q/P",
            "dQ/Q0",
            "H kN",
            "wear W",
            "T gamma N",
        ]
        .map(str::to_owned),
    );
    heads
}

/// A row for each section of a point: the worst wheelset or wheel.
fn cells(point: &Point) -> Vec<Vec<String>> {
    let keys: Vec<String> = point.values_in_words();
    let Some(curve) = &point.answer.curve else { return vec![keys] };
    let row = |section: &SectionCurve| {
        let sum_n = section.worst(|wheelset| Some(wheelset.sum_n));
        let range =
            |over: OverSeeds| format!("{:.1} to {:.1}", 1e-3 * over.lowest, 1e-3 * over.highest);
        let of_wheels = |of: fn(&WheelCurve) -> OverSeeds| section.worst_wheel(of);
        let stability = section.worst(|wheelset| wheelset.stability_rms_n);
        let mut row = keys.clone();
        row.extend([
            section.section.part.name().to_owned(),
            number(sum_n, 1e-3, 1),
            sum_n.map_or_else(dash, range),
            number(of_wheels(|wheel| wheel.y_over_q), 1.0, 3),
            number(of_wheels(|wheel| wheel.y_quasi_static_n), 1e-3, 1),
            number(stability, 1e-3, 1),
            number(of_wheels(|wheel| wheel.derailment_gb), 1.0, 3),
            number(of_wheels(|wheel| wheel.unloading), 1.0, 3),
            number(section.worst(|wheelset| Some(wheelset.axle_force_gb_n)), 1e-3, 1),
            number(Some(section.wear_w), 1.0, 0),
            number(of_wheels(|wheel| wheel.t_gamma_n), 1.0, 0),
        ]);
        row
    };
    curve.sections.iter().map(row).collect()
}

/// The wheelsets of the full curve, row by row.
fn wheelsets(full: &SectionCurve) -> Vec<Vec<String>> {
    let heads = [
        "wheelset",
        "sum Y qst kN",
        "0.15 %",
        "99.85 %",
        "outer Y qst kN",
        "outer Y/Q",
        "inner Y qst kN",
        "inner Y/Q",
        "outer dQ/Q0",
        "inner dQ/Q0",
        "wear W outer",
        "inner",
        "T gamma N outer",
        "inner",
    ];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(full.wheelsets.iter().enumerate().map(|(index, wheelset)| {
        let WheelsetCurve { outer, inner, .. } = wheelset;
        let kn = |over: OverSeeds| number(Some(over), 1e-3, 1);
        let plain = |over: OverSeeds, digits: usize| number(Some(over), 1.0, digits);
        vec![
            (index + 1).to_string(),
            kn(wheelset.sum_quasi_static_n),
            kn(wheelset.sum_low_n),
            kn(wheelset.sum_high_n),
            kn(outer.y_quasi_static_n),
            plain(outer.y_over_q, 3),
            kn(inner.y_quasi_static_n),
            plain(inner.y_over_q, 3),
            plain(outer.unloading, 3),
            plain(inner.unloading, 3),
            plain(outer.wear_w, 0),
            plain(inner.wear_w, 0),
            plain(outer.t_gamma_n, 1),
            plain(inner.t_gamma_n, 1),
        ]
    }));
    rows
}

fn number(over: Option<OverSeeds>, scale: f64, digits: usize) -> String {
    over.map_or_else(dash, |over| format!("{:.digits$}", scale * over.mean))
}

fn dash() -> String {
    "-".to_owned()
}

/// What curving holds for.
pub(super) fn conditions(points: &[Point], procedure: &Procedure) -> Vec<String> {
    let mut lines = Vec::new();
    for curve in points.iter().filter_map(|point| point.answer.curve.as_ref()) {
        let ends = curve.sections.iter().map(|section| {
            let section = section.section;
            format!("{} {:.0} to {:.0} m", section.part.name(), section.from_m, section.to_m)
        });
        let line = format!(
            "{:.0} km/h, {} curve of {:.0} m, cant {:.3} m, unbalanced {:.3} m/s2 (cant deficiency {:.0} mm); \
             {} m of run-in, {}; {}",
            curve.speed_kmh,
            curve.direction,
            curve.radius_m,
            curve.cant_m,
            curve.unbalanced_m_per_s2,
            1e3 * curve.cant_deficiency_m,
            curve.lead_in_m,
            ends.collect::<Vec<_>>().join(", "),
            curve.track.in_words()
        );
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    if lines.len() > 2 {
        let more = lines.len() - 1;
        lines.truncate(1);
        lines.push(format!("and {more} other conditions, in curve.json"));
    }
    let curve = points.iter().find_map(|point| point.answer.curve.as_ref());
    if let Some(limits) = curve.and_then(|curve| curve.limits.first()) {
        lines.push(format!(
            "limits at {:.1} kN an axle: sum of Y {:.1} kN (Prud'homme, k1 {}), its rms around an instability \
             {:.1} kN, Y/Q and Q/P {Y_OVER_Q}, unloading {UNLOADING}, H {:.1} kN",
            1e-3 * limits.axle_load_n,
            1e-3 * limits.prudhomme_n,
            procedure.k1,
            1e-3 * limits.stability_rms_n,
            1e-3 * limits.axle_force_gb_n
        ));
    }
    lines.extend(
        [
            "worst wheelset or wheel, mean over seeds; sum of Y (outward) and Y/Q by EN 14363: 20 Hz, mean \
             over 2 m every 0.5 m, 0.15 and 99.85 %; qst: median",
            "rms sum Y: over 100 m, 2 Hz around the highest line from 1 to 10 Hz; Q/P, dQ/Q0, H by GB/T \
             5599-2019: 40 Hz, 99.85 %",
            "wear: mean power lost in all patches; T gamma: mean of the worst wheel, without spin",
        ]
        .map(str::to_owned),
    );
    lines
}
