//! A damper slot of the line: where its force comes from, and what it remembers.

use super::ahead::Ahead;
use super::stand_in::StandIn;
use super::{KNOWN_DELAY_CYCLES, Line};
use crate::command::Command;
use crate::compensation::{Compensator, CompensatorState};
use crate::damper::{Damper, DamperState, Motion};
use crate::guard::Guard;
use crate::supervision::{CommandLimits, Demand, Ramp};
use crate::vehicle::{DAMPER_SLOTS, DamperForces};
use crate::virtual_wear::{VirtualWear, VirtualWearState, ahead_cycles};

/// Share of the acceleration of a rig in which contacts are rounded; the rest is for what the
/// compensator adds.
const ROUNDING_SHARE: f64 = 0.8;

/// Where the force of a slot comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Slot<'a> {
    /// Nothing is mounted.
    Empty,
    /// The model, inside the vehicle step.
    Modelled(Damper),
    /// A rig.
    Rig(RigSlot<'a>),
    /// The rig in another slot.
    StandIn(StandIn),
}

impl Slot<'_> {
    /// Puts the model of a rig, or of a damper for which one stands, in its place.
    pub fn use_model(&mut self) {
        if let Self::Rig(RigSlot { model, .. }) | Self::StandIn(StandIn { model, .. }) = self {
            *self = Self::Modelled(model.clone());
        }
    }
}

/// A slot whose damper is on a rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RigSlot<'a> {
    /// The damper that acts while the measured force is faded in and out.
    pub model: Damper,
    /// Wear in software.
    pub wear: Option<VirtualWear<'a>>,
    /// How the delay of the rig is compensated.
    pub compensator: Compensator,
    /// Limits of the commands that the bench asks for.
    pub limits: CommandLimits,
}

impl<'a> RigSlot<'a> {
    /// A rig whose compensator also takes out what is known of the delay outside of it.
    pub fn new(
        model: Damper,
        compensator: Compensator,
        limits: CommandLimits,
        cycle_s: f64,
    ) -> Self {
        let compensator = compensator.with_known_delay(KNOWN_DELAY_CYCLES * cycle_s);
        Self { model, wear: None, compensator, limits }
    }

    /// The same rig with clearance and compliance put before its damper, which is known as
    /// `specimen`. The motion is computed ahead by the delay of the rig, in whole cycles, and the
    /// compensator is left with the rest.
    #[must_use]
    pub fn behind_wear(
        self,
        clearance_2a_m: f64,
        compliance_m_per_n: f64,
        specimen: &'a Damper,
        cycle_s: f64,
    ) -> Self {
        let known_delay_s = KNOWN_DELAY_CYCLES * cycle_s;
        let ahead_cycles = ahead_cycles(&self.compensator, known_delay_s, cycle_s);
        let wear = VirtualWear {
            clearance_2a_m,
            compliance_m_per_n,
            specimen,
            ahead_cycles,
            rounding_cycles: 0,
        };
        let wear = wear.rounded(ROUNDING_SHARE * self.limits.acceleration_m_per_s2, cycle_s);
        let rest_s = known_delay_s - f64::from(ahead_cycles) * cycle_s;
        let compensator = self.compensator.with_known_delay(rest_s).without_jerk();
        Self { wear: Some(wear), compensator, ..self }
    }
}

/// What a slot remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlotState {
    /// The model's state.
    pub damper: DamperState,
    /// The last believed force.
    pub guard: Guard,
    /// What the wear remembers.
    pub wear: VirtualWearState,
    /// Extension at which the vehicle stands still: mid-stroke (m).
    pub mid_stroke_m: f64,
    /// Limits of the commands: those of the bench, or tighter ones that the rig asks for.
    pub limits: CommandLimits,
    /// Where the ram is wanted: the vehicle's motion with wear and fades.
    pub wanted: Command,
    /// Where it will be wanted, as far as the wear looks ahead.
    pub ahead: Ahead,
    /// What the compensator remembers.
    pub compensator: CompensatorState,
    /// Last command to a rig.
    pub command: Command,
    /// Commands that a limit has changed.
    pub limited: u64,
    /// The most that the vehicle's motion has asked of the ram, limits apart.
    pub demand: Demand,
    /// Displacement at which the ram stood when it was coupled (m).
    pub ram_start_m: f64,
    /// Share of the vehicle's motion in the command.
    pub motion: Ramp,
    /// Share of the measured force in what the vehicle feels.
    pub coupling: Ramp,
    /// Whether the measured force may be taken; a fade-out goes on without it.
    pub is_force_believed: bool,
    /// Whether the rig is lost and the slot goes on with its model.
    pub has_dropped_out: bool,
}

impl Default for SlotState {
    fn default() -> Self {
        Self::NEW
    }
}

impl SlotState {
    /// Nothing has happened yet.
    pub const NEW: Self = Self {
        damper: DamperState::NEW,
        guard: Guard::NEW,
        wear: VirtualWearState::NEW,
        mid_stroke_m: 0.0,
        limits: CommandLimits::NONE,
        wanted: Command::REST,
        ahead: Ahead::resting(Command::REST),
        compensator: CompensatorState::NEW,
        command: Command::REST,
        limited: 0,
        demand: Demand::NONE,
        ram_start_m: 0.0,
        motion: Ramp::NONE,
        coupling: Ramp::NONE,
        is_force_believed: false,
        has_dropped_out: false,
    };
}

/// Forces of the four slots during one cycle.
pub(super) struct SlotForces<'a> {
    pub(super) line: &'a Line<'a>,
    pub(super) slots: &'a mut [SlotState; DAMPER_SLOTS],
    pub(super) held_n: [f64; DAMPER_SLOTS],
}

impl DamperForces for SlotForces<'_> {
    #[inline]
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        debug_assert!(slot < DAMPER_SLOTS, "slot {slot} of {DAMPER_SLOTS}");
        debug_assert!(lane == 0, "the line has one lane, not lane {lane}");
        let (Some(source), Some(state)) = (self.line.slots.get(slot), self.slots.get_mut(slot))
        else {
            return 0.0;
        };
        let motion = Motion::new(extension_m - state.mid_stroke_m, rate_m_per_s);
        match source {
            Slot::Empty => 0.0,
            Slot::Modelled(damper) => damper.advance(&mut state.damper, motion, substep_s),
            Slot::Rig(rig) => {
                let model_n = rig.model.advance(&mut state.damper, motion, substep_s);
                let held_n = self.held_n.get(slot).copied().unwrap_or(0.0);
                state.coupling.between(model_n, held_n)
            }
            Slot::StandIn(own) => {
                let measured = self.measured(own.of);
                let Some(state) = self.slots.get_mut(slot) else { return 0.0 };
                own.force_n(&mut state.damper, motion, measured, substep_s)
            }
        }
    }
}

impl SlotForces<'_> {
    /// The measured force of a rig (N), and how far it is coupled.
    fn measured(&self, slot: usize) -> (f64, Ramp) {
        let force_n = self.held_n.get(slot).copied().unwrap_or(0.0);
        (force_n, self.slots.get(slot).map_or(Ramp::default(), |rig| rig.coupling))
    }
}
