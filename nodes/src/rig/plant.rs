//! What a rig moves and measures: the plant behind its node.
//!
//! On the host it is an emulator, on a board a servo controller and its sensors, or a model.

use super::condition::Condition;
use core::fmt::Debug;

/// A ram with what is mounted on it, in cycles. A value has the parameters, and its
/// [`Plant::State`] everything that changes.
pub trait Plant: Clone {
    /// What it is made from.
    type Setup;
    /// Everything that it remembers. A clone is a snapshot.
    type State: Debug + Clone + PartialEq;

    /// A plant for cycles of `period_s`; `stream` keeps the noise of several rigs apart.
    fn new(setup: &Self::Setup, period_s: f64, stream: u64) -> Self;

    /// Seed of the numbers that an emulated rig draws.
    fn seed(setup: &Self::Setup) -> u64;

    /// What the rig knows of itself at the start.
    fn condition(setup: &Self::Setup) -> Condition;

    /// The same plant for cycles of another length (s).
    #[must_use]
    fn with_period(self, period_s: f64) -> Self;

    /// Length of a cycle (s).
    fn period_s(&self) -> f64;

    /// Largest travel from the middle to either side (m).
    fn stroke_m(&self) -> f64;

    /// The ram at rest at a displacement (m).
    fn start_at(&self, ram_m: f64) -> Self::State;

    /// Begins a session with the plant as it stands.
    fn begin(&self, state: &mut Self::State);

    /// One cycle.
    fn cycle(&self, state: &mut Self::State, target: Target) -> Reading;

    /// Gives the drive its power or takes it, before each cycle: it has power while the rig is
    /// armed, moves or comes to rest. An emulated drive always has it.
    fn power(&self, _state: &mut Self::State, _is_on: bool) {}

    /// Whether the last reading was measured. One that was not repeats the last that was.
    fn is_measured(&self, _state: &Self::State) -> bool {
        true
    }

    /// Whether the drive has lost its power although the rig gives it.
    fn has_lost_power(&self, _state: &Self::State) -> bool {
        false
    }

    /// Whether the ram stands still.
    fn is_at_rest(&self, state: &Self::State) -> bool;

    /// Displacement of the ram (m).
    fn ram_m(state: &Self::State) -> f64;

    /// Displacement across the eyes of the damper (m).
    fn eyes_m(state: &Self::State) -> f64;

    /// Force of the damper (N).
    fn force_n(state: &Self::State) -> f64;

    /// Temperature of the damper (degrees Celsius), if there is a thermometer.
    fn temperature_degc(state: &Self::State) -> Option<f64>;
}

/// What the ram does in a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// Follow the reference that runs on from here.
    Follow(Reference),
    /// Come to rest and hold.
    Hold,
    /// Go to mid-stroke slowly.
    Centre,
}

/// What the sensors show at the end of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Load cell, tension positive (N).
    pub force_n: f64,
    /// Displacement across the damper's eyes, or at the ram where its sensor is there, extension
    /// positive (m).
    pub displacement_m: f64,
    /// Displacement of the ram (m).
    pub ram_displacement_m: f64,
    /// How far the ram is behind the command, pure delay included; zero unless it follows (m).
    pub behind_m: f64,
    /// Limits that changed the motion in this cycle.
    pub limits: Limits,
}

/// What the ram should follow from now on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reference {
    /// Displacement now (m).
    pub displacement_m: f64,
    /// Rate at which it runs on (m/s).
    pub velocity_m_per_s: f64,
}

impl Reference {
    /// The reference after a time.
    #[must_use]
    pub fn after(self, time_s: f64) -> Self {
        let displacement_m = self.displacement_m + self.velocity_m_per_s * time_s;
        Self { displacement_m, ..self }
    }
}

/// Limits that changed the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Limits {
    /// The stroke.
    pub stroke: bool,
    /// The speed.
    pub rate: bool,
}

impl Limits {
    /// Whether any did.
    pub fn any(self) -> bool {
        self.stroke || self.rate
    }
}
