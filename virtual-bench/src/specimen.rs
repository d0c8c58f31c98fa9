//! What can be mounted in the bench.

use crate::excitation::Excitation;
use crate::grid::Grid;
use std::sync::atomic::{AtomicBool, Ordering};

/// One test as a specimen meets it.
#[derive(Debug, Clone, Copy)]
pub struct Load<'a> {
    /// What the actuator does.
    pub excitation: &'a Excitation,
    /// Position around which it does so, m.
    pub mean_m: f64,
    /// Steps at which the force is asked for.
    pub grid: Grid,
    /// Where a joint with clearance starts, as a share of half the clearance, -1 to 1.
    pub start: f64,
    /// Temperature of the oil at the start, degrees Celsius.
    pub start_degc: f64,
    /// Temperature around the damper, degrees Celsius.
    pub ambient_degc: f64,
    /// The temperature of the oil is measured.
    pub thermometer: bool,
    /// Seed of what is random in the specimen.
    pub seed: u64,
    /// Ends the test early where it is set.
    pub stop: &'a AtomicBool,
}

impl Load<'_> {
    /// Displacement and velocity after a number of steps (m, m/s).
    pub fn at(&self, step: usize) -> (f64, f64) {
        debug_assert!(step <= self.grid.steps, "no step {step}");
        let (x, v) = self.excitation.at(step as f64 * self.grid.step_s);
        (self.mean_m + x, v)
    }

    /// The test is to end early: what has been simulated of it is of no use.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// The response of a specimen, one value at the start and after each step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Temperature of the oil, degrees Celsius.
    pub temperature_degc: Vec<f64>,
    /// Steps that the simulation could not solve as it should; none is usual.
    pub doubtful_steps: u32,
}

impl Response {
    /// There is a value at the start and after each step.
    pub(crate) fn is_complete(&self, steps: usize) -> bool {
        self.force_n.len() == steps + 1 && self.temperature_degc.len() == steps + 1
    }
}

/// Something with two eyes that a bench can move.
pub trait Specimen: Sync {
    /// The longest step that it needs, s.
    fn longest_step_s(&self) -> f64;

    /// Its force over a test; fewer values where the test is stopped.
    fn respond(&self, load: &Load<'_>) -> Response;
}
