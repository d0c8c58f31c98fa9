//! The tables of faults with an expected outcome: those of a run that they end, and those of a rig
//! without which it goes on.

use crate::error::CommandError;
use crate::output::print;
use hil_host::faults::{Injected, Row, drop_outs, table};
use report::{Cell, Table};
use scenario::run::Run;

/// Injects every fault of the table and prints what became of it; whether all is as expected.
pub(super) fn inject(run: &Run) -> Result<bool, CommandError> {
    let mut found = Found::default();
    let all_right = table(run, |row, injected, is_right| found.add(row, injected, is_right))?;
    found.print()?;
    Ok(all_right)
}

/// The same of the faults of one rig, where the vehicle may go on without it: one of three, and the
/// only one.
pub(super) fn drop_out(run: &Run) -> Result<bool, CommandError> {
    let mut all_right = true;
    let cases = [
        (2, "three rigs, if_rig_drops_out = \"model\", a fault of the first"),
        (0, "one rig, if_rig_drops_out = \"model\""),
    ];
    for (others, title) in cases {
        let mut found = Found::default();
        all_right &=
            drop_outs(run, others, |row, injected, is_right| found.add(row, injected, is_right))?;
        print(title)?;
        found.print()?;
    }
    Ok(all_right)
}

/// What was found, row by row.
#[derive(Default)]
struct Found {
    rows: Vec<[Cell; 8]>,
    violations: Vec<String>,
}

impl Found {
    fn add(&mut self, row: &Row, injected: &Injected, is_right: bool) {
        self.rows.push(cells(row, injected, is_right));
        if let Some(violation) = injected.violation {
            self.violations.push(format!("{} {}: {violation}", row.number, row.what));
        }
    }

    fn print(self) -> Result<(), CommandError> {
        let table = Table::new("")
            .number("row", "")
            .text("fault")
            .text("found")
            .number("detected after", "cycles")
            .number("at most", "cycles")
            .text("end")
            .text("rig")
            .text("as expected");
        let mut lines: Vec<String> = table.rows(self.rows).lines();
        lines.extend(self.violations);
        Ok(print(&lines.join("\n"))?)
    }
}

fn cells(row: &Row, injected: &Injected, is_right: bool) -> [Cell; 8] {
    let found = injected.found().map_or("nothing", |stop| stop.cause.signal.key());
    let within = row.expected.within().map_or(Cell::Empty, Cell::from);
    let goes_on = if injected.dropped_out.is_some() { "goes on, dropped out" } else { "goes on" };
    [
        u64::from(row.number).into(),
        row.what.into(),
        found.into(),
        injected.cycles_to_detect().map_or(Cell::Empty, Cell::from),
        within,
        injected.end.map_or(goes_on, |end| end.name()).into(),
        injected.rig.name().into(),
        if is_right { "yes" } else { "NO" }.into(),
    ]
}
