//! How well every rig followed, and what its damper did against its model.

use super::traces::line;
use crate::statistics::{RigTraces, Statistics};
use crate::summary::{MeasuredDelay, Summary};
use report::{Cell, Plot, Section, Table};
use scenario::run::{Run, SlotForce};

/// The rigs of a run; none where there is no rig.
pub(super) fn rigs(run: &Run, summary: &Summary, statistics: &Statistics) -> Option<Section> {
    let mut section = Section::new("Rigs");
    let mut table = Table::new("Tracking of the command")
        .text("damper")
        .number("delay", "ms")
        .number("error rms", "mm")
        .number("NRMSE", "%")
        .number("error max", "mm")
        .number("force less model, rms", "N");
    let mut any = false;
    for (slot, place) in run.slots.iter().enumerate() {
        if !matches!(place.force, SlotForce::Rig { .. }) || statistics.shown.rows < 2 {
            continue;
        }
        any = true;
        let figures = &statistics.shown.slots[slot];
        let tracking = &figures.tracking;
        table = table.row([
            Cell::from(place.place.as_str()),
            (tracking.delay_s() * 1e3).into(),
            (tracking.rms_m() * 1e3).into(),
            (tracking.nrmse() * 1e2).into(),
            (tracking.most_m() * 1e3).into(),
            figures.residual.rms().into(),
        ]);
        let RigTraces { command_m, measured_m, error_m, measured_n, model_n } =
            &statistics.traces.rigs[slot];
        let stroke = Plot::new(&format!("Stroke of {}", place.place));
        let stroke = stroke.x("time", "s").y("displacement", "mm");
        let stroke = line(stroke, "command", command_m, 1e3);
        let stroke = line(stroke, "measured", measured_m, 1e3).panel_below("error", "mm");
        let stroke = line(stroke, "measured less command", error_m, 1e3);
        let force = Plot::new(&format!("Force of {} and of its model", place.place));
        let force = line(force.x("time", "s").y("force", "kN"), "measured", measured_n, 1e-3);
        section = section.plot(stroke).plot(line(force, "model", model_n, 1e-3));
    }
    let calibrated =
        |section: Section, line: &String| section.note(&format!("Calibration, {line}."));
    let section = summary.calibrations.iter().fold(section, calibrated);
    any.then(|| {
        let section = section.table(table).table(delay_table(summary));
        match stand_in_table(summary) {
            Some(table) => section.table(table),
            None => section,
        }
    })
}

/// Dampers for which another rig stood, and how exactly; none where each had its own.
fn stand_in_table(summary: &Summary) -> Option<Table> {
    let mut table = Table::new("Dampers for which another rig stood")
        .text("damper")
        .text("is")
        .text("force of the rig of")
        .text("sign")
        .number("until", "s")
        .number("difference of the strokes, rms", "mm")
        .number("of the stroke of the rig", "%")
        .number("force less own model, rms", "N");
    let mut any = false;
    for damper in &summary.damper {
        let Some(stand_in) = &damper.stand_in else { continue };
        any = true;
        table = table.row([
            Cell::from(damper.name.as_str()),
            damper.place.as_str().into(),
            stand_in.of.as_str().into(),
            if stand_in.is_reversed { "reversed" } else { "the same" }.into(),
            stand_in.until_s.into(),
            (stand_in.stroke_difference_rms_m * 1e3).into(),
            stand_in.stroke_difference_percent.into(),
            stand_in.force_less_model_rms_n.into(),
        ]);
    }
    any.then_some(table)
}

/// The delay of the force of every rig against the wanted motion, and what it costs.
fn delay_table(summary: &Summary) -> Table {
    let mut table = Table::new("Delay of the force")
        .text("damper")
        .text("measured")
        .number("delay", "ms")
        .number("± (95 %)", "ms")
        .number("blocks", "s")
        .number("damping lost", "%")
        .number("at most", "%")
        .number("NRMSE to the wanted motion", "%")
        .number("energy, wanted less measured", "%");
    for damper in &summary.damper {
        let Some(tracking) = &damper.tracking else { continue };
        let measured = [("before RUN", tracking.before_run), ("in RUN", tracking.delay)];
        for (when, delay) in measured {
            let Some(delay) = delay else { continue };
            let MeasuredDelay { mean_s, half_width_s, blocks, .. } = delay;
            let in_run = (when == "in RUN").then_some(tracking);
            table = table.row([
                Cell::from(damper.name.as_str()),
                when.into(),
                (mean_s * 1e3).into(),
                (half_width_s * 1e3).into(),
                f64::from(blocks).into(),
                delay.damping_lost_percent.into(),
                delay.damping_lost_at_most_percent.into(),
                in_run.and_then(|tracking| tracking.nrmse).map(|share| share * 1e2).into(),
                in_run
                    .and_then(|tracking| tracking.exchanged_energy_error)
                    .map(|share| share * 1e2)
                    .into(),
            ]);
        }
    }
    table
}
