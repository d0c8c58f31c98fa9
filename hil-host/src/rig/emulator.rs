//! The physics of an emulated rig: ram, fixture, damper, load cell, displacement sensors.
//!
//! ```text
//! command -> delay line -> ram x_r --[ fixture, compliance C ]-- eyes x_e --[ damper F ]-- ground
//! x_e = x_r - C F(x_e)
//! ```
//!
//! One cycle has [`SUBSTEPS`] substeps: the ram moves, then the force is found at which fixture and
//! damper agree. A damper's force never falls with its displacement, so `F = D(x_r - C F)` has one
//! solution, enclosed from the start by the last force and the force at it; a bounded
//! false-position search finds it. That holds for a fixture softer than the damper as well, where
//! feeding back the last force would blow up.
//!
//! **Delay.** A command is the position of the eyes at the instant at which the cycle begins; the
//! reading is taken at its end. With velocity the reference runs on over the cycle and the ram is
//! behind it by the lag and the whole cycles of pure delay: 0.5 ms on the default rig. Without
//! velocity the reference stands still until the next command, which costs the cycle as well:
//! 1.16 ms on the default rig.
//!
//! Displacement is kept at the ram and across the eyes: their difference is the fixture. Noise is
//! added by the sensors and counted in cycles ([`Noise`]). Inertia of the fixture, friction of the
//! bearings and the sensors' own dynamics are not modelled.

use super::actuator::{Limits, Ram, RamState, Reference};
use super::noise::Noise;
use firmware_core::damper::{Damper, DamperState, Motion};
use scenario::rig::{DELAY_CYCLES_MAX, RigSetup};

/// Substeps of a cycle.
const SUBSTEPS: u32 = 4;

/// Most evaluations of the damper in the search of one substep.
const SEARCH_STEPS: u32 = 12;

/// References that the delay line keeps.
const LINE: usize = DELAY_CYCLES_MAX as usize + 1;

/// A rig that exists only as numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Emulator {
    ram: Ram,
    damper: Damper,
    fixture_m_per_n: f64,
    delay_cycles: u16,
    force_noise_n: f64,
    displacement_noise_m: f64,
    noise: Noise,
    step_s: f64,
}

/// Everything an emulated rig remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct EmulatorState {
    cycle: u64,
    ram: RamState,
    eyes_m: f64,
    force_n: f64,
    damper: DamperState,
    line: [Reference; LINE],
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
    /// Displacement across the damper's eyes, extension positive (m).
    pub displacement_m: f64,
    /// Displacement of the ram (m).
    pub ram_displacement_m: f64,
    /// How far the ram is behind the command, pure delay included; zero unless it follows (m).
    pub behind_m: f64,
    /// Limits that changed the motion in this cycle.
    pub limits: Limits,
}

impl Emulator {
    /// A rig for cycles of `period_s`; `stream` keeps the noise of several rigs apart.
    pub fn new(setup: &RigSetup, period_s: f64, stream: u64) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        Self {
            ram: Ram::new(setup.stroke_m, setup.rate_m_per_s, setup.lag_s, step_s),
            damper: setup.damper.clone().prepared(step_s),
            fixture_m_per_n: setup.fixture_m_per_n,
            delay_cycles: setup.delay_cycles.min(DELAY_CYCLES_MAX),
            force_noise_n: setup.force_noise_n,
            displacement_noise_m: setup.displacement_noise_m,
            noise: Noise::new(setup.seed, stream),
            step_s,
        }
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub fn with_period(self, period_s: f64) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.ram;
        Self {
            ram: Ram::new(stroke_m, rate_m_per_s, lag_s, step_s),
            damper: self.damper.prepared(step_s),
            step_s,
            ..self
        }
    }

    /// Length of a cycle (s).
    pub fn period_s(&self) -> f64 {
        self.step_s * f64::from(SUBSTEPS)
    }

    /// Largest travel from the middle to either side (m).
    pub fn stroke_m(&self) -> f64 {
        self.ram.stroke_m
    }

    /// The ram in the middle, the damper at rest, the noise at cycle 0.
    pub fn start(&self) -> EmulatorState {
        self.start_at(0.0)
    }

    /// The ram at rest at a displacement, the damper at rest there, the noise at cycle 0.
    pub fn start_at(&self, ram_m: f64) -> EmulatorState {
        let ram_m = ram_m.clamp(-self.ram.stroke_m, self.ram.stroke_m);
        let held = Reference { displacement_m: ram_m, ..Reference::default() };
        EmulatorState {
            cycle: 0,
            ram: RamState { displacement_m: ram_m, ..RamState::default() },
            eyes_m: ram_m,
            force_n: 0.0,
            damper: DamperState::starting(Motion::new(ram_m, 0.0)),
            line: [held; LINE],
        }
    }

    /// Begins a session with the plant as it stands: the noise counts from here, and the delay line
    /// holds where the ram is.
    pub fn begin(&self, state: &mut EmulatorState) {
        let held = Reference { displacement_m: state.ram.displacement_m, ..Reference::default() };
        (state.cycle, state.line) = (0, [held; LINE]);
    }

    /// One cycle.
    pub fn cycle(&self, state: &mut EmulatorState, command: Target) -> Reading {
        let target = match command {
            Target::Follow(reference) => Target::Follow(self.delayed(state, reference)),
            own => {
                let held = Reference { displacement_m: state.ram.displacement_m, ..<_>::default() };
                self.delayed(state, held);
                own
            }
        };
        let mut limits = Limits::default();
        for substep in 0..SUBSTEPS {
            match target {
                Target::Follow(reference) => {
                    let reference = reference.after(f64::from(substep) * self.step_s);
                    self.ram.follow(&mut state.ram, reference, &mut limits);
                }
                Target::Hold => self.ram.stop(&mut state.ram),
                Target::Centre => self.ram.centre(&mut state.ram),
            }
            self.settle(state);
        }
        let behind_m = match command {
            Target::Follow(reference) => {
                reference.after(self.period_s()).displacement_m - state.ram.displacement_m
            }
            _ => 0.0,
        };
        let [load_cell, eyes, ram, _] = self.noise.at(state.cycle);
        state.cycle += 1;
        Reading {
            force_n: state.force_n + self.force_noise_n * load_cell,
            displacement_m: state.eyes_m + self.displacement_noise_m * eyes,
            ram_displacement_m: state.ram.displacement_m + self.displacement_noise_m * ram,
            behind_m,
            limits,
        }
    }

    /// Puts a reference into the delay line and takes out the one that is due.
    fn delayed(&self, state: &mut EmulatorState, reference: Reference) -> Reference {
        let length = LINE as u64;
        let put = (state.cycle % length) as usize;
        let due = ((state.cycle + length - u64::from(self.delay_cycles)) % length) as usize;
        if let Some(place) = state.line.get_mut(put) {
            *place = reference;
        }
        state.line.get(due).copied().unwrap_or(reference)
    }

    /// Finds the force at which fixture and damper agree, and moves the damper there.
    fn settle(&self, state: &mut EmulatorState) {
        let (ram, before) = (state.ram, state.force_n);
        if self.fixture_m_per_n == 0.0 {
            // Nothing to agree on: no trial, and no copy of the damper's state.
            let motion = Motion::new(ram.displacement_m, ram.velocity_m_per_s);
            state.force_n = self.damper.advance(&mut state.damper, motion, self.step_s);
            state.eyes_m = ram.displacement_m;
            return;
        }
        let start = state.damper;
        let per_step = 1.0 / self.step_s;
        let damper_at = |force_n: f64| {
            let motion = Motion::new(
                ram.displacement_m - self.fixture_m_per_n * force_n,
                ram.velocity_m_per_s - self.fixture_m_per_n * (force_n - before) * per_step,
            );
            let mut damper = start;
            let answer_n = self.damper.advance(&mut damper, motion, self.step_s);
            (answer_n, damper, motion.displacement_m)
        };
        let mut found = damper_at(before);
        // Force on the fixture and how far the damper's answer is off: two ends of a bracket.
        let (mut low, mut high) = (before, found.0);
        let mut low_off = found.0 - low;
        found = damper_at(high);
        let mut high_off = found.0 - high;
        for _ in 0..SEARCH_STEPS {
            if high_off.abs() <= 1e-9 * high.abs().max(1.0) || low_off == high_off {
                break;
            }
            let next = high - high_off * (high - low) / (high_off - low_off);
            found = damper_at(next);
            let off = found.0 - next;
            if (off > 0.0) == (high_off > 0.0) {
                // The far end stays where it is: give it half its weight (Illinois).
                low_off *= 0.5;
            } else {
                (low, low_off) = (high, high_off);
            }
            (high, high_off) = (next, off);
        }
        (state.force_n, state.damper, state.eyes_m) = found;
    }
}

impl EmulatorState {
    /// Cycles since the start.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// The ram.
    pub fn ram(&self) -> RamState {
        self.ram
    }

    /// Displacement across the eyes, without noise (m).
    pub fn eyes_m(&self) -> f64 {
        self.eyes_m
    }

    /// Force of the damper, without noise (N).
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    /// The damper.
    pub fn damper(&self) -> &DamperState {
        &self.damper
    }
}
