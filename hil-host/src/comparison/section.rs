//! The section of the report: the table, and both runs over each other where they differ most.

use super::{Comparison, SecondRun};
use crate::columns::Columns;
use crate::control::End;
use crate::page::{kilo, milli, most_in, spectrum};
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Cell, Plot, Section, Table};
use scenario::run::{CYCLE_S, Run};
use std::ops::Range;

/// What the time histories and loops show (s): some ten strokes of a yaw damper, few enough to see
/// each.
const SHOWN_S: f64 = 4.0;

/// The section of a comparison.
pub(crate) fn section(
    run: &Run,
    run_state: End,
    columns: &Columns,
    comparison: &Comparison,
    second: &SecondRun,
) -> Section {
    let other = &second.columns;
    let first = columns.first_after(run.run_in_s);
    let end = columns.time_s.len().min(other.time_s.len());
    let rows = first.min(end)..end;
    let shown = most_different(columns, other, rows.clone());
    let mut section = Section::new("Before and after").text(&format!(
        "What the difference of the dampers does to the vehicle. Before: the same run with “{}” in \
         every slot. After: the run of this report. Changes are relative to before; a force in \
         compression that grows in size has a positive change. The record of the run before is \
         record-compared.npy.",
        comparison.name
    ));
    for warning in comparison.warnings(run_state) {
        section = section.warning(&warning);
    }
    section = section.table(table(comparison));
    if shown.is_empty() {
        return section;
    }
    section = section.plot(accelerations(columns, other, &shown));
    let loops = run.slots.iter().enumerate().take(DAMPER_SLOTS);
    let loops: Vec<Plot> = loops
        .map(|(slot, place)| damper_loop(&place.place, slot, columns, other, &shown))
        .collect();
    let carbody = spectra("carbody", 0, columns, other, &rows);
    let bogie = spectra("front bogie", 2, columns, other, &rows);
    section.plots(loops).plots([carbody, bogie])
}

fn table(comparison: &Comparison) -> Table {
    let mut table = Table::new(&format!("Before ({}) and after", comparison.name))
        .text("quantity")
        .text("unit")
        .number("before", "")
        .number("after", "")
        .number_with_digits("change", "%", 3);
    for quantity in &comparison.quantities {
        let (scale, unit) = quantity.readable();
        table = table.row([
            Cell::from(quantity.quantity.as_str()),
            Cell::from(unit),
            quantity.before.map(|value| value * scale).into(),
            quantity.after.map(|value| value * scale).into(),
            quantity.change_percent.into(),
        ]);
    }
    table
}

/// The rows of [`SHOWN_S`] in which the front bogie's lateral acceleration differs most.
fn most_different(columns: &Columns, other: &Columns, rows: Range<usize>) -> Range<usize> {
    let window = (SHOWN_S / CYCLE_S) as usize;
    let pairs =
        columns.acceleration[2][rows.clone()].iter().zip(&other.acceleration[2][rows.clone()]);
    let difference: Vec<f64> = pairs.map(|(after, before)| after - before).collect();
    match most_in(&difference, window) {
        Some(at) => rows.start + at..rows.start + at + window,
        None => rows,
    }
}

const BEFORE: &str = "before";
const AFTER: &str = "after";

fn accelerations(columns: &Columns, other: &Columns, shown: &Range<usize>) -> Plot {
    let time = &columns.time_s[shown.clone()];
    let trace = |of: &Columns, body: usize| of.acceleration[body][shown.clone()].to_vec();
    Plot::new("Lateral acceleration of front bogie and carbody, before and after")
        .caption("The seconds in which the front bogie differs most.")
        .x("time", "s")
        .y("bogie, front", "m/s²")
        .line(BEFORE, time, &trace(other, 2))
        .line(AFTER, time, &trace(columns, 2))
        .panel_below("carbody", "m/s²")
        .line(BEFORE, time, &trace(other, 0))
        .line(AFTER, time, &trace(columns, 0))
}

fn damper_loop(
    place: &str,
    slot: usize,
    columns: &Columns,
    other: &Columns,
    shown: &Range<usize>,
) -> Plot {
    let stroke = |of: &Columns| milli(&of.extension_m[slot][shown.clone()]);
    let force = |of: &Columns| kilo(&of.force_n[slot][shown.clone()]);
    Plot::new(&format!("Force over displacement before and after, {place}"))
        .x("displacement", "mm")
        .y("force", "kN")
        .line(BEFORE, &stroke(other), &force(other))
        .line(AFTER, &stroke(columns), &force(columns))
}

fn spectra(
    name: &str,
    index: usize,
    columns: &Columns,
    other: &Columns,
    rows: &Range<usize>,
) -> Plot {
    let density = |of: &Columns| spectrum(&of.acceleration[index][rows.clone()]);
    let (before, after) = (density(other), density(columns));
    Plot::new(&format!("Lateral acceleration of the {name}, before and after"))
        .x("frequency", "Hz")
        .y("power spectral density", "(m/s²)²/Hz")
        .log_x()
        .log_y()
        .line(BEFORE, &before.0, &before.1)
        .line(AFTER, &after.0, &after.1)
}
