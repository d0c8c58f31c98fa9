//! The root locus drawn: where the modes of hunting go as the speed rises.

use super::answer::Point;
use super::linear::{AtSpeed, LinearSpeed};
use report::{Plot, Section};

/// Points of the grid whose loci are drawn, at most.
const DRAWN: usize = 4;
/// Modes that fade faster are left out (1/s).
const FASTEST_PER_S: f64 = -20.0;

/// The root loci of the first points, and the growth of their least damped modes over speed.
pub(super) fn section(points: &[Point]) -> Option<Section> {
    let with: Vec<&Point> = points.iter().filter(|point| !point.answer.linear.is_empty()).collect();
    if with.is_empty() {
        return None;
    }
    let mut section = Section::new("Root locus").text(
        "Modes about steady running, every damper as stiffness and damping of one stroke. To the right of zero \
         a small motion grows.",
    );
    for point in with.iter().take(DRAWN) {
        section = section.plots(plots(point));
    }
    if with.len() > DRAWN {
        let left = with.len() - DRAWN;
        section = section.note(&format!("{left} more are in critical-speed.json."));
    }
    Some(section)
}

fn plots(point: &Point) -> [Plot; 2] {
    let words = point.at.iter().map(|set| format!("{} {:e}", set.called(), set.number()));
    let at = words.collect::<Vec<_>>().join(", ");
    let title = |what: &str| if at.is_empty() { what.to_owned() } else { format!("{what}, {at}") };
    let mut locus = Plot::new(&title("Root locus"))
        .x("growth rate", "1/s")
        .y("frequency", "Hz")
        .at("grows", 0.0)
        .caption(&format!("Every mode of {} at every speed.", speeds(&point.answer.linear)));
    let mut growth = Plot::new(&title("Growth of the least damped mode"))
        .x("speed", "km/h")
        .y("growth rate", "1/s")
        .limit("grows", 0.0);
    for linear in &point.answer.linear {
        let name = linear.stroke_in_words();
        let modes = || linear.locus.iter().flat_map(|at| &at.modes);
        let slow = modes().filter(|mode| mode.growth_per_s > FASTEST_PER_S);
        let (x, y): (Vec<f64>, Vec<f64>) =
            slow.map(|mode| (mode.growth_per_s, mode.frequency_hz)).unzip();
        locus = locus.scatter(&name, &x, &y);
        let least = |at: &AtSpeed| Some((at.kmh, at.modes.first()?.growth_per_s));
        let (x, y): (Vec<f64>, Vec<f64>) = linear.locus.iter().filter_map(least).unzip();
        growth = growth.points(&name, &x, &y);
    }
    [locus, growth]
}

fn speeds(linear: &[LinearSpeed]) -> String {
    let locus = linear.first().map(|linear| linear.locus.as_slice()).unwrap_or_default();
    match locus {
        [first, .., last] => format!("{:.0} to {:.0} km/h", first.kmh, last.kmh),
        [only] => format!("{:.0} km/h", only.kmh),
        [] => "no speed".to_owned(),
    }
}
