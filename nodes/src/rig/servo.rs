//! A rig whose ram a servo controller moves, as a board sees it: a set-point out, two sensors in.
//!
//! ```text
//! command -> set-point (DAC) -> controller -> ram -> damper
//!            enable line                      displacement, force (ADCs) -> reading
//! ```
//! The order in which the line is closed and the set-point may move is [`SetPoint`]'s. The node
//! gives the drive power while it is armed or moves; a drive that loses it meanwhile, because its
//! sensors are gone, leads to FAULT and does not come back before a reset. What is between the
//! set-point and the readings is the bench's own: this plant adds no physics.

use super::condition::Condition;
use super::plant::{Limits, Plant, Reading, Target};
use super::ram::Ram;
use super::set_point::{STILL_M, ServoInterface, SetPoint};
use core::fmt::Debug;

/// What a rig behind a servo controller is made from.
#[derive(Debug, Clone)]
pub struct ServoSetup<S> {
    /// Converters and enable line.
    pub servo: S,
    /// Largest travel from the middle to either side (m).
    pub stroke_m: f64,
    /// Largest speed of the set-point (m/s).
    pub rate_m_per_s: f64,
    /// Seed of the numbers that it draws.
    pub seed: u64,
}

/// A rig behind a servo controller, for one length of cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoRig<S> {
    servo: S,
    /// The ram as the set-point may move it, with a cycle as its substep.
    set_point: Ram,
}

/// Everything that it remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoState<S> {
    servo: S,
    set_point: SetPoint,
    has_power: bool,
    has_lost_power: bool,
    is_measured: bool,
    last: Reading,
    /// Change of the displacement in the last cycle (m).
    moved_m: f64,
}

impl<S> ServoState<S> {
    /// The converters, and the bench behind them.
    pub fn servo(&self) -> &S {
        &self.servo
    }
}

impl<S: ServoInterface + Debug + Clone + PartialEq> Plant for ServoRig<S> {
    type Setup = ServoSetup<S>;
    type State = ServoState<S>;

    fn new(setup: &ServoSetup<S>, period_s: f64, _stream: u64) -> Self {
        let set_point = Ram::new(setup.stroke_m, setup.rate_m_per_s, 0.0, period_s);
        Self { servo: setup.servo.clone(), set_point }
    }

    fn seed(setup: &ServoSetup<S>) -> u64 {
        setup.seed
    }

    fn condition(setup: &ServoSetup<S>) -> Condition {
        Condition::of_ram(setup.stroke_m, setup.rate_m_per_s)
    }

    fn with_period(self, period_s: f64) -> Self {
        let Ram { stroke_m, rate_m_per_s, .. } = self.set_point;
        Self { set_point: Ram::new(stroke_m, rate_m_per_s, 0.0, period_s), ..self }
    }

    fn period_s(&self) -> f64 {
        self.set_point.step_s()
    }

    fn stroke_m(&self) -> f64 {
        self.set_point.stroke_m
    }

    /// The ram is where it is: a board moves none to begin.
    fn start_at(&self, ram_m: f64) -> ServoState<S> {
        let last = Reading {
            force_n: 0.0,
            displacement_m: ram_m,
            ram_displacement_m: ram_m,
            behind_m: 0.0,
            limits: Limits::default(),
        };
        ServoState {
            servo: self.servo.clone(),
            set_point: SetPoint::new(),
            has_power: false,
            has_lost_power: false,
            is_measured: false,
            last,
            moved_m: f64::INFINITY,
        }
    }

    fn begin(&self, _state: &mut ServoState<S>) {}

    fn power(&self, state: &mut ServoState<S>, is_on: bool) {
        state.has_power = is_on;
    }

    fn cycle(&self, state: &mut ServoState<S>, target: Target) -> Reading {
        let was_enabled = state.set_point.is_enabled();
        let read =
            state.set_point.cycle(&self.set_point, &mut state.servo, state.has_power, target);
        state.has_lost_power = was_enabled && state.has_power && !state.set_point.is_enabled();
        state.is_measured = read.is_some();
        if let Some(read) = read {
            state.moved_m = (read.displacement_m - state.last.displacement_m).abs();
            state.last = read;
        }
        state.last
    }

    fn is_measured(&self, state: &ServoState<S>) -> bool {
        state.is_measured
    }

    fn has_lost_power(&self, state: &ServoState<S>) -> bool {
        state.has_lost_power
    }

    /// Neither asked to move nor seen to.
    fn is_at_rest(&self, state: &ServoState<S>) -> bool {
        let is_asked = state.set_point.is_enabled() && !state.set_point.is_at_rest();
        !is_asked && (state.moved_m < STILL_M || !state.is_measured)
    }

    fn ram_m(state: &ServoState<S>) -> f64 {
        state.last.displacement_m
    }

    fn eyes_m(state: &ServoState<S>) -> f64 {
        state.last.displacement_m
    }

    fn force_n(state: &ServoState<S>) -> f64 {
        state.last.force_n
    }

    fn temperature_degc(_state: &ServoState<S>) -> Option<f64> {
        None
    }
}
