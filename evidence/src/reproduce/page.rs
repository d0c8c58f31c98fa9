//! The reproduction as one report: for every figure the study's statement, our numbers, the plots.

use super::locomotive::Locomotive;
use super::row::{Figure, Role, Row};
use report::{Cell, Report, Section, Table};

/// The report.
pub fn page(figures: &[Figure], locomotive: &Locomotive) -> Report {
    let mut report = Report::new("The SS9 yaw-damper study, reproduced")
        .subtitle("The 2014 study compared with our results")
        .fact("scenario", &locomotive.title);
    for line in &locomotive.about {
        report = report.fact("vehicle", line);
    }
    if figures.iter().flat_map(|figure| &figure.rows).any(|row| row.paper.is_some()) {
        report = report.section(overview(figures));
    }
    figures.iter().map(section).fold(report, Report::section)
}

/// All numbers that the study gives, in one table.
fn overview(figures: &[Figure]) -> Section {
    let published: Vec<&Row> =
        figures.iter().flat_map(|figure| &figure.rows).filter(|row| row.paper.is_some()).collect();
    let count = |role: Role| published.iter().filter(|row| row.role == role).count();
    Section::new("The study's numbers compared with ours")
        .text(&format!(
            "Of {} numbers, {} were used for calibration, {} were known when start values were \
             chosen, and {} are predicted. Masses and suspension are those of a public locomotive \
             of the same class, not of the SS9.",
            published.len(),
            count(Role::Calibrated),
            count(Role::Informed),
            count(Role::Predicted)
        ))
        .table(table("Numbers given in the study's text", &published))
}

fn section(figure: &Figure) -> Section {
    let rows: Vec<&Row> = figure.rows.iter().collect();
    let mut section =
        Section::new(&format!("Figure {} of the study: {}", figure.number, figure.title))
            .text(&format!("The study: {}.", figure.said))
            .plots(figure.plots.clone())
            .table(figure.table.clone().unwrap_or_else(|| table("Numbers", &rows)));
    for remark in &figure.remarks {
        section = section.note(remark);
    }
    section
}

fn table(caption: &str, rows: &[&Row]) -> Table {
    let table = Table::new(caption)
        .text("figure")
        .text("quantity")
        .text("at")
        .number("the study", "")
        .number("ours", "")
        .text("unit")
        .number("error", "%")
        .text("role")
        .text("note");
    table.rows(rows.iter().map(|row| -> Vec<Cell> {
        vec![
            row.figure.into(),
            row.quantity.replace('_', " ").into(),
            conditions(row).into(),
            row.paper.into(),
            row.ours.into(),
            row.unit.into(),
            row.relative_error.map(|error| 100.0 * error).into(),
            format!("{:?}", row.role).to_lowercase().into(),
            row.note.clone().into(),
        ]
    }))
}

/// Conditions in the usual units of the field.
fn conditions(row: &Row) -> String {
    let words = row.at.iter().map(|(name, value)| match *name {
        "ke_n_per_m" => format!("Ke {} MN/m", 1e-6 * value),
        "clearance_2a_m" => format!("2a {} mm", short(1e3 * value)),
        "speed_kmh" => format!("{value} km/h"),
        name => format!("{} {}", name.replace('_', " "), short(*value)),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Up to four decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The figures as text for a terminal: for each the study's statement and a table.
pub fn text(figures: &[Figure]) -> String {
    let mut lines = Vec::new();
    for figure in figures {
        lines.push(format!("figure {}: {}", figure.number, figure.title));
        lines.push(format!("the study: {}", figure.said));
        lines.extend(table("", &figure.rows.iter().collect::<Vec<_>>()).lines());
        lines.push(String::new());
    }
    lines.join("\n").trim_end().to_owned()
}
