//! Commas between the cells and as decimal marks in one file, which nobody can read apart.
//!
//! `0,001,12,5` may be four whole numbers, `0,001` and `12,5`, or others. Names of the columns show
//! it: every row has more cells than there are names, and all of them are whole numbers. Without
//! names, decimals that begin with a zero in every second cell show it.

use crate::error::MeasurementError;
use crate::layout::Separator;
use crate::lines;
use files::quoted;
use std::path::Path;

/// Rows that are looked at.
const ROWS_MOST: usize = 50;
/// Rows that are needed.
const ROWS_LEAST: usize = 5;
/// Lines above the numbers that are looked at.
const HEAD_MOST: usize = 400;

/// Refuses a text whose commas have two meanings.
///
/// # Errors
/// The first row of it, and what to do.
pub(crate) fn check(file: &Path, text: &str) -> Result<(), MeasurementError> {
    let Some((at, line)) = ambiguous_row(text) else { return Ok(()) };
    Err(MeasurementError::Cell {
        file: file.to_owned(),
        row: at + 1,
        column: "row".to_owned(),
        found: format!(
            "\"{}\", with commas as decimal marks and between the cells, which is ambiguous",
            quoted(line.trim())
        ),
        expected: "decimal points, or semicolons or tabs between the cells: export the file again \
                   with one of them"
            .to_owned(),
    })
}

fn ambiguous_row(text: &str) -> Option<(usize, &str)> {
    let is_text = |line: &&str| !lines::is_blank(line, Separator::Comma);
    let mut above = None;
    let mut rows = Vec::new();
    for (at, line) in text.lines().enumerate().filter(|(_, line)| is_text(line)) {
        if is_row(line) {
            rows.push((at, line));
        } else if rows.is_empty() && at < HEAD_MOST {
            above = Some(line);
        } else {
            break;
        }
        if rows.len() >= ROWS_MOST {
            break;
        }
    }
    if rows.len() < ROWS_LEAST {
        return None;
    }
    let cells = |line: &str| line.trim_end_matches(',').split(',').count();
    let named = above.map_or(0, cells);
    let split = rows.iter().all(|(_, line)| (named..=2 * named).contains(&cells(line)))
        && rows.iter().any(|(_, line)| cells(line) > named);
    let is_ambiguous = if named >= 2 { split } else { has_decimals_alone(&rows) };
    let first = rows.iter().find(|(_, line)| named < 2 || cells(line) > named);
    first.filter(|_| is_ambiguous).copied()
}

/// A line of at least four whole numbers between commas, none of them quoted.
fn is_row(line: &str) -> bool {
    let is_whole = |cell: &str| {
        let cell = cell.trim();
        let digits = cell.strip_prefix(['-', '+']).unwrap_or(cell);
        !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    let line = line.trim_end_matches(',');
    line.split(',').count() >= 4 && line.split(',').all(is_whole)
}

/// Every second cell is without a sign, and some of them in every such column begin with a zero.
fn has_decimals_alone(rows: &[(usize, &str)]) -> bool {
    let width = |line: &str| line.split(',').count();
    let first = rows.first().map_or(0, |(_, line)| width(line));
    if first % 2 == 1 || rows.iter().any(|(_, line)| width(line) != first) {
        return false;
    }
    (1..first).step_by(2).all(|column| {
        let cells = || rows.iter().filter_map(|(_, line)| line.split(',').nth(column));
        let begins = |cell: &str| cell.len() > 1 && cell.starts_with('0');
        cells().any(begins) && !cells().any(|cell| cell.trim().starts_with(['-', '+']))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_can_be_read_apart_are_not_refused() {
        let repeated = |head: &str, row: &str| format!("{head}{}", format!("{row}\n").repeat(20));
        for (head, row, is_refused) in [
            ("t,x,F\n", "0,001,12,5,4,0", true),
            ("t,x,F\n", "0,001,12,5,4", true),
            ("", "0,001,12,050,-4,047", true),
            ("t,x,F,T\n", "0,12,5,20", false),
            ("t,x,F,T\n", "0,12,5,20,", false),
            ("", "0,12,-5,20", false),
            ("", "1,12,5,20", false),
            ("t,x,F\n", "\"0,001\",\"12,5\",\"4,0\"", false),
            ("t;x;F\n", "0,001;12,5;4,0", false),
            ("t,x,F\n", "0.001,12.5,4.0,7.0", false),
        ] {
            assert_eq!(ambiguous_row(&repeated(head, row)).is_some(), is_refused, "{head}{row}");
        }
    }
}
