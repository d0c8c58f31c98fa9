//! Curving as tables, with the conditions for which it holds.

use super::answer::Point;
use super::assessment::{Curve, SectionCurve};
use super::limits::{UNLOADING, Y_OVER_Q};
use super::procedure::Procedure;
use super::wheelset::{WheelCurve, WheelsetCurve};
use crate::over_seeds::OverSeeds;
use crate::point_table::{self, key_cells, keyed};
use report::{Cell, Table};

/// The points as text for a terminal, and under which conditions they hold. A single point is
/// listed wheelset by wheelset as well.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    let mut tables = vec![table(points)];
    if let [Point { answer, .. }] = points {
        tables.extend(answer.curve.as_ref().and_then(Curve::full).map(wheelsets));
    }
    point_table::text(&tables, points, &conditions(points, procedure))
}

/// A row for each section of a point: the worst wheelset or wheel.
pub(super) fn table(points: &[Point]) -> Table {
    keyed("Worst wheelset or wheel, mean over seeds", points)
        .text("section")
        .fixed("sum Y", "kN", 1)
        .written("over seeds", "kN")
        .fixed("Y/Q", "", 3)
        .fixed("Y qst", "kN", 1)
        .fixed("rms sum Y", "kN", 1)
        .fixed("Q/P", "", 3)
        .fixed("dQ/Q0", "", 3)
        .fixed("H", "kN", 1)
        .fixed("wear", "W", 0)
        .fixed("T gamma", "N", 0)
        .rows(points.iter().flat_map(rows))
}

fn rows(point: &Point) -> Vec<Vec<Cell>> {
    let sections = point.answer.curve.as_ref().map_or(&[][..], |curve| &curve.sections);
    let row = |section: &SectionCurve| {
        let mean = |over: Option<OverSeeds>, scale: f64| over.map(|over| scale * over.mean).into();
        let of_wheels = |of: fn(&WheelCurve) -> OverSeeds| section.worst_wheel(of);
        let sum_n = section.worst(|wheelset| Some(wheelset.sum_n));
        let range =
            |over: OverSeeds| format!("{:.1} to {:.1}", 1e-3 * over.lowest, 1e-3 * over.highest);
        let mut row = key_cells(point);
        row.extend([
            section.section.part.name().into(),
            mean(sum_n, 1e-3),
            sum_n.map(range).into(),
            mean(of_wheels(|wheel| wheel.y_over_q), 1.0),
            mean(of_wheels(|wheel| wheel.y_quasi_static_n), 1e-3),
            mean(section.worst(|wheelset| wheelset.stability_rms_n), 1e-3),
            mean(of_wheels(|wheel| wheel.derailment_gb), 1.0),
            mean(of_wheels(|wheel| wheel.unloading), 1.0),
            mean(section.worst(|wheelset| Some(wheelset.axle_force_gb_n)), 1e-3),
            mean(Some(section.wear_w), 1.0),
            mean(of_wheels(|wheel| wheel.t_gamma_n), 1.0),
        ]);
        row
    };
    sections.iter().map(row).collect()
}

/// The wheelsets of the full curve, row by row.
fn wheelsets(full: &SectionCurve) -> Table {
    let table = Table::new("Wheelsets in the full curve, mean over seeds")
        .written("wheelset", "")
        .fixed("sum Y qst", "kN", 1)
        .fixed("0.15 %", "kN", 1)
        .fixed("99.85 %", "kN", 1)
        .fixed("outer Y qst", "kN", 1)
        .fixed("outer Y/Q", "", 3)
        .fixed("inner Y qst", "kN", 1)
        .fixed("inner Y/Q", "", 3)
        .fixed("outer dQ/Q0", "", 3)
        .fixed("inner dQ/Q0", "", 3)
        .fixed("outer wear", "W", 0)
        .fixed("inner wear", "W", 0)
        .fixed("outer T gamma", "N", 1)
        .fixed("inner T gamma", "N", 1);
    table.rows(full.wheelsets.iter().zip(1_u64..).map(|(wheelset, number)| {
        let WheelsetCurve { outer, inner, .. } = wheelset;
        let kn = |over: OverSeeds| Cell::from(1e-3 * over.mean);
        let plain = |over: OverSeeds| Cell::from(over.mean);
        [
            number.into(),
            kn(wheelset.sum_quasi_static_n),
            kn(wheelset.sum_low_n),
            kn(wheelset.sum_high_n),
            kn(outer.y_quasi_static_n),
            plain(outer.y_over_q),
            kn(inner.y_quasi_static_n),
            plain(inner.y_over_q),
            plain(outer.unloading),
            plain(inner.unloading),
            plain(outer.wear_w),
            plain(inner.wear_w),
            plain(outer.t_gamma_n),
            plain(inner.t_gamma_n),
        ]
    }))
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
