//! The period of the control loop.

/// Length of one control cycle (s).
pub const CYCLE_S: f64 = 1e-3;
