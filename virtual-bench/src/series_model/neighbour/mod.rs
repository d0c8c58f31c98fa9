//! Neighbours: real parts that do not quite follow the equation of an effect, and inputs that no
//! record holds.
//!
//! An identification that meets a neighbour of an effect should name that effect and report that
//! something remains; one that meets a hidden input should name nothing with confidence. The
//! equations are written and integrated here (`chain`), apart from the core:
//!
//! | kind | near | equation |
//! | --- | --- | --- |
//! | `void_by_force` | `cavitation` | `L' = s v <1 - F_o/(s F)>`; the body carries nothing while L > 0 and s F < 0 |
//! | `fading_relief` | `temperature_fade` | `F_h = exp(-k (T - 20)) f(v)`: the relief falls as Ce does; `C T' = abs(F v) - W (T - T_a)` |
//! | `progressive_stop` | `bump_stop` | `F += q <x - x_e>^2 - q <-x - x_c>^2` |
//! | `one_sided_stop` | `bump_stop` | `F += s k <s x - x_s>`, at one end only |
//! | `exponential_friction` | `seal_friction` | `F += sgn(v) (Fc + (Fs - Fc) exp(-abs(v)/v_s))`, sticking up to Fs |
//! | `air_of_exponent` | `entrained_air` | `d += d_max (1 - (1 + F/F_a)^(-1/n))`, n not 1.4 |
//! | `power_orifice` | `quadratic_orifice` | `F = Ce v + b v^p` up to relief, p not 2 |
//! | `algebraic_yield` | `soft_yield` | `F += F_y v/sqrt(v^2 + v_y^2)` |
//! | `dahl_of_exponent` | `presliding_friction` | `dz = F_c/x_d sgn(u) abs(u)^i dx`, `u = 1 - s z/F_c`, i not 1 |
//! | `switching_valve` | | `F_h = (1 +- c) f(v)`, the sign changes at random times |
//! | `ripple_over_position` | | `F + A sin(2 pi x/l + phi)` |
//! | `clock_skew` | | F is read at `t (1 - c)`: the clocks of the two channels drift apart |
//!
//! with `<>` zero below zero and s a direction. [`NEIGHBOURS`] lists them, and [`Draw`] gives one
//! of a drawn shape at a strength. [`NeighbourDamper`] is a specimen.

mod chain;
mod draw;

pub use chain::Drive;
pub use draw::{Draw, Reach};

use super::SeriesModel;
use crate::heat::temperatures_degc;
use crate::specimen::{Load, Response, Specimen};
use firmware_core::damper::HeatBalance;

/// A neighbour with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Neighbour {
    /// A void that opens by the force.
    VoidByForce {
        /// Force from which it opens, N; its sign is the direction in which the void is made.
        opening_n: f64,
    },
    /// Oil whose relief force falls with the temperature as its damping does.
    FadingRelief {
        /// Relative loss of force per kelvin, 1/K.
        fade_per_k: f64,
        /// Heat balance of the oil.
        heat: HeatBalance,
    },
    /// Stops at both ends whose force grows with the square of the depth.
    ProgressiveStop {
        /// Where the stop in extension begins, m from mid-stroke.
        extension_m: f64,
        /// Where the stop in compression begins, m from mid-stroke.
        compression_m: f64,
        /// Force per depth squared, N/m2.
        progression_n_per_m2: f64,
    },
    /// A straight stop at one end.
    OneSidedStop {
        /// Where it begins, m from mid-stroke; its sign is the end.
        from_m: f64,
        /// Stiffness, N/m.
        stiffness_n_per_m: f64,
    },
    /// Friction of the seal with an exponential Stribeck curve.
    ExponentialFriction {
        /// Friction force at high speed, N.
        coulomb_n: f64,
        /// Friction force at rest, N.
        breakaway_n: f64,
        /// Speed at which 37 % of the difference remains, m/s.
        stribeck_m_per_s: f64,
    },
    /// Free air of another exponent.
    AirOfExponent {
        /// Deflection that squeezing all bubbles takes, m.
        toe_m: f64,
        /// Force at which the pressure in the bubbles has doubled, N.
        air_force_n: f64,
        /// Polytropic exponent.
        exponent: f64,
    },
    /// An orifice whose force grows with a power of the speed.
    PowerOrifice {
        /// Force at 1 m/s, N.
        force_n: f64,
        /// Power of the speed.
        power: f64,
    },
    /// A yield force with another knee.
    AlgebraicYield {
        /// Force beyond the knee, N.
        yield_n: f64,
        /// Speed of the knee, m/s.
        knee_m_per_s: f64,
    },
    /// Presliding friction of another exponent, between the eyes.
    DahlOfExponent {
        /// Capacity, N.
        capacity_n: f64,
        /// Capacity over the stiffness at zero force, m.
        travel_m: f64,
        /// Exponent.
        exponent: f64,
    },
    /// A valve that switches at random times.
    SwitchingValve {
        /// Share by which the hydraulic force is higher or lower.
        share: f64,
        /// Mean time between two switches, s.
        dwell_s: f64,
    },
    /// A ripple over the position of the eyes.
    RippleOverPosition {
        /// Amplitude, N.
        amplitude_n: f64,
        /// Length of a period, m.
        period_m: f64,
    },
    /// Clocks that drift apart.
    ClockSkew {
        /// Delay of the force per time.
        rate: f64,
    },
}

/// What the list of neighbours says about one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NeighbourInfo {
    /// Its name in results.
    pub name: &'static str,
    /// The effect whose equation it is near; none for a hidden input.
    pub near: Option<&'static str>,
}

const fn near(name: &'static str, effect: &'static str) -> NeighbourInfo {
    NeighbourInfo { name, near: Some(effect) }
}

const fn hidden(name: &'static str) -> NeighbourInfo {
    NeighbourInfo { name, near: None }
}

/// All neighbours, then all hidden inputs.
pub const NEIGHBOURS: [NeighbourInfo; 12] = [
    near("void_by_force", "cavitation"),
    near("fading_relief", "temperature_fade"),
    near("progressive_stop", "bump_stop"),
    near("one_sided_stop", "bump_stop"),
    near("exponential_friction", "seal_friction"),
    near("air_of_exponent", "entrained_air"),
    near("power_orifice", "quadratic_orifice"),
    near("algebraic_yield", "soft_yield"),
    near("dahl_of_exponent", "presliding_friction"),
    hidden("switching_valve"),
    hidden("ripple_over_position"),
    hidden("clock_skew"),
];

impl Neighbour {
    /// Its name in results.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::VoidByForce { .. } => "void_by_force",
            Self::FadingRelief { .. } => "fading_relief",
            Self::ProgressiveStop { .. } => "progressive_stop",
            Self::OneSidedStop { .. } => "one_sided_stop",
            Self::ExponentialFriction { .. } => "exponential_friction",
            Self::AirOfExponent { .. } => "air_of_exponent",
            Self::PowerOrifice { .. } => "power_orifice",
            Self::AlgebraicYield { .. } => "algebraic_yield",
            Self::DahlOfExponent { .. } => "dahl_of_exponent",
            Self::SwitchingValve { .. } => "switching_valve",
            Self::RippleOverPosition { .. } => "ripple_over_position",
            Self::ClockSkew { .. } => "clock_skew",
        }
    }
}

/// A series damper with one neighbour, as a specimen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeighbourDamper {
    /// Its five numbers.
    pub model: SeriesModel,
    /// What it has; none for the plain damper.
    pub neighbour: Option<Neighbour>,
}

impl Specimen for NeighbourDamper {
    fn longest_step_s(&self) -> f64 {
        20e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let drive = Drive {
            displacement_m: &|t| load.mean_m + load.excitation.displacement_m(t),
            start_m: 0.5 * load.start * self.model.clearance_2a_m,
            start_degc: load.start_degc,
            ambient_degc: load.ambient_degc,
            seed: load.seed,
        };
        let (trace, own_degc) = self.simulate(&drive, load.grid);
        let force_n = trace.force_n;
        let temperature_degc = match self.neighbour {
            Some(Neighbour::FadingRelief { .. }) => own_degc,
            _ => temperatures_degc(HeatBalance::YAW_DAMPER, load, &force_n),
        };
        Response { force_n, temperature_degc, doubtful_steps: 0 }
    }
}

#[cfg(test)]
mod tests;
