//! How late the ram of a rig was measured to be.

use serde::{Deserialize, Serialize};

/// A delay with its source. The delay is that of the measured displacement which arrives in a cycle
/// against the command that leaves in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredRam {
    /// The delay (s).
    pub delay_s: f64,
    /// Where it is from.
    pub source: String,
}
