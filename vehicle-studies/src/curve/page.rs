//! The report of a study of curving: forces with their limits over what was varied, wheelsets,
//! spectra.

use super::answer::{CurveAnswer, Point};
use super::assessment::{Curve, SectionCurve};
use super::limits::{UNLOADING, Y_OVER_Q};
use super::procedure::Procedure;
use super::sections::Part;
use super::text::{conditions, table};
use super::wheelset::WheelCurve;
use crate::over_keys::{self, Line};
use crate::over_seeds::OverSeeds;
use crate::point_table;
use report::{Plot, Report, Section, Table};

/// Points whose spectra are drawn, at most.
const DRAWN: usize = 8;

/// The report, behind its title and facts.
pub(super) fn page(points: &[Point], procedure: &Procedure, report: Report) -> Report {
    let conditions = conditions(points, procedure);
    let found = point_table::section("Curve", table(points), points, &conditions);
    let mut report = report.subtitle("Curving").section(found);
    let plots = over_what_was_varied(points);
    if !plots.is_empty() {
        report = report.section(Section::new("Over what was varied").plots(plots));
    }
    let first = points.iter().find_map(|point| point.answer.curve.as_ref());
    if let Some(curve) = first {
        report = report.section(wheelsets(curve)).section(spectra(points));
    }
    report
}

fn over_what_was_varied(points: &[Point]) -> Vec<Plot> {
    let first = points.iter().find_map(|point| point.answer.curve.as_ref());
    let Some(limits) = first.and_then(|curve| curve.limits.first()) else { return Vec::new() };
    let at = |part: Part| {
        move |found: &CurveAnswer| -> Option<SectionCurve> {
            let sections = &found.curve.as_ref()?.sections;
            sections.iter().find(|section| section.section.part == part).cloned()
        }
    };
    let plot = |title: &str,
                [name, unit]: [&str; 2],
                of: &dyn Fn(&SectionCurve) -> Option<OverSeeds>,
                scale: f64,
                limits: &[(&str, f64)]| {
        let mean =
            |part: Part| move |found: &CurveAnswer| Some(scale * of(&at(part)(found)?)?.mean);
        let (curve, entry, exit) = (mean(Part::Curve), mean(Part::Entry), mean(Part::Exit));
        let range = |found: &CurveAnswer| {
            let over = of(&at(Part::Curve)(found)?)?;
            Some([scale * over.lowest, scale * over.highest])
        };
        let lines = [
            Line { name: "full curve", of: &curve, range: Some(&range) },
            Line { name: "entry", of: &entry, range: None },
            Line { name: "exit", of: &exit, range: None },
        ];
        over_keys::plot(title, [name, unit], points, &lines, limits)
    };
    let wheel =
        |of: fn(&WheelCurve) -> OverSeeds| move |section: &SectionCurve| section.worst_wheel(of);
    [
        plot(
            "Sum of guiding forces, worst wheelset",
            ["sum of Y", "kN"],
            &|section| section.worst(|axle| Some(axle.sum_n)),
            1e-3,
            &[("Prud'homme", 1e-3 * limits.prudhomme_n)],
        ),
        plot(
            "Sum of guiding forces, first wheelset",
            ["sum of Y", "kN"],
            &|section| Some(section.wheelsets.first()?.sum_n),
            1e-3,
            &[("Prud'homme", 1e-3 * limits.prudhomme_n)],
        ),
        plot("Y/Q, worst wheel", ["Y/Q", ""], &wheel(|w| w.y_over_q), 1.0, &[("limit", Y_OVER_Q)]),
        plot(
            "Wheel unloading, worst wheel",
            ["dQ/Q0", ""],
            &wheel(|w| w.unloading),
            1.0,
            &[("limit up to 160 km/h", UNLOADING)],
        ),
        plot(
            "Rms of the sum of guiding forces around an instability",
            ["rms over 100 m", "kN"],
            &|section| section.worst(|axle| axle.stability_rms_n),
            1e-3,
            &[("half of Prud'homme", 1e-3 * limits.stability_rms_n)],
        ),
        plot("Wear power, all wheels", ["power", "W"], &|section| Some(section.wear_w), 1.0, &[]),
        plot("T gamma, worst wheel", ["T gamma", "N"], &wheel(|w| w.t_gamma_n), 1.0, &[]),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The wheelsets of the first point in the full curve.
fn wheelsets(curve: &Curve) -> Section {
    let mut section = Section::new("Wheelsets in the full curve, first point");
    let (Some(full), Some(limits)) = (curve.full(), curve.limits.first()) else { return section };
    let number: Vec<f64> = (1..=full.wheelsets.len()).map(|number| number as f64).collect();
    let kn = |of: fn(&super::wheelset::WheelsetCurve) -> OverSeeds| -> Vec<f64> {
        full.wheelsets.iter().map(|axle| 1e-3 * of(axle).mean).collect()
    };
    let forces = Plot::new("Sum of guiding forces, outward")
        .x("wheelset", "")
        .y("sum of Y", "kN")
        .band("0.15 to 99.85 %", &number, &kn(|axle| axle.sum_low_n), &kn(|axle| axle.sum_high_n))
        .points("quasi-static", &number, &kn(|axle| axle.sum_quasi_static_n))
        .limit("Prud'homme", 1e-3 * limits.prudhomme_n)
        .limit("Prud'homme", -1e-3 * limits.prudhomme_n);
    let mut table = Table::new("Wheels, mean over seeds")
        .text("wheel")
        .number_with_digits("Y quasi-static", "kN", 3)
        .number_with_digits("Q quasi-static", "kN", 3)
        .number_with_digits("Y/Q", "", 3)
        .number_with_digits("Q/P", "", 3)
        .number_with_digits("unloading", "", 3)
        .number_with_digits("wear power", "W", 3)
        .number_with_digits("T gamma", "N", 3);
    for (index, axle) in full.wheelsets.iter().enumerate() {
        for (side, wheel) in [("outer", &axle.outer), ("inner", &axle.inner)] {
            table = table.row([
                format!("{} {side}", index + 1).into(),
                (1e-3 * wheel.y_quasi_static_n.mean).into(),
                (1e-3 * wheel.q_quasi_static_n.mean).into(),
                wheel.y_over_q.mean.into(),
                wheel.derailment_gb.mean.into(),
                wheel.unloading.mean.into(),
                wheel.wear_w.mean.into(),
                wheel.t_gamma_n.mean.into(),
            ]);
        }
    }
    section = section.plot(forces);
    section.table(table)
}

/// Spectra of the first wheelset's force, a line for each of the first points.
fn spectra(points: &[Point]) -> Section {
    let mut plot = Plot::new("Sum of guiding forces of the first wheelset, full curve")
        .x("frequency", "Hz")
        .y("density", "kN2/Hz")
        .log_x()
        .log_y();
    let curves = points.iter().filter_map(|point| Some((point, point.answer.curve.as_ref()?)));
    let with = curves.filter_map(|(point, curve)| Some((point, curve.spectrum.as_ref()?)));
    let all: Vec<_> = with.collect();
    let mut section = Section::new("Spectrum of the lateral axle force");
    if all.is_empty() {
        return section.text("The full curve is too short for one.");
    }
    for (point, spectrum) in all.iter().take(DRAWN) {
        let lines = spectrum.density.iter().enumerate().skip(1).filter(|(_, d)| **d > 0.0);
        let (hz, density): (Vec<f64>, Vec<f64>) =
            lines.map(|(line, d)| (line as f64 * spectrum.resolution_hz, 1e-6 * d)).unzip();
        plot = plot.line(&point.in_words("density"), &hz, &density);
    }
    section = section.plot(plot);
    if all.len() > DRAWN {
        section = section.note(&format!("{} more are in curve.json.", all.len() - DRAWN));
    }
    section
}
