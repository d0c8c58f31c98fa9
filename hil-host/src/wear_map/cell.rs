//! One damper on one emulated rig, worn in its joint and worn in software, and without a rig.
//!
//! All are driven by the same motion. The force is compared sample by sample, the work over whole
//! cycles of the motion. The rig has its noise.

use super::Sine;
use firmware_core::command::Command;
use firmware_core::compensation::{Answer, Compensator, Feedforward};
use firmware_core::damper::{Damper, DamperError};
use firmware_core::guard::ForceInput;
use firmware_core::line::{RigSlot, SlotState};
use firmware_core::supervision::CommandLimits;
use firmware_core::virtual_wear::WearFound;
use rig_emulator::{Emulator, Reading, Reference, Target};
use scenario::rig::{Drive, RigSetup};
use scenario::run::{CYCLE_S, worn};

/// Periods until the motion has its full stroke, and until the mismatch is learned.
const RUN_IN_PERIODS: u32 = 8;
/// Periods that are compared.
const JUDGED_PERIODS: u32 = 4;

/// A rig with a damper, as it is and as the host knows it.
#[derive(Debug, Clone)]
pub(super) struct Bench {
    pub(super) rig: RigSetup,
    pub(super) specimen: Damper,
    pub(super) model: Damper,
    pub(super) compensator: Compensator,
    pub(super) limits: CommandLimits,
}

/// What a damper did over the judged periods.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Driven {
    forces_n: Vec<f64>,
    pub(super) work_j: f64,
    /// What the gate of a run would find.
    pub(super) found: Option<WearFound>,
    limited: u64,
}

impl Driven {
    /// Share of the commands that a limit changed.
    pub(super) fn limited_share(&self) -> f64 {
        self.limited as f64 / self.forces_n.len().max(1) as f64
    }

    /// Root of the mean square of the force (N).
    pub(super) fn rms_n(&self) -> f64 {
        rms(self.forces_n.iter().copied())
    }

    /// The same of the difference from another (N).
    pub(super) fn differs_n(&self, other: &Self) -> f64 {
        rms(self.forces_n.iter().zip(&other.forces_n).map(|(own, other)| own - other))
    }
}

impl Bench {
    /// The damper with wear in its joint as a vehicle has it: on a rig that is late by nothing and
    /// shows what is.
    pub(super) fn without_rig(&self, wear: (f64, f64), sine: Sine) -> Result<Driven, DamperError> {
        let exact = RigSetup {
            drive: Drive::Ideal,
            lag_s: 0.0,
            delay_cycles: 0,
            fixture_m_per_n: 0.0,
            force_noise_n: 0.0,
            displacement_noise_m: 0.0,
            ..self.rig.clone()
        };
        // The half cycle by which a held force is early is taken out by every compensator.
        let compensator = Compensator::Feedforward(Feedforward::polynomial(1, 0.0));
        let slot = RigSlot::new(self.model.clone(), compensator, self.limits, CYCLE_S);
        Ok(drive(&slot, &exact, &self.worn(wear)?, sine))
    }

    /// The damper with wear in its joint, on the rig.
    pub(super) fn in_joint(&self, wear: (f64, f64), sine: Sine) -> Result<Driven, DamperError> {
        Ok(drive(&self.slot(), &self.rig, &self.worn(wear)?, sine))
    }

    fn worn(
        &self,
        (clearance_2a_m, compliance_m_per_n): (f64, f64),
    ) -> Result<Damper, DamperError> {
        worn(&self.specimen, clearance_2a_m, compliance_m_per_n)
    }

    /// The damper with wear in software before it.
    pub(super) fn in_software(&self, wear: (f64, f64), sine: Sine) -> Driven {
        drive(&self.worn_slot(wear), &self.rig, &self.specimen, sine)
    }

    /// Travel in which the contact of a motion is rounded (m).
    pub(super) fn rounding_m(&self, wear: (f64, f64), sine: Sine) -> f64 {
        let omega = std::f64::consts::TAU * sine.frequency_hz;
        let (stroke_m, half_m) = (sine.stroke_m, 0.5 * wear.0);
        let speed = omega * libm::sqrt((stroke_m * stroke_m - half_m * half_m).max(0.0));
        let is_crossed = half_m > 0.0;
        let rounding =
            |slot: RigSlot<'_>| slot.wear.map_or(0.0, |wear| wear.rounding_m(speed, CYCLE_S));
        if is_crossed { rounding(self.worn_slot(wear)) } else { 0.0 }
    }

    fn worn_slot(&self, (clearance_2a_m, compliance_m_per_n): (f64, f64)) -> RigSlot<'_> {
        self.slot().behind_wear(clearance_2a_m, compliance_m_per_n, &self.model, CYCLE_S)
    }

    fn slot(&self) -> RigSlot<'_> {
        RigSlot::new(self.model.clone(), self.compensator, self.limits, CYCLE_S)
    }
}

fn drive(slot: &RigSlot<'_>, rig: &RigSetup, specimen: &Damper, sine: Sine) -> Driven {
    let rig = RigSetup { damper: specimen.clone(), ..rig.clone() };
    let emulator = Emulator::new(&rig, CYCLE_S, 0);
    let (mut ram, mut memory) = (emulator.start(), SlotState::coupled(slot));
    let period_cycles = 1.0 / (sine.frequency_hz * CYCLE_S);
    let cycles = |periods: u32| libm::round(f64::from(periods) * period_cycles) as u64;
    let (begin, end) = (cycles(RUN_IN_PERIODS), cycles(RUN_IN_PERIODS + JUDGED_PERIODS));
    let mut driven = Driven {
        forces_n: Vec::with_capacity((end - begin) as usize),
        work_j: 0.0,
        found: None,
        limited: 0,
    };
    let mut arrived = (ForceInput::Missing, None);
    let (mut force_n, mut last) = (0.0, (0.0, 0.0));
    for cycle in 0..end {
        if cycle == begin {
            memory.wear.clear();
            driven.limited = memory.limited;
        }
        let vehicle = sine.at(cycle as f64 * CYCLE_S);
        let command = memory.follow(slot, vehicle, arrived, CYCLE_S);
        if cycle >= begin {
            // The force that the vehicle feels in this cycle, at the motion where it begins.
            driven.forces_n.push(force_n);
            driven.work_j += 0.5 * (force_n + last.0) * (vehicle.displacement_m - last.1);
        }
        last = (force_n, vehicle.displacement_m);
        let reference = Reference {
            displacement_m: command.displacement_m,
            velocity_m_per_s: command.velocity_m_per_s,
        };
        let reading = emulator.cycle(&mut ram, Target::Follow(reference));
        let Reading { displacement_m, .. } = reading;
        force_n = reading.force_n;
        let answer = Answer { displacement_m, force_n, age_cycles: 0 };
        arrived = (ForceInput::Fresh(force_n), Some(answer));
    }
    if let Some(wear) = &slot.wear {
        driven.found = memory.wear.found(wear);
    }
    driven.limited = memory.limited - driven.limited;
    driven
}

impl Sine {
    /// The motion at a time (s); its stroke grows over the first two periods.
    fn at(self, time_s: f64) -> Command {
        let omega = std::f64::consts::TAU * self.frequency_hz;
        let (sin, cos) = libm::sincos(omega * time_s);
        let growth_s = 2.0 / self.frequency_hz;
        let share = (time_s / growth_s).min(1.0);
        let slope = if share < 1.0 { 1.0 / growth_s } else { 0.0 };
        Command {
            displacement_m: share * self.stroke_m * sin,
            velocity_m_per_s: self.stroke_m * (share * omega * cos + slope * sin),
        }
    }
}

fn rms(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    libm::sqrt(values.map(|value| value * value).sum::<f64>() / count)
}
