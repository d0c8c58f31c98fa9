//! How the delay of rigs is asked for, with every number that matters to the answer.

use crate::critical_speed::Procedure;
use serde::Serialize;

/// Key of the axis of delays of the force (ms).
pub const OWN_KEY: &str = "rig_delay_ms";

/// What is asked; track and duration of the scenario do not matter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// How the critical speed is asked for.
    #[serde(flatten)]
    pub procedure: Procedure,
    /// Whether the speed from which irregular track leads to hunting is asked for too.
    pub hunts_from: bool,
    /// Stroke of the dampers for eigenvalues, half the travel (m).
    pub stroke_m: f64,
    /// Time over which the delay is measured (s).
    pub measured_s: f64,
}
