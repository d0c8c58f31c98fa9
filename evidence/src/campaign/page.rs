//! The merged table as text, what is worst on top.

use super::aims::Aim;
use super::line::CaseResult;
use super::table::{Grid, Row, Table};
use super::wilson::Rate;
use report::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Rows that open the page.
const WORST: usize = 12;

/// The table for people.
pub fn text(table: &Table) -> String {
    let brief = if table.brief { "brief " } else { "" };
    let mut out = format!("{} {brief}cases of seed {}\n", table.cases, table.seed);
    for (index, why) in &table.failures {
        let _ = writeln!(out, "  case {index} gave no identification: {why}");
    }
    let parts = [
        worst(table),
        Some(aims(&table.aims)),
        Some(grid("Right, by motion and kind of truth", "motion", &table.by_motion)),
        Some(grid("Right, by noise and kind of truth", "noise", &table.by_noise)),
        Some(grid("Known noise floor within 30 %, by motion and noise", "motion", &table.floors)),
        listed("Named model worse than the refit on the third set", &worse(table)),
        listed("Rivals that the next test did not separate", &not_separated(table)),
        Some(rows("Every truth at every size", table.rows.iter())),
        Some(confusion(table)),
        groups(table),
        Some(coverage(table)),
        Some(medians(table)),
    ];
    for part in parts.into_iter().flatten() {
        let _ = write!(out, "\n{part}");
    }
    out.push_str(
        "\nBounds are one-sided, 95 % each (Wilson). Effects of the catalogue come from the damper \
         of the core that also\nfits them (at 100 µs): their rates are upper bounds. All other \
         specimens have an integration of their own.\n",
    );
    out
}

/// Seconds per case, by kind of truth and by motion. They are no part of the table: the same cases
/// give the same bytes.
pub fn times(lines: &[CaseResult]) -> String {
    let columns = report::Table::new("Mean seconds per case")
        .text("")
        .number("cases", "")
        .fixed("size", "s", 1)
        .fixed("identify", "s", 1)
        .fixed("next test", "s", 1)
        .fixed("all, longest", "s", 1);
    let mut by: BTreeMap<&str, Vec<&CaseResult>> = BTreeMap::new();
    for line in lines {
        for level in [line.kind.as_str(), line.motion.as_str(), "all"] {
            by.entry(level).or_default().push(line);
        }
    }
    let rows = by.into_iter().map(|(level, lines)| {
        let mean = |of: &dyn Fn(&CaseResult) -> f64| {
            lines.iter().map(|line| of(line)).sum::<f64>() / lines.len() as f64
        };
        let whole = |line: &CaseResult| line.sizing_seconds + line.seconds + line.next_test_seconds;
        [
            Cell::from(level),
            Cell::Count(lines.len() as u64),
            mean(&|line| line.sizing_seconds).into(),
            mean(&|line| line.seconds).into(),
            mean(&|line| line.next_test_seconds).into(),
            lines.iter().map(|line| whole(line)).fold(0.0, f64::max).into(),
        ]
    });
    columns.rows(rows).to_text()
}

fn worst(table: &Table) -> Option<String> {
    let bad = |row: &&Row| !row.wrong.is_empty() && !(0.1..3.0).contains(&row.size);
    let bad: Vec<&Row> = table.rows.iter().filter(bad).take(WORST).collect();
    (!bad.is_empty()).then(|| rows("Worst at", bad.into_iter()))
}

fn aims(aims: &[Aim]) -> String {
    let columns = report::Table::new("Targets")
        .text("what")
        .written("cases", "")
        .fixed("rate", "%", 1)
        .fixed("from", "%", 1)
        .fixed("to", "%", 1)
        .number("no vote", "")
        .written("target", "%")
        .text("");
    let row = |aim: &Aim| {
        let met = match (aim.met, aim.shown) {
            (None, _) => "",
            (Some(true), true) => "met, bound included",
            (Some(true), false) => "met",
            (Some(false), _) => "missed",
        };
        let target = match aim.target {
            None => Cell::Empty,
            Some((least, 1.0)) => format!("{:.0}", 100.0 * least).into(),
            Some((least, most)) => format!("{:.0} to {:.0}", 100.0 * least, 100.0 * most).into(),
        };
        let Rate { lower, upper, rate, .. } = aim.rate;
        let percent = |value: f64| rate.map(|_| 100.0 * value);
        [
            Cell::from(aim.what.as_str()),
            counted(&aim.rate),
            rate.map(|rate| 100.0 * rate).into(),
            percent(lower).into(),
            percent(upper).into(),
            Cell::Count(aim.not_voting as u64),
            target,
            met.into(),
        ]
    };
    columns.rows(aims.iter().map(row)).to_text()
}

fn grid(caption: &str, head: &str, grid: &Grid) -> String {
    let names: BTreeSet<&String> = grid.values().flat_map(|row| row.keys()).collect();
    let columns = names
        .iter()
        .fold(report::Table::new(caption).text(head), |columns, name| columns.written(name, ""));
    let row = |(level, rates): (&String, &BTreeMap<String, Rate>)| {
        let cells = names.iter().map(|name| rates.get(*name).map_or(Cell::Empty, counted));
        let cells: Vec<Cell> = std::iter::once(Cell::from(level.as_str())).chain(cells).collect();
        cells
    };
    columns.rows(grid.iter().map(row)).to_text()
}

fn rows<'a>(caption: &str, rows: impl Iterator<Item = &'a Row>) -> String {
    let columns = report::Table::new(caption)
        .text("kind")
        .text("truth")
        .number("size", "")
        .written("right", "")
        .fixed("rate", "%", 1)
        .fixed("from", "%", 1)
        .number("not reached", "")
        .fixed("their size", "", 2)
        .fixed("over truth", "", 3)
        .text("wrong");
    let row = |row: &Row| {
        [
            Cell::from(row.kind.as_str()),
            row.truth.as_str().into(),
            (row.size > 0.0).then_some(row.size).into(),
            counted(&row.right),
            row.right.rate.map(|rate| 100.0 * rate).into(),
            row.right.rate.map(|_| 100.0 * row.right.lower).into(),
            Cell::Count(row.not_reached as u64),
            row.size_not_reached.into(),
            row.over_truth.into(),
            list(&row.wrong).into(),
        ]
    };
    columns.rows(rows.map(row)).to_text()
}

fn confusion(table: &Table) -> String {
    let caption = "What was named first (3 times the noise and more)";
    let columns = report::Table::new(caption).text("truth").text("named");
    let rows = table.confusion.iter().map(|(truth, said)| {
        let said: Vec<String> =
            said.iter().map(|(name, count)| format!("{name} {count}")).collect();
        [Cell::from(truth.as_str()), said.join(", ").into()]
    });
    columns.rows(rows).to_text()
}

fn groups(table: &Table) -> Option<String> {
    let columns = report::Table::new("Groups that records could not tell apart");
    let columns = columns.number("cases", "").text("group");
    let rows = table
        .groups
        .iter()
        .map(|(group, count)| [Cell::Count(*count as u64), group.as_str().into()]);
    (!table.groups.is_empty()).then(|| columns.rows(rows).to_text())
}

fn coverage(table: &Table) -> String {
    let columns = report::Table::new("Stated 95 % intervals that hold the truth")
        .text("parameter")
        .written("cases", "")
        .fixed("rate", "%", 1);
    let rows = table.coverage.iter().map(|(parameter, covered)| {
        let rate = covered.rate.map(|rate| 100.0 * rate);
        [Cell::from(parameter.as_str()), counted(covered), rate.into()]
    });
    columns.rows(rows).to_text()
}

fn medians(table: &Table) -> String {
    let columns = report::Table::new("Median errors on the third set, over the noise")
        .text("kind")
        .number("cases", "")
        .fixed("refit", "", 3)
        .fixed("with effects", "", 3)
        .fixed("true damper", "", 3)
        .fixed("floor found", "", 3);
    let rows = table.medians.iter().map(|row| {
        [
            Cell::from(row.kind.as_str()),
            Cell::Count(row.cases as u64),
            row.before.into(),
            row.after.into(),
            row.truth.into(),
            row.floor.into(),
        ]
    });
    columns.rows(rows).to_text()
}

fn worse(table: &Table) -> Vec<String> {
    let of = |(index, ratio): &(usize, f64)| format!("#{index} {ratio:.3} times");
    table.worse_than_refit.iter().map(of).collect()
}

fn not_separated(table: &Table) -> Vec<String> {
    table.not_separated.iter().map(|(index, what)| format!("#{index} {what}")).collect()
}

fn listed(caption: &str, lines: &[String]) -> Option<String> {
    let text = [&[caption.to_owned()], lines].concat().join("\n  ");
    (!lines.is_empty()).then(|| format!("{text}\n"))
}

fn counted(rate: &Rate) -> Cell {
    format!("{}/{}", rate.count, rate.of).into()
}

fn list(cases: &[usize]) -> String {
    cases.iter().map(|case| format!("#{case}")).collect::<Vec<_>>().join(" ")
}
