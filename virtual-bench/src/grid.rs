//! The time steps of a simulation.

/// How a simulation samples time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Length of a step, s.
    pub step_s: f64,
    /// Number of steps.
    pub steps: usize,
}
