//! The page: for every reference a description, the tolerance, a table, and plots.

use super::{Check, Reference, text};
use report::{Cell, Plot, Report, Section, Table, Tile};

/// Quantities that are compared at more places show the tightest one.
const SHOWN: usize = 8;

/// The report.
pub fn page(references: &[Reference]) -> Report {
    let checks: usize = references.iter().map(|reference| reference.checks.len()).sum();
    let misses: Vec<String> = text::misses(references).collect();
    let missed = Tile::count("comparisons that miss", misses.len() as u64);
    let mut overview = Section::new("Overview")
        .text(
            "Numbers of this program compared with known numbers: benchmarks of the field, \
             published values, closed forms, independent solutions, and laws that every model must \
             obey. All our numbers were computed for this page. Every section states how its \
             tolerances are derived. \"Used\" is the difference as a share of the tolerance, 100 % \
             at its limit.",
        )
        .tiles([
            Tile::count("references", references.len() as u64),
            Tile::count("comparisons", checks as u64),
            if misses.is_empty() { missed.good() } else { missed.bad() },
        ])
        .table(overview_table(references));
    for miss in &misses {
        overview = overview.warning(miss);
    }
    let report = Report::new("Validation")
        .subtitle("Our results compared with known numbers")
        .section(overview);
    references.iter().map(section).fold(report, Report::section)
}

fn overview_table(references: &[Reference]) -> Table {
    let table = Table::new("References")
        .text("reference")
        .text("verdict")
        .number("comparisons", "")
        .number_with_digits("most of a tolerance used", "%", 3);
    table.rows(references.iter().map(|reference| {
        let used = reference.checks.iter().filter(|check| check.is_two_sided()).map(Check::used);
        let row: [Cell; 4] = [
            reference.title.into(),
            reference.verdict().into(),
            (reference.checks.len() as u64).into(),
            (100.0 * used.fold(0.0, f64::max)).into(),
        ];
        row
    }))
}

fn section(reference: &Reference) -> Section {
    let mut section = Section::new(reference.title)
        .text(&reference.what)
        .text(&format!("Source: {}", reference.source))
        .text(&format!("Tolerance: {}", reference.tolerance));
    for limit in &reference.limits {
        section = section.note(limit);
    }
    section = section.table(text::table(reference.title, shown(reference)));
    for miss in reference.misses() {
        section = section.warning(&format!("Misses: {}, {}", miss.quantity, miss.at));
    }
    if reference.checks.len() > shown(reference).len() {
        section = section.text(
            "Where a quantity is compared at many places, the comparison that uses most of its \
             tolerance is shown; all are in validation.json.",
        );
    }
    match reference.plots.as_slice() {
        [] => section,
        [plot] => section.plot(plot.clone()),
        plots => plots.chunks(2).fold(section, |section, two: &[Plot]| section.plots(two.to_vec())),
    }
}

/// Every check of a quantity that has few, the tightest of one that has many.
fn shown(reference: &Reference) -> Vec<(&Check, usize)> {
    let mut rows = Vec::new();
    for (tightest, count) in reference.tightest() {
        if count > SHOWN {
            rows.push((tightest, count));
        } else {
            let own = reference.checks.iter().filter(|check| check.quantity == tightest.quantity);
            rows.extend(own.map(|check| (check, 1)));
        }
    }
    rows
}
