//! How one file is read: separators, columns, units and signs, all checked.

use crate::drive::OnMass;
use crate::unit::{Kind, Unit};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The name of a column in the place of an answer that a file does not give.
pub(crate) const OPEN: &str = "?";

/// The layout of one file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// What separates two cells.
    pub(crate) separator: Separator,
    /// What precedes the decimals; a point where nobody says it.
    pub(crate) decimal: Option<Decimal>,
    /// Beginning of a comment line.
    pub(crate) comment: String,
    /// Lines before the row of names.
    pub(crate) skip_lines: usize,
    /// There is a row of names.
    pub(crate) header: bool,
    /// There is a row of units below the names.
    pub(crate) units_row: bool,
    /// Rows below the names that hold neither units nor numbers.
    pub(crate) skip_below_names: usize,
    /// Names of the columns where they stand in a comment and in no row of their own.
    pub(crate) names: Vec<String>,
    /// Which sign of the file means extension; `None` leaves it to the file.
    pub(crate) extension: Option<Extension>,
    /// The columns are this project's own, which has a convention of signs.
    pub(crate) own_columns: bool,
    /// Columns whose values separate the tests of a file.
    pub(crate) split_by: Vec<String>,
    /// Values that a row must have.
    pub(crate) only: BTreeMap<String, Wanted>,
    /// Sampling rate of a file without time.
    pub(crate) sample_rate_hz: Option<f64>,
    /// Time; unused with a sampling rate.
    pub(crate) time: Reading,
    /// Displacement; where it is not required a velocity may take its place.
    pub(crate) displacement: OptionalReading,
    /// Force, one test each.
    pub(crate) force: Vec<Reading>,
    /// Velocity.
    pub(crate) velocity: OptionalReading,
    /// Temperature.
    pub(crate) temperature: OptionalReading,
    /// Acceleration of a body, where it takes the place of the displacement.
    pub(crate) acceleration: Option<Reading>,
    /// How a body was driven.
    pub(crate) on_mass: OnMass,
    /// Effects that the laboratory's processing has destroyed, and how.
    pub(crate) destroyed: BTreeMap<&'static str, String>,
    /// What was tested.
    pub(crate) specimen: Option<String>,
    /// What was understood without a mapping, a line for every test.
    pub(crate) understood: Option<String>,
}

/// A column: where it is and how a reading becomes a value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    /// What it holds.
    pub(crate) kind: Kind,
    /// Its name in the file.
    pub(crate) column: String,
    /// Its unit, if the mapping states one; else that of the units row, else SI.
    pub(crate) unit: Option<Unit>,
    /// The reading that means zero.
    pub(crate) offset: f64,
    /// What one of the reading is in the unit: of counts and volts.
    pub(crate) scale: Option<f64>,
    /// 1 or -1.
    pub(crate) sign: f64,
}

/// A column that a file may lack.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OptionalReading {
    /// The column.
    pub(crate) reading: Reading,
    /// The mapping names it, so the file must have it.
    pub(crate) required: bool,
}

/// What separates two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Separator {
    #[default]
    Comma,
    Semicolon,
    Tab,
    Whitespace,
}

/// What precedes the decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Decimal {
    #[default]
    Point,
    Comma,
}

/// Which sign of a file means extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Extension {
    /// Positive displacement is extension, positive force is tension.
    Positive,
    /// Negative displacement is extension, negative force is tension.
    Negative,
    /// Not known.
    #[default]
    Unknown,
}

/// What a cell must hold for its row to be kept.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub(crate) enum Wanted {
    Number(f64),
    Text(String),
    Any(Vec<Wanted>),
}

impl Layout {
    /// The layout of this project's own files.
    pub(crate) fn own() -> Self {
        let optional = |kind, column| OptionalReading {
            reading: Reading::plain(kind, column),
            required: false,
        };
        Self {
            separator: Separator::Comma,
            decimal: None,
            comment: "#".to_owned(),
            skip_lines: 0,
            header: true,
            units_row: false,
            skip_below_names: 0,
            names: Vec::new(),
            extension: None,
            own_columns: true,
            split_by: Vec::new(),
            only: BTreeMap::new(),
            sample_rate_hz: None,
            time: Reading::plain(Kind::Time, "time_s"),
            displacement: optional(Kind::Displacement, "displacement_m"),
            force: vec![Reading::plain(Kind::Force, "force_n")],
            velocity: optional(Kind::Velocity, "velocity_m_per_s"),
            temperature: optional(Kind::Temperature, "temperature_degc"),
            acceleration: None,
            on_mass: OnMass::default(),
            destroyed: BTreeMap::new(),
            specimen: None,
            understood: None,
        }
    }
}

impl Layout {
    /// Rows between the names and the first row of numbers.
    pub(crate) fn rows_below_names(&self) -> usize {
        usize::from(self.units_row) + self.skip_below_names
    }
}

impl Reading {
    /// A column in SI units, or in those of the units row.
    pub(crate) fn plain(kind: Kind, column: &str) -> Self {
        Self { kind, column: column.to_owned(), unit: None, offset: 0.0, scale: None, sign: 1.0 }
    }
}

impl Separator {
    /// The byte between two cells; whitespace has become tabs.
    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab | Self::Whitespace => b'\t',
        }
    }

    /// As it is written in mappings.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Comma => "comma",
            Self::Semicolon => "semicolon",
            Self::Tab => "tab",
            Self::Whitespace => "whitespace",
        }
    }
}

impl Extension {
    /// As it is written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::Negative => "negative",
            Self::Unknown => "unknown",
        }
    }

    /// The one of this name.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let all = [Self::Positive, Self::Negative, Self::Unknown];
        all.into_iter().find(|extension| extension.name() == name)
    }
}

impl Wanted {
    /// Whether a cell holds it. Numbers match within 0.1 %, so that 0.871 finds 0.8712.
    pub(crate) fn holds(&self, cell: &str, number: Option<f64>) -> bool {
        match self {
            Self::Number(wanted) => {
                number.is_some_and(|found| (found - wanted).abs() <= 1e-3 * wanted.abs())
            }
            Self::Text(wanted) => cell == wanted,
            Self::Any(several) => several.iter().any(|wanted| wanted.holds(cell, number)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wanted_values_match_as_people_write_them() {
        let wanted = Wanted::Any(vec![Wanted::Number(0.871), Wanted::Text("B".to_owned())]);
        assert!(wanted.holds("0.8712", Some(0.8712)) && wanted.holds("B", None));
        assert!(!wanted.holds("0.88", Some(0.88)) && !wanted.holds("b", None));
        assert!(Wanted::Number(0.0).holds("0", Some(0.0)));
        assert!(!Wanted::Number(0.2).holds("0.25", Some(0.25)));
    }
}
