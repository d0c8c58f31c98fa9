//! The layout of a file that has no mapping, from its own text.
//!
//! A file with this project's columns is what it says. Else the rows of numbers are looked for,
//! under each separator and decimal mark; the row above them holds the names, or the two rows above
//! them names and units; the names say what the columns hold ([`header`](crate::header)). What was
//! understood is said with every test. Where a question is open, the file is read as if it had this
//! project's columns, which says what is missing.

use crate::header::{self, Header};
use crate::layout::{Decimal, Layout, OptionalReading, Reading, Separator};
use crate::lines;
use crate::number::Number;
use crate::stamp;
use crate::unit::Kind;
use csv::StringRecord;
use files::quoted;

/// Rows of numbers in a row that make a table.
const ROWS_LEAST: usize = 5;
/// Rows of numbers that are looked at.
const ROWS_MOST: usize = 400;
/// One cell in so many may hold a word in the place of a number.
const MARKED_SHARE: usize = 50;
/// Lines above the numbers that are looked at.
const HEAD_MOST: usize = 400;

/// What a text shows about its layout.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recognised {
    /// What separates two cells.
    pub(crate) separator: Separator,
    /// What precedes the decimals.
    pub(crate) decimal: Decimal,
    /// The decimal mark is certain, or no cell depends on it.
    pub(crate) decimal_is_certain: bool,
    /// Lines before the row of names, or before the numbers.
    pub(crate) skip_lines: usize,
    /// Names of the columns; empty where there is no row of names.
    pub(crate) names: Vec<String>,
    /// There is a row of units.
    pub(crate) units: Option<Vec<String>>,
    /// Cells of the first row of numbers.
    pub(crate) first: Vec<String>,
    /// The names come again further down.
    pub(crate) comes_again: bool,
    /// What the columns hold, as far as their names say it.
    pub(crate) columns: Vec<Option<Header>>,
}

/// The layout of a file without a mapping.
pub(crate) fn layout(text: &str) -> Layout {
    let own = Layout::own();
    let first = text.lines().find(|line| {
        !line.trim_start().starts_with(&own.comment) && !lines::is_blank(line, own.separator)
    });
    let names = first.map(|line| lines::cells(line, own.separator)).unwrap_or_default();
    let has = |name: &str| names.iter().any(|other| other == name);
    if has("time_s") && has("force_n") && (has("displacement_m") || has("velocity_m_per_s")) {
        return own;
    }
    // A motion without a force is a file of its own kind.
    if has("time_s") && has("displacement_m") && !names.iter().any(is_force) {
        return own;
    }
    match recognised(text).and_then(|found| found.layout()) {
        Some(layout) => layout,
        None => own,
    }
}

fn is_force(name: &str) -> bool {
    header::read(name, None).is_some_and(|header| header.kind == Kind::Force)
}

/// What a text shows about its layout, if it holds rows of numbers.
pub(crate) fn recognised(text: &str) -> Option<Recognised> {
    let all: Vec<&str> = text.lines().collect();
    let ways = [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Whitespace];
    let marks = [(Decimal::Point, false), (Decimal::Comma, true), (Decimal::Point, true)];
    let mut best: Option<(usize, Recognised)> = None;
    for separator in ways {
        for (decimal, declared) in marks {
            let Some(body) = Body::find(&all, separator, decimal, declared) else { continue };
            // The first way with the most numbers in a row.
            if best.as_ref().is_none_or(|(width, _)| body.width > *width) {
                let width = body.width;
                best = Some((width, body.recognised(&all, separator, decimal)));
            }
        }
    }
    best.map(|(_, found)| found)
}

/// The first rows of numbers.
struct Body {
    /// Index of the first line.
    start: usize,
    /// Cells of a row.
    width: usize,
    /// Their cells.
    rows: Vec<StringRecord>,
}

impl Body {
    fn find(all: &[&str], separator: Separator, decimal: Decimal, declared: bool) -> Option<Self> {
        let mut found: Option<Self> = None;
        let number =
            |cell: &str| Number::of(cell, decimal, declared).is_some() || stamp::is_stamp(cell);
        for (at, line) in all.iter().enumerate() {
            if lines::is_blank(line, separator) || line.trim_start().starts_with('#') {
                continue;
            }
            let cells = row(line, separator);
            let numbers = cells.iter().filter(|cell| number(cell)).count();
            let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
            // Text columns are allowed, but not half of them.
            let is_row = numbers >= 2 && 2 * numbers > filled;
            found = match found {
                Some(mut body) if is_row && body.width == cells.len() => {
                    body.rows.push(cells);
                    Some(body)
                }
                Some(body) if body.rows.len() >= ROWS_LEAST => {
                    found = Some(body);
                    break;
                }
                _ if is_row => Some(Self { start: at, width: cells.len(), rows: vec![cells] }),
                _ => None,
            };
            let rows = found.as_ref().map_or(0, |body| body.rows.len());
            if rows >= ROWS_MOST || (rows == 0 && at > HEAD_MOST) {
                break;
            }
        }
        let body = found.filter(|body| body.rows.len() >= ROWS_LEAST)?;
        // Every column of numbers is one in nearly every row: an overflow or a gap that a program
        // has marked with a word is for the reader of the cells to refuse.
        let marked = (body.rows.len() / MARKED_SHARE).max(1);
        let is_mixed = (0..body.width).any(|column| {
            let cells = body.rows.iter().filter_map(|row| row.get(column));
            let numbers = cells.clone().filter(|cell| number(cell)).count();
            let others = cells.filter(|cell| !cell.is_empty() && !number(cell)).count();
            2 * numbers > body.rows.len() && others > marked
        });
        (!is_mixed).then_some(body)
    }

    fn recognised(&self, all: &[&str], separator: Separator, decimal: Decimal) -> Recognised {
        let above: Vec<(usize, StringRecord)> = all
            .iter()
            .enumerate()
            .take(self.start)
            .rev()
            .filter(|(_, line)| !lines::is_blank(line, separator))
            .filter(|(_, line)| !line.trim_start().starts_with('#'))
            .map(|(at, line)| (at, row(line, separator)))
            .take(2)
            .collect();
        let filled = |cells: &StringRecord| cells.iter().filter(|cell| !cell.is_empty()).count();
        // A row of names has a text for nearly every column.
        let is_head = |cells: &StringRecord| {
            cells.len() >= 2 && cells.len() <= self.width + 1 && 2 * filled(cells) > self.width
        };
        let is_units = |cells: &StringRecord| {
            let units = cells.iter().filter(|cell| is_unit(cell)).count();
            units >= 1 && 2 * units >= filled(cells) && !cells.iter().any(names_kind)
        };
        let texts = |cells: &StringRecord| cells.iter().map(str::to_owned).collect::<Vec<_>>();
        let (names, units) = match above.as_slice() {
            [(_, units), (at, names), ..] if is_units(units) && is_head(names) => {
                (Some((*at, texts(names))), Some(texts(units)))
            }
            [(at, names), ..] if is_head(names) => (Some((*at, texts(names))), None),
            _ => (None, None),
        };
        let (start, mut names) = names.unwrap_or((self.start, Vec::new()));
        while names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        let columns = names.iter().enumerate().map(|(at, name)| {
            let unit = units.as_ref().and_then(|units| units.get(at)).map(String::as_str);
            header::read(name, unit)
        });
        let head = all.get(start).map_or("", |line| line.trim());
        let again = |line: &str| line.trim() == head;
        let comes_again = !names.is_empty()
            && all.get(self.start..).is_some_and(|below| below.iter().any(|line| again(line)));
        Recognised {
            separator,
            decimal,
            decimal_is_certain: decimal == Decimal::Point || self.shows_decimal_commas(),
            skip_lines: all.get(..start).map_or(0, |above| skipped(above, separator)),
            columns: columns.collect(),
            first: self.rows.first().map(texts).unwrap_or_default(),
            names,
            units,
            comes_again,
        }
    }

    /// A comma that cannot stand between thousands.
    fn shows_decimal_commas(&self) -> bool {
        let grouped = |cell: &str| Number::of(cell, Decimal::Point, true).is_some();
        self.rows.iter().flatten().any(|cell| cell.contains(',') && !grouped(cell))
    }
}

/// Lines to be skipped: none where all above the names is blank or a comment.
fn skipped(above: &[&str], separator: Separator) -> usize {
    let is_text =
        |line: &&str| !lines::is_blank(line, separator) && !line.trim_start().starts_with('#');
    if above.iter().any(is_text) { above.len() } else { 0 }
}

/// The cells of a line.
fn row(line: &str, separator: Separator) -> StringRecord {
    if separator == Separator::Whitespace {
        return line.split_whitespace().collect::<Vec<_>>().into();
    }
    lines::cells(line, separator)
}

fn is_unit(cell: &str) -> bool {
    Kind::ALL.iter().any(|kind| kind.unit(cell).is_some())
}

/// True for a name that says what its column holds, and is no unit itself.
fn names_kind(cell: &str) -> bool {
    !is_unit(cell) && header::read(cell, None).is_some()
}

impl Recognised {
    /// The column of a kind.
    ///
    /// # Errors
    /// The names of all candidates where there is not one.
    pub(crate) fn column(&self, kind: Kind) -> Result<usize, Vec<usize>> {
        let holds = |at: &usize| {
            self.columns
                .get(*at)
                .is_some_and(|header| header.as_ref().is_some_and(|header| header.kind == kind))
        };
        let is_filled = |at: &usize| self.first.get(*at).is_some_and(|cell| self.is_value(cell));
        let candidates: Vec<usize> =
            (0..self.columns.len()).filter(holds).filter(is_filled).collect();
        let with_unit: Vec<usize> =
            candidates.iter().copied().filter(|at| self.named(*at).1.is_some()).collect();
        match (candidates.as_slice(), with_unit.as_slice()) {
            ([one], _) | (_, [one]) => Ok(*one),
            _ => Err(candidates),
        }
    }

    /// Name and unit of a column.
    pub(crate) fn named(&self, at: usize) -> (&str, Option<&str>) {
        let unit = self.columns.get(at).and_then(|header| header.as_ref()?.unit.as_ref());
        let name = self.names.get(at).map_or("", String::as_str);
        (name, unit.map(|(unit, _)| unit.as_str()))
    }

    /// A cell is a number or a time.
    fn is_value(&self, cell: &str) -> bool {
        Number::of(cell, self.decimal, true).is_some() || stamp::is_stamp(cell)
    }

    /// The first cell of a column is a date or a time of day.
    pub(crate) fn is_stamped(&self, at: usize) -> bool {
        self.first.get(at).is_some_and(|cell| stamp::is_stamp(cell))
    }

    /// The layout, where no question is open.
    fn layout(&self) -> Option<Layout> {
        let reading = |kind: Kind, at: usize| -> Reading {
            let unit = self.columns.get(at).and_then(|header| header.as_ref()?.unit.as_ref());
            let unit = unit.map(|(_, unit)| *unit);
            Reading { unit, ..Reading::plain(kind, self.names.get(at).map_or("", String::as_str)) }
        };
        let with_unit =
            |kind: Kind, at: usize| Some(reading(kind, at)).filter(|r| r.unit.is_some());
        let time_at = self.column(Kind::Time).ok()?;
        let time = reading(Kind::Time, time_at);
        let force = with_unit(Kind::Force, self.column(Kind::Force).ok()?)?;
        let displacement = match self.column(Kind::Displacement) {
            Ok(at) => Some(with_unit(Kind::Displacement, at)?),
            Err(several) if several.is_empty() => None,
            Err(_) => return None,
        };
        let optional = |kind: Kind, plain: &OptionalReading| match self.column(kind) {
            Ok(at) => match with_unit(kind, at) {
                Some(reading) => OptionalReading { reading, required: true },
                None => plain.clone(),
            },
            Err(_) => plain.clone(),
        };
        let own = Layout::own();
        let velocity = optional(Kind::Velocity, &own.velocity);
        let temperature = optional(Kind::Temperature, &own.temperature);
        if !self.decimal_is_certain || (displacement.is_none() && !velocity.required) {
            return None;
        }
        let is_own = |reading: &Reading, name: &str| reading.column == name;
        let own_columns = displacement.as_ref().is_some_and(|reading| {
            is_own(reading, "displacement_m")
                && is_own(&force, "force_n")
                && is_own(&time, "time_s")
        });
        let mut said = Vec::new();
        for (kind, reading) in [
            (Kind::Time, Some(&time)),
            (Kind::Displacement, displacement.as_ref()),
            (Kind::Velocity, velocity.required.then_some(&velocity.reading)),
            (Kind::Force, Some(&force)),
            (Kind::Temperature, temperature.required.then_some(&temperature.reading)),
        ] {
            let Some(reading) = reading else { continue };
            let at = self.names.iter().position(|name| *name == reading.column).unwrap_or(0);
            let unit = match reading.unit {
                Some(unit) => format!(" in {}", unit.name()),
                None if kind == Kind::Time && !self.is_stamped(at) => {
                    " in s, not stated".to_owned()
                }
                None => String::new(),
            };
            said.push(format!("{} \"{}\"{unit}", kind.name(), quoted(&reading.column)));
        }
        let decimal = if self.decimal == Decimal::Comma { ", decimal commas" } else { "" };
        let understood = format!("understood without a mapping: {}{decimal}", said.join(", "));
        Some(Layout {
            separator: self.separator,
            decimal: Some(self.decimal),
            skip_lines: self.skip_lines,
            units_row: self.units.is_some(),
            own_columns,
            displacement: match displacement {
                Some(reading) => OptionalReading { reading, required: true },
                None => own.displacement.clone(),
            },
            time,
            force: vec![force],
            velocity,
            temperature,
            understood: Some(understood),
            ..own
        })
    }
}
