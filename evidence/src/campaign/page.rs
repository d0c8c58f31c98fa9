//! The merged table as text, what is worst on top.

use super::table::{Row, Table};
use super::wilson::Rate;
use std::fmt::Write;

/// Rows that open the page.
const WORST: usize = 12;

/// The table for people.
pub fn text(table: &Table) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write(&mut out, table);
    out
}

fn write(out: &mut String, table: &Table) -> std::fmt::Result {
    let brief = if table.brief { "brief " } else { "" };
    writeln!(out, "{} {brief}cases of seed {}", table.cases, table.seed)?;
    let bad: Vec<&Row> = table
        .rows
        .iter()
        .filter(|row| !row.wrong.is_empty() && !(0.1..3.0).contains(&row.size))
        .take(WORST)
        .collect();
    if !bad.is_empty() {
        writeln!(out, "\nworst at")?;
        for row in bad {
            let cases = list(&row.wrong);
            writeln!(out, "  {:<48}{}  cases {cases}", label(row), rate(&row.right))?;
        }
    }
    for (index, why) in &table.failures {
        writeln!(out, "  case {index} gave no identification: {why}")?;
    }
    writeln!(out, "\n{:<72}{:<36}target", "aim", "rate, 95 % interval")?;
    for aim in &table.aims {
        let met = match (aim.met, aim.open) {
            (None, _) => "no case",
            (Some(true), false) => "met",
            (Some(true), true) => "met, by few cases",
            (Some(false), false) => "missed",
            (Some(false), true) => "missed, by few cases",
        };
        let target = match aim.target {
            (least, 1.0) => format!("{:.0} %", 100.0 * least),
            (least, most) => format!("{:.0} to {:.0} %", 100.0 * least, 100.0 * most),
        };
        writeln!(out, "{:<72}{:<36}{target:<12}{met}", aim.what, rate(&aim.rate))?;
    }
    writeln!(out, "\n{:<48}{:<36}{:>11}{:>14}", "truth", "right", "not reached", "over truth")?;
    for row in &table.rows {
        let over = row.over_truth.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
        writeln!(
            out,
            "{:<48}{:<36}{:>11}{over:>14}  {}",
            label(row),
            rate(&row.right),
            row.not_reached,
            list(&row.wrong)
        )?;
    }
    writeln!(out, "\ntruth (3 times the noise and more): what was named first")?;
    for (truth, said) in &table.confusion {
        let said: Vec<String> =
            said.iter().map(|(name, count)| format!("{name} {count}")).collect();
        writeln!(out, "  {truth:<30}{}", said.join(", "))?;
    }
    if !table.groups.is_empty() {
        writeln!(out, "\ngroups that records could not tell apart")?;
        for (group, count) in &table.groups {
            writeln!(out, "  {count:>4}  {group}")?;
        }
    }
    writeln!(out, "\n{:<48}its 95 % interval holds the truth", "parameter")?;
    for (parameter, covered) in &table.coverage {
        writeln!(out, "{parameter:<48}{}", rate(covered))?;
    }
    writeln!(
        out,
        "\n{:<20}{:>7}{:>12}{:>12}{:>14}{:>14}   medians; errors held out over the floor found",
        "kind", "cases", "before", "after", "true damper", "floor/noise"
    )?;
    for row in &table.medians {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.3}"));
        writeln!(
            out,
            "{:<20}{:>7}{:>12}{:>12}{:>14}{:>14}",
            row.kind,
            row.cases,
            number(row.before),
            number(row.after),
            number(row.truth),
            number(row.floor)
        )?;
    }
    writeln!(
        out,
        "\nEffects of the catalogue come from the damper of the core that also fits them (at 100 µs): \
         their rates are upper bounds. Nothing missing and outside: an integration of its own."
    )
}

fn label(row: &Row) -> String {
    if row.size > 0.0 {
        format!("{} {} x{}", row.kind, row.truth, row.size)
    } else {
        format!("{} {}", row.kind, row.truth)
    }
}

fn rate(rate: &Rate) -> String {
    match rate.rate {
        None => "no case".to_owned(),
        Some(value) => format!(
            "{}/{} {:.1} % ({:.1} to {:.1})",
            rate.count,
            rate.of,
            100.0 * value,
            100.0 * rate.lower,
            100.0 * rate.upper
        ),
    }
}

fn list(cases: &[usize]) -> String {
    cases.iter().map(|case| format!("#{case}")).collect::<Vec<_>>().join(" ")
}
