//! Why a CAN interface cannot be used.

use files::quoted;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a bus cannot be opened.
#[derive(Debug)]
pub enum BusError {
    /// This kernel has no CAN at all.
    NoCan,
    /// No interface of this name.
    NoInterface {
        /// The name.
        interface: String,
    },
    /// The interface exists and is not up.
    Down {
        /// The name.
        interface: String,
    },
    /// The FD profile on an interface that is set up for classical frames.
    NotFd {
        /// The name.
        interface: String,
    },
    /// A log is to be played back on an interface that has hardware.
    NotVirtual {
        /// The name.
        interface: String,
    },
    /// A serial line that cannot be connected to.
    NoLine {
        /// Its socket.
        line: PathBuf,
        /// What the kernel said.
        error: io::Error,
    },
    /// The kernel refused something else.
    Refused {
        /// The name.
        interface: String,
        /// What the kernel said.
        error: io::Error,
    },
}

impl BusError {
    /// Whether another interface, or the same one set up, would do: the input is at fault.
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::NoCan
            | Self::NoInterface { .. }
            | Self::Down { .. }
            | Self::NotFd { .. }
            | Self::NoLine { .. }
            | Self::NotVirtual { .. } => true,
            Self::Refused { .. } => false,
        }
    }
}

impl fmt::Display for BusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCan => f.write_str(
                "this kernel has no CAN (try `modprobe vcan`, or a machine whose kernel has it); \
                 --bus memory needs none",
            ),
            Self::NoInterface { interface } => {
                let name = quoted(interface);
                write!(
                    f,
                    "no CAN interface \"{name}\"; a virtual one: `modprobe vcan && ip link add dev \
                     {name} type vcan && ip link set {name} up`"
                )
            }
            Self::Down { interface } => {
                let name = quoted(interface);
                write!(
                    f,
                    "CAN interface \"{name}\" is down; set its bit rate if it is a real one, then \
                     `ip link set {name} up`"
                )
            }
            Self::NotFd { interface } => {
                let name = quoted(interface);
                write!(
                    f,
                    "CAN interface \"{name}\" takes no FD frames; virtual: `ip link set {name} mtu \
                     72`, real: `ip link set {name} type can ... fd on`"
                )
            }
            Self::NotVirtual { interface } => write!(
                f,
                "CAN interface \"{}\" has hardware, expected a virtual one: a log moves nothing \
                 but an emulated rig",
                quoted(interface)
            ),
            Self::NoLine { line, error } => {
                write!(f, "line \"{}\": {error}", quoted(&line.display().to_string()))
            }
            Self::Refused { interface, error } => {
                write!(f, "CAN interface \"{}\" cannot be used: {error}", quoted(interface))
            }
        }
    }
}

impl std::error::Error for BusError {}
