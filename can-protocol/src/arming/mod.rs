//! Arming: the exchange after which a rig may move.

mod item;
mod message;

pub use item::ArmItem;
pub use message::{ArmMessage, ArmSide};
