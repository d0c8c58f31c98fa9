//! Wear put before a damper on a rig: clearance and softness in software.
//!
//! A worn damper is a healthy one behind a joint with play and a soft spring. The rig carries the
//! healthy one; the host computes how the joint would move it:
//!
//! ```text
//! vehicle x --[ play 2a, spring K_v ]-- w --[ damper on the rig, F ]
//!
//! K_v dz(x - w, a) = F(w)          dz: dead zone of half width a
//! ```
//! `w` is needed before `F` is known, by the delay of rig and bus. So both sides are taken `h`
//! cycles ahead, and the compensator is left with less than half a cycle:
//!
//! ```text
//! x(t + h)   extrapolated from the vehicle's displacement, velocity, acceleration and jerk
//! F(t + h) = (1 + q) M[w](t + h) + dF(t)
//! q          least squares of F_measured - M[x_measured] on M[x_measured], over a second
//! dF         low-pass of what q leaves of the difference
//! ```
//! `M` is a model of the healthy damper, once driven by what the joint wants and once by what the
//! rig measured (a predictor after O. J. M. Smith, 1957). The delay lies outside of the loop that
//! is closed over `dF`, so it does not make it unstable; what does is a damper that is stiffer or
//! softer than its model ([`WearFound`]).
//!
//! Extrapolating `w` instead of `x` would carry every contact beyond its flank, and feeding the
//! force straight back, `x - F / K_v`, has a gain of the damper's stiffness over `K_v`, which is
//! above one for any wear that matters.
//!
//! A ram cannot follow the kink of a closing gap. It is rounded over some cycles on either side,
//! which takes `v^2 / (2 a)` of travel ([`VirtualWear::rounding_m`]).
//!
//! Limits: softer than the damper on the rig only. Between contacts the damper rests where its own
//! model is without force, so preload and the zero error of a load cell make it creep through the
//! gap as preload would in the joint of a worn damper.

mod joint;
mod mismatch;
mod reference;
mod rounding;
mod verdict;

pub use verdict::{FORCE_ERROR_MAX, LOOP_GAIN_MAX, WearFound, loop_gain};

use crate::command::Command;
use crate::compensation::{Compensator, Differences, Feedforward};
use crate::damper::{Damper, DamperState, Motion};
use joint::Joint;
use mismatch::{Correction, Mismatch};
use reference::Reference;
pub use rounding::MOST_ROUNDING_CYCLES;
use rounding::{Rounding, rounding_cycles};

/// The motion is computed by at most so many cycles ahead.
pub const MOST_AHEAD_CYCLES: u8 = 63;
/// Speed at which a gap closes at the working point of the SS9 study: 3.5 Hz with 3.46 mm (m/s).
const CONTACT_SPEED_M_PER_S: f64 = 0.076;
/// Order of the extrapolation of the vehicle's motion.
const ORDER: u8 = 3;

/// Parameters of the wear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualWear<'a> {
    /// Extra total clearance (m).
    pub clearance_2a_m: f64,
    /// Extra series compliance (m/N).
    pub compliance_m_per_n: f64,
    /// The damper on the rig, as the host knows it.
    pub specimen: &'a Damper,
    /// Cycles by which the motion is computed ahead.
    pub ahead_cycles: u8,
    /// Cycles on either side over which contacts are rounded.
    pub rounding_cycles: u8,
}

/// What a rig measured at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Displacement of the damper (m).
    pub displacement_m: f64,
    /// Its force (N).
    pub force_n: f64,
}

impl Reading {
    fn is_finite(&self) -> bool {
        self.displacement_m.is_finite() && self.force_n.is_finite()
    }
}

/// What the wear remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualWearState {
    differences: Differences,
    /// The model that is driven by what the joint wants.
    wanted: DamperState,
    /// Where it was last, contacts not rounded.
    targets: Rounding,
    /// The model on the vehicle's own motion, as if there were no joint.
    healthy: DamperState,
    healthy_squares: f64,
    healthy_cycles: u32,
    fastest_m_per_s: f64,
    /// What the specimen differs from its model.
    mismatch: Mismatch,
    /// What a worn damper would have done.
    reference: Reference,
}

impl Default for VirtualWearState {
    fn default() -> Self {
        Self::NEW
    }
}

impl VirtualWearState {
    /// Nothing has happened yet.
    pub(crate) const NEW: Self = Self {
        differences: Differences::NEW,
        wanted: DamperState::NEW,
        targets: Rounding::NEW,
        healthy: DamperState::NEW,
        healthy_squares: 0.0,
        healthy_cycles: 0,
        fastest_m_per_s: 0.0,
        mismatch: Mismatch::NEW,
        reference: Reference::NEW,
    };
}

/// Cycles by which a compensator's rig is late, to the nearest; the rest is left to it.
///
/// ```
/// use firmware_core::compensation::{Compensator, Feedforward};
/// use firmware_core::virtual_wear::ahead_cycles;
/// let compensator = Compensator::Feedforward(Feedforward::polynomial(2, 4.7e-3));
/// assert_eq!(ahead_cycles(&compensator, -0.5e-3, 1e-3), 4);
/// assert_eq!(ahead_cycles(&Compensator::None, -0.5e-3, 1e-3), 0);
/// ```
pub fn ahead_cycles(compensator: &Compensator, known_delay_s: f64, cycle_s: f64) -> u8 {
    debug_assert!(cycle_s > 0.0, "cycle of {cycle_s} s");
    let [gain, delay_s, ..] = compensator.series(&compensator.start()).0;
    let cycles = libm::round((delay_s / gain + known_delay_s) / cycle_s);
    cycles.max(0.0).min(f64::from(MOST_AHEAD_CYCLES)) as u8
}

impl VirtualWear<'_> {
    /// The same with contacts rounded to an acceleration (m/s2).
    #[must_use]
    pub fn rounded(self, acceleration_m_per_s2: f64, cycle_s: f64) -> Self {
        let cycles = rounding_cycles(CONTACT_SPEED_M_PER_S, acceleration_m_per_s2, cycle_s);
        Self { rounding_cycles: cycles, ..self }
    }

    /// Travel within which a contact at a relative speed is rounded (m).
    pub fn rounding_m(&self, speed_m_per_s: f64, cycle_s: f64) -> f64 {
        let cycles = 2.0 * f64::from(self.rounding_cycles) + 1.0;
        0.5 * speed_m_per_s * cycles * cycle_s
    }

    /// Takes the vehicle's motion of a cycle, and what has arrived from the rig since the last one,
    /// and returns the motion of the damper, [`VirtualWear::ahead_cycles`] ahead.
    pub fn step(
        &self,
        state: &mut VirtualWearState,
        vehicle: Command,
        reading: Option<Reading>,
        cycle_s: f64,
    ) -> Command {
        debug_assert!(self.clearance_2a_m >= 0.0, "clearance of {} m", self.clearance_2a_m);
        debug_assert!(self.compliance_m_per_n >= 0.0, "{} m/N", self.compliance_m_per_n);
        let arrived = state.mismatch.take(self.specimen, reading, cycle_s);
        let correction = state.mismatch.correction();
        state.take_healthy(self.specimen, vehicle, cycle_s);
        let motion = state.differences.take(vehicle, cycle_s);
        let ahead_cycles = self.ahead_cycles.saturating_add(self.rounding_cycles);
        let ahead_s = f64::from(ahead_cycles) * cycle_s;
        let ahead = Feedforward::polynomial(ORDER, ahead_s).series.command(&motion);
        if !ahead.is_finite() {
            // The state of a diverged model: the line stops by itself.
            return ahead;
        }
        state.reference.take(self, vehicle.displacement_m, arrived, correction, cycle_s);
        let (target_m, _) =
            self.balance(&mut state.wanted, ahead.displacement_m, &correction, cycle_s);
        let (displacement_m, rate_m) = state.targets.take(target_m, self.rounding_cycles);
        let command = Command { displacement_m, velocity_m_per_s: rate_m / cycle_s };
        debug_assert!(command.is_finite(), "a finite motion gives a finite command");
        command
    }

    /// Moves a model of the damper to where it stands behind the joint, with the vehicle's end at
    /// `x_m`; its place (m) and its force, not corrected (N).
    fn balance(
        &self,
        damper: &mut DamperState,
        x_m: f64,
        correction: &Correction,
        cycle_s: f64,
    ) -> (f64, f64) {
        let joint = Joint {
            half_clearance_m: 0.5 * self.clearance_2a_m,
            compliance_m_per_n: self.compliance_m_per_n,
        };
        let before = *damper;
        let force_n = |displacement_m: f64| {
            let mut next = before;
            let moved = Motion::new(displacement_m, 0.0);
            correction.of(self.specimen.advance(&mut next, moved, cycle_s))
        };
        let stiffness = self.specimen.nominal().ke_n_per_m;
        let from_m = before.motion().displacement_m;
        let target_m = joint.balance(x_m, from_m, stiffness, force_n);
        let model_n = self.specimen.advance(damper, Motion::new(target_m, 0.0), cycle_s);
        (target_m, model_n)
    }
}

impl VirtualWearState {
    /// Begins what is judged anew.
    pub fn clear(&mut self) {
        self.mismatch.clear();
        self.reference.clear();
        (self.healthy_squares, self.healthy_cycles, self.fastest_m_per_s) = (0.0, 0, 0.0);
    }

    /// The fastest motion of the vehicle since [`VirtualWearState::clear`] (m/s): no contact is
    /// faster.
    pub const fn fastest_m_per_s(&self) -> f64 {
        self.fastest_m_per_s
    }

    /// What is judged of a wear, since [`VirtualWearState::clear`]; nothing before the damper has
    /// moved.
    pub fn found(&self, wear: &VirtualWear<'_>) -> Option<WearFound> {
        let healthy_n = self.healthy_n();
        let sizes_n = self.mismatch.sizes_n().filter(|_| healthy_n > 0.0)?;
        Some(WearFound::of(wear, sizes_n, self.reference.error_n(), healthy_n))
    }

    fn healthy_n(&self) -> f64 {
        crate::sqrt::sqrt(self.healthy_squares / f64::from(self.healthy_cycles.max(1)))
    }

    fn take_healthy(&mut self, specimen: &Damper, vehicle: Command, cycle_s: f64) {
        let motion = Motion::new(vehicle.displacement_m, vehicle.velocity_m_per_s);
        let force_n = specimen.advance(&mut self.healthy, motion, cycle_s);
        self.healthy_squares += force_n * force_n;
        self.fastest_m_per_s = self.fastest_m_per_s.max(vehicle.velocity_m_per_s.abs());
        self.healthy_cycles = self.healthy_cycles.saturating_add(1);
    }
}
