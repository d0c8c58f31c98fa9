//! Arming: the exchange after which a rig may move.

mod agreement;
mod configuration;
mod host;
mod item;
mod limits;
mod message;
mod quiet;
mod readiness;
mod refusal;
mod rig;

pub use agreement::Agreement;
pub use configuration::{Configuration, DBC_HASH};
pub use host::{HostArming, HostOutcome, HostPlan, Patience};
pub use item::ArmItem;
pub use limits::Limits;
pub use message::{ArmMessage, ArmSide};
pub use quiet::{Foreign, Heard, Listener, Quiet};
pub use readiness::{Readiness, Requirements};
pub use refusal::{Refusal, Shortfall};
pub use rig::{RigArming, RigEvent, RigStatus};
