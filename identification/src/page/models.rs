//! The record with the maker's model over it; then the same model with its numbers refitted.

use super::curves::{Over, Which, loop_of, over_time};
use super::prefix::quantity;
use super::shown::Shown;
use super::words;
use crate::grey_box::NOMINAL;
use crate::identify::Identification;
use crate::uncertainty::uncertainty;
use report::{Cell, Section, Table};

/// The record and the datasheet.
pub(super) fn datasheet(identification: &Identification, worst: Option<&Shown<'_>>) -> Section {
    let given = identification.on_train.datasheet.is_some();
    let heading = if given { "The record, and the datasheet over it" } else { "The record" };
    let mut section = Section::new(heading);
    let Some(shown) = worst else { return section };
    let name = &shown.test.record.name;
    section = section.text(&format!(
        "The test shown is {name}: it has the largest error of the refitted model.{}",
        if given {
            " All models are given the measured displacement only, not the measured force; no \
             error counts the run-in."
        } else {
            " No datasheet was given, so there is no datasheet error."
        }
    ));
    let which = Which { datasheet: given, ..Which::default() };
    if let Some(errors) = identification.result.errors.datasheet {
        let held = errors.holdout_nrmse.map_or(String::new(), |share| {
            format!(" and {} over those held out", words::percent(share))
        });
        section = section.text(&format!(
            "The error of the maker's numbers is {} of the rms force over the fitted tests{held}.",
            words::percent(errors.train_nrmse)
        ));
    }
    section.plot(over_time(&format!("Force in {}", shown.title()), shown, which)).plots([
        loop_of(shown, Over::Displacement, &shown.stretch(), which)
            .caption("The area of the loop is the work of its cycles."),
        loop_of(shown, Over::Velocity, &shown.stretch(), which),
    ])
}

/// The refitted model.
pub(super) fn refitted(identification: &Identification, worst: Option<&Shown<'_>>) -> Section {
    let given = identification.on_train.datasheet.is_some();
    let mut section = Section::new("The model, refitted");
    let text = if given {
        "Before an effect is searched, the five numbers of the nominal model are fitted to the \
         training tests. This is the baseline: errors of the datasheet's numbers are removed."
    } else {
        "The five numbers of the nominal model are fitted to the training tests: the baseline."
    };
    section = section.text(text).table(nominal(identification));
    if let Some(shown) = worst {
        let which = Which { datasheet: given, refitted: true, with_effects: false };
        section =
            section.plot(over_time(&format!("Force in {}", shown.title()), shown, which)).plots([
                loop_of(shown, Over::Displacement, &shown.stretch(), which),
                loop_of(shown, Over::Velocity, &shown.stretch(), which),
            ]);
    }
    section
}

/// Nominal parameters: of the datasheet, refitted, and of the final model.
fn nominal(identification: &Identification) -> Table {
    let standing = &identification.findings.refitted.linearised;
    let deviations = uncertainty(standing, &identification.train);
    let added = !identification.result.effects.is_empty();
    let mut table = Table::new("Nominal parameters; std is one standard deviation")
        .text("parameter")
        .text("is")
        .text("unit")
        .number("datasheet", "")
        .number("refitted", "")
        .number_with_digits("std", "", 2);
    if added {
        table = table.number("with effects", "").number_with_digits("std", "", 2);
    }
    for (index, (name, unit)) in NOMINAL.iter().enumerate() {
        let last = identification.result.nominal.get(*name);
        let mut row = vec![
            Cell::from(*name),
            Cell::from(format!(
                "{}: {}",
                meaning(name),
                quantity(standing.fit.values[index], unit)
            )),
            Cell::from(*unit),
            last.and_then(|value| value.datasheet).into(),
            standing.fit.values[index].into(),
            deviation(deviations[index]),
        ];
        if added {
            row.push(last.map(|value| value.value).into());
            row.push(deviation(last.and_then(|value| value.std)));
        }
        table = table.row(row);
    }
    table
}

/// A standard deviation, or the words for none.
pub(super) fn deviation(std: Option<f64>) -> Cell {
    std.map_or(Cell::from("not fixed"), Cell::Number)
}

fn meaning(name: &str) -> &'static str {
    match name {
        "ce_n_s_per_m" => "Ce, damping below relief",
        "ke_n_per_m" => "Ke, stiffness in series",
        "clearance_2a_m" => "2a, clearance of the joints",
        "f_relief_n" => "relief force",
        "c2_n_s_per_m" => "damping beyond relief",
        _ => "",
    }
}
