//! The report of the scores.

use super::answer::{Answer, Below, Score};
use super::condition::Condition;
use super::data_sheet::Answered;
use super::errors::{AIMS, Errors};
use super::text::{CONDITIONS, in_words, tables};
use report::{Plot, Report, Section};

/// The report, behind its title and facts.
pub fn page(answer: &Answer, report: Report) -> Report {
    let mut found = Section::new("Scores");
    for aim in &answer.aims {
        found = if aim.is_met { found.note(&in_words(aim)) } else { found.warning(&in_words(aim)) };
    }
    for table in tables(answer) {
        found = found.table(table);
    }
    found = CONDITIONS.iter().fold(found, |section, line| section.text(line));
    let report = report
        .subtitle("Reference problem of hybrid simulation with a yaw damper")
        .fact("result of", answer.result_of)
        .fact("seed of the perturbed rigs", &answer.question.seed.to_string())
        .section(found)
        .section(rig(answer));
    let report = match answer.question.dead_times_ms.as_slice() {
        [_, _, ..] => report.section(over_dead_time(answer)),
        _ => report,
    };
    match answer.from_below.as_slice() {
        [] => report,
        below => report.section(ring_downs(below)),
    }
}

fn rig(answer: &Answer) -> Section {
    let plot = |of: fn(&Answered) -> f64, mut plot: Plot| {
        for damper in &answer.dampers {
            let points = damper.data_sheet.answers.iter().map(|line| (line.frequency_hz, of(line)));
            let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
            plot = plot.points(damper.damper.name(), &x, &y);
        }
        plot
    };
    let empty = Plot::new("Answer of the nominal rig to a sine, without dead time")
        .x("frequency", "Hz")
        .log_x()
        .y("gain", "");
    let gain = plot(|line| line.gain, empty).panel_below("delay", "ms");
    let both = plot(|line| 1e3 * line.delay_s(), gain);
    Section::new("Rig").plot(both.caption("With each damper mounted, which loads the rig."))
}

/// Work and phase over the dead time, nominal rig.
fn over_dead_time(answer: &Answer) -> Section {
    let mut section = Section::new("Over the dead time");
    for damper in &answer.question.dampers {
        let of = |regime: &str, value: fn(&Errors) -> f64, hunting: bool, aim: f64, unit: &str| {
            let title = format!("{regime}, {} dampers", damper.name());
            let (name, unit) = unit.split_once(", ").unwrap_or((unit, ""));
            let mut plot = Plot::new(&title)
                .x("dead time", "ms")
                .y(name, unit)
                .limit("aim", aim)
                .limit("aim", -aim)
                .y_range(-5.0 * aim..=5.0 * aim);
            for compensator in names(answer) {
                let (x, y) = line(answer, *damper, compensator, |score| {
                    let own = &score.nominal;
                    let errors = if hunting { own.hunting } else { own.track };
                    errors.as_ref().map(value)
                });
                plot = plot.points(compensator, &x, &y);
            }
            plot
        };
        let (work, phase) = (AIMS.work_percent, AIMS.phase_deg);
        section = section
            .plots([
                of("track", |one| one.work_percent, false, work, "error of the work, %"),
                of("hunting", |one| one.work_percent, true, work, "error of the work, %"),
            ])
            .plots([
                of("track", |one| one.phase_deg, false, phase, "phase, degrees"),
                of("hunting", |one| one.phase_deg, true, phase, "phase, degrees"),
            ]);
    }
    section.note("Larger errors are outside of the first view; zoom out to see them.")
}

/// The compensators, each once.
fn names(answer: &Answer) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for score in &answer.scores {
        if !names.contains(&score.compensator) {
            names.push(score.compensator);
        }
    }
    names
}

fn line(
    answer: &Answer,
    damper: Condition,
    compensator: &str,
    value: impl Fn(&Score) -> Option<f64>,
) -> (Vec<f64>, Vec<f64>) {
    let own = answer
        .scores
        .iter()
        .filter(|score| score.damper == damper && score.compensator == compensator);
    own.map(|score| (f64::from(score.dead_time_ms), value(score).unwrap_or(f64::NAN))).unzip()
}

fn ring_downs(all: &[Below]) -> Section {
    let mut plot = Plot::new("Decay rates of ring-downs below the critical speed")
        .x("speed", "km/h")
        .y("decay rate", "1/s")
        .limit("neither grows nor dies", 0.0);
    for one in all {
        let (x, y): (Vec<f64>, Vec<f64>) =
            one.found.ring_downs.iter().map(|ring| (ring.kmh, ring.decay_per_s)).unzip();
        let how = if one.compensator.is_some() { "on rigs" } else { "modelled" };
        plot = plot.points(&format!("{}, {how}", one.damper.name()), &x, &y);
    }
    Section::new("From below").plot(plot)
}
