//! The report of a study of the delay of rigs.

use super::answer::{Point, Speeds};
use super::procedure::Question;
use super::text::{cases, conditions, hunts_from, table};
use crate::point_table;
use report::{Plot, Report, Section};
use scenario::setting::Setting;

/// The report, behind its title and facts.
pub(super) fn page(points: &[Point], question: &Question, report: Report) -> Report {
    let conditions = conditions(points, question);
    let found = point_table::section("Critical speeds", table(points), points, &conditions);
    let report = report.subtitle("Critical speed and the delay of a rig").section(found);
    over_delay(points).into_iter().fold(report, Report::section)
}

/// The difference over the delay, where nothing else is varied.
fn over_delay(points: &[Point]) -> Option<Section> {
    let [_only] = points.first()?.at.as_slice() else { return None };
    let mut sorted: Vec<&Point> = points.iter().collect();
    let delay_ms = |point: &Point| point.at.first().map_or(f64::NAN, Setting::number);
    sorted.sort_by(|one, other| delay_ms(one).total_cmp(&delay_ms(other)));
    let x: Vec<f64> = sorted.iter().map(|point| delay_ms(point)).collect();
    let mut plot = Plot::new("Error of the critical speed that is measured with rigs")
        .x("delay of the force", "ms")
        .y("difference to modelled dampers", "km/h")
        .limit("no difference", 0.0)
        .caption("Emulated rigs. Dashed: by eigenvalues at one stroke of the dampers.");
    for (name, of) in cases(points) {
        let line = |speed: fn(&Speeds) -> Option<f64>| -> Vec<f64> {
            let off =
                |point: &&Point| Some(of(point)?.difference(point.answer.modelled, speed)?[0]);
            sorted.iter().map(|point| off(point).unwrap_or(f64::NAN)).collect()
        };
        let (fold, linear) = (line(|speeds| speeds.fold.kmh()), line(|speeds| speeds.linear.kmh()));
        plot = plot.points(&name, &x, &fold).dashed(&format!("{name}, eigenvalues"), &x, &linear);
        if hunts_from(points) {
            let from = line(|speeds| speeds.hunts_from_kmh);
            plot = plot.points(&format!("{name}, hunts from"), &x, &from);
        }
    }
    Some(Section::new("Over the delay").plot(plot))
}
