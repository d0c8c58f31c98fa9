//! The summary at the top of the page, and the method and notes at its end.

use super::prefix::{Prefixed, quantity};
use super::words::{floor_has_lines, percent};
use crate::identify::Identification;
use crate::result::Errors;
use crate::tables;
use crate::test_set::TestSet;
use report::{Section, Tile, significant};

/// Names and values under the title.
pub(super) fn facts(identification: &Identification) -> Vec<(&'static str, String)> {
    let size = |tests: &TestSet| {
        let seconds: f64 = tests
            .tests
            .iter()
            .map(|test| test.record.force_n.len() as f64 * test.record.step_s)
            .sum();
        let count = tests.tests.len();
        let word = if count == 1 { "test" } else { "tests" };
        format!("{count} {word}, {} s", significant(seconds, 3))
    };
    let held_out = &identification.holdout;
    let none = held_out.tests.is_empty();
    vec![
        ("fitted", size(&identification.train)),
        ("held out", if none { "nothing".to_owned() } else { size(held_out) }),
        ("largest force", quantity(identification.train.scale.force_n, "N")),
        ("largest speed", quantity(identification.train.scale.velocity_m_per_s, "m/s")),
        ("sampling", format!("{} Hz", significant(identification.train.lowest_rate_hz(), 4))),
    ]
}

/// Key numbers, the story in a few sentences, and the errors of the three models.
pub(super) fn section(identification: &Identification) -> Section {
    let result = &identification.result;
    let errors = &result.errors;
    let held_out = errors.refitted.is_some_and(|errors| errors.holdout_rmse_n.is_some());
    let shown: Vec<(&str, f64, f64)> = tables::models(&identification.result)
        .into_iter()
        .filter_map(|(name, errors)| {
            let (rmse_n, share) = judged(errors.as_ref()?);
            Some((name, rmse_n, share))
        })
        .collect();
    // One unit for all three, so that they compare at a glance.
    let unit = Prefixed::for_all("N", shown.iter().map(|(_, rmse_n, _)| rmse_n));
    let which = if held_out { "held-out error" } else { "error" };
    let mut tiles: Vec<Tile> = shown
        .iter()
        .map(|(name, rmse_n, share)| {
            let unit_and_share = format!("{} ({})", unit.unit, percent(*share));
            Tile::number(&format!("{which}, {name}"), unit.value(*rmse_n), &unit_and_share)
        })
        .collect();
    tiles.push(match (result.noise_floor_n, result.noise_at_least_n) {
        (Some(floor_n), _) => force_tile("noise floor", floor_n),
        (None, Some(at_least_n)) => force_tile("noise, at least", at_least_n),
        (None, None) => Tile::text("noise floor", "unknown"),
    });
    tiles.push(Tile::text(
        "effects added",
        &match result.effects.len() {
            0 => "none".to_owned(),
            count => count.to_string(),
        },
    ));
    tiles.push(match &result.unexplained {
        None if result.not_judged.is_some() => Tile::text("unexplained", "not judged").bad(),
        None => Tile::text("unexplained", "nothing").good(),
        Some(part) => force_tile("unexplained, rms", part.rms_n).bad(),
    });
    let mut section = Section::new("Summary").tiles(tiles).text(&story(identification, held_out));
    if result.interrupted {
        section = section.warning(
            "The search was interrupted. The findings are those of the rounds until then: \
             effects may be missing that a complete search would find.",
        );
    }
    if !held_out {
        section = section.note(
            "No test was held out: the errors are those of the fitted tests. The gain of an \
             effect was still judged on pieces left out of the fit one by one.",
        );
    }
    section.table(tables::errors(identification))
}

fn force_tile(name: &str, rms_n: f64) -> Tile {
    let prefixed = Prefixed::for_size("N", rms_n);
    Tile::number(name, prefixed.value(rms_n), &prefixed.unit)
}

/// Error and its share of the force: on tests held out, if there are any.
fn judged(errors: &Errors) -> (f64, f64) {
    let fitted = (errors.train_rmse_n, errors.train_nrmse);
    errors.holdout_rmse_n.zip(errors.holdout_nrmse).unwrap_or(fitted)
}

fn story(identification: &Identification, held_out: bool) -> String {
    let result = &identification.result;
    let tests = if held_out { "the tests held out" } else { "the tests" };
    let share = |errors: &Option<Errors>| errors.as_ref().map(|errors| percent(judged(errors).1));
    let mut sentences = Vec::new();
    if let Some(datasheet) = share(&result.errors.datasheet) {
        sentences.push(format!(
            "With the datasheet's numbers the error of the force of {tests} is {datasheet} rms."
        ));
    }
    if let Some(refitted) = share(&result.errors.refitted) {
        sentences.push(if sentences.is_empty() {
            format!("Refitted to the records, the model has an error of {refitted} on {tests}.")
        } else {
            format!("Refitted to the records, it is {refitted}.")
        });
    }
    let with_effects = share(&result.errors.with_effects).filter(|_| !result.effects.is_empty());
    if let Some(with_effects) = with_effects {
        let names: Vec<String> =
            result.effects.iter().map(|effect| super::words::spoken(effect.name)).collect();
        sentences.push(format!("With {} it is {with_effects}.", super::words::listed(&names)));
    }
    sentences.push(noise(identification));
    sentences.join(" ")
}

/// What is known about the noise.
fn noise(identification: &Identification) -> String {
    let result = &identification.result;
    let share = |rms_n: f64| percent(rms_n / tables::training_force_n(identification));
    let method = result.noise_floor_method;
    match (result.noise_floor_n, result.noise_at_least_n) {
        (Some(floor_n), _) => {
            let lines =
                if floor_has_lines(result) { ", including lines of the spectrum" } else { "" };
            format!(
                "Noise alone is {} of the force of the training tests ({method}{lines}).",
                share(floor_n)
            )
        }
        (None, Some(at_least_n)) => format!(
            "Noise is at least {} of the force of the training tests ({method}); how much more is \
             unknown, since no cycle and no test repeats.",
            share(at_least_n)
        ),
        (None, None) => format!("The noise floor is {method}."),
    }
}

/// The method, and notes for the reader.
pub(super) fn about(identification: &Identification) -> Section {
    let train = &identification.train;
    let left_out = if train.whole_tests {
        format!("each of the {} fitted tests in turn", train.pieces.len())
    } else {
        format!(
            "{} runs of whole cycles with a guard gap, as there are fewer than four tests",
            train.pieces.len()
        )
    };
    let tried = identification.empirical.as_ref();
    let mut section = Section::new("How this was done")
        .text(
            "A laboratory tool and no safety function. Errors are the measured less the \
             simulated force, in free-run simulation from the measured displacement, over all \
             samples but the run-in of each test. The initial position of the dashpot is found \
             from the run-in. Uncertainties are one standard deviation from the scatter of \
             independent blocks.",
        )
        .text(&format!(
            "Candidates were judged by leaving out {left_out}. The tests held out were used \
             for the errors shown and to keep or cut accepted effects{}.",
            if tried.is_some() {
                " and to refuse an empirical map that is worse on them"
            } else {
                ""
            }
        ))
        .text(&format!(
            "The numbers are in result.json, the damper in model.toml{}, and every simulated \
             sample in the folder predictions.",
            if tried.is_some_and(|tried| tried.kept) {
                ", with the empirical map in model-empirical.toml"
            } else {
                ""
            }
        ));
    let notes = &identification.result.notes;
    for note in notes {
        section = section.note(note);
    }
    section
}
