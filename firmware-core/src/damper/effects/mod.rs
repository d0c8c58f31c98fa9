//! What a nominal damper lacks, one effect per file.
//!
//! A new effect is one new file and one line in the list at the end of this file. The file holds
//! the parameter table, from which `effect_parameters!` makes the struct, and a [`DamperEffect`],
//! which says how the effect enters the chain and how large it is in tests and campaigns
//! ([`in_service`](DamperEffect::in_service), [`drawn`](DamperEffect::drawn)). It enters the chain
//! by one or more of these methods, each with a default that does nothing:
//!
//! | method | for | when |
//! | --- | --- | --- |
//! | [`shape`](DamperEffect::shape) | a changed law: friction, asymmetry, valve stages, stiffening, a soft toe of air | once |
//! | [`slow`](DamperEffect::slow) | a factor on a law from temperature, position, aeration, wear | each step, frozen for it |
//! | [`creep`](DamperEffect::creep) | a deflection of the attachment with a fast memory | each step, solved with the chain |
//! | [`margin`](DamperEffect::margin) | a switch (a void opens, a gap closes) | the step is cut where it reaches zero |
//! | [`remember`](DamperEffect::remember) | the effect's own memory | after each piece of a step |
//! | [`output`](DamperEffect::output) | parts parallel to the chain, and the sensor | after each piece, in list order |
//! | [`delay_s`](DamperEffect::delay_s) | a late reading | after everything else |
//!
//! A [`Place::Inboard`] or [`Place::Attachment`] effect that is neither slow, nor creeps, nor
//! switches is its law alone: in a step it is not asked anything.
//!
//! The order of the list is the order in which effects act, whatever the order they are given in.

pub mod draw;
pub mod parameter;

use heapless::Vec;

pub use draw::Draw;
pub use parameter::{Parameter, Scale, Unit};

use super::error::DamperError;
use super::implicit::Creep;
use super::nominal::Nominal;
use super::parts::{Factors, Parts};
use super::{Done, Instant};

/// Most parameters of one effect.
pub const MAX_PARAMETERS: usize = 8;

/// Parameter values in table order.
pub type Values = Vec<f64, MAX_PARAMETERS>;

/// What one effect remembers between steps.
pub type Memory = [f64; 4];

/// Where in the damper an effect sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Parallel to the hydraulic body, inside the attachment: the attachment filters it.
    Inboard,
    /// In series with the body.
    Attachment,
    /// Parallel to the whole damper, between its eyes.
    Parallel,
    /// Between the force and what is read of it.
    Sensor,
}

impl Place {
    /// As it is written in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inboard => "inboard",
            Self::Attachment => "attachment",
            Self::Parallel => "parallel",
            Self::Sensor => "sensor",
        }
    }
}

/// A parameter table and the values that follow it; `effect_parameters!` writes it.
pub trait Table: Sized {
    /// The table.
    const PARAMETERS: &'static [Parameter];

    /// The effect from values in table order, if there are as many.
    fn from_table(values: &[f64]) -> Option<Self>;

    /// The values in table order.
    fn values(&self) -> Values;
}

/// What the factors of a slow state change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Slow {
    /// There are none.
    Nothing,
    /// The body alone.
    Body,
    /// The attachment, perhaps the body too.
    Attachment,
}

/// How an effect enters the chain. Frozen configuration in `self`, memory outside.
pub trait DamperEffect: Table + Copy {
    /// Its name in scenarios and results.
    const NAME: &'static str;
    /// Where it sits.
    const PLACE: Place;
    /// Its equation, one line.
    const EQUATION: &'static str;
    /// What its [`slow`](Self::slow) factors change.
    const SLOW: Slow = Slow::Nothing;
    /// It has [`creep`](Self::creep).
    const CREEPS: bool = false;
    /// It has a [`margin`](Self::margin).
    const SWITCHES: bool = false;
    /// The test that shows it on a bench, one sentence.
    const SHOWN_BY: &'static str;
    /// Sampling rate below which a record cannot hold it, Hz.
    const NEEDS_RATE_HZ: f64 = 0.0;
    /// It distinguishes extension from compression.
    const DIRECTIONAL: bool = false;
    /// Start values of a fit in natural sizes, where the typical ones alone would find only one of
    /// several shapes: relaxation times, knees, positions.
    const STARTS: &'static [&'static [f64]] = &[];
    /// How many parameters at the end of the table may share the value of the one before them: a
    /// fit for which that is enough needs no more.
    const MAY_SHARE: usize = 0;
    /// The largest strength of [`drawn`](Self::drawn) at which a damper is still a damper.
    const STRONGEST: f64;
    /// The hydraulic damper of the virtual bench, which is modelled from oil, valves, seals and
    /// rubber, has this effect.
    const IN_HYDRAULIC_MODEL: bool;

    /// The effect of a drawn shape at a strength between zero and [`STRONGEST`](Self::STRONGEST),
    /// as a campaign mounts it.
    fn drawn(strength: f64, draw: &Draw) -> Self;

    /// The effect at `size` times what is seen in service. Wear, warming and foam are as much
    /// faster as a test of a second is shorter than service.
    fn in_service(nominal: &Nominal, size: f64) -> Self;

    /// The effect from values in table order.
    ///
    /// # Errors
    /// [`DamperError::ValueCount`], or [`DamperError::Parameter`] for a value that no damper of
    /// any size can have.
    fn from_values(values: &[f64]) -> Result<Self, DamperError> {
        debug_assert!(Self::PARAMETERS.len() <= MAX_PARAMETERS, "{} has a long table", Self::NAME);
        let (given, expected) = (values.len(), Self::PARAMETERS.len());
        let count = DamperError::ValueCount { effect: Self::NAME, given, expected };
        let effect = Self::from_table(values).ok_or(count)?;
        effect.validate()?;
        Ok(effect)
    }

    /// Checks the values against what is possible at any size of damper.
    ///
    /// # Errors
    /// [`DamperError::Parameter`] naming the first value that is not.
    fn validate(&self) -> Result<(), DamperError> {
        for (row, value) in Self::PARAMETERS.iter().zip(self.values()) {
            let (lower, upper) = row.bounds_at_any_scale();
            if !(value >= lower && value <= upper) {
                let (owner, parameter) = (Self::NAME, row.name);
                return Err(DamperError::Parameter { owner, parameter, value, lower, upper });
            }
        }
        Ok(())
    }

    /// Changes the laws of the parts, once, when the damper is built.
    fn shape(&self, _parts: &mut Parts, _nominal: &Nominal) {}

    /// Multiplies the factors that hold during a step. `at` is the instant that stands for the
    /// step, and its end when the force is read from the attachment.
    fn slow(&self, _at: &Instant, _memory: &Memory, _factors: &mut Factors) {}

    /// Creep of the attachment over a step, given the force at its beginning.
    fn creep(&self, _nominal: &Nominal, _memory: &Memory, _from_n: f64, _step_s: f64) -> Creep {
        Creep::NONE
    }

    /// How far the effect still is from switching at the end of a piece, in any unit. Where it
    /// falls below zero the step is cut, just on the far side, and [`remember`](Self::remember)
    /// switches. A margin that dips below zero and comes back within one step is not seen.
    fn margin(&self, _memory: &Memory, _done: &Done) -> f64 {
        f64::INFINITY
    }

    /// Brings the memory to the end of a piece of a step.
    fn remember(&self, _nominal: &Nominal, _memory: &mut Memory, _done: &Done) {}

    /// The force outside of this effect, given the force inside of it, at the end of a piece.
    fn output(&self, _memory: &mut Memory, _done: &Done, force_n: f64) -> f64 {
        force_n
    }

    /// How late the force is read, s.
    fn delay_s(&self) -> f64 {
        0.0
    }
}

/// What the catalogue says about an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectInfo {
    /// Its name in scenarios and results.
    pub name: &'static str,
    /// Where it sits.
    pub place: Place,
    /// Its equation, one line.
    pub equation: &'static str,
    /// Its parameter table.
    pub parameters: &'static [Parameter],
    /// The test that shows it on a bench.
    pub shown_by: &'static str,
    /// Sampling rate below which a record cannot hold it, Hz.
    pub needs_rate_hz: f64,
    /// It distinguishes extension from compression.
    pub directional: bool,
    /// Further start values of a fit, in natural sizes; the typical ones come first.
    pub starts: &'static [&'static [f64]],
    /// How many parameters at the end of the table may share the value of the one before them.
    pub may_share: usize,
    /// The largest strength of [`Effect::drawn`] at which a damper is still a damper.
    pub strongest: f64,
    /// The hydraulic damper of the virtual bench has it.
    pub in_hydraulic_model: bool,
}

impl EffectInfo {
    /// The same effect with one parameter for those that may share a value; none where no two may.
    ///
    /// ```
    /// use firmware_core::damper::effects::CATALOGUE;
    /// let of = |name| CATALOGUE.iter().find(|info| info.name == name).unwrap();
    /// let even = of("asymmetric_damping").shorter().unwrap();
    /// assert_eq!(even.parameters.len(), 1);
    /// assert_eq!(even.effect(&[0.1])?.values(), [0.1, 0.1]);
    /// assert!(of("seal_friction").shorter().is_none());
    /// # Ok::<(), firmware_core::damper::DamperError>(())
    /// ```
    pub fn shorter(&self) -> Option<Self> {
        let kept = self.parameters.len().checked_sub(self.may_share)?;
        let parameters = self.parameters.get(..kept)?;
        let shorter = self.may_share > 0 && kept > 0;
        shorter.then_some(Self { parameters, starts: &[], may_share: 0, ..*self })
    }

    /// The effect from values in the order of this table; parameters that a shorter table leaves
    /// out take the last value.
    ///
    /// # Errors
    /// [`DamperError::ValueCount`], [`DamperError::Parameter`].
    pub fn effect(&self, values: &[f64]) -> Result<Effect, DamperError> {
        let whole = CATALOGUE.iter().find(|info| info.name == self.name);
        let whole = whole.map_or(self.parameters.len(), |info| info.parameters.len());
        if values.len() != self.parameters.len() {
            let (effect, given, expected) = (self.name, values.len(), self.parameters.len());
            return Err(DamperError::ValueCount { effect, given, expected });
        }
        let last = values.last().copied().into_iter().cycle();
        let mut all = Values::new();
        for value in values.iter().copied().chain(last).take(whole) {
            // No table is longer than `MAX_PARAMETERS`.
            let _ = all.push(value);
        }
        Effect::from_values(self.name, &all)
    }
}

macro_rules! effects {
    ($($module:ident: $effect:ident,)+) => {
        $(pub mod $module;)+
        $(pub use $module::$effect;)+

        /// An effect that the nominal damper lacks.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Effect {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $effect($effect),)+
        }

        /// All effects, in the order in which they act.
        pub const CATALOGUE: &[EffectInfo] = &[$(EffectInfo {
            name: $effect::NAME,
            place: $effect::PLACE,
            equation: $effect::EQUATION,
            parameters: $effect::PARAMETERS,
            shown_by: $effect::SHOWN_BY,
            needs_rate_hz: $effect::NEEDS_RATE_HZ,
            directional: $effect::DIRECTIONAL,
            starts: $effect::STARTS,
            may_share: $effect::MAY_SHARE,
            strongest: $effect::STRONGEST,
            in_hydraulic_model: $effect::IN_HYDRAULIC_MODEL,
        },)+];

        $(impl From<$effect> for Effect {
            fn from(effect: $effect) -> Self {
                Self::$effect(effect)
            }
        })+

        impl Effect {
            /// The effect of this name from values in the order of its table.
            ///
            /// # Errors
            /// [`DamperError::UnknownEffect`], [`DamperError::ValueCount`],
            /// [`DamperError::Parameter`].
            pub fn from_values(name: &str, values: &[f64]) -> Result<Self, DamperError> {
                $(if name == $effect::NAME {
                    return Ok(Self::$effect(DamperEffect::from_values(values)?));
                })+
                Err(DamperError::UnknownEffect)
            }

            /// The effect of this name in a drawn shape at a strength.
            ///
            /// # Errors
            /// [`DamperError::UnknownEffect`], [`DamperError::Parameter`].
            pub fn drawn(name: &str, strength: f64, draw: &Draw) -> Result<Self, DamperError> {
                $(if name == $effect::NAME {
                    let effect = $effect::drawn(strength, draw);
                    effect.validate()?;
                    return Ok(Self::$effect(effect));
                })+
                Err(DamperError::UnknownEffect)
            }

            /// The effect of this name at `size` times what is seen in service.
            ///
            /// # Errors
            /// [`DamperError::UnknownEffect`], [`DamperError::Parameter`].
            pub fn in_service(
                name: &str,
                nominal: &Nominal,
                size: f64,
            ) -> Result<Self, DamperError> {
                $(if name == $effect::NAME {
                    let effect = $effect::in_service(nominal, size);
                    effect.validate()?;
                    return Ok(Self::$effect(effect));
                })+
                Err(DamperError::UnknownEffect)
            }

            /// Its place in the catalogue.
            pub fn index(&self) -> usize {
                let name = self.name();
                let index = CATALOGUE.iter().position(|info| info.name == name);
                debug_assert!(index.is_some(), "{name} is not in the catalogue");
                index.unwrap_or(CATALOGUE.len())
            }

            /// Its name in scenarios and results.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$effect(_) => $effect::NAME,)+ }
            }

            /// Where it sits.
            pub fn place(&self) -> Place {
                match self { $(Self::$effect(_) => $effect::PLACE,)+ }
            }

            /// Its parameter table.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $(Self::$effect(_) => $effect::PARAMETERS,)+ }
            }

            /// Its values in the order of the table.
            pub fn values(&self) -> Values {
                match self { $(Self::$effect(effect) => effect.values(),)+ }
            }

            pub(super) fn slow_part(&self) -> Slow {
                match self { $(Self::$effect(_) => $effect::SLOW,)+ }
            }

            pub(super) fn creeps(&self) -> bool {
                match self { $(Self::$effect(_) => $effect::CREEPS,)+ }
            }

            pub(super) fn switches(&self) -> bool {
                match self { $(Self::$effect(_) => $effect::SWITCHES,)+ }
            }

            /// True where [`shape`](DamperEffect::shape) says all of it.
            pub(super) fn is_law_alone(&self) -> bool {
                let inside = matches!(self.place(), Place::Inboard | Place::Attachment);
                inside && !(self.slow_part() != Slow::Nothing || self.creeps() || self.switches())
            }

            pub(super) fn margin(&self, memory: &Memory, done: &Done) -> f64 {
                match self { $(Self::$effect(effect) => effect.margin(memory, done),)+ }
            }

            pub(super) fn delay_s(&self) -> f64 {
                match self { $(Self::$effect(effect) => effect.delay_s(),)+ }
            }

            pub(super) fn validate(&self) -> Result<(), DamperError> {
                match self { $(Self::$effect(effect) => effect.validate(),)+ }
            }

            pub(super) fn shape(&self, parts: &mut Parts, nominal: &Nominal) {
                match self { $(Self::$effect(effect) => effect.shape(parts, nominal),)+ }
            }

            pub(super) fn slow(&self, at: &Instant, memory: &Memory, factors: &mut Factors) {
                match self { $(Self::$effect(effect) => effect.slow(at, memory, factors),)+ }
            }

            pub(super) fn creep(
                &self,
                nominal: &Nominal,
                memory: &Memory,
                from_n: f64,
                step_s: f64,
            ) -> Creep {
                match self {
                    $(Self::$effect(effect) => effect.creep(nominal, memory, from_n, step_s),)+
                }
            }

            pub(super) fn remember(&self, nominal: &Nominal, memory: &mut Memory, done: &Done) {
                match self { $(Self::$effect(effect) => effect.remember(nominal, memory, done),)+ }
            }

            pub(super) fn output(&self, memory: &mut Memory, done: &Done, force_n: f64) -> f64 {
                match self { $(Self::$effect(effect) => effect.output(memory, done, force_n),)+ }
            }
        }
    };
}

// Those that add to a law come before those that scale it; the sensor comes last.
effects! {
    seal_friction: SealFriction,
    quadratic_orifice: QuadraticOrifice,
    orifice_leakage: OrificeLeakage,
    second_valve_stage: SecondValveStage,
    soft_yield: SoftYield,
    asymmetric_damping: AsymmetricDamping,
    position_dependent_damping: PositionDependentDamping,
    temperature_fade: TemperatureFade,
    gas_preload: GasPreload,
    stiffening_attachment: StiffeningAttachment,
    rubber_hysteresis: RubberHysteresis,
    entrained_air: EntrainedAir,
    fixture_compliance: FixtureCompliance,
    stroke_dependent_stiffness: StrokeDependentStiffness,
    aeration_memory: AerationMemory,
    clearance_growth: ClearanceGrowth,
    cavitation: Cavitation,
    clearance_impact: ClearanceImpact,
    moving_mass: MovingMass,
    bump_stop: BumpStop,
    presliding_friction: PreslidingFriction,
    force_offset: ForceOffset,
    sensor_delay: SensorDelay,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_is_usable() {
        let scale = Nominal::NEW.scale();
        for info in CATALOGUE {
            assert!(!info.parameters.is_empty() && info.parameters.len() <= MAX_PARAMETERS);
            let usual: Values = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            for (row, value) in info.parameters.iter().zip(&usual) {
                let (lower, upper) = row.bounds(&scale);
                assert!(lower < upper && lower <= *value && *value <= upper, "{}", row.name);
                assert!(!row.meaning.is_empty());
            }
            for start in info.starts {
                assert_eq!(start.len(), info.parameters.len(), "{}", info.name);
                for (row, value) in info.parameters.iter().zip(*start) {
                    assert!(row.lower <= *value && *value <= row.upper, "{}", row.name);
                }
            }
            assert!(info.shown_by.ends_with('.'), "{}", info.name);
            let effect = Effect::from_values(info.name, &usual).unwrap();
            assert_eq!(effect.values(), usual);
            assert_eq!((effect.name(), effect.place()), (info.name, info.place));
            assert!(Effect::from_values(info.name, &usual[1..]).is_err());
            let mut bad = usual.clone();
            bad[0] = f64::NAN;
            assert!(Effect::from_values(info.name, &bad).is_err());
        }
        assert_eq!(Effect::from_values("gremlins", &[]), Err(DamperError::UnknownEffect));
    }

    #[test]
    fn names_are_unique() {
        for (i, info) in CATALOGUE.iter().enumerate() {
            assert!(CATALOGUE[..i].iter().all(|other| other.name != info.name));
        }
    }
}
