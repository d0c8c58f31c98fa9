//! What the tables of all studies share: columns for the keys that are varied, and the text around
//! a table on a terminal.

use crate::point::GridPoint;
use crate::trip::Pace;
use report::{Cell, Section, Table};

/// A table that begins with a column for each key that is varied.
pub(crate) fn keyed<A>(caption: &str, points: &[GridPoint<A>]) -> Table {
    let keys = points.first().map(|point| point.at.as_slice()).unwrap_or_default();
    keys.iter().fold(Table::new(caption), |table, set| table.written(&set.called(), ""))
}

/// The first cells of a point in such a table: the values of its keys.
pub(crate) fn key_cells<A>(point: &GridPoint<A>) -> Vec<Cell> {
    point.values_in_words().into_iter().map(Cell::from).collect()
}

/// Tables with the reasons why points have no answer, the conditions under which the answers hold,
/// and how fast they were simulated.
pub(crate) fn text<A>(tables: &[Table], points: &[GridPoint<A>], conditions: &[String]) -> String {
    let mut lines = Vec::new();
    for (number, table) in tables.iter().enumerate() {
        lines.extend(table.lines());
        if number == 0 {
            lines.extend(failures(points));
        }
        lines.push(String::new());
    }
    lines.extend_from_slice(conditions);
    let pace = Pace::over(points.iter().filter_map(|point| point.pace));
    lines.extend(pace.map(|pace| pace.in_words()));
    lines.join("\n")
}

/// The same on a page, without the speed of simulation.
pub(crate) fn section<A>(
    heading: &str,
    table: Table,
    points: &[GridPoint<A>],
    conditions: &[String],
) -> Section {
    let section = Section::new(heading).table(table);
    let section = failures(points).fold(section, |section, why| section.warning(&why));
    conditions.iter().fold(section, |section, line| section.text(line))
}

/// Why points have no answer, or only a part of it.
fn failures<A>(points: &[GridPoint<A>]) -> impl Iterator<Item = String> {
    points.iter().filter_map(|point| {
        let why = point.failure.as_ref()?;
        Some(format!("point {}: {}", point.index + 1, files::quoted(why)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::setting::Setting;

    #[test]
    fn a_point_without_an_answer_is_named_on_the_terminal_and_on_the_page() {
        let point = |index: usize, failure: Option<&str>| GridPoint {
            index,
            study: String::new(),
            at: vec![Setting::to("damper.ke_n_per_m", 1e6 * index as f64)],
            answer: (),
            failure: failure.map(str::to_owned),
            pace: None,
        };
        let points = [point(0, None), point(1, Some("off the track at 40 m"))];
        let table = || {
            let rows = points.iter().map(|point| {
                key_cells(point).into_iter().chain([Cell::from(2.5)]).collect::<Vec<_>>()
            });
            keyed("Answers", &points).fixed("force", "kN", 1).rows(rows)
        };
        let said = ["speeds in km/h".to_owned()].to_vec();
        assert_eq!(
            text(&[table()], &points, &said),
            "damper.ke_n_per_m  force kN\n                0       2.5\n              1e6       2.5\n\
             point 2: off the track at 40 m\n\nspeeds in km/h"
        );
        let page =
            report::Report::new("study").section(section("Answers", table(), &points, &said));
        assert!(page.to_html().unwrap().contains("point 2: off the track at 40 m"));
    }
}
