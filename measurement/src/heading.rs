//! The names above the rows of numbers, and what stands between.
//!
//! The names are mostly in the row above the numbers, with a row of units below them. Programs
//! write more: types of channels, sensors, filters. Then the names are in the nearest row that says
//! two different things. Where no row says it, a comment may, as MATLAB and NumPy write it.

use crate::header;
use crate::layout::Separator;
use crate::lines;
use crate::unit::Kind;
use csv::StringRecord;

/// Rows above the numbers that are looked at.
const ROWS_MOST: usize = 16;
/// Beginnings of comments.
const MARKS: [&str; 4] = ["#", "%", "//", "!"];

/// What stands above the numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Heading {
    /// Index of the line of the names, or of the first row of numbers.
    pub(crate) at: usize,
    /// Names of the columns; empty where there are none.
    pub(crate) names: Vec<String>,
    /// The row of units.
    pub(crate) units: Option<Vec<String>>,
    /// Rows between names and numbers that hold no units.
    pub(crate) skip_below_names: usize,
    /// The names stand in a comment.
    pub(crate) is_comment: bool,
}

impl Heading {
    /// The heading of rows of `width` cells; `counts` is true where the first cells count the rows.
    pub(crate) fn find(above: &[&str], separator: Separator, width: usize, counts: bool) -> Self {
        let lines =
            || above.iter().enumerate().rev().filter(|(_, line)| !lines::is_blank(line, separator));
        let rows: Vec<(usize, StringRecord)> = lines()
            .filter(|(_, line)| !line.trim_start().starts_with('#'))
            .map(|(at, line)| (at, lines::row(line, separator)))
            .take(ROWS_MOST)
            .collect();
        let comments: Vec<(usize, StringRecord)> = lines()
            .take(ROWS_MOST)
            .filter_map(|(at, line)| Some((at, lines::row(comment(line)?, separator))))
            .collect();
        let nearest = Self::nearest(&rows, width);
        let mut heading = [
            nearest.clone().filter(Self::says_enough),
            (0..rows.len()).find_map(|index| Self::of_row(&rows, index, width)),
            Self::of_comment(&comments, width),
            nearest,
        ]
        .into_iter()
        .flatten()
        .next()
        .unwrap_or(Self { at: above.len(), ..Self::default() });
        while heading.names.last().is_some_and(String::is_empty) {
            heading.names.pop();
        }
        if counts && !heading.names.is_empty() && heading.names.len() + 1 == width {
            heading.names.insert(0, lines::ROW_NUMBER.to_owned());
            heading.units.iter_mut().for_each(|units| units.insert(0, String::new()));
        }
        heading
    }

    /// The row above the numbers as names, or as units below names.
    fn nearest(rows: &[(usize, StringRecord)], width: usize) -> Option<Self> {
        let named = |at: usize, names: &StringRecord, units: Option<&StringRecord>| {
            let units = units.map(texts);
            Some(Self { at, names: texts(names), units, ..Self::default() })
        };
        match rows {
            [(_, units), (at, names), ..] if is_units(units) && is_head(names, width) => {
                named(*at, names, Some(units))
            }
            [(at, names), ..] if is_head(names, width) => named(*at, names, None),
            _ => None,
        }
    }

    /// A row as names, if it says enough, with the row of units among those below it.
    fn of_row(rows: &[(usize, StringRecord)], index: usize, width: usize) -> Option<Self> {
        let (at, names) = rows.get(index).filter(|(_, names)| is_head(names, width))?;
        let below: Vec<&StringRecord> =
            rows.get(..index)?.iter().rev().map(|(_, cells)| cells).collect();
        let units = units_among(&below).and_then(|at| below.get(at)).map(|units| texts(units));
        let skip_below_names = below.len() - usize::from(units.is_some());
        let heading =
            Self { at: *at, names: texts(names), units, skip_below_names, is_comment: false };
        Some(heading).filter(|heading| !is_units(names) && heading.says_enough())
    }

    /// The nearest comment that names as many columns as there are.
    fn of_comment(comments: &[(usize, StringRecord)], width: usize) -> Option<Self> {
        (0..comments.len()).find_map(|index| {
            let (at, names) = comments.get(index).filter(|(_, names)| names.len() == width)?;
            let below = index.checked_sub(1).and_then(|below| comments.get(below));
            let units = below.map(|(_, units)| units).filter(|units| is_units(units)).map(texts);
            let heading =
                Self { at: *at, names: texts(names), units, skip_below_names: 0, is_comment: true };
            Some(heading).filter(|heading| !is_units(names) && heading.says_enough())
        })
    }

    /// Two columns say what they hold, and not the same.
    fn says_enough(&self) -> bool {
        let mut kinds: Vec<Kind> = Vec::new();
        for (at, name) in self.names.iter().enumerate() {
            let unit = self.units.as_ref().and_then(|units| units.get(at)).map(String::as_str);
            let kind = header::read(name, unit).map(|header| header.kind);
            kinds.extend(kind.filter(|kind| !kinds.contains(kind)));
        }
        kinds.len() >= 2
    }
}

/// Which of several rows is the row of units, if one is.
pub(crate) fn units_among(rows: &[&StringRecord]) -> Option<usize> {
    let count = |row: &StringRecord| row.iter().filter(|cell| is_unit(cell)).count();
    // `Min` alone is a word and no unit.
    let candidates = rows.iter().enumerate().filter(|(_, row)| is_units(row) && count(row) >= 2);
    // The first of those with the most units.
    candidates.rev().max_by_key(|(_, row)| count(row)).map(|(at, _)| at)
}

/// The text of a comment.
fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let mark = MARKS.iter().find(|mark| line.starts_with(**mark))?;
    Some(line.trim_start_matches(mark).trim())
}

/// A row of names has a text for nearly every column.
fn is_head(cells: &StringRecord, width: usize) -> bool {
    let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
    let is_comment = cells.get(0).is_some_and(|cell| comment(cell).is_some());
    cells.len() >= 2 && cells.len() <= width + 1 && 2 * filled > width && !is_comment
}

fn is_units(cells: &StringRecord) -> bool {
    let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
    let units = cells.iter().filter(|cell| is_unit(cell)).count();
    units >= 1 && 2 * units >= filled && !cells.iter().any(names_kind)
}

fn is_unit(cell: &str) -> bool {
    Kind::ALL.iter().any(|kind| kind.unit(cell).is_some())
}

/// True for a name that says what its column holds, and is no unit itself.
fn names_kind(cell: &str) -> bool {
    !is_unit(cell) && header::read(cell, None).is_some()
}

fn texts(cells: &StringRecord) -> Vec<String> {
    cells.iter().map(str::to_owned).collect()
}
