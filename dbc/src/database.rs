//! A DBC file: its messages, and the signals that somebody asks for.

use crate::error::DbcError;
use crate::field::Field;
use crate::id::CanId;
use crate::lines::{line_of, lines_of_message};
use crate::multiplex::{Condition, MOST_CONDITIONS, MOST_RANGES, Presence};
use crate::signal::{Kind, Signal};
use can_dbc::{
    AttributeValue, ByteOrder, Dbc, ExtendedMultiplex, Message as DbcMessage, MessageId,
    MultiplexIndicator, NumericValue, Signal as DbcSignal, SignalExtendedValueType, ValueType,
};
use files::input::{self, Limit};
use files::{did_you_mean, quote};
use std::path::{Path, PathBuf};

/// A message database.
///
/// Only what is asked for is judged: a signal that makes no sense hurts nobody who does not use it.
#[derive(Debug, Clone, PartialEq)]
pub struct Database {
    path: PathBuf,
    text: String,
    dbc: Dbc,
}

/// A message of a database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Its identifier.
    pub id: CanId,
    /// Its name.
    pub name: String,
    /// Bytes of its payload.
    pub len: usize,
    /// Whether it is a CAN FD frame: so says `VFrameFormat`, or it has more than 8 bytes.
    pub is_fd: bool,
}

/// A signal with what a user calls it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedSignal {
    /// Message and signal, `MESSAGE.SIGNAL`.
    pub name: String,
    /// The line of the file that it stands in.
    pub line: Option<usize>,
    /// The unit, as the file has it.
    pub unit: String,
    /// Its bits and values.
    pub signal: Signal,
}

impl Database {
    /// Reads a file. Text that is no UTF-8 is taken as Latin-1, in which most editors of DBC write.
    ///
    /// # Errors
    /// The file cannot be read, or is no DBC.
    pub fn read(path: &Path) -> Result<Self, DbcError> {
        let text = match String::from_utf8(input::read_bytes(path, Limit::Text)?) {
            Ok(text) => text,
            Err(why) => why.as_bytes().iter().map(|byte| char::from(*byte)).collect(),
        };
        Self::from_text(path, text.trim_start_matches('\u{feff}'))
    }

    /// Text that is in memory already; `path` names it in errors.
    ///
    /// # Errors
    /// The text is no DBC.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, DbcError> {
        let dbc = Dbc::try_from(text).map_err(|why| syntax(path, &why.to_string()))?;
        Ok(Self { path: path.to_owned(), text: text.to_owned(), dbc })
    }

    /// What the file holds.
    pub fn contents(&self) -> &Dbc {
        &self.dbc
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A signal by its name, or by `MESSAGE.SIGNAL` where several messages have one of that name.
    ///
    /// # Errors
    /// No signal or several, or one whose bits cannot be used.
    pub fn signal(&self, name: &str) -> Result<(Message, NamedSignal), DbcError> {
        let all = || {
            let messages = self.dbc.messages.iter();
            messages.flat_map(|message| message.signals.iter().map(move |signal| (message, signal)))
        };
        let is_named = |(message, signal): &(&DbcMessage, &DbcSignal)| {
            signal.name == name || full_name(message, signal) == name
        };
        let found: Vec<_> = all().filter(is_named).collect();
        found.iter().try_for_each(|(message, _)| self.refuse_twice(message))?;
        match *found {
            [(message, signal)] => {
                Ok((self.message(message, signal)?, self.named(message, signal)?))
            }
            [] => {
                let known: Vec<String> = if name.contains('.') {
                    all().map(|(message, signal)| full_name(message, signal)).collect()
                } else {
                    all().map(|(_, signal)| signal.name.clone()).collect()
                };
                let similar = did_you_mean(name, known.iter().map(String::as_str));
                Err(DbcError::NoSignal { file: self.path.clone(), name: name.to_owned(), similar })
            }
            [(message, signal), (other, _), ..] if std::ptr::eq(message, other) => {
                let found = "a second one of this name in its message".to_owned();
                Err(self.unusable(message, signal, found, "names of their own"))
            }
            _ => Err(DbcError::Ambiguous {
                file: self.path.clone(),
                name: name.to_owned(),
                signals: found.iter().map(|(message, signal)| full_name(message, signal)).collect(),
            }),
        }
    }

    /// Refuses a message whose name or identifier another one has too.
    fn refuse_twice(&self, message: &DbcMessage) -> Result<(), DbcError> {
        let mut others = self.dbc.messages.iter().filter(|other| !std::ptr::eq(*other, message));
        let is_same = |other: &&DbcMessage| other.name == message.name || other.id == message.id;
        let Some(other) = others.find(is_same) else { return Ok(()) };
        let first = lines_of_message(&self.text, &message.name).next();
        let (line, found) = if other.name == message.name {
            let again = lines_of_message(&self.text, &message.name).nth(1);
            let first = first.map_or(String::new(), |line| format!(" (line {line})"));
            (again, format!("a second message of this name{first}"))
        } else {
            (first, format!("the identifier of message {} as well", other.name))
        };
        Err(DbcError::Twice { file: self.path.clone(), line, message: message.name.clone(), found })
    }

    /// The message of a signal.
    fn message(&self, message: &DbcMessage, signal: &DbcSignal) -> Result<Message, DbcError> {
        let refuse = |found, expected| Err(self.unusable(message, signal, found, expected));
        let id = match message.id {
            MessageId::Standard(id) if id <= 0x7FF => CanId::Standard(id),
            MessageId::Extended(id) => CanId::Extended(id),
            MessageId::Standard(id) => {
                let found = format!("identifier {id} in its message");
                return refuse(found, "11 bits, or 29 bits with bit 31 set");
            }
        };
        let is_fd = message.size > 8 || self.frame_format(message.id).is_some_and(|it| it >= 14);
        let is_length = match message.size {
            0..=8 => true,
            12 | 16 | 20 | 24 | 32 | 48 | 64 => is_fd,
            _ => false,
        };
        if !is_length {
            let found = format!("{} bytes in its message", message.size);
            return refuse(found, "0 to 8, 12, 16, 20, 24, 32, 48 or 64");
        }
        Ok(Message { id, name: message.name.clone(), len: message.size as usize, is_fd })
    }

    /// The attribute `VFrameFormat`: from 14 on it is a CAN FD frame.
    fn frame_format(&self, id: MessageId) -> Option<u64> {
        let all = self.dbc.attribute_values_message.iter();
        let mut own = all.filter(|value| value.message_id == id && value.name == "VFrameFormat");
        match own.next()?.value {
            AttributeValue::Uint(format) => Some(format),
            _ => None,
        }
    }

    fn named(&self, message: &DbcMessage, signal: &DbcSignal) -> Result<NamedSignal, DbcError> {
        let prepared = self.prepared(message, signal)?;
        if prepared.end() > message.size as usize {
            let found = format!("bits behind the {} bytes of its message", message.size);
            return Err(self.unusable(message, signal, found, "bits within them"));
        }
        Ok(NamedSignal {
            name: full_name(message, signal),
            line: line_of(&self.text, &message.name, &signal.name),
            unit: signal.unit.clone(),
            signal: prepared,
        })
    }

    fn prepared(&self, message: &DbcMessage, signal: &DbcSignal) -> Result<Signal, DbcError> {
        let refuse = |found, expected| Err(self.unusable(message, signal, found, expected));
        let Some(field) = field_of(signal) else {
            return refuse(format!("{} bits", signal.size), "1 to 64");
        };
        let kind = match (self.float_of(message, signal), signal.value_type) {
            (Some(32), _) => Kind::Float32,
            (Some(_), _) => Kind::Float64,
            (None, ValueType::Signed) => Kind::Signed,
            (None, ValueType::Unsigned) => Kind::Unsigned,
        };
        if let Some(bits) = self.float_of(message, signal).filter(|bits| *bits != signal.size) {
            return refuse(format!("{} bits", signal.size), if_float(bits));
        }
        let is_number = signal.factor.is_finite() && signal.offset.is_finite();
        if signal.factor == 0.0 || !is_number {
            let found = format!("factor {} and offset {}", signal.factor, signal.offset);
            return refuse(found, "a factor other than 0, and finite numbers");
        }
        let (low, high) = (number(signal.min), number(signal.max));
        if low.is_nan() || high.is_nan() || low > high {
            return refuse(format!("limits [{low}|{high}]"), "the lower one first");
        }
        let prepared = Signal {
            field,
            kind,
            factor: signal.factor,
            offset: signal.offset,
            limits: (low < high).then_some((low, high)),
            presence: self.presence(message, signal)?,
        };
        if prepared.is_on_its_selector() {
            return refuse("bits of its own selector".to_owned(), "bits apart from it");
        }
        Ok(prepared)
    }

    /// Bits of a float, as `SIG_VALTYPE_` says.
    fn float_of(&self, message: &DbcMessage, signal: &DbcSignal) -> Option<u64> {
        let mut types = self.dbc.signal_extended_value_type_list.iter();
        let own =
            types.find(|one| one.message_id == message.id && one.signal_name == signal.name)?;
        match own.signal_extended_value_type {
            SignalExtendedValueType::SignedOrUnsignedInteger => None,
            SignalExtendedValueType::IEEEfloat32Bit => Some(32),
            SignalExtendedValueType::IEEEdouble64bit => Some(64),
        }
    }

    /// The chain of conditions under which a signal is in its frame.
    fn presence(&self, message: &DbcMessage, signal: &DbcSignal) -> Result<Presence, DbcError> {
        let refuse = |found: String, expected| Err(self.unusable(message, signal, found, expected));
        let (mut presence, mut depth, mut of) = (Presence::default(), 0, signal);
        while let Some((selector, ranges)) = self.condition(message, of) {
            let Some(field) = selector.and_then(field_of) else {
                return refuse("no selector of its page".to_owned(), "one with 1 to 64 bits");
            };
            if ranges.is_empty() || ranges.len() > MOST_RANGES {
                return refuse(format!("{} ranges of its page", ranges.len()), "1 to 8");
            }
            let Some(place) = presence.conditions.get_mut(depth) else {
                return refuse(format!("over {MOST_CONDITIONS} selectors"), "at most 4");
            };
            let mut kept = [None; MOST_RANGES];
            for (to, from) in kept.iter_mut().zip(ranges) {
                *to = Some(from);
            }
            *place = Some(Condition { selector: field, ranges: kept });
            depth += 1;
            let Some(next) = selector else { break };
            of = next;
        }
        Ok(presence)
    }

    /// The selector of a signal's page, where it has one, and the values with which it is there;
    /// none for a signal that is in every frame.
    fn condition<'a>(
        &'a self,
        message: &'a DbcMessage,
        signal: &DbcSignal,
    ) -> Option<(Option<&'a DbcSignal>, Ranges)> {
        let named = |name: &str| message.signals.iter().find(|signal| signal.name == name);
        let is_own = |one: &&ExtendedMultiplex| {
            one.message_id == message.id && one.signal_name == signal.name
        };
        if let Some(own) = self.dbc.extended_multiplex.iter().find(is_own) {
            let ranges = own.mappings.iter().map(|range| (range.min_value, range.max_value));
            return Some((named(&own.multiplexor_signal_name), ranges.collect()));
        }
        let (MultiplexIndicator::MultiplexedSignal(page)
        | MultiplexIndicator::MultiplexorAndMultiplexedSignal(page)) = signal.multiplexer_indicator
        else {
            return None;
        };
        let is_selector =
            |one: &&DbcSignal| one.multiplexer_indicator == MultiplexIndicator::Multiplexor;
        Some((message.signals.iter().find(is_selector), vec![(page, page)]))
    }

    fn unusable(
        &self,
        message: &DbcMessage,
        signal: &DbcSignal,
        found: String,
        expected: &'static str,
    ) -> DbcError {
        DbcError::Signal {
            file: self.path.clone(),
            line: line_of(&self.text, &message.name, &signal.name),
            signal: full_name(message, signal),
            found,
            expected,
        }
    }
}

/// First and last value of each range.
type Ranges = Vec<(u64, u64)>;

fn full_name(message: &DbcMessage, signal: &DbcSignal) -> String {
    format!("{}.{}", message.name, signal.name)
}

fn field_of(signal: &DbcSignal) -> Option<Field> {
    let is_little_endian = signal.byte_order == ByteOrder::LittleEndian;
    // The start bit of the longest frame is 511.
    let start = u32::try_from(signal.start_bit).ok().filter(|start| *start < 512)?;
    Field::new(start, u32::try_from(signal.size).ok()?, is_little_endian)
}

const fn if_float(bits: u64) -> &'static str {
    if bits == 32 { "32, for an IEEE float" } else { "64, for an IEEE double" }
}

fn number(value: NumericValue) -> f64 {
    match value {
        NumericValue::Uint(value) => value as f64,
        NumericValue::Int(value) => value as f64,
        NumericValue::Double(value) => value,
    }
}

/// The parser's message in one line; it names the place as ` --> LINE:COLUMN`.
fn syntax(path: &Path, said: &str) -> DbcError {
    let place = said.split_once("--> ").map_or("", |(_, rest)| rest);
    let line = place.split(':').next().and_then(|line| line.trim().parse().ok());
    let last = said.lines().rfind(|line| line.trim_start().starts_with('='));
    let message = last.map_or(said, |line| line.trim_start().trim_start_matches("= "));
    DbcError::Syntax { file: path.to_owned(), line, message: quote::message(message) }
}
