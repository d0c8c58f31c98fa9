//! Dampers behind emulated rigs: the loop of a run in virtual time, without a bus.
//!
//! ```text
//! cycle k    vehicle step, forces held -> command -> rig -> displacement and force
//! cycle k+1  vehicle step with this force
//! ```
//! The order is that of a run on the memory bus. The force of a rig whose ram is half a cycle late
//! has no delay in the mean ([`firmware_core::line`]).
//!
//! [`Rigs::late_by`] are ideal: their rams are late by a set time and nothing else, their fixture
//! is that of the scenario's rig, their sensors have no noise. A force that is early is that of a
//! compensator that extrapolates too far, on a ram half a cycle late. [`Rigs::compensated`] are any
//! rig with any compensator, and [`Rigs::filtered`] one whose command comes from a linear filter of
//! the wanted motion.
//!
//! Limits: values are not rounded to the steps of frames, and commands have no limits.

use super::TripState;
use super::filter::{DiscreteFilter, FilterState};
use firmware_core::compensation::{Answer, Compensator, Feedforward};
use firmware_core::damper::Damper;
use firmware_core::guard::ForceInput;
use firmware_core::line::{DelayBlocks, KNOWN_DELAY_CYCLES, Line, LineState, RigSlot};
use firmware_core::supervision::{CommandLimits, Event};
use firmware_core::vehicle::DAMPER_SLOTS;
use rig_emulator::{Emulator, EmulatorState, Reading, Reference, Target};
use scenario::rig::RigSetup;
use scenario::run::CYCLE_S;

/// How late a ram is whose force has no delay (s).
const RAM_DELAY_S: f64 = -KNOWN_DELAY_CYCLES * CYCLE_S;
/// Order of the polynomial of a compensator.
const ORDER: u8 = 2;

/// Rigs that are all alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Rigs {
    /// Delay of the force (s); negative where it is early.
    delay_s: f64,
    rig: RigSetup,
    compensator: Compensator,
    /// What makes the command of the wanted motion in the place of the compensator.
    filter: Option<DiscreteFilter>,
    slots: [bool; DAMPER_SLOTS],
}

impl Rigs {
    /// Rigs in some slots whose force is late by `delay_s`, otherwise like `rig`; none for a delay
    /// that a rig does not keep.
    pub fn late_by(rig: &RigSetup, delay_s: f64, slots: [bool; DAMPER_SLOTS]) -> Option<Self> {
        let rig = rig.late_by(RAM_DELAY_S + delay_s.max(0.0))?;
        let compensator = if delay_s < 0.0 {
            let polynomial = Feedforward::polynomial(ORDER, RAM_DELAY_S - delay_s);
            Compensator::Feedforward(polynomial).with_known_delay(KNOWN_DELAY_CYCLES * CYCLE_S)
        } else {
            Compensator::None
        };
        let rig = RigSetup { force_noise_n: 0.0, displacement_noise_m: 0.0, ..rig };
        Some(Self { delay_s, rig, compensator, filter: None, slots })
    }

    /// Rigs like `rig` in some slots, each with its own noise, with a compensator that makes up for
    /// them. Eigenvalues take them for rigs without delay.
    pub fn compensated(
        rig: &RigSetup,
        compensator: Compensator,
        slots: [bool; DAMPER_SLOTS],
    ) -> Self {
        Self { delay_s: 0.0, rig: rig.clone(), compensator, filter: None, slots }
    }

    /// The same with a linear filter in the place of a compensator.
    pub fn filtered(rig: &RigSetup, filter: DiscreteFilter, slots: [bool; DAMPER_SLOTS]) -> Self {
        Self { filter: Some(filter), ..Self::compensated(rig, Compensator::None, slots) }
    }

    /// Whether the damper of a slot is behind a rig.
    pub fn has(&self, slot: usize) -> bool {
        self.slots.get(slot).copied().unwrap_or(false)
    }

    /// Delay of the force (s); negative where it is early.
    pub fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// The slot of a line whose damper is behind a rig.
    pub(super) fn slot(&self, model: Damper) -> RigSlot<'static> {
        RigSlot {
            model,
            wear: None,
            compensator: self.compensator,
            limits: CommandLimits::default(),
        }
    }

    /// The rig of a slot with its damper.
    pub(super) fn emulated(&self, slot: usize, damper: &Damper) -> Emulated {
        let rig = RigSetup { damper: damper.clone(), ..self.rig.clone() };
        let emulator = Emulator::new(&rig, CYCLE_S, slot as u64);
        Emulated { slot, emulator, filter: self.filter.clone() }
    }
}

/// The rig of a slot.
#[derive(Debug, Clone)]
pub(super) struct Emulated {
    slot: usize,
    emulator: Emulator,
    filter: Option<DiscreteFilter>,
}

/// What the rig of a slot remembers.
#[derive(Debug, Clone)]
pub(super) struct RigState {
    emulator: EmulatorState,
    /// What it has measured in the last cycle.
    pub(super) reading: Option<Reading>,
    /// The delay of its force.
    pub(super) delay: DelayBlocks,
    filter: FilterState,
}

impl Emulated {
    /// Its ram in the middle.
    pub(super) fn start(&self) -> RigState {
        let emulator = self.emulator.start();
        let filter = self.filter.as_ref().map(DiscreteFilter::start).unwrap_or_default();
        RigState { emulator, reading: None, delay: DelayBlocks::default(), filter }
    }
}

/// Couples the rigs of a line at once: in the middle of its stroke nothing has to be faded.
pub(super) fn couple(line: &Line<'_>, state: &mut LineState) {
    for event in [Event::Agreed, Event::Arm] {
        state.on(event);
    }
    let coupled = line.couple(state, [0.0; DAMPER_SLOTS]);
    debug_assert!(coupled.is_ok(), "a ram stands where its vehicle is: {coupled:?}");
}

/// One cycle of a line and its rigs.
pub(super) fn step(line: &Line<'_>, rigs: &[Emulated], state: &mut TripState) {
    debug_assert_eq!(rigs.len(), state.rigs.len(), "the state of another trip");
    let mut inputs = [ForceInput::Missing; DAMPER_SLOTS];
    let mut answers = [None; DAMPER_SLOTS];
    for (rig, memory) in rigs.iter().zip(&state.rigs) {
        let Some(Reading { force_n, displacement_m, .. }) = memory.reading else { continue };
        inputs[rig.slot] = ForceInput::Fresh(force_n);
        answers[rig.slot] = Some(Answer { displacement_m, force_n, age_cycles: 0 });
    }
    line.step_on(line.track, &mut state.line, &inputs, &answers);
    for (rig, memory) in rigs.iter().zip(&mut state.rigs) {
        let slot = &state.line.slots[rig.slot];
        let measured_m = memory.reading.map_or(f64::NAN, |reading| reading.displacement_m);
        memory.delay.take(slot.wanted.displacement_m, measured_m, CYCLE_S);
        let command = match &rig.filter {
            Some(filter) => filter.step(&mut memory.filter, slot.wanted),
            None => slot.command,
        };
        let command = Reference {
            displacement_m: command.displacement_m,
            velocity_m_per_s: command.velocity_m_per_s,
        };
        let reading = rig.emulator.cycle(&mut memory.emulator, Target::Follow(command));
        memory.reading = Some(reading);
    }
}
