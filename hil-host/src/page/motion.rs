//! Time histories and loops: accelerations, damper forces, force over stroke and velocity.

use super::traces::{kilo, line, milli};
use crate::statistics::Traces;
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Plot, Section};
use scenario::run::Run;

pub(super) fn accelerations(traces: &Traces) -> Section {
    let plot = |title: &str, offset: usize| {
        let trace = |plot: Plot, name: &str, index: usize| {
            line(plot, name, &traces.acceleration[index], 1.0)
        };
        let plot = Plot::new(title).x("time", "s").y("wheelset 1", "m/s²");
        let plot = trace(plot, "wheelset 1", 4 + offset).panel_below("bogie, front", "m/s²");
        let plot = trace(plot, "bogie, front", 2 + offset).panel_below("carbody", "m/s²");
        trace(plot, "carbody", offset)
    };
    Section::new("Accelerations")
        .plot(plot("Lateral acceleration of wheelset, bogie and carbody", 0))
        .plot(plot("Vertical acceleration of wheelset, bogie and carbody", 1))
}

pub(super) fn forces(run: &Run, traces: &Traces) -> Section {
    let mut section = Section::new("Damper forces");
    // Left and right of a bogie together: one pushes while the other drags.
    for (number, slots) in run.slots.chunks(2).enumerate() {
        let mut plot =
            Plot::new(&format!("Force of {}", names(slots))).x("time", "s").y("force", "kN");
        for (side, slot) in slots.iter().enumerate() {
            plot = line(plot, &slot.place, &traces.force[2 * number + side], 1e-3);
        }
        if let Some(zoom) = &traces.zoom[2 * number] {
            plot = plot.zoom("Enlarged: the dead zone at every reversal", zoom.clone());
        }
        section = section.plot(plot);
    }
    section
}

fn names(slots: &[scenario::run::Slot]) -> String {
    slots.iter().map(|slot| slot.place.as_str()).collect::<Vec<_>>().join(" and ")
}

pub(super) fn loops(run: &Run, traces: &Traces) -> Section {
    let mut section = Section::new("Loops");
    if let Some(from_s) = traces.loops_from_s {
        section = section.text(&format!(
            "A minute from {from_s:.1} s on, where the force of the first damper does most."
        ));
    }
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let drawn = &traces.loops[slot];
        let force = kilo(&drawn.force_n);
        let stroke = milli(&drawn.extension_m);
        let rate = milli(&drawn.rate_m_per_s);
        section = section.plots([
            Plot::new(&format!("Force over displacement, {}", place.place))
                .x("displacement", "mm")
                .y("force", "kN")
                .line(&place.place, &stroke, &force),
            Plot::new(&format!("Force over velocity, {}", place.place))
                .x("velocity", "mm/s")
                .y("force", "kN")
                .line(&place.place, &rate, &force),
        ]);
    }
    section
}
