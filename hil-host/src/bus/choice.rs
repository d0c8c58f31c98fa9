//! Which bus a rig is on, as a user writes it.

use files::{quoted, suggestion};
use std::fmt;
use std::str::FromStr;

/// Where the rigs are.
///
/// ```
/// use hil_host::bus::BusChoice;
/// assert_eq!("socketcan:can0".parse(), Ok(BusChoice::SocketCan("can0".to_owned())));
/// let refused = "can0".parse::<BusChoice>().unwrap_err();
/// assert_eq!(refused.to_string(), "found \"can0\", expected memory or socketcan:INTERFACE");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BusChoice {
    /// Emulated rigs in this process.
    Memory,
    /// A CAN interface.
    SocketCan(String),
}

impl BusChoice {
    /// Whether the rigs on it go on in cycles that the host misses.
    pub(crate) const fn has_own_time(&self) -> bool {
        !matches!(self, Self::Memory)
    }

    /// The interface as `bus.log` names it.
    pub(crate) fn interface(&self) -> &str {
        match self {
            Self::Memory => "memory",
            Self::SocketCan(name) => name,
        }
    }
}

impl FromStr for BusChoice {
    type Err = InvalidBus;

    fn from_str(text: &str) -> Result<Self, InvalidBus> {
        match text.split_once(':') {
            None if text == "memory" => Ok(Self::Memory),
            Some(("socketcan", name)) if is_interface(name) => Ok(Self::SocketCan(name.to_owned())),
            _ => Err(InvalidBus { found: text.to_owned() }),
        }
    }
}

/// What Linux takes for the name of an interface: 1 to 15 bytes, no white space, no slash.
fn is_interface(name: &str) -> bool {
    let plain = |c: char| !(c.is_control() || c.is_whitespace() || c == '/');
    (1..=15).contains(&name.len()) && name.chars().all(plain)
}

impl fmt::Display for BusChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Memory => f.write_str("memory"),
            Self::SocketCan(name) => write!(f, "socketcan:{name}"),
        }
    }
}

/// A text that names no bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InvalidBus {
    /// The text.
    pub found: String,
}

impl fmt::Display for InvalidBus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A bus with an interface is compared without it.
        let (kind, interface) = self.found.split_once(':').unwrap_or((&self.found, ""));
        let similar = match suggestion::closest(kind, ["memory", "socketcan"]) {
            Some("socketcan") if interface.is_empty() => {
                "; did you mean socketcan:can0?".to_owned()
            }
            Some("socketcan") => format!("; did you mean socketcan:{}?", quoted(interface)),
            Some(kind) => format!("; did you mean {kind}?"),
            None => String::new(),
        };
        let found = quoted(&self.found);
        write!(f, "found \"{found}\", expected memory or socketcan:INTERFACE{similar}")
    }
}

impl std::error::Error for InvalidBus {}
