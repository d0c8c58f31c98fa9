//! Answers as a table for a terminal.

use crate::point::GridPoint;
use crate::trip::pace::Pace;

/// Rows as lines with aligned columns, the first row as heads; below them why points have no
/// answer.
pub(crate) fn table<A>(rows: &[Vec<String>], points: &[GridPoint<A>]) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<usize> = (0..columns).filter_map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        cells.collect::<Vec<_>>().join("   ")
    };
    let mut lines: Vec<String> = rows.iter().map(line).collect();
    let failures =
        points.iter().filter_map(|point| Some((point.index + 1, point.failure.as_ref()?)));
    lines.extend(failures.map(|(number, why)| format!("point {number}: {why}")));
    lines
}

/// How fast the trips of all points were simulated, in words; none where no time is recorded.
pub(crate) fn pace<A>(points: &[GridPoint<A>]) -> Option<String> {
    Pace::over(points.iter().filter_map(|point| point.pace)).map(|pace| pace.in_words())
}
