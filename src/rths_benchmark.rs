//! `yawbench rths-benchmark`: the virtual benchmark of real-time hybrid simulation, with its own
//! controller and with our compensators; or, with `--yaw-damper`, our reference problem.

use crate::error::CommandError;
use crate::exit::{FAILED, INTERRUPTED};
use crate::output::print;
use crate::progress::{bar, show};
use crate::stop;
use crate::yaw_damper::{self, YawDamperArgs};
use clap::Args;
use files::number;
use report::{Cell, Table};
use rths::published::{TABLE_3, TOLERANCE};
use rths::{
    Benchmark, Criteria, NAMES, NOISE_SEEDS, Outside, PLANTS, Record, RthsError, Statistics,
};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(crate) struct RthsBenchmarkArgs {
    /// The acceleration of the ground as CSV, `time_s,ground_acceleration_m_per_s2`; a synthetic
    /// record by default. The published table is of El Centro, 1940.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Seed of the noise, of the perturbed plants and of the synthetic record.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the numbers as JSON.
    #[arg(long)]
    json: bool,
    /// Our reference problem instead: a locomotive with its yaw dampers on emulated rigs.
    #[arg(long, conflicts_with = "record")]
    yaw_damper: bool,
    #[command(flatten)]
    of_yaw_damper: YawDamperArgs,
}

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Printed<'a> {
    record: Option<String>,
    criteria: [&'static str; 9],
    /// Criteria outside of their tolerance, where the published table is of this record.
    outside: Option<Vec<Outside>>,
    #[serde(flatten)]
    benchmark: &'a Benchmark,
}

/// Runs the command.
///
/// # Errors
/// A record that cannot be read or is none.
pub(crate) fn command(args: &RthsBenchmarkArgs) -> Result<ExitCode, CommandError> {
    if args.yaw_damper {
        return yaw_damper::command(&args.of_yaw_damper, args.seed, args.json);
    }
    let record = match &args.record {
        Some(file) => Record::read(file)?,
        None => Record::synthetic(args.seed, rths::SYNTHETIC_DURATION_S),
    };
    let progress = bar("runs of the benchmark");
    let done = |done: usize, of: usize| show(&progress, [done, of], "runs".to_owned());
    let found = rths::run(&record, args.seed, stop::flag(), &done);
    progress.finish_and_clear();
    let found = match found {
        Err(RthsError::Stopped) => return Ok(ExitCode::from(INTERRUPTED)),
        found => found?,
    };
    let outside = found.outside();
    let is_other = outside.as_ref().is_some_and(|outside| !outside.is_empty());
    if args.json {
        let record = args.record.as_ref().map(|file| file.display().to_string());
        let printed = Printed { record, criteria: NAMES, outside, benchmark: &found };
        print(&serde_json::to_string_pretty(&printed)?)?;
    } else {
        print(&text(args, &found, outside.as_deref()).join("\n"))?;
    }
    Ok(if is_other { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

/// The tables.
fn text(args: &RthsBenchmarkArgs, found: &Benchmark, outside: Option<&[Outside]>) -> Vec<String> {
    let record = args.record.as_ref().map(|file| file.display().to_string());
    let mut lines = vec![format!(
        "Record: {}, {} s, peak {} m/s2. Seed {}.",
        record.as_ref().map_or("synthetic".to_owned(), |file| files::quoted(file).to_string()),
        number(found.duration_s),
        number(found.peak_m_per_s2),
        found.seed
    )];
    let heading = |lines: &mut Vec<String>, text: String| lines.extend([String::new(), text]);
    heading(&mut lines, format!("PI + lead, mean over {NOISE_SEEDS} realisations of the noise"));
    lines.extend(baseline(found).lines());
    match outside {
        Some([]) => {
            lines.push("The published table is reproduced within its tolerances.".to_owned());
        }
        Some(outside) => lines.extend(outside.iter().map(not_reproduced)),
        None => lines.push(
            "The published table is of El Centro, 1940 (41.18 s, peak 3.135 m/s2): no comparison."
                .to_owned(),
        ),
    }
    heading(&mut lines, "Compensators, nominal plant".to_owned());
    lines.extend(nominal(found).lines());
    heading(&mut lines, format!("{PLANTS} perturbed plants, case 1"));
    lines.extend(perturbed(found).lines());
    heading(&mut lines, "Unknown delay in addition, case 1".to_owned());
    lines.extend(extra_delay(found).lines());
    heading(&mut lines, "Aims of the adaptive compensator".to_owned());
    for aim in &found.aims {
        let is_met = if aim.is_met { "met" } else { "MISSED" };
        let [found, most] = [aim.found_percent, aim.most_percent];
        lines.push(format!("{}: {found:.2} %, at most {most} %: {is_met}", aim.what));
    }
    lines
}

/// A criterion outside of its tolerance, in a line.
fn not_reproduced(outside: &Outside) -> String {
    let Outside { case, number, difference, most, deviation } = outside;
    format!(
        "NOT reproduced: J{number} of case {case} differs by {difference:.2}, at most {most:.2}; \
         one realisation of the noise has a sigma of {deviation:.2}, and the published value is one"
    )
}

/// The columns of the criteria.
fn with_criteria(table: Table) -> Table {
    NAMES.into_iter().fold(table, |table, name| {
        let (name, unit) = name.split_once(", ").unwrap_or((name, ""));
        table.fixed(name, unit, 2)
    })
}

/// The criteria as cells.
fn cells(criteria: Criteria) -> impl Iterator<Item = Cell> {
    criteria.0.into_iter().map(Cell::from)
}

/// What is wrong with a run.
fn remark(is_saturated: bool, has_run_away: bool) -> Cell {
    match (is_saturated, has_run_away) {
        (true, true) => "unstable; fell back".into(),
        (true, false) => "unstable".into(),
        (false, true) => "fell back".into(),
        (false, false) => "".into(),
    }
}

fn baseline(found: &Benchmark) -> Table {
    let mut rows = Vec::new();
    for (row, published) in found.baseline.iter().zip(TABLE_3) {
        let case = || Cell::from(u64::from(row.case));
        let line = |what: &str, criteria| {
            [case(), what.into()].into_iter().chain(cells(criteria)).collect::<Vec<Cell>>()
        };
        if let Some(difference) = row.difference {
            rows.push(line("published", published));
            rows.push(line("computed", row.mean));
            rows.push(line("difference", difference));
        } else {
            rows.push(line("computed", row.mean));
        }
        rows.push(line("of one realisation, sigma", row.deviation));
    }
    if found.outside().is_some() {
        let most = [Cell::Empty, "difference, at most".into()].into_iter();
        rows.push(most.chain(cells(TOLERANCE)).collect());
    }
    with_criteria(Table::new("").number("case", "").text("")).rows(rows)
}

fn nominal(found: &Benchmark) -> Table {
    let table = with_criteria(Table::new("").text("compensator").number("case", ""));
    let table = table.fixed("J2 without noise", "%", 2).text("remark");
    table.rows(found.nominal.iter().map(|row| {
        let first = [row.compensator.into(), u64::from(row.case).into()];
        let remark = remark(row.is_saturated, row.has_run_away);
        let last = [row.j2_without_noise_percent.into(), remark];
        first.into_iter().chain(cells(row.criteria)).chain(last).collect::<Vec<_>>()
    }))
}

fn perturbed(found: &Benchmark) -> Table {
    let statistics = |table: Table, name: &str| {
        ["mean", "max", "sigma"]
            .iter()
            .fold(table, |table, what| table.fixed(&format!("{name} {what}"), "%", 2))
    };
    let table = statistics(statistics(Table::new("").text("controller"), "J2"), "J4");
    let table = table.number("unstable", "").number("fell back", "");
    let of = |statistics: Statistics| [statistics.mean, statistics.max, statistics.sigma];
    table.rows(found.perturbed.iter().map(|row| {
        let numbers = of(row.j2_percent).into_iter().chain(of(row.j4_percent)).map(Cell::from);
        let counts = [row.saturated.into(), row.run_away.into()];
        [row.controller.into()].into_iter().chain(numbers).chain(counts).collect::<Vec<_>>()
    }))
}

fn extra_delay(found: &Benchmark) -> Table {
    let table = Table::new("").text("controller").fixed("delay", "ms", 2);
    with_criteria(table).text("remark").rows(found.extra_delay.iter().map(|row| {
        let first = [row.controller.into(), (row.delay_s * 1e3).into()];
        let last = [remark(row.is_saturated, row.has_run_away)];
        first.into_iter().chain(cells(row.criteria)).chain(last).collect::<Vec<_>>()
    }))
}
