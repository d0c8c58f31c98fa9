//! The section of the report: the table, and both runs over each other where they differ most.

use super::Comparison;
use super::pairs::each_pair;
use crate::BenchError;
use crate::control::End;
use crate::page::{kilo, milli, spectrum};
use crate::record::Row;
use crate::statistics::{Liveliest, SEGMENT_S};
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Cell, Plot, Section, Table};
use scenario::run::Run;
use signal::spectrum::Welch;
use std::path::PathBuf;

/// What the time histories and loops show (s): some ten strokes of a yaw damper, few enough to see
/// each.
const SHOWN_S: f64 = 4.0;

/// The section of a comparison; `records` are those of the run and of the one compared with.
///
/// # Errors
/// A record cannot be read.
pub(crate) fn section(
    run: &Run,
    run_state: End,
    comparison: &Comparison,
    records: &[PathBuf; 2],
) -> Result<Section, BenchError> {
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
    let (whole, shown) = both(run, records)?;
    if shown.is_empty() {
        return Ok(section);
    }
    section = section.plot(accelerations(&shown));
    let loops = run.slots.iter().enumerate().take(DAMPER_SLOTS);
    let loops = loops.map(|(slot, place)| damper_loop(&place.place, slot, &shown));
    let spectra = [spectra("the carbody", &whole[0]), spectra("the front bogie", &whole[1])];
    Ok(section.plots(loops.collect::<Vec<_>>()).plots(spectra))
}

/// A row of the run before, and the same one of the run after.
type Pair = (Row, Row);

/// The spectra of carbody and front bogie, each before and after, and the rows of [`SHOWN_S`] in
/// which the front bogie's lateral acceleration differs most; all rows of a short run.
fn both(run: &Run, records: &[PathBuf; 2]) -> Result<([[Welch; 2]; 2], Vec<Pair>), BenchError> {
    let cycle_s = run.cycle_s();
    let welch = || [(); 2].map(|()| Welch::new(1.0 / cycle_s, SEGMENT_S));
    let mut whole = [welch(), welch()];
    let mut most_different = Liveliest::new((SHOWN_S / cycle_s) as usize);
    each_pair(records, run.run_in_s, |after, before| {
        let [of_after, of_before] = [after, before].map(|row| row.acceleration_m_per_s2);
        for (spectra, body) in whole.iter_mut().zip([0, 2]) {
            spectra[0].push(of_before[body]);
            spectra[1].push(of_after[body]);
        }
        most_different.take(after.time_s, of_after[2] - of_before[2]);
    })?;
    let from_s = most_different.begin_s();
    let to_s = from_s.map_or(f64::INFINITY, |from_s| from_s + SHOWN_S - 0.5 * cycle_s);
    let mut shown = Vec::new();
    each_pair(records, from_s.unwrap_or(run.run_in_s), |after, before| {
        if after.time_s < to_s {
            shown.push((*before, *after));
        }
    })?;
    Ok((whole, shown))
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

const BEFORE: &str = "before";
const AFTER: &str = "after";

fn accelerations(shown: &[Pair]) -> Plot {
    let time: Vec<f64> = shown.iter().map(|(_, after)| after.time_s).collect();
    let of = |row: &Row, body: usize| row.acceleration_m_per_s2[body];
    let before = |body| shown.iter().map(|(row, _)| of(row, body)).collect::<Vec<_>>();
    let after = |body| shown.iter().map(|(_, row)| of(row, body)).collect::<Vec<_>>();
    Plot::new("Lateral acceleration of front bogie and carbody, before and after")
        .caption("The seconds in which the front bogie differs most.")
        .x("time", "s")
        .y("bogie, front", "m/s²")
        .line(BEFORE, &time, &before(2))
        .line(AFTER, &time, &after(2))
        .panel_below("carbody", "m/s²")
        .line(BEFORE, &time, &before(0))
        .line(AFTER, &time, &after(0))
}

fn damper_loop(place: &str, slot: usize, shown: &[Pair]) -> Plot {
    let of = |row: &Row| (row.extension_m[slot], row.force_n[slot]);
    let (stroke_before, before): (Vec<f64>, Vec<f64>) =
        shown.iter().map(|(row, _)| of(row)).unzip();
    let (stroke_after, after): (Vec<f64>, Vec<f64>) = shown.iter().map(|(_, row)| of(row)).unzip();
    Plot::new(&format!("Force over displacement before and after, {place}"))
        .x("displacement", "mm")
        .y("force", "kN")
        .line(BEFORE, &milli(&stroke_before), &kilo(&before))
        .line(AFTER, &milli(&stroke_after), &kilo(&after))
}

fn spectra(name: &str, [before, after]: &[Welch; 2]) -> Plot {
    let (before, after) = (spectrum(before), spectrum(after));
    Plot::new(&format!("Lateral acceleration of {name}, before and after"))
        .x("frequency", "Hz")
        .y("power spectral density", "(m/s²)²/Hz")
        .log_x()
        .log_y()
        .line(BEFORE, &before.0, &before.1)
        .line(AFTER, &after.0, &after.1)
}
