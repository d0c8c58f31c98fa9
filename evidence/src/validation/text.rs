//! The comparisons as tables for a terminal.

use super::Reference;
use super::check::Check;
use report::{Cell, Table, significant};

/// For every reference a table with a row per quantity (how many comparisons, the tightest); then
/// what misses.
pub fn text(references: &[Reference]) -> String {
    let mut lines = Vec::new();
    for reference in references {
        lines.push(format!("{} - {}", reference.verdict(), reference.title));
        lines.extend(table(reference.title, reference.tightest()).lines());
        lines.push(String::new());
    }
    let before = lines.len();
    lines.extend(misses(references).map(|miss| format!("MISS {miss}")));
    if lines.len() == before {
        let checks: usize = references.iter().map(|reference| reference.checks.len()).sum();
        let count = references.len();
        lines.push(format!("all {checks} comparisons of {count} references pass"));
    }
    lines.join("\n")
}

/// A row for each of some comparisons, each with the number of those that it stands for.
pub(super) fn table(caption: &str, checks: Vec<(&Check, usize)>) -> Table {
    let table = Table::new(caption)
        .text("quantity")
        .number("comparisons", "")
        .text("at")
        .number_with_digits("ours", "", 7)
        .number_with_digits("known", "", 7)
        .text("allowed")
        .text("unit")
        .number_with_digits("used", "%", 2)
        .text("verdict");
    table.rows(checks.into_iter().map(|(check, count)| -> [Cell; 9] {
        [
            check.quantity.as_str().into(),
            (count as u64).into(),
            check.at.as_str().into(),
            check.ours.into(),
            check.expected.into(),
            check.allowed().into(),
            check.unit.into(),
            check.is_two_sided().then(|| 100.0 * check.used()).into(),
            if check.passes { "passes" } else { "MISSES" }.into(),
        ]
    }))
}

/// Every comparison that misses, in a line.
pub fn misses(references: &[Reference]) -> impl Iterator<Item = String> {
    references.iter().flat_map(|reference| {
        reference.misses().map(|check| {
            format!(
                "{}: {}, {}: {} {}, known {}, allowed {}",
                reference.name,
                check.quantity,
                check.at,
                significant(check.ours, 6),
                check.unit,
                significant(check.expected, 6),
                check.allowed()
            )
        })
    })
}
