//! The last second before a stop: what a person wants to see first of a run that was stopped.

use super::traces::{kilo, milli};
use crate::record::Row;
use crate::summary::Summary;
use report::{Plot, Section};
use scenario::run::{Run, SlotForce};

/// Time that is shown before a stop, and behind it (ms).
pub(crate) const SHOWN_MS: (u64, u64) = (1000, 100);

/// The rows around the stop: of every rig command, measured displacement, both forces and age; of a
/// run without a rig the motion of the leading wheelset and the damper forces.
pub(super) fn last_second(run: &Run, summary: &Summary, rows: &[Row]) -> Option<Section> {
    let cause = summary.cause.as_ref().filter(|_| rows.len() > 1)?;
    let time: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let of = |value: &dyn Fn(&Row) -> f64| -> Vec<f64> { rows.iter().map(value).collect() };
    let mut section = Section::new("The last second")
        .text(&format!("The run was stopped {}. The line marks that cycle.", cause.message));
    let mut has_rig = false;
    for (slot, place) in run.slots.iter().enumerate() {
        if !matches!(place.force, SlotForce::Rig { .. }) {
            continue;
        }
        has_rig = true;
        let mut plot = Plot::new(&format!("Around the stop, {}", place.place))
            .x("time", "s")
            .y("displacement", "mm")
            .line("command", &time, &milli(&of(&|row| row.command_m[slot])))
            .line("measured", &time, &milli(&of(&|row| row.measured_m[slot])))
            .at("stop", cause.time_s)
            .panel_below("force", "kN")
            .line("measured", &time, &kilo(&of(&|row| row.measured_n[slot])))
            .line("model", &time, &kilo(&of(&|row| row.model_n[slot])))
            .line("on the vehicle", &time, &kilo(&of(&|row| row.force_n[slot])));
        plot = plot.at("stop", cause.time_s);
        if let (Some(limit), "N") = (cause.limit, cause.unit.as_deref().unwrap_or("")) {
            plot = plot.limit("limit", limit * 1e-3).limit("limit", -limit * 1e-3);
        }
        let age = of(&|row| match row.age_cycles[slot] {
            u8::MAX => f64::NAN,
            age => f64::from(age),
        });
        section = section.plot(
            plot.panel_below("age", "cycles")
                .line("age of the measurement", &time, &age)
                .at("stop", cause.time_s),
        );
    }
    if !has_rig {
        let wheelset = milli(&of(&|row| row.wheelset_lateral_m[0]));
        let mut plot = Plot::new("Around the stop")
            .x("time", "s")
            .y("wheelset 1", "mm")
            .line("lateral position of wheelset 1", &time, &wheelset)
            .at("stop", cause.time_s)
            .panel_below("force", "kN");
        for (slot, place) in run.slots.iter().enumerate() {
            plot = plot.line(&place.place, &time, &kilo(&of(&|row| row.force_n[slot])));
        }
        section = section.plot(plot.at("stop", cause.time_s));
    }
    Some(section)
}
