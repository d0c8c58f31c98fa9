//! The gateway: a rig that speaks its own messages, behind a bus that speaks ours.
//!
//! ```text
//!             ours: arming, seals, states         the rig's own DBC
//!   host  <------------------------------> Gateway <---------------> rig
//!                                            front    codec
//! ```
//!
//! Towards the host a [`Gateway`] is a bus with one rig on it: it answers the arming exchange,
//! takes sealed commands and gives sealed measurements, so the control loop knows nothing of it.
//! Towards the wire it writes each command into the rig's command message, and reads force and
//! displacement from the rig's messages. A DBC and a map that names signals in it say how
//! ([`GatewayPlan`]).
//!
//! What the rig's messages lack, the gateway makes up, and with it goes what the lacking part is
//! for: a seal that the gateway computes itself proves nothing about the wire. Each such [`Loss`]
//! has a name, and a run begins only where an operator has accepted every one.
//!
//! A rig that neither counts its measurements nor stops by itself when commands cease cannot be
//! coupled at all. A time-out that the map declares is tried before the rig is armed
//! (`gateway/preparation.rs`).
//!
//! Limits: one rig on its interface; no CRC of the rig's own; no slow-down, which its messages
//! cannot say; SAFE is latched here and ends with this process.
//!
//! Read in this order: `map` (the file), `resolve` (its names to a `plan`, by `key`, `look_up` and
//! `unit`), `placement` (whose message, whose bits) and `capacity` (what signals hold), `loss`,
//! `codec` (frames to values and back), `preparation` (what is tried before arming), `front` (the
//! rig that the host sees), `gateway` (the bus).

mod capacity;
mod codec;
mod error;
mod front;
#[expect(clippy::module_inception, reason = "the bus itself, next to its parts")]
mod gateway;
mod key;
mod load;
mod look_up;
mod loss;
mod map;
mod placement;
mod plan;
mod preparation;
mod resolve;
mod unit;
mod wire;

pub use error::GatewayError;
pub use gateway::Gateway;
pub(crate) use load::load;
pub use loss::{InvalidLoss, Loss, loss_lines};
pub use plan::GatewayPlan;
pub use preparation::Unready;
pub use wire::Wire;
