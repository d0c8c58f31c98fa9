//! Time histories and loops: accelerations, damper forces, force over stroke and velocity.

use super::traces::{kilo, milli, most_in};
use crate::columns::Columns;
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Plot, Section};
use scenario::run::{CYCLE_S, Run};

/// Up to this length a whole trace is drawn with an enlarged part (s).
const ZOOM_S: f64 = 2.0;

pub(super) fn accelerations(columns: &Columns, first: usize) -> Section {
    let time = &columns.time_s[first..];
    let trace = |index: usize| &columns.acceleration[index][first..];
    let section = Section::new("Accelerations");
    let plot = |title: &str, offset: usize| {
        Plot::new(title)
            .x("time", "s")
            .y("wheelset 1", "m/s²")
            .line("wheelset 1", time, trace(4 + offset))
            .panel_below("bogie, front", "m/s²")
            .line("bogie, front", time, trace(2 + offset))
            .panel_below("carbody", "m/s²")
            .line("carbody", time, trace(offset))
    };
    section
        .plot(plot("Lateral acceleration of wheelset, bogie and carbody", 0))
        .plot(plot("Vertical acceleration of wheelset, bogie and carbody", 1))
}

pub(super) fn forces(run: &Run, columns: &Columns, first: usize) -> Section {
    let time = &columns.time_s[first..];
    let mut section = Section::new("Damper forces");
    // Left and right of a bogie together: one pushes while the other drags.
    for pair in run.slots.chunks(2).enumerate() {
        let (number, slots) = pair;
        let mut plot =
            Plot::new(&format!("Force of {}", names(slots))).x("time", "s").y("force", "kN");
        for (side, slot) in slots.iter().enumerate() {
            let force = kilo(&columns.force_n[2 * number + side][first..]);
            plot = plot.line(&slot.place, time, &force);
        }
        if let Some((from, to)) = liveliest(&columns.force_n[2 * number][first..], time) {
            plot = plot.zoom("Enlarged: the dead zone at every reversal", from..=to);
        }
        section = section.plot(plot);
    }
    section
}

fn names(slots: &[scenario::run::Slot]) -> String {
    slots.iter().map(|slot| slot.place.as_str()).collect::<Vec<_>>().join(" and ")
}

/// The window of [`ZOOM_S`] with the most work in it.
fn liveliest(force: &[f64], time: &[f64]) -> Option<(f64, f64)> {
    let from = *time.get(most_in(force, (ZOOM_S / CYCLE_S) as usize)?)?;
    Some((from, from + ZOOM_S))
}

pub(super) fn loops(run: &Run, columns: &Columns, first: usize) -> Section {
    let mut section = Section::new("Loops");
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let force = kilo(&columns.force_n[slot][first..]);
        let stroke = milli(&columns.extension_m[slot][first..]);
        let rate = milli(&columns.rate_m_per_s[slot][first..]);
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
