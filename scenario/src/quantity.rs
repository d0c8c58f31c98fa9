//! Numbers that say where they come from.
//!
//! In a file a quantity is a plain number, or a table with its provenance:
//! ```toml
//! mass_kg = { value = 65440.0, provenance = "derived", note = "126 t less the rest" }
//! ```

use crate::error::ScenarioError;
use crate::source::Source;
use files::number;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::Range;

/// Where a number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Provenance {
    /// Printed in a named source.
    Published,
    /// Worked out from published numbers.
    Derived,
    /// An engineer's guess within a stated range.
    Estimated,
    /// Fitted here so that the model meets a published result.
    Calibrated,
    /// Fitted to measured records of this very damper.
    Identified,
}

impl Provenance {
    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Derived => "derived",
            Self::Estimated => "estimated",
            Self::Calibrated => "calibrated",
            Self::Identified => "identified",
        }
    }
}

/// A number with its provenance and its place in the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quantity {
    /// The number, in the unit at the end of its key.
    pub value: f64,
    /// Where it comes from, if the file says so.
    pub provenance: Option<Provenance>,
    /// What the file says about it.
    pub note: Option<String>,
    span: Range<usize>,
}

impl Quantity {
    /// A number that is in no file.
    pub fn plain(value: f64) -> Self {
        Self { value, ..Self::default() }
    }

    /// A number that a file gives, or its default.
    pub(crate) fn or(given: Option<&Self>, default: f64) -> Self {
        given.cloned().unwrap_or_else(|| Self::plain(default))
    }

    /// The same number with where it comes from and what there is to say about it.
    #[must_use]
    pub fn with_provenance(self, provenance: Provenance, note: Option<String>) -> Self {
        Self { provenance: Some(provenance), note, ..self }
    }

    /// The value, if a vehicle can have it: above zero and within two bounds far beyond any.
    ///
    /// A number outside them overflows in the equations, where nothing would name it.
    pub(crate) fn positive_within(
        &self,
        source: &Source,
        key: &str,
        lower: f64,
        upper: f64,
    ) -> Result<f64, ScenarioError> {
        debug_assert!(0.0 < lower && lower < upper, "a range of positive numbers");
        let expected = format!("a positive number from {} to {}", number(lower), number(upper));
        self.within(source, key, lower, upper, &expected)
    }

    /// The value, if it is zero or more and at most `upper`.
    pub(crate) fn up_to(
        &self,
        source: &Source,
        key: &str,
        upper: f64,
    ) -> Result<f64, ScenarioError> {
        self.within(source, key, 0.0, upper, &format!("zero or more and at most {}", number(upper)))
    }

    /// The value, if its size is at most `largest`.
    pub(crate) fn sized(
        &self,
        source: &Source,
        key: &str,
        largest: f64,
    ) -> Result<f64, ScenarioError> {
        let bound = number(largest);
        self.within(source, key, -largest, largest, &format!("a number from -{bound} to {bound}"))
    }

    /// The value, if it is finite and above zero.
    ///
    /// # Errors
    /// Names the key, the value and the file's line.
    pub fn positive(&self, source: &Source, key: &str) -> Result<f64, ScenarioError> {
        self.within(source, key, f64::MIN_POSITIVE, f64::MAX, "a positive number")
    }

    /// The value, if it is finite and not below zero.
    ///
    /// # Errors
    /// Names the key, the value and the file's line.
    pub fn not_negative(&self, source: &Source, key: &str) -> Result<f64, ScenarioError> {
        self.within(source, key, 0.0, f64::MAX, "zero or more")
    }

    /// The value, if it is finite.
    ///
    /// # Errors
    /// Names the key, the value and the file's line.
    pub fn finite(&self, source: &Source, key: &str) -> Result<f64, ScenarioError> {
        self.within(source, key, -f64::MAX, f64::MAX, "a finite number")
    }

    /// The value, if it lies in a range.
    ///
    /// # Errors
    /// Names the key, the value, what was expected and the file's line.
    pub fn within(
        &self,
        source: &Source,
        key: &str,
        lower: f64,
        upper: f64,
        expected: &str,
    ) -> Result<f64, ScenarioError> {
        if self.value >= lower && self.value <= upper {
            return Ok(self.value);
        }
        Err(self.refused(source, key, expected))
    }

    /// The value that a file gives, if it lies in a range, or the default.
    ///
    /// # Errors
    /// As for [`Quantity::within`].
    pub(crate) fn within_or(
        given: Option<&Self>,
        source: &Source,
        key: &str,
        (least, most, unit): (f64, f64, &str),
        default: f64,
    ) -> Result<f64, ScenarioError> {
        let range = format!("{least} to {most} {unit}");
        given.map_or(Ok(default), |value| value.within(source, key, least, most, &range))
    }

    /// The error of a number that is not what was expected.
    pub(crate) fn refused(
        &self,
        source: &Source,
        key: &str,
        expected: impl Into<String>,
    ) -> ScenarioError {
        let (key, expected) = (key.into(), expected.into());
        ScenarioError::Value { at: source.place(&self.span), key, found: self.value, expected }
    }

    /// An error at this number.
    pub fn error(&self, source: &Source, message: impl Into<String>) -> ScenarioError {
        source.error(&self.span, message)
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = toml::Spanned::<Plain>::deserialize(deserializer)?;
        let span = spanned.span();
        let Plain(mut quantity) = spanned.into_inner();
        quantity.span = span;
        Ok(quantity)
    }
}

impl Serialize for Quantity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.provenance.is_none() && self.note.is_none() {
            return serializer.serialize_f64(self.value);
        }
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("value", &self.value)?;
        if let Some(provenance) = &self.provenance {
            map.serialize_entry("provenance", provenance)?;
        }
        if let Some(note) = &self.note {
            map.serialize_entry("note", note)?;
        }
        map.end()
    }
}

/// A quantity before its place is known.
struct Plain(Quantity);

impl<'de> Deserialize<'de> for Plain {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrTable).map(Plain)
    }
}

struct NumberOrTable;

impl<'de> Visitor<'de> for NumberOrTable {
    type Value = Quantity;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a number, or a table with value, provenance and note")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Quantity, E> {
        Ok(Quantity::plain(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Quantity, E> {
        Ok(Quantity::plain(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Quantity, E> {
        Ok(Quantity::plain(value as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Quantity, A::Error> {
        let mut quantity = Quantity::default();
        let mut value: Option<Quantity> = None;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "value" => value = Some(map.next_value::<Plain>()?.0),
                "provenance" => quantity.provenance = Some(map.next_value()?),
                "note" => quantity.note = Some(map.next_value()?),
                _ => {
                    return Err(A::Error::unknown_field(&key, &["value", "provenance", "note"]));
                }
            }
        }
        quantity.value = value.ok_or_else(|| A::Error::missing_field("value"))?.value;
        Ok(quantity)
    }
}
