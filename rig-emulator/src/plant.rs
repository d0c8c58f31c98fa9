//! The emulator as the plant behind a node of the bus.

use crate::emulator::{Emulator, EmulatorState};
use can_protocol::arming::Limits;
use nodes::rig::{Condition, Plant, Reading, Target};
use scenario::rig::{Mounted, RigSetup};

/// What an emulated rig agrees to with a bar between its eyes (um): no host that needs more arms
/// it.
const BAR_STROKE_UM: u32 = 100;

impl Plant for Emulator {
    type Setup = RigSetup;
    type State = EmulatorState;

    fn new(setup: &RigSetup, period_s: f64, stream: u64) -> Self {
        Self::new(setup, period_s, stream)
    }

    fn seed(setup: &RigSetup) -> u64 {
        setup.seed
    }

    /// An emulated rig is ready, limited by its ram, or by the bar that is mounted.
    fn condition(setup: &RigSetup) -> Condition {
        let micro = |value: f64| (value * 1e6).round() as u32;
        Condition::ready(Limits {
            stroke_um: match setup.mounted {
                Mounted::Bar { .. } => BAR_STROKE_UM,
                Mounted::Damper | Mounted::Load { .. } => micro(setup.stroke_m),
            },
            velocity_um_per_s: micro(setup.rate_m_per_s),
            // Neither has a limit of its own here.
            acceleration_mm_per_s2: u32::MAX,
            force_n: u32::MAX,
        })
    }

    fn with_period(self, period_s: f64) -> Self {
        self.with_period(period_s)
    }

    fn period_s(&self) -> f64 {
        self.period_s()
    }

    fn stroke_m(&self) -> f64 {
        self.stroke_m()
    }

    fn start_at(&self, ram_m: f64) -> EmulatorState {
        self.start_at(ram_m)
    }

    fn begin(&self, state: &mut EmulatorState) {
        self.begin(state);
    }

    fn cycle(&self, state: &mut EmulatorState, target: Target) -> Reading {
        self.cycle(state, target)
    }

    fn is_at_rest(&self, state: &EmulatorState) -> bool {
        self.is_at_rest(state)
    }

    fn ram_m(state: &EmulatorState) -> f64 {
        state.ram().displacement_m
    }

    fn eyes_m(state: &EmulatorState) -> f64 {
        state.eyes_m()
    }

    fn force_n(state: &EmulatorState) -> f64 {
        state.force_n()
    }

    fn temperature_degc(state: &EmulatorState) -> Option<f64> {
        state.temperature_degc()
    }
}
