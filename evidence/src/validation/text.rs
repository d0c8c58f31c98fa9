//! The comparisons as a table of plain text.

use super::Reference;
use report::significant;
use std::fmt::Write;

/// One line per quantity: how many comparisons, the tightest, and whether all pass; then what
/// misses.
pub fn text(references: &[Reference]) -> String {
    let mut out = String::new();
    for reference in references {
        line(&mut out, format_args!("{} - {}", reference.verdict(), reference.title));
        for (check, count) in reference.tightest() {
            line(
                &mut out,
                format_args!(
                    "  {:<48} {:>4}  {:<28} ours {:>11}  known {:>11}  {:<24} {:>4.0} %",
                    check.quantity,
                    count,
                    check.at,
                    significant(check.ours, 5),
                    significant(check.expected, 5),
                    format!("{} {}", check.allowed(), check.unit),
                    100.0 * check.used()
                ),
            );
        }
    }
    let misses: Vec<String> = misses(references).collect();
    if misses.is_empty() {
        let checks: usize = references.iter().map(|reference| reference.checks.len()).sum();
        let count = references.len();
        line(&mut out, format_args!("all {checks} comparisons of {count} references pass"));
    }
    for miss in misses {
        line(&mut out, format_args!("MISS {miss}"));
    }
    out
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

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{text}");
}
