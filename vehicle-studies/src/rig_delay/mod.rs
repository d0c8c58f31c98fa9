//! The critical speed that a vehicle has with its dampers behind rigs that are late.
//!
//! ```text
//! v(tau, rigs) - v(all dampers modelled)       tau: delay of the force that compensation has left
//! ```
//! A late force has lost a part of its damping and gained stiffness instead
//! (`1 - cos(w tau) + w lambda sin(w tau)`, [`firmware_core::compensation::damping_energy_lost`]),
//! so the critical speed that is measured with a rig is that of another damper. The speed is the
//! one below which no hunting stays ([`Fold`](crate::critical_speed::Fold)): no seed and no
//! threshold enter. The rigs are emulated ([`Rigs`](crate::trip::Rigs)). Next to each speed stands
//! that of eigenvalues, with every damper behind a rig turned by the delay at one stroke.
//!
//! Limits: the rig is a pure delay, and all rigs have the same one. A servo rig is late by its
//! load; its delay as a run measures it is the mean.

mod answer;
mod page;
mod procedure;
mod study;
mod text;

pub use answer::{OnRigs, RigDelay, Speeds};
pub use procedure::{OWN_KEY, Question};
