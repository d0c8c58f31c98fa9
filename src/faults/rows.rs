//! The table of faults with an expected outcome.

use crate::error::CommandError;
use crate::output::print;
use hil_host::faults::{Expected, Injected, Row, table};
use report::{Cell, Table};
use scenario::run::Run;

/// Injects every fault of the table and prints what became of it; whether all is as expected.
pub(super) fn inject(run: &Run) -> Result<bool, CommandError> {
    let mut rows = Vec::new();
    let mut violations = Vec::new();
    let all_right = table(run, |row, injected, is_right| {
        rows.push(cells(row, injected, is_right));
        if let Some(violation) = injected.violation {
            violations.push(format!("{} {}: {violation}", row.number, row.what));
        }
    })?;
    let table = Table::new("")
        .number("row", "")
        .text("fault")
        .text("found")
        .number("detected after", "cycles")
        .number("at most", "cycles")
        .text("end")
        .text("rig")
        .text("as expected");
    let mut lines: Vec<String> = table.rows(rows).lines();
    lines.extend(violations);
    print(&lines.join("\n"))?;
    Ok(all_right)
}

fn cells(row: &Row, injected: &Injected, is_right: bool) -> [Cell; 8] {
    let found = injected.stop.map_or("nothing", |stop| stop.cause.signal.key());
    let within = match row.expected {
        Expected::GoesOn => Cell::Empty,
        Expected::Ends(_, within) => within.into(),
    };
    [
        u64::from(row.number).into(),
        row.what.into(),
        found.into(),
        injected.cycles_to_detect().map_or(Cell::Empty, Cell::from),
        within,
        injected.end.map_or("goes on", |end| end.name()).into(),
        injected.rig.name().into(),
        if is_right { "yes" } else { "NO" }.into(),
    ]
}
