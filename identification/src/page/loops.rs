//! Loops of every test held out, before and after.

use super::curves::{Over, Which, loop_of, residual_of};
use super::prefix::quantity;
use super::shown::Shown;
use crate::identify::Identification;
use report::Section;

/// Fitted tests that are drawn where none is held out.
const MOST_FITTED: usize = 6;

/// Loops before and after.
pub(super) fn section(identification: &Identification, tests: &[Shown<'_>]) -> Section {
    let added = !identification.result.effects.is_empty();
    let held_out = tests.iter().any(|shown| shown.held_out);
    let mut section = Section::new(match (held_out, added) {
        (true, true) => "Loops of the held-out tests, before and after",
        (true, false) => "Loops of the held-out tests",
        (false, true) => "Loops, before and after",
        (false, false) => "Loops",
    });
    section = section.text(if held_out {
        "No fit and no choice has seen these tests. The stretch shown is the one with the \
         largest error of the refitted model, whole cycles where there are any."
    } else {
        "No test was held out, so these are fitted ones."
    });
    let which = Which { datasheet: false, refitted: true, with_effects: added };
    let chosen = tests.iter().filter(|shown| shown.held_out == held_out);
    let most = if held_out { usize::MAX } else { MOST_FITTED };
    let plots = chosen.take(most).flat_map(|shown| {
        let name = &shown.test.record.name;
        let row = identification.result.per_test.iter().find(|row| row.file == *name);
        let error = |of: Option<f64>| of.map_or("–".to_owned(), |rms_n| quantity(rms_n, "N"));
        let caption = row.map_or(String::new(), |row| {
            let refitted = error(row.rmse_n.refitted);
            if added {
                format!(
                    "Error over the whole test: {refitted} before, {} after.",
                    error(row.rmse_n.with_effects)
                )
            } else {
                format!("Error over the whole test: {refitted}.")
            }
        });
        let stretch = shown.stretch();
        [
            loop_of(shown, Over::Displacement, &stretch, which).caption(&caption),
            residual_of(shown, &stretch, which),
        ]
    });
    section.plots(plots.collect::<Vec<_>>())
}
