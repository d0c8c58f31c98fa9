//! The layout of a file that has no mapping, from its own text.
//!
//! A file with this project's columns is what it says. Else the rows of numbers are looked for,
//! under each separator and decimal mark; a row above them holds the names, or a comment does, and
//! one of the rows between may hold units ([`heading`](crate::heading)); the names say what the
//! columns hold ([`header`](crate::header)). What was understood is said with every test.

use crate::fault::Fault;
use crate::header::{self, Header};
use crate::heading::Heading;
use crate::labview::Preamble;
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
    /// The names stand in a comment.
    pub(crate) is_named_in_comment: bool,
    /// Rows between the names and the numbers that hold no units.
    pub(crate) skip_below_names: usize,
    /// There is a row of units.
    pub(crate) units: Option<Vec<String>>,
    /// Cells of the first row of numbers.
    pub(crate) first: Vec<String>,
    /// Columns with a number or a time in some row.
    pub(crate) filled: Vec<bool>,
    /// Line of the first row of numbers, from one.
    pub(crate) first_line: usize,
    /// Samples a second, where the file states them and has no time.
    pub(crate) rate_hz: Option<f64>,
    /// The names come again further down.
    pub(crate) comes_again: bool,
    /// What the columns hold, as far as their names say it.
    pub(crate) columns: Vec<Option<Header>>,
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
            // The first way with the most columns of numbers.
            if best.as_ref().is_none_or(|(most, _)| body.number_columns > *most) {
                let most = body.number_columns;
                best = Some((most, body.recognised(&all, separator, decimal)));
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
    /// Columns of numbers among them.
    number_columns: usize,
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
            let cells = lines::row(line, separator);
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
                _ if is_row => Some(Self {
                    start: at,
                    width: cells.len(),
                    number_columns: 0,
                    rows: vec![cells],
                }),
                _ => None,
            };
            let rows = found.as_ref().map_or(0, |body| body.rows.len());
            if rows >= ROWS_MOST || (rows == 0 && at > HEAD_MOST) {
                break;
            }
        }
        let mut body = found.filter(|body| body.rows.len() >= ROWS_LEAST)?;
        // Every column of numbers is one in nearly every row: an overflow or a gap that a program
        // has marked with a word is for the reader of the cells to refuse.
        let marked = (body.rows.len() / MARKED_SHARE).max(1);
        let is_marked = |cell: &str| Fault::of(cell, number, false) != Fault::Other;
        for column in 0..body.width {
            let cells = body.rows.iter().filter_map(|row| row.get(column));
            let numbers = cells.clone().filter(|cell| number(cell)).count();
            let others = cells.filter(|cell| !number(cell) && !is_marked(cell)).count();
            let is_numbers = 2 * numbers > body.rows.len();
            if is_numbers && others > marked {
                return None;
            }
            body.number_columns += usize::from(is_numbers);
        }
        Some(body)
    }

    fn recognised(&self, all: &[&str], separator: Separator, decimal: Decimal) -> Recognised {
        let above = all.get(..self.start).unwrap_or_default();
        let first: Vec<&str> = self.rows.iter().filter_map(|row| row.get(0)).collect();
        let heading = Heading::find(above, separator, self.width, lines::counts(&first));
        let preamble = Preamble::of(above, separator).unwrap_or_default();
        let Heading { at, names, units, .. } = &heading;
        let columns = names.iter().enumerate().map(|(at, name)| {
            let unit = units.as_ref().and_then(|units| units.get(at)).map(String::as_str);
            let header = header::read(name, unit.or(preamble.unit(at)));
            header.filter(|_| !self.repeats(names, at))
        });
        let head = all.get(*at).map_or("", |line| line.trim());
        let again = |line: &str| line.trim() == head;
        let comes_again = !names.is_empty()
            && all.get(self.start..).is_some_and(|below| below.iter().any(|line| again(line)));
        let skip_lines = if heading.is_comment {
            self.start
        } else {
            all.get(..*at).map_or(0, |above| skipped(above, separator))
        };
        Recognised {
            separator,
            decimal,
            decimal_is_certain: decimal == Decimal::Point || self.shows_decimal_commas(),
            skip_lines,
            columns: columns.collect(),
            first: self.rows.first().map(texts).unwrap_or_default(),
            filled: (0..self.width).map(|column| self.is_filled(column, decimal)).collect(),
            first_line: self.start + 1,
            rate_hz: preamble.step_s.map(|step_s| 1.0 / step_s),
            is_named_in_comment: heading.is_comment,
            skip_below_names: heading.skip_below_names,
            names: heading.names,
            units: heading.units,
            comes_again,
        }
    }

    /// True for a column with a value in some row.
    fn is_filled(&self, column: usize, decimal: Decimal) -> bool {
        let is_value =
            |cell: &str| Number::of(cell, decimal, true).is_some() || stamp::is_stamp(cell);
        self.rows.iter().any(|row| row.get(column).is_some_and(is_value))
    }

    /// True for a column that an earlier one repeats, name and cells.
    fn repeats(&self, names: &[String], column: usize) -> bool {
        (0..column).any(|earlier| {
            let same = |row: &StringRecord| row.get(earlier) == row.get(column);
            names.get(earlier) == names.get(column) && self.rows.iter().all(same)
        })
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

fn texts(cells: &StringRecord) -> Vec<String> {
    cells.iter().map(str::to_owned).collect()
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
        let is_filled = |at: &usize| self.filled.get(*at) == Some(&true);
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

    /// The unit of the signal, where a column holds volts or counts.
    pub(crate) fn raw(&self, at: usize) -> Option<&str> {
        self.columns.get(at)?.as_ref()?.raw.as_deref()
    }

    /// What a mapping calls a column.
    pub(crate) fn key(&self, at: usize) -> String {
        match self.names.get(at) {
            Some(name) if !self.is_named_in_comment => name.clone(),
            _ => (at + 1).to_string(),
        }
    }

    /// True where the decimal mark is a comma.
    pub(crate) fn has_decimal_commas(&self) -> bool {
        self.decimal == Decimal::Comma
    }

    /// The first cell of a column is a date or a time of day.
    pub(crate) fn is_stamped(&self, at: usize) -> bool {
        self.first.get(at).is_some_and(|cell| stamp::is_stamp(cell))
    }

    /// The layout, where no question is open.
    pub(crate) fn layout(&self) -> Option<Layout> {
        let reading = |kind: Kind, at: usize| -> Reading {
            let unit = self.columns.get(at).and_then(|header| header.as_ref()?.unit.as_ref());
            let unit = unit.map(|(_, unit)| *unit);
            Reading { unit, ..Reading::plain(kind, self.names.get(at).map_or("", String::as_str)) }
        };
        let with_unit =
            |kind: Kind, at: usize| Some(reading(kind, at)).filter(|r| r.unit.is_some());
        let time_at = self.column(Kind::Time).ok();
        let rate_hz = self.rate_hz.filter(|_| time_at.is_none());
        let own = Layout::own();
        let time = match time_at {
            Some(at) => reading(Kind::Time, at),
            None => own.time.clone(),
        };
        if time_at.is_none() && rate_hz.is_none() {
            return None;
        }
        let stated_force = match self.column(Kind::Force) {
            Ok(at) => Some(with_unit(Kind::Force, at)?),
            Err(_) => None,
        };
        let force = stated_force.clone().or_else(|| own.force.first().cloned())?;
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
        let rate = rate_hz.map(|rate| format!("{} samples a second", files::number(rate)));
        let mut said: Vec<String> = rate.into_iter().collect();
        for (kind, reading) in [
            (Kind::Time, Some(&time).filter(|_| rate_hz.is_none())),
            (Kind::Displacement, displacement.as_ref()),
            (Kind::Velocity, velocity.required.then_some(&velocity.reading)),
            (Kind::Force, stated_force.as_ref()),
            (Kind::Temperature, temperature.required.then_some(&temperature.reading)),
        ] {
            let Some(reading) = reading else { continue };
            let at = self.names.iter().position(|name| *name == reading.column).unwrap_or(0);
            let unit = match self.named(at).1 {
                Some(unit) => format!(" in {}", quoted(kind.symbol(unit).unwrap_or(unit))),
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
            header: !self.is_named_in_comment,
            names: if self.is_named_in_comment { self.names.clone() } else { Vec::new() },
            units_row: self.units.is_some() && !self.is_named_in_comment,
            skip_below_names: self.skip_below_names,
            sample_rate_hz: rate_hz,
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
