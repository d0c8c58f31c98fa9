//! How well every rig followed, and what its damper did against its model.

use super::traces::line;
use crate::statistics::{RigTraces, Statistics};
use report::{Cell, Plot, Section, Table};
use scenario::run::{Run, SlotForce};

/// The rigs of a run; none where there is no rig.
pub(super) fn rigs(run: &Run, statistics: &Statistics) -> Option<Section> {
    let mut section = Section::new("Rigs");
    let mut table = Table::new("Tracking")
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
    any.then(|| section.table(table))
}
