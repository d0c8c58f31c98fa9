//! The yaw damper: a chain in series, driven by the motion between its eyes.
//!
//! ```text
//! eye --[ attachment e = c(F): clearance, stiffness, rubber ]--[ body F = f(v_d), v_d = x_d' ]--
//!        parts parallel to the body (seal friction) sit inside the attachment                 eye
//! ```
//!
//! Displacement is positive in extension from mid-stroke, force positive in tension, dissipated
//! work positive. The nominal damper has five numbers ([`Nominal`]); what it lacks are [`effects`],
//! one file each, on the same path. One [`Damper::advance`] serves the vehicle, the rig emulator
//! and the fit of measured records, so that no fit absorbs an integration error.
//!
//! How a step is solved:
//! - Attachment and body are joined into one rising piecewise-linear law (`law`), which is
//!   followed exactly from knot to knot (`series`): clearance, relief, sticking, hard caps.
//! - Factors from slow states (position, temperature, wear) are frozen in each step, at mid-step
//!   or, where the chain answers faster than the step, towards its end (`series::weight_of_step`).
//!   Of the law under them a piece of a step usually needs one segment (`piece`).
//! - Attachments with a fast memory (rubber) are solved together with the chain by a bracketed,
//!   second-order, L-stable step (`implicit`).
//! - A step is cut where an effect switches (a void opens, a gap closes) and where a late sensor
//!   will look (`step`).
//! - Parts parallel to the whole damper and the sensor act on the result; an `empirical` map, where
//!   there is one, comes on top.
//!
//! Work is bounded in every case, there is no heap and no way to panic.
//!
//! ```
//! use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
//!
//! let damper = Damper::new(Nominal::NEW, &[])?.prepared(1e-3);
//! let mut state = DamperState::starting(Motion::new(0.0, 0.01));
//! let mut force_n = 0.0;
//! for step in 1..=1000 {
//!     // Extension at 10 mm/s: the dashpot alone takes it after a second.
//!     force_n = damper.advance(&mut state, Motion::new(1e-5 * f64::from(step), 0.01), 1e-3);
//! }
//! assert!((force_n - 10.0e3).abs() < 1.0);
//! # Ok::<(), firmware_core::damper::DamperError>(())
//! ```

mod chain;
mod curve;
mod delay;
pub mod effects;
mod empirical;
mod error;
mod heat;
mod implicit;
mod law;
mod near;
mod nominal;
mod parts;
mod piece;
mod sampling;
mod segment;
mod series;
mod step;

use heapless::Vec;

pub use curve::{Curve, Knot, Side};
pub use effects::Effect;
pub use empirical::{EmpiricalMap, MAP_KNOTS, MapCoordinate, MapKnot};
pub use error::DamperError;
pub use heat::HeatBalance;
pub use implicit::Creep;
pub use nominal::Nominal;
pub use parts::{Factors, Parts, attachment_force_n};

use chain::{Arrival, Drive, Stand};
use delay::DelayLine;
use effects::{Memory, Slow};
use empirical::Turned;
use law::Law;
use parts::Body;
use step::Sample;

/// Most effects in one damper.
pub const MAX_EFFECTS: usize = 8;

/// Memories smaller than this are set to zero: they are no physics, only slow arithmetic.
const TINY: f64 = 1e-30;

/// Motion between the eyes of the damper at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Motion {
    /// Displacement, m, positive in extension from mid-stroke.
    pub displacement_m: f64,
    /// Velocity, m/s. Between two steps the motion is a parabola with the mean acceleration of
    /// their velocities; a caller without velocities passes zero and gets straight lines.
    pub velocity_m_per_s: f64,
}

impl Motion {
    /// A displacement and a velocity.
    pub const fn new(displacement_m: f64, velocity_m_per_s: f64) -> Self {
        Self { displacement_m, velocity_m_per_s }
    }
}

/// The instant at which slow factors are taken and frozen for a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Instant {
    /// Motion between the eyes.
    pub motion: Motion,
    /// Position of the piston, m.
    pub piston_m: f64,
    /// Velocity of the piston, m/s.
    pub piston_velocity_m_per_s: f64,
    /// Time since the beginning of the step, s.
    pub since_s: f64,
    /// Change of the piston's position since then, m.
    pub piston_travel_m: f64,
    /// Measured temperature of the oil, degrees Celsius, if it is measured.
    pub temperature_degc: Option<f64>,
}

/// A finished step, as effects see it; or a piece of one, where the step is cut at an event.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Done {
    /// Length of the piece, s: the whole step where it is not cut.
    pub step_s: f64,
    /// Length of the whole step, s.
    pub whole_s: f64,
    /// Time from the end of the piece to the end of the whole step, s; zero for the last piece.
    pub ahead_s: f64,
    /// Motion at the end of the piece.
    pub motion: Motion,
    /// Mean acceleration between the eyes over the whole step, m/s2.
    pub acceleration_m_per_s2: f64,
    /// Velocity between the eyes at the end of the piece on the parabola of the whole step, m/s;
    /// for a caller without velocities the mean one.
    pub end_velocity_m_per_s: f64,
    /// Force in the chain at its beginning, N.
    pub start_force_n: f64,
    /// Force in the chain at its end, N.
    pub chain_force_n: f64,
    /// Position of the piston at its end, m.
    pub piston_m: f64,
    /// Change of the piston's position, m.
    pub piston_travel_m: f64,
    /// Velocity of the piston at its end, m/s.
    pub piston_velocity_m_per_s: f64,
    /// Deflection of the attachment at its end without creep, m.
    pub deflection_m: f64,
    /// Half of the clearance, m, with what wear has added.
    pub half_clearance_m: f64,
    /// Measured temperature of the oil, degrees Celsius, if it is measured.
    pub temperature_degc: Option<f64>,
}

/// Everything a damper remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamperState {
    motion: Motion,
    deflection_m: f64,
    creep_m: f64,
    resting: bool,
    chain_force_n: f64,
    output_n: f64,
    piston_velocity_m_per_s: f64,
    temperature_degc: Option<f64>,
    memory: [Memory; MAX_EFFECTS],
    delay: DelayLine,
    turned: Turned,
    fallbacks: u32,
}

impl DamperState {
    /// Nothing has happened yet.
    pub(crate) const NEW: Self = Self {
        motion: Motion::new(0.0, 0.0),
        deflection_m: 0.0,
        creep_m: 0.0,
        resting: false,
        chain_force_n: 0.0,
        output_n: 0.0,
        piston_velocity_m_per_s: 0.0,
        temperature_degc: None,
        memory: [[0.0; 4]; MAX_EFFECTS],
        delay: DelayLine::NEW,
        turned: Turned::NEW,
        fallbacks: 0,
    };

    /// At mid-stroke, at rest, the joint in the middle of its clearance.
    pub fn rest() -> Self {
        Self { resting: true, ..Self::NEW }
    }

    /// Without force at the given motion, the joint in the middle of its clearance.
    pub fn starting(motion: Motion) -> Self {
        Self { motion, ..Self::rest() }
    }

    /// The same with the piston elsewhere: the attachment then starts deflected by the difference.
    #[must_use]
    pub fn with_piston_m(mut self, piston_m: f64) -> Self {
        self.deflection_m = self.motion.displacement_m - self.creep_m - piston_m;
        self
    }

    /// Takes the measured temperature of the oil, degrees Celsius, for the steps from here on.
    /// `None`, or no number, says that it is not measured: effects of temperature then reckon with
    /// the heat that the damper turns out.
    ///
    /// ```
    /// use firmware_core::damper::DamperState;
    /// let mut state = DamperState::rest();
    /// assert_eq!(state.temperature_degc(), None);
    /// state.set_temperature_degc(Some(31.5));
    /// assert_eq!(state.temperature_degc(), Some(31.5));
    /// state.set_temperature_degc(Some(f64::NAN));
    /// assert_eq!(state.temperature_degc(), None);
    /// ```
    pub fn set_temperature_degc(&mut self, temperature_degc: Option<f64>) {
        self.temperature_degc = temperature_degc.filter(|value| value.is_finite());
    }

    /// Measured temperature of the oil, degrees Celsius.
    pub fn temperature_degc(&self) -> Option<f64> {
        self.temperature_degc
    }

    /// Motion at the last step.
    pub fn motion(&self) -> Motion {
        self.motion
    }

    /// Position of the piston, m.
    pub fn piston_m(&self) -> f64 {
        self.motion.displacement_m - self.deflection_m - self.creep_m
    }

    /// Velocity of the piston at the end of the last step, m/s.
    pub fn piston_velocity_m_per_s(&self) -> f64 {
        self.piston_velocity_m_per_s
    }

    /// Deflection of the attachment with its clearance and creep, m.
    pub fn deflection_m(&self) -> f64 {
        self.deflection_m + self.creep_m
    }

    /// Force in the chain at the end of the last step, N, without parallel parts and sensor.
    pub fn chain_force_n(&self) -> f64 {
        self.chain_force_n
    }

    /// Force that the last step returned, N.
    pub fn force_n(&self) -> f64 {
        self.output_n
    }

    /// Steps that had to be closed by backward Euler, or were given no finite motion.
    pub fn fallbacks(&self) -> u32 {
        self.fallbacks
    }
}

/// What the effects of a damper ask for in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct InStep {
    slow: Slow,
    creeps: bool,
    switches: bool,
}

/// A damper: nominal parameters, effects, the laws that follow from them, and a map where it has
/// one.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper {
    nominal: Nominal,
    effects: Vec<Effect, MAX_EFFECTS>,
    parts: Parts,
    body: Body,
    law: Law,
    per_step: f64,
    law_alone: bool,
    in_step: InStep,
    delay_s: f64,
    empirical: Option<EmpiricalMap>,
}

impl Damper {
    /// A damper with the given effects, in any order, each at most once.
    ///
    /// # Errors
    /// A parameter outside what is possible, too many or repeated effects, or effects that
    /// together leave no rising law.
    pub fn new(nominal: Nominal, effects: &[Effect]) -> Result<Self, DamperError> {
        nominal.validate()?;
        let mut ordered: Vec<Effect, MAX_EFFECTS> = Vec::new();
        for effect in effects {
            effect.validate()?;
            if ordered.iter().any(|other| other.index() == effect.index()) {
                return Err(DamperError::RepeatedEffect { effect: effect.name() });
            }
            let given = effects.len();
            let full = DamperError::TooManyEffects { given, limit: MAX_EFFECTS };
            ordered.push(*effect).map_err(|_| full)?;
        }
        ordered.sort_unstable_by_key(Effect::index);
        let (hydraulic, attachment) = (nominal.hydraulic(), nominal.attachment());
        let mut parts = Parts { hydraulic, dry: Curve::ZERO, attachment };
        for effect in &ordered {
            effect.shape(&mut parts, &nominal);
        }
        Law::check(&parts)?;
        let mut law = Law::empty();
        let body = Body::nominal(&parts);
        law.join(&parts, &body, &Factors::NONE);
        debug_assert!(
            ordered.iter().zip(ordered.iter().skip(1)).all(|(a, b)| a.index() < b.index()),
            "effects act in the order of the catalogue"
        );
        let law_alone = ordered.iter().all(Effect::is_law_alone);
        let in_step = InStep {
            slow: ordered.iter().map(Effect::slow_part).max().unwrap_or(Slow::Nothing),
            creeps: ordered.iter().any(Effect::creeps),
            switches: ordered.iter().any(Effect::switches),
        };
        let delay_s = ordered.iter().map(Effect::delay_s).sum();
        Ok(Self {
            nominal,
            effects: ordered,
            parts,
            body,
            law,
            per_step: 0.0,
            law_alone,
            in_step,
            delay_s,
            empirical: None,
        })
    }

    /// The same damper with an empirical map added to its force.
    #[must_use]
    pub fn with_empirical(self, map: EmpiricalMap) -> Self {
        Self { empirical: Some(map), ..self }
    }

    /// The same damper without its empirical map: its physics alone.
    #[must_use]
    pub fn without_empirical(self) -> Self {
        Self { empirical: None, ..self }
    }

    /// The same damper, faster for steps of exactly this length. It gives the same numbers.
    #[must_use]
    pub fn prepared(mut self, step_s: f64) -> Self {
        self.prepare(step_s);
        self
    }

    /// The same in its place: a damper is large for the stack of a board.
    pub fn prepare(&mut self, step_s: f64) {
        debug_assert!(step_s > 0.0 && step_s.is_finite(), "step of {step_s} s");
        self.law.prepare(step_s);
        self.per_step = 1.0 / step_s;
    }

    /// The nominal parameters.
    pub fn nominal(&self) -> &Nominal {
        &self.nominal
    }

    /// The effects, in the order of the catalogue.
    pub fn effects(&self) -> &[Effect] {
        &self.effects
    }

    /// The empirical map, if there is one.
    pub fn empirical(&self) -> Option<&EmpiricalMap> {
        self.empirical.as_ref()
    }

    /// The force at a constant velocity of the piston at mid-stroke, N, slow factors and map left
    /// out.
    ///
    /// ```
    /// use firmware_core::damper::{Damper, Nominal};
    /// let damper = Damper::new(Nominal::NEW, &[])?;
    /// // 18 kN at relief (18 mm/s), 80 kN s/m beyond.
    /// assert!((damper.steady_force_n(0.118) - 26.0e3).abs() < 1e-6);
    /// # Ok::<(), firmware_core::damper::DamperError>(())
    /// ```
    pub fn steady_force_n(&self, velocity_m_per_s: f64) -> f64 {
        self.parts.hydraulic.at(velocity_m_per_s) + self.parts.dry.at(velocity_m_per_s)
    }

    /// Moves the damper to `motion` in `step_s` and returns the force there, N.
    ///
    /// Without a finite motion, or a step above zero, nothing moves: the last force is returned and
    /// [`DamperState::fallbacks`] counts it.
    #[inline]
    pub fn advance(&self, state: &mut DamperState, motion: Motion, step_s: f64) -> f64 {
        let finite = motion.displacement_m.is_finite() && motion.velocity_m_per_s.is_finite();
        if !(finite && step_s > 0.0 && step_s < f64::INFINITY) {
            state.fallbacks = state.fallbacks.saturating_add(1);
            return state.output_n;
        }
        debug_assert!(self.effects.len() <= state.memory.len(), "an effect without a memory");
        debug_assert!(!self.law.sliding.is_empty(), "a damper without a law");
        let before = state.fallbacks;
        let prepared = step_s == self.law.step_s;
        debug_assert!(!prepared || self.per_step == 1.0 / step_s, "prepared for another step");
        let per_step = if prepared { self.per_step } else { 1.0 / step_s };
        let mean = (motion.displacement_m - state.motion.displacement_m) * per_step;
        let gained = motion.velocity_m_per_s - state.motion.velocity_m_per_s;
        let drive = Drive {
            velocity_m_per_s: mean - 0.5 * gained,
            acceleration_m_per_s2: gained * per_step,
        };
        let mut force_n = if self.law_alone {
            let stand = Stand { deflection_m: state.deflection_m, resting: state.resting };
            let arrival = series::advance(&self.law, stand, drive, step_s);
            state.arrive(&arrival, motion);
            arrival.force_n
        } else {
            self.advance_with_effects(state, &Sample { motion, drive, step_s })
        };
        if let Some(map) = &self.empirical {
            let velocity = drive.velocity_m_per_s + drive.acceleration_m_per_s2 * step_s;
            force_n += map.advance(state, velocity, step_s);
        }
        state.output_n = force_n;
        debug_assert!(state.motion == motion, "the step ends where the motion does");
        debug_assert!(state.fallbacks >= before, "fallbacks are only counted up");
        force_n
    }
}

impl DamperState {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival, motion: Motion) {
        self.motion = motion;
        self.deflection_m = without_tiny(arrival.stand.deflection_m);
        self.resting = arrival.stand.resting;
        self.chain_force_n = arrival.force_n;
        self.piston_velocity_m_per_s = arrival.piston_velocity_m_per_s;
        self.fallbacks = self.fallbacks.saturating_add(u32::from(arrival.fell_back));
    }
}

#[inline]
fn without_tiny(value: f64) -> f64 {
    if value.abs() < TINY { 0.0 } else { value }
}
