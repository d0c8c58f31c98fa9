//! Errors, test by test.

use crate::identify::Identification;
use crate::result::{Models, PerTest};
use crate::tables::{DATASHEET, REFITTED, WITH_EFFECTS};
use report::{Cell, Section, Table};

/// The error tables.
pub(super) fn section(identification: &Identification) -> Section {
    let given = identification.result.errors.datasheet.is_some();
    let added = !identification.result.effects.is_empty();
    let names = [(DATASHEET, given), (REFITTED, true), (WITH_EFFECTS, added)];
    let table = |caption: &str, unit: &str, digits| {
        let table = Table::new(caption).text("test").text("role");
        let shown = names.iter().filter(|(_, shown)| *shown);
        shown.fold(table, |table, (name, _)| table.number_with_digits(name, unit, digits))
    };
    let cells = |row: &PerTest, of: &Models<Option<f64>>, scale: f64| -> Vec<Cell> {
        let role = if row.role == "holdout" { "held out" } else { "fitted" };
        let values = [of.datasheet, of.refitted, of.with_effects].into_iter().zip(names);
        let shown = values.filter(|(_, (_, shown))| *shown);
        let numbers = shown.map(|(value, _)| Cell::from(value.map(|value| scale * value)));
        [row.file.as_str().into(), role.into()].into_iter().chain(numbers).collect()
    };
    let mut rms = table("rms error", "N", 4);
    if added {
        rms = rms.number_with_digits("less by", "%", 3);
    }
    rms = rms.number("samples", "");
    let mut peaks = table("Error of the peak force", "%", 3);
    let mut works = table("Error of the work per cycle", "%", 3);
    for row in &identification.result.per_test {
        let mut line = cells(row, &row.rmse_n, 1.0);
        if added {
            let pair = row.rmse_n.refitted.zip(row.rmse_n.with_effects);
            let less = pair.filter(|(before, _)| *before > 0.0);
            line.push(less.map(|(before, after)| 100.0 * (1.0 - after / before)).into());
        }
        line.push((row.samples as u64).into());
        rms = rms.row(line);
        peaks = peaks.row(cells(row, &row.peak_force_error, 100.0));
        works = works.row(cells(row, &row.work_per_cycle_error, 100.0));
    }
    let less = if added {
        " \"Less by\" compares the model with effects to the refitted one."
    } else {
        ""
    };
    Section::new("Errors, test by test")
        .text(&format!(
            "All errors are those of free-run simulation, over all samples but the run-in.{less} \
             Peak and work are simulated over measured, less one; a test without cycles has no \
             value of work."
        ))
        .table(rms)
        .table(peaks)
        .table(works)
}
