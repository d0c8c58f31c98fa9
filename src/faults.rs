//! `yawbench faults`: faults injected into a coupled run in virtual time, and what became of each.

use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::print;
use clap::Args;
use hil_host::faults::{Expected, Injected, Row, table};
use report::{Cell, Table};
use scenario::run::{Overrides, Run};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct FaultsArgs {
    /// A scenario with a damper on a rig.
    #[arg(default_value = "scenarios/ss9-160kmh.toml")]
    scenario: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// A scenario that cannot be read or has no rig.
pub(crate) fn command(args: &FaultsArgs) -> Result<ExitCode, CommandError> {
    let overrides = Overrides { duration_s: Some(10.0), speed_kmh: None };
    let run = Run::load(&args.scenario, overrides)?;
    let mut rows = Vec::new();
    let mut violations = Vec::new();
    let all_right = table(&run, |row, injected, is_right| {
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
    Ok(if all_right { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

fn cells(row: &Row, injected: &Injected, is_right: bool) -> [Cell; 8] {
    let found = injected.stop.map_or("nothing", |stop| stop.cause.signal.key());
    let within = match row.expected {
        Expected::GoesOn => Cell::Empty,
        Expected::Ends(_, within, _) => within.into(),
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
