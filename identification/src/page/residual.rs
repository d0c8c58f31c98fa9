//! The residual of the final model.

use super::coordinates::{plots, shares};
use super::prefix::quantity;
use super::words::{capitalised, percent, probability, seen};
use crate::fit::Fit;
use crate::identify::Identification;
use crate::residual::ResidualAnalysis;
use crate::residual::question::Answer;
use report::{Cell, Plot, Section, Table};
use signal::spectrum::Spectrum;

/// Segments of a spectrum, as a share of the counted length of a test.
const SEGMENTS: f64 = 4.0;

/// The remaining residual.
pub(super) fn section(identification: &Identification) -> Section {
    let (before, after) = (&identification.residual_before, &identification.residual_after);
    let added = !identification.result.effects.is_empty();
    let mapped = identification.empirical.as_ref().is_some_and(|tried| tried.kept);
    let mut section = Section::new("The remaining residual");
    section = match &after.unexplained {
        None => section.text(&format!(
            "{} rms. Over all tests no part of it repeats, follows a coordinate or the motion, \
             grows with the force or stands out of the spectrum{}: {}{}.",
            quantity(after.rms_n, "N"),
            after.noise.floor_n.map_or(String::new(), |floor| format!(
                " beyond a quarter of the noise floor of {}",
                quantity(floor, "N")
            )),
            if after.not_judged().is_some() {
                "but these records do not ask every question"
            } else {
                "it is taken for noise"
            },
            if after.lines.is_empty() { "" } else { ", including the lines of single tests below" }
        )),
        Some(part) => section
            .warning(&format!(
                "{} rms {} have no explanation in the catalogue: {}. {}",
                quantity(part.rms_n, "N"),
                seen(part.coordinate),
                part.description,
                if mapped {
                    "model.toml does not cover it; the empirical map below is a file of its own."
                } else {
                    "The model does not cover it."
                }
            ))
            .text(&format!("The whole residual is {} rms.", quantity(after.rms_n, "N"))),
    };
    section = section.text(&repeat(after)).table(questions(after));
    if let Some(why) = identification.result.not_judged.as_deref() {
        section = section.warning(&capitalised(&format!("not judged: {why}.")));
    }
    section = if added {
        section
            .text("The residual over the same coordinates; grey: before effects were added.")
            .plots(plots(identification, after, Some(before)))
            .table(shares(after, Some(before)))
    } else {
        section.text("Over the coordinates it is the residual drawn above, as no effect was added.")
    };
    section = section.plots(spectrum(identification));
    if after.lines.is_empty() {
        return section.text("No test has a line in the spectrum of its residual.");
    }
    let mut table = Table::new("Lines in the spectrum of the residual")
        .text("test")
        .number("frequency", "Hz")
        .number_with_digits("rms", "N", 3);
    for line in &after.lines {
        let name = &identification.train.tests[line.test].record.name;
        table = table.row([name.as_str().into(), line.frequency_hz.into(), line.rms_n.into()]);
    }
    section.table(table)
}

/// The questions that need no noise floor, with their answers.
fn questions(left: &ResidualAnalysis) -> Table {
    let (motion, size) = (&left.motion, &left.size);
    let answer = |answer: &Answer, why: String| match answer {
        Answer::Yes => ("yes", why),
        Answer::No => ("no", why),
        Answer::NotTested(why) => ("not tested by this motion", why.clone()),
    };
    let of_motion = answer(
        &motion.answer,
        format!(
            "a regression on the motion removes {} of the squared residual on {} left-out pieces, \
             and improves {} of them",
            percent(motion.share.max(0.0)),
            motion.pieces,
            percent(motion.improved)
        ),
    );
    let of_size = answer(
        &size.answer,
        format!(
            "rank correlation of its size with the force {:.2}, {}",
            size.correlation,
            probability(size.p_value)
        ),
    );
    let table = Table::new("Questions that need no noise floor")
        .text("question")
        .text("answer")
        .text("why");
    let rows =
        [("does it follow the motion?", of_motion), ("does its size follow the force?", of_size)];
    table.rows(
        rows.map(|(question, (answer, why))| [question.into(), answer.into(), Cell::from(why)]),
    )
}

fn repeat(left: &ResidualAnalysis) -> String {
    let repeat = &left.repeat;
    match repeat.noise_floor_n {
        None => "No test has cycles, so it is unknown whether a part of it repeats.".to_owned(),
        Some(floor) if repeat.repeated_rms_n == 0.0 => format!(
            "From cycle to cycle nothing repeats ({}), {} do not; {} tests have cycles.",
            probability(repeat.p_value),
            quantity(floor, "N"),
            repeat.tests
        ),
        Some(floor) => format!(
            "From cycle to cycle {} rms repeat ({}), {} do not; {} tests have cycles.",
            quantity(repeat.repeated_rms_n, "N"),
            probability(repeat.p_value),
            quantity(floor, "N"),
            repeat.tests
        ),
    }
}

/// Spectrum of the residual, before and after, in the test with the strongest line or, without
/// lines, with the largest residual.
fn spectrum(identification: &Identification) -> Vec<Plot> {
    let tests = &identification.train;
    let findings = &identification.findings;
    let (before, after) = (findings.refitted.fit(), findings.with_effects.fit());
    let rms_n = |test: usize| {
        let counted = tests.tests[test].counted();
        signal::statistics::rms(&after.residual_n(tests, test)[counted])
    };
    let strongest =
        identification.residual_after.lines.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
    let largest = || (0..tests.tests.len()).max_by(|a, b| rms_n(*a).total_cmp(&rms_n(*b)));
    let Some(test) = strongest.map(|line| line.test).or_else(largest) else { return Vec::new() };
    let record = &tests.tests[test].record;
    let of = |fit: &Fit| {
        let counted = tests.tests[test].counted();
        let residual = &fit.residual_n(tests, test)[counted];
        let segment_s = residual.len() as f64 * record.step_s / SEGMENTS;
        let spectrum = Spectrum::welch(residual, 1.0 / record.step_s, segment_s).ok()?;
        let lines = spectrum.lines().filter(|(hz, density)| *hz > 0.0 && *density > 0.0);
        Some(lines.map(|(hz, density)| (hz, density.sqrt())).unzip::<f64, f64, Vec<_>, Vec<_>>())
    };
    let (Some((hz, first)), Some((_, last))) = (of(before), of(after)) else { return Vec::new() };
    let mut plot = Plot::new(&format!("Spectrum of the residual in {}", record.name))
        .palette(&super::curves::PALETTE)
        .x("frequency", "Hz")
        .y("amplitude spectral density", "N/√Hz")
        .log_x()
        .log_y();
    plot = plot.line(crate::tables::REFITTED, &hz, &first);
    if !identification.result.effects.is_empty() {
        plot = plot.line(crate::tables::WITH_EFFECTS, &hz, &last);
    }
    if let Some(line) = strongest {
        plot = plot.at("strongest line", line.frequency_hz);
    }
    vec![plot]
}
