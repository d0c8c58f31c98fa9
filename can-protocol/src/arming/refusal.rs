//! Why a rig was not armed: one item, and who objected.
use super::item::ArmItem;
use super::quiet::Heard;
use core::fmt;

/// An item whose value does not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortfall {
    /// The item.
    pub item: ArmItem,
    /// Its value.
    pub found: u32,
    /// The value that it must have, reach or not exceed.
    pub needed: u32,
}

/// The end of an exchange that did not arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The rig did not answer.
    Unanswered {
        /// What was asked.
        item: ArmItem,
        /// How often.
        attempts: u8,
    },
    /// The rig refused, for the reason of this item.
    ByRig(ArmItem),
    /// The host refused what the rig answered.
    ByHost(Shortfall),
    /// The bus never stayed quiet.
    NotQuiet(Heard),
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { item, found, needed } = self;
        match item {
            ArmItem::ZeroAge | ArmItem::ForceAtRest if *found == u32::MAX => {
                write!(f, "{item} is unknown, must be at most {needed}")
            }
            ArmItem::ZeroAge | ArmItem::ForceAtRest => {
                write!(f, "{item} is {found}, must be at most {needed}")
            }
            ArmItem::RigNumber => write!(f, "{item} {found:#010x} repeats an earlier session code"),
            ArmItem::Alive | ArmItem::Configuration => {
                write!(f, "{item} is {found:#010x}, must be {needed:#010x}")
            }
            _ => write!(f, "{item} is {found}, must be at least {needed}"),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unanswered { item, attempts } => {
                write!(f, "the rig did not answer {item} in {attempts} attempts")
            }
            Self::ByRig(item) => write!(f, "the rig refused: {item}"),
            Self::ByHost(shortfall) => shortfall.fmt(f),
            Self::NotQuiet(heard) => write!(f, "the bus is not quiet: {heard}"),
        }
    }
}
