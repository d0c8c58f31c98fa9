//! What happened in a run.

use crate::summary::Summary;
use report::{Cell, Section, Table};

/// Events that are shown.
const SHOWN: usize = 200;

/// The events of a run, and every counter that is not zero; none where there is neither.
pub(super) fn events(summary: &Summary) -> Option<Section> {
    let events = &summary.events;
    let counters = [summary.counters(), summary.rounded_commands()].concat();
    let mut section = Section::new("Events");
    if !counters.is_empty() {
        section = section.text(&format!("Counted: {}.", counters.join(", ")));
    }
    if events.is_empty() {
        return (!counters.is_empty()).then_some(section);
    }
    if events.len() > SHOWN {
        section = section.text(&format!("The first {SHOWN} events; events.jsonl has all of them."));
    }
    let mut table = Table::new("Events")
        .number_with_digits("time", "s", 6)
        .number("cycle", "")
        .text("event")
        .text("damper or node")
        .number("value", "")
        .number("limit", "");
    for event in events.iter().take(SHOWN) {
        let place = match (event.slot, event.node) {
            (Some(slot), _) => format!("damper {slot}"),
            (None, Some(node)) => format!("node {node}"),
            (None, None) => String::new(),
        };
        table = table.row([
            event.time_s.into(),
            event.cycle.into(),
            Cell::from(&*event.what),
            Cell::from(place),
            event.value.into(),
            event.limit.into(),
        ]);
    }
    Some(section.table(table))
}
