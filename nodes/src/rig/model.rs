//! A rig that is a model: a damper of `firmware-core` on a ram that follows a little late.
//!
//! ```text
//! command -> ram (first-order lag, speed, stroke) -> eyes -> damper -> reading
//! ```
//! The fixture is rigid and the sensors are exact: it is the `ideal` rig of `rig-emulator` without
//! compliance and noise, and gives its bits. An image without a bench runs it in the place of one.

use super::condition::Condition;
use super::plant::{Plant, Reading, Reference, Target};
use super::ram::{Ram, RamState, bounded};
use firmware_core::damper::{Damper, DamperState, Motion};

/// Substeps of a cycle.
pub const SUBSTEPS: u32 = 4;

/// What a model of a rig is made from.
#[derive(Debug, Clone, Copy)]
pub struct ModelSetup<'a> {
    /// The damper, prepared for [`SUBSTEPS`] in a cycle where speed counts.
    pub damper: &'a Damper,
    /// Largest travel from the middle to either side (m).
    pub stroke_m: f64,
    /// Largest speed of the ram (m/s).
    pub rate_m_per_s: f64,
    /// Time constant of the ram's lag (s).
    pub lag_s: f64,
    /// Seed of the numbers that it draws.
    pub seed: u64,
}

/// A model of a rig for one length of cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelRig<'a> {
    damper: &'a Damper,
    ram: Ram,
    period_s: f64,
}

/// Everything that it remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelState {
    ram: RamState,
    damper: DamperState,
    force_n: f64,
}

impl ModelRig<'_> {
    fn step_s(&self) -> f64 {
        self.period_s / f64::from(SUBSTEPS)
    }
}

impl<'a> Plant for ModelRig<'a> {
    type Setup = ModelSetup<'a>;
    type State = ModelState;

    fn new(setup: &ModelSetup<'a>, period_s: f64, _stream: u64) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        let ram = Ram::new(setup.stroke_m, setup.rate_m_per_s, setup.lag_s, step_s);
        Self { damper: setup.damper, ram, period_s }
    }

    fn seed(setup: &ModelSetup<'a>) -> u64 {
        setup.seed
    }

    fn condition(setup: &ModelSetup<'a>) -> Condition {
        Condition::of_ram(setup.stroke_m, setup.rate_m_per_s)
    }

    fn with_period(self, period_s: f64) -> Self {
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.ram;
        let ram = Ram::new(stroke_m, rate_m_per_s, lag_s, period_s / f64::from(SUBSTEPS));
        Self { ram, period_s, ..self }
    }

    fn period_s(&self) -> f64 {
        self.period_s
    }

    fn stroke_m(&self) -> f64 {
        self.ram.stroke_m
    }

    fn start_at(&self, ram_m: f64) -> ModelState {
        let displacement_m = bounded(ram_m, self.ram.stroke_m);
        ModelState {
            ram: RamState { displacement_m, velocity_m_per_s: 0.0 },
            damper: DamperState::starting(Motion::new(displacement_m, 0.0)),
            force_n: 0.0,
        }
    }

    fn begin(&self, _state: &mut ModelState) {}

    fn cycle(&self, state: &mut ModelState, target: Target) -> Reading {
        let ModelState { ram, damper, force_n } = state;
        let limits = self.ram.cycle(ram, target, SUBSTEPS, |ram| {
            let motion = Motion::new(ram.displacement_m, ram.velocity_m_per_s);
            *force_n = self.damper.advance(damper, motion, self.step_s());
        });
        let displacement_m = ram.displacement_m;
        let behind_m = match target {
            Target::Follow(reference) => {
                let Reference { displacement_m: wanted_m, .. } = reference.after(self.period_s);
                wanted_m - displacement_m
            }
            Target::Hold | Target::Centre => 0.0,
        };
        Reading {
            force_n: *force_n,
            displacement_m,
            ram_displacement_m: displacement_m,
            behind_m,
            limits,
        }
    }

    fn is_at_rest(&self, state: &ModelState) -> bool {
        state.ram.velocity_m_per_s == 0.0
    }

    fn ram_m(state: &ModelState) -> f64 {
        state.ram.displacement_m
    }

    fn eyes_m(state: &ModelState) -> f64 {
        state.ram.displacement_m
    }

    fn force_n(state: &ModelState) -> f64 {
        state.force_n
    }

    fn temperature_degc(_state: &ModelState) -> Option<f64> {
        None
    }
}
