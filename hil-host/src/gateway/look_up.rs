//! Signals of the DBC, as the keys of the map name them.

use super::error::GatewayError;
use super::key::MapKey;
use super::map::Mapped;
use super::unit::Dimension;
use dbc::{Database, DbcError, Message, NamedSignal, Signal};
use files::quoted;
use scenario::source::Source;

/// Fewest values of a counter.
const FEWEST_COUNTS: u64 = 3;

/// A signal of the DBC under a key of the map.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) key: MapKey,
    pub(super) message: Message,
    /// `MESSAGE.SIGNAL`.
    pub(super) name: String,
    pub(super) signal: Signal,
    /// SI units in one physical unit of the DBC, with the sign; 1 for a code or a counter.
    pub(super) scale: f64,
}

impl Found {
    fn new(key: MapKey, (message, named): (Message, NamedSignal), scale: f64) -> Self {
        Self { key, message, name: named.name, signal: named.signal, scale }
    }
}

/// Finds the signals of a map.
#[derive(Debug, Clone, Copy)]
pub(super) struct LookUp<'a> {
    pub(super) database: &'a Database,
    pub(super) map: &'a Source,
}

impl LookUp<'_> {
    /// A signal with a unit.
    pub(super) fn quantity(
        &self,
        key: MapKey,
        mapped: &Mapped,
        dimension: Dimension,
    ) -> Result<Found, GatewayError> {
        let found = self.named(&key, &mapped.signal)?;
        let (_, named) = &found;
        let unit = mapped.unit.as_ref().unwrap_or(&named.unit);
        let scale = match (mapped.scale.or_else(|| dimension.scale(unit)), &mapped.unit) {
            (Some(scale), _) => scale * mapped.sign,
            (None, Some(unit)) => {
                let found = format!("unit \"{}\"", quoted(unit));
                return Err(key.refuse(self.map, found, dimension.units()));
            }
            (None, None) => {
                return Err(GatewayError::Unit {
                    file: self.database.path().to_owned(),
                    line: named.line,
                    signal: named.name.clone(),
                    unit: unit.clone(),
                    expected: dimension.units(),
                });
            }
        };
        Ok(Found::new(key, found, scale))
    }

    /// A signal whose values are codes, without a unit.
    pub(super) fn code(&self, key: MapKey, name: &str) -> Result<Found, GatewayError> {
        let found = self.named(&key, name)?;
        Ok(Found::new(key, found, 1.0))
    }

    /// A signal that counts.
    pub(super) fn counter(&self, key: MapKey, name: &str) -> Result<Found, GatewayError> {
        let found = self.code(key, name)?;
        if !found.signal.is_whole() || found.signal.modulus() < FEWEST_COUNTS {
            let said = format!("signal {}", found.name);
            return Err(found.key.refuse(self.map, said, "an unsigned signal of 2 bits or more"));
        }
        Ok(found)
    }

    /// A signal by its name: where the DBC has none or several of it, the map is at fault.
    fn named(&self, key: &MapKey, name: &str) -> Result<(Message, NamedSignal), GatewayError> {
        let dbc = self.database.path().file_name().unwrap_or_default().to_string_lossy();
        self.database.signal(name).map_err(|why| match why {
            DbcError::NoSignal { name, similar, .. } => {
                let found = format!("no signal \"{}\" in {dbc}", quoted(&name));
                key.refuse(self.map, found, format!("the name of one{similar}"))
            }
            DbcError::Ambiguous { name, signals, .. } => {
                let signals: Vec<String> =
                    signals.iter().map(|signal| quoted(signal).to_string()).collect();
                let found = format!("several signals \"{}\" in {dbc}", quoted(&name));
                key.refuse(self.map, found, format!("one of {}", signals.join(", ")))
            }
            other => other.into(),
        })
    }
}
