//! A key of the map, and the line that it stands in.

use super::error::GatewayError;
use files::quoted;
use scenario::source::Source;
use std::fmt;
use toml::de::DeTable;

/// A key of the map: its table, itself, and the name of a constant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct MapKey {
    table: &'static str,
    name: &'static str,
    constant: Option<String>,
}

impl MapKey {
    /// A key of a table.
    pub(super) const fn new(table: &'static str, name: &'static str) -> Self {
        Self { table, name, constant: None }
    }

    /// A constant of the command, by the name of its signal.
    pub(super) fn constant(signal: &str) -> Self {
        Self { constant: Some(signal.to_owned()), ..Self::new("command", "constants") }
    }

    /// Whether it is a constant of the command.
    pub(super) const fn is_constant(&self) -> bool {
        self.constant.is_some()
    }

    /// What stands at this key of a map does not fit.
    pub(super) fn refuse(
        &self,
        map: &Source,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> GatewayError {
        GatewayError::Key {
            file: map.path().to_owned(),
            line: self.line(map.text()),
            key: self.to_string(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// Its line, from one; `None` where the text does not have it.
    fn line(&self, text: &str) -> Option<usize> {
        let map = DeTable::parse(text).ok()?;
        let table = map.get_ref().get(self.table)?.get_ref().as_table()?;
        let (mut key, value) = table.get_key_value(self.name)?;
        if let Some(constant) = &self.constant {
            (key, _) = value.get_ref().as_table()?.get_key_value(constant.as_str())?;
        }
        Some(text.get(..key.span().start)?.matches('\n').count() + 1)
    }
}

/// As a user looks for it: `[command] displacement`.
impl fmt::Display for MapKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] {}", self.table, self.name)?;
        match &self.constant {
            Some(signal) => write!(f, " {}", quoted(signal)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_in_every_way_to_write_it() {
        let constant = MapKey::constant("A.B");
        assert_eq!(constant.to_string(), "[command] constants A.B");
        let line =
            |text: &str| (MapKey::new("command", "velocity").line(text), constant.line(text));
        let table = "[command]\nvelocity = \"v\"\nconstants = { \"A.B\" = 2 }\n";
        assert_eq!(line(table), (Some(2), Some(3)));
        let dotted = "# a map\ncommand.velocity = \"v\"\n[command.constants]\n\"A.B\" = 2\n";
        assert_eq!(line(dotted), (Some(2), Some(4)));
        assert_eq!(line("[command]\n"), (None, None));
    }
}
