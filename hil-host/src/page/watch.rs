//! The residual of every watched rig.

use super::traces::line;
use crate::counts::Counts;
use crate::statistics::Traces;
use can_protocol::Watch;
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Cell, Plot, Section, Table};
use scenario::run::Run;

/// Measured less modelled force of every watched rig, from the start of the run.
pub(super) fn watch(run: &Run, counts: &Counts, traces: &Traces) -> Option<Section> {
    let mut section = Section::new("Watch over the rigs").text(
        "Force that a rig measured less the force of the model that the scenario names for it, \
         driven with the measured displacement. The usual residual is learnt first; drift is raised \
         where the running rms rises above the limit and cleared below two thirds of it.",
    );
    let mut table = Table::new("Residual")
        .text("damper")
        .number("rms, learnt", "N")
        .number("rms at the end", "N")
        .text("drift at the end")
        .number("drift first raised", "s")
        .number("cycles with drift", "");
    let mut any = false;
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let watched = &counts.watch[slot];
        if watched.verdict == Watch::None {
            continue;
        }
        any = true;
        table = table.row([
            Cell::from(place.place.as_str()),
            watched.learnt_rms_n.into(),
            watched.last_rms_n().into(),
            Cell::from(drift(watched.verdict)),
            watched.drift_since_s.into(),
            watched.drift_cycles.into(),
        ]);
        let (rms, limit) = (&traces.residual_rms[slot], &traces.residual_limit[slot]);
        let mut plot =
            Plot::new(&format!("Residual of {}", place.place)).x("time", "s").y("rms", "N");
        for (name, trace) in [("running rms", rms), ("limit", limit)] {
            if !trace.value.is_empty() {
                plot = line(plot, name, trace, 1.0);
            }
        }
        section = section.plot(plot);
        if let Some(since_s) = watched.drift_since_s {
            section = section.warning(&format!(
                "{}: the rig's damper has not behaved like its model since {since_s:.3} s, for {} \
                 cycles.",
                place.place, watched.drift_cycles
            ));
        }
    }
    any.then(|| section.table(table))
}

/// Whether a watch shows drift, in words.
const fn drift(verdict: Watch) -> &'static str {
    match verdict {
        Watch::None => "no watch",
        Watch::Learning => "still learning",
        Watch::Steady => "no",
        Watch::Drift => "yes",
    }
}
