//! `report.html` of a body on a damper.

use super::identify::{OnMass, Shown};
use super::result::OnMassResult;
use super::search::{LEAST_GAIN, LEAST_PARTS};
use super::summary;
use report::{Plot, Report, Section, Tile, significant};

/// Samples of the stretch that is drawn.
const STRETCH: usize = 400;
/// Records that are drawn.
const DRAWN: usize = 8;

/// The report of a body that was identified.
pub fn on_mass_page(found: &OnMass) -> Report {
    let result = &found.result;
    let mut report = Report::new("A body on a damper: force in, motion out")
        .subtitle(&result.sentence())
        .fact("records", &result.per_record.len().to_string())
        .fact("output", &format!("{} ({})", result.output, result.unit))
        .section(headline(result))
        .section(naming(result));
    report = report.section(records(found));
    report.section(about(result))
}

fn headline(result: &OnMassResult) -> Section {
    let unit = result.unit;
    let number = |value: Option<f64>| value.map_or("not known".to_owned(), |v| significant(v, 3));
    let last = result.models.get(result.kept.saturating_sub(1));
    let first = result.models.first();
    let held = last.is_some_and(|model| model.holdout_rms.is_some());
    let which = if held { "held-out error" } else { "training error" };
    let error = |model: Option<&super::result::ModelErrors>| {
        model.map(|model| model.holdout_rms.unwrap_or(model.train_rms))
    };
    let unexplained = match (&result.unexplained, result.noise_floor) {
        (Some(part), _) => Tile::number("unexplained, rms", part.rms, unit).bad(),
        (None, Some(_)) => Tile::text("unexplained", "nothing").good(),
        (None, None) => Tile::text("unexplained", "not judged"),
    };
    let name = first.map_or("first model", |model| model.name.as_str());
    let tiles = [
        Tile::text(&format!("{which}, {name}, {unit}"), &number(error(first))),
        Tile::text(&format!("{which}, kept model, {unit}"), &number(error(last))),
        Tile::text(&format!("noise floor, {unit}"), &number(result.noise_floor)),
        unexplained,
    ];
    let mut section = Section::new("Summary").tiles(tiles);
    if result.interrupted {
        section = section.warning("The search was interrupted: laws may be missing.");
    }
    for law in result.laws.iter().filter(|law| !law.given) {
        section = section.text(&summary::law(law));
    }
    if let Some(part) = &result.unexplained {
        section = section.text(&format!("Unexplained: {}.", part.description));
    }
    section
        .text(&format!("Noise floor: {}.", summary::floor(result)))
        .table(summary::models(result))
        .table(summary::parameters(result))
}

fn naming(result: &OnMassResult) -> Section {
    let section = Section::new("Candidates of motion").text(&format!(
        "Every law is added to the body, fitted to all parts, and fitted again without two of six \
         parts, which it then predicts. A law is accepted if it removes {} % of the squared error \
         on left-out parts, in short records more, and is better in {LEAST_PARTS} of six, unless the \
         model without it is at the noise floor already. A law that removes less than \
         half of that from the fitted parts is not judged further.",
        significant(100.0 * LEAST_GAIN, 2)
    ));
    (0..result.rounds.len())
        .fold(section, |section, round| section.table(summary::candidates(result, round)))
}

fn records(found: &OnMass) -> Section {
    let section = Section::new("Records").table(summary::records(&found.result));
    // Held-out records first: they show more.
    let mut shown: Vec<&Shown> = found.shown.iter().collect();
    shown.sort_by_key(|shown| !shown.held_out);
    section.plots(shown.into_iter().take(DRAWN).map(|shown| plot(shown, &found.result)))
}

/// The stretch with the largest error of the first model, and the errors of both models.
fn plot(shown: &Shown, result: &OnMassResult) -> Plot {
    let record = &shown.record;
    let worst = record.motion.iter().zip(&shown.first).map(|(a, b)| (a - b).abs()).enumerate();
    let worst = worst.fold((0, 0.0), |best, now| if now.1 > best.1 { now } else { best }).0;
    let from = worst.saturating_sub(STRETCH / 2).min(record.len().saturating_sub(STRETCH));
    let range = from..(from + STRETCH).min(record.len());
    let (factor, unit) = if result.unit == "m" { (1e3, "mm") } else { (1.0, "m/s²") };
    let cut = |values: &[f64]| -> Vec<f64> {
        values[range.clone()].iter().map(|value| factor * value).collect()
    };
    let error = |model: &[f64]| -> Vec<f64> {
        let all: Vec<f64> = record.motion.iter().zip(model).map(|(a, b)| a - b).collect();
        cut(&all)
    };
    let time_s: Vec<f64> = range.clone().map(|n| n as f64 * record.step_s).collect();
    let role = if shown.held_out { "held out" } else { "fitted" };
    let first = result.models.first().map_or("first model", |model| model.name.as_str());
    Plot::new(&format!("{} ({role})", record.name))
        .caption("The stretch around the largest error of the first model.")
        .x("time", "s")
        .y(result.output, unit)
        .backdrop("measured", &time_s, &cut(&record.motion))
        .dashed(first, &time_s, &cut(&shown.first))
        .line("kept model", &time_s, &cut(&shown.kept))
        .panel_below("measured less simulated", unit)
        .dashed(first, &time_s, &error(&shown.first))
        .line("kept model", &time_s, &error(&shown.kept))
}

fn about(result: &OnMassResult) -> Section {
    let section = Section::new("How this was done").text(
        "The body is simulated from the force alone, never from a measured motion. Periods of a \
         periodic record are averaged; the motion settles for one period or more, and the next \
         one is compared. A record that moves at its first sample gives the model its displacement \
         and velocity there; of a held-out record its first 5 % are used for that and are not \
         counted. Uncertainties are one standard deviation for a white residual.",
    );
    result.notes.iter().fold(section, |section, note| section.note(note))
}
