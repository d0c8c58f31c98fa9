//! `yawbench faults`: faults injected into a coupled run in virtual time, and what became of each.

use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::print;
use crate::progress::{bar, show};
use crate::stop;
use clap::Args;
use hil_host::faults::{Expected, Injected, Row, schedule, table};
use report::{Cell, Table};
use scenario::run::{Overrides, Run};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct FaultsArgs {
    /// A scenario with a damper on a rig.
    #[arg(default_value = "scenarios/ss9-160kmh.toml")]
    scenario: PathBuf,
    /// Cycles of random faults after the table; none by default.
    #[arg(long, value_name = "N", default_value_t = 0)]
    cycles: u64,
    /// Seed of the random faults.
    #[arg(long, default_value_t = 1)]
    seed: u64,
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
    let mut holds = true;
    if args.cycles > 0 {
        let bar = bar("random faults");
        let survey = schedule(&run, args.seed, args.cycles, stop::flag(), &mut |done| {
            let thousands = [done.min(args.cycles) / 1000, args.cycles / 1000];
            show(&bar, thousands.map(|cycles| cycles as usize), "thousand cycles".to_owned());
        })?;
        bar.finish_and_clear();
        holds = survey.violations.is_empty();
        let violations = survey.violations.iter().filter_map(|(fault, injected)| {
            Some(format!("{fault:?} from cycle {}: {}", injected.begin, injected.violation?))
        });
        let mut lines = vec![format!(
            "{} cycles with {} random faults, seed {}: {} sessions went on, {} ramped out, {} \
             ended in the safe state, {} could not begin; {} violations",
            survey.cycles,
            survey.faults,
            args.seed,
            survey.went_on,
            survey.ramped_out,
            survey.safe,
            survey.refused,
            survey.violations.len()
        )];
        lines.extend(violations.take(20));
        print(&lines.join("\n"))?;
    }
    Ok(if all_right && holds { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
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
