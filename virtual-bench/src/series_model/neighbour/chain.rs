//! The integration of a series damper with a neighbour.
//!
//! ```text
//! e = x - x_d        F = attachment(e)        x_d' = v(F)        Heun's rule, 20 us
//! ```
//!
//! Attachment and body are smooth laws whose inverse is bracketed, not sampled. Where the chain
//! answers faster than the step, the step is divided.
//!
//! Limits: a hard cap (C2 = 0) is a slope of a thousandth of Ce; friction must fall more slowly
//! with speed than the oil rises, as [`super::Draw`] makes it.

use super::{Neighbour, NeighbourDamper};
use crate::grid::Grid;
use crate::series_model::Trace;
use firmware_core::damper::HeatBalance;
use signal::random::Random;

/// Temperature at which the five numbers hold, degrees Celsius.
const NOMINAL_DEGC: f64 = 20.0;
/// Largest change of a chain over one part of a step, as a share.
const LARGEST_SHARE: f64 = 0.1;
/// Most parts of a step.
const MAX_PARTS: f64 = 64.0;
/// Least slope beyond relief, as a share of Ce.
const LEAST_SLOPE: f64 = 1e-3;
/// Refinements of a bracket, at most.
const MAX_TRIES: u32 = 80;

/// One motion of a damper.
#[derive(Clone, Copy)]
pub struct Drive<'a> {
    /// Displacement over time, m.
    pub displacement_m: &'a dyn Fn(f64) -> f64,
    /// Where the joint starts, m from the middle of its clearance.
    pub start_m: f64,
    /// Temperature of the oil at the start, degrees Celsius.
    pub start_degc: f64,
    /// Temperature around the damper, degrees Celsius.
    pub ambient_degc: f64,
    /// Seed of what is random.
    pub seed: u64,
}

/// What changes over time.
#[derive(Debug, Clone, Copy)]
struct State {
    piston_m: f64,
    void_m: f64,
    degc: f64,
    presliding_n: f64,
}

impl NeighbourDamper {
    /// Force and piston over time, and the temperature of the oil, at the start and after each
    /// step.
    pub fn simulate(&self, drive: &Drive<'_>, grid: Grid) -> (Trace, Vec<f64>) {
        let mut random = Random::new(drive.seed, 6);
        let phase_rad = random.phase();
        let mut valve = Valve::new(self.neighbour, random);
        let x = drive.displacement_m;
        let mut at_m = x(0.0);
        let mut state = State {
            piston_m: at_m - drive.start_m,
            void_m: 0.0,
            degc: drive.start_degc,
            presliding_n: 0.0,
        };
        let parts = (grid.step_s * self.fastest_per_s() / LARGEST_SHARE).ceil();
        let parts = parts.clamp(1.0, MAX_PARTS);
        let part_s = grid.step_s / parts;
        let mut trace = Trace::default();
        let mut degc = Vec::with_capacity(grid.steps + 1);
        let mut keep = |at_m: f64, state: &State| {
            let chain_n = self.attachment_n(at_m - state.piston_m);
            trace.force_n.push(chain_n + self.parallel_n(at_m, state, phase_rad));
            trace.piston_m.push(state.piston_m);
            degc.push(state.degc);
        };
        keep(at_m, &state);
        for step in 0..grid.steps {
            let start_s = step as f64 * grid.step_s;
            for part in 1..=parts as u32 {
                let next_m = x(start_s + f64::from(part) * part_s);
                self.advance(&mut state, (at_m, next_m), part_s, valve.gain_after(part_s));
                state.degc = self.heated(&state, next_m, drive.ambient_degc, part_s);
                at_m = next_m;
            }
            keep(at_m, &state);
        }
        if let Some(Neighbour::ClockSkew { rate }) = self.neighbour {
            trace.force_n = read_late(&trace.force_n, rate);
        }
        (trace, degc)
    }

    /// Moves the state over a part of a step, from one displacement to the next.
    fn advance(&self, state: &mut State, (from_m, to_m): (f64, f64), h: f64, valve: f64) {
        let gain = valve * self.fade(state.degc);
        let before_m = state.piston_m;
        if !self.follows_void(state, to_m) {
            let first = self.speed(self.attachment_n(from_m - before_m), gain);
            let tried_m = before_m + h * first;
            let second = self.speed(self.attachment_n(to_m - tried_m), gain);
            state.piston_m = before_m + 0.5 * h * (first + second);
            if let Some(Neighbour::VoidByForce { opening_n }) = self.neighbour {
                let side = opening_n.signum();
                let force = side * self.attachment_n(to_m - state.piston_m);
                let way = side * (state.piston_m - before_m);
                state.void_m += way.max(0.0) * (1.0 - opening_n.abs() / force.max(1e-9)).max(0.0);
            }
        }
        state.presliding_n = self.rubbed_n(state.presliding_n, to_m - from_m);
    }

    /// A piston in its void follows the eye without force, up to the end of the void.
    fn follows_void(&self, state: &mut State, to_m: f64) -> bool {
        let Some(Neighbour::VoidByForce { opening_n }) = self.neighbour else { return false };
        let side = opening_n.signum();
        let back = side * self.attachment_n(to_m - state.piston_m) < 0.0;
        if state.void_m <= 0.0 || !back {
            return false;
        }
        let slack_m = to_m + side * 0.5 * self.model.clearance_2a_m;
        let way_m = (side * (state.piston_m - slack_m)).max(0.0);
        state.piston_m -= side * way_m.min(state.void_m);
        state.void_m = (state.void_m - way_m).max(0.0);
        true
    }

    /// Force of the attachment at a deflection, N.
    fn attachment_n(&self, deflection_m: f64) -> f64 {
        let strain_m = deflection_m.abs() - 0.5 * self.model.clearance_2a_m;
        if strain_m <= 0.0 {
            return 0.0;
        }
        let ke = self.model.ke_n_per_m;
        let force = match self.neighbour {
            Some(Neighbour::AirOfExponent { toe_m, air_force_n, exponent }) => {
                let air = |force: f64| {
                    toe_m * (1.0 - libm::pow(1.0 + force / air_force_n, -1.0 / exponent))
                };
                root(&|force| force / ke + air(force) - strain_m, ke * strain_m)
            }
            _ => ke * strain_m,
        };
        force.copysign(deflection_m)
    }

    /// Speed of the piston under a force of the chain, the oil's part of it times `gain`, m/s.
    fn speed(&self, force_n: f64, gain: f64) -> f64 {
        let size = force_n.abs();
        if let Some(Neighbour::ExponentialFriction { breakaway_n, .. }) = self.neighbour
            && size <= breakaway_n
        {
            return 0.0;
        }
        let most = self.plain_speed(size / gain);
        let speed = match self.neighbour {
            Some(Neighbour::ExponentialFriction { coulomb_n, breakaway_n, stribeck_m_per_s }) => {
                let dry = |v: f64| {
                    coulomb_n + (breakaway_n - coulomb_n) * libm::exp(-v / stribeck_m_per_s)
                };
                root(&|v| gain * self.plain_n(v) + dry(v) - size, most)
            }
            Some(Neighbour::AlgebraicYield { yield_n, knee_m_per_s }) => {
                let soft = |v: f64| yield_n * v / libm::hypot(v, knee_m_per_s);
                root(&|v| gain * self.plain_n(v) + soft(v) - size, most)
            }
            Some(Neighbour::PowerOrifice { force_n, power }) => {
                let ce = self.model.ce_n_s_per_m;
                let below = |v: f64| ce * v + force_n * libm::pow(v, power);
                let relief = self.model.f_relief_n;
                let below_n = size.min(relief);
                root(&|v| below(v) - below_n, below_n / ce) + (size - below_n) / self.beyond()
            }
            _ => most,
        };
        speed.copysign(force_n)
    }

    /// Slope beyond relief, N s/m.
    fn beyond(&self) -> f64 {
        self.model.c2_n_s_per_m.max(LEAST_SLOPE * self.model.ce_n_s_per_m)
    }

    /// Force of the plain dashpot at a speed, N.
    fn plain_n(&self, speed: f64) -> f64 {
        let opens = self.model.f_relief_n / self.model.ce_n_s_per_m;
        let below = speed.min(opens);
        self.model.ce_n_s_per_m * below + self.beyond() * (speed - below)
    }

    /// Speed of the plain dashpot at a force, m/s.
    fn plain_speed(&self, force_n: f64) -> f64 {
        let below = force_n.min(self.model.f_relief_n);
        below / self.model.ce_n_s_per_m + (force_n - below) / self.beyond()
    }

    /// The fastest rate at which the chain forgets, 1/s. Friction may halve the slope of the oil.
    fn fastest_per_s(&self) -> f64 {
        let slope = self.model.ce_n_s_per_m.min(self.beyond());
        2.0 * self.model.ke_n_per_m / slope
    }

    /// Factor on the force of the oil at a temperature.
    fn fade(&self, degc: f64) -> f64 {
        match self.neighbour {
            Some(Neighbour::FadingRelief { fade_per_k, .. }) => {
                libm::exp((-fade_per_k * (degc - NOMINAL_DEGC)).clamp(-6.9, 6.9))
            }
            _ => 1.0,
        }
    }

    fn heated(&self, state: &State, at_m: f64, ambient_degc: f64, h: f64) -> f64 {
        let Some(Neighbour::FadingRelief { heat, .. }) = self.neighbour else { return state.degc };
        let force_n = self.attachment_n(at_m - state.piston_m);
        let power_w = (force_n * self.speed(force_n, self.fade(state.degc))).abs();
        HeatBalance::step(&heat, state.degc, power_w, ambient_degc, h)
    }

    /// Presliding friction after a travel, N, by the midpoint rule.
    fn rubbed_n(&self, force_n: f64, travel_m: f64) -> f64 {
        let Some(Neighbour::DahlOfExponent { capacity_n, travel_m: x_d, exponent }) =
            self.neighbour
        else {
            return 0.0;
        };
        let slope = |z: f64| {
            let u = 1.0 - travel_m.signum() * z / capacity_n;
            capacity_n / x_d * libm::pow(u.abs(), exponent).copysign(u)
        };
        let middle_n = force_n + 0.5 * travel_m * slope(force_n);
        (force_n + travel_m * slope(middle_n)).clamp(-capacity_n, capacity_n)
    }

    /// Force parallel to the chain, N.
    fn parallel_n(&self, at_m: f64, state: &State, phase_rad: f64) -> f64 {
        match self.neighbour {
            Some(Neighbour::ProgressiveStop {
                extension_m,
                compression_m,
                progression_n_per_m2,
            }) => {
                let square = |depth_m: f64| depth_m.max(0.0) * depth_m.max(0.0);
                progression_n_per_m2 * (square(at_m - extension_m) - square(-at_m - compression_m))
            }
            Some(Neighbour::OneSidedStop { from_m, stiffness_n_per_m }) => {
                let side = from_m.signum();
                side * stiffness_n_per_m * (side * (at_m - from_m)).max(0.0)
            }
            Some(Neighbour::RippleOverPosition { amplitude_n, period_m }) => {
                amplitude_n * libm::sin(std::f64::consts::TAU * at_m / period_m + phase_rad)
            }
            _ => state.presliding_n,
        }
    }
}

/// A valve that switches at random times.
struct Valve {
    share: f64,
    dwell_s: f64,
    remaining_s: f64,
    random: Random,
}

impl Valve {
    fn new(neighbour: Option<Neighbour>, mut random: Random) -> Self {
        let Some(Neighbour::SwitchingValve { share, dwell_s }) = neighbour else {
            return Self { share: 0.0, dwell_s: f64::INFINITY, remaining_s: f64::INFINITY, random };
        };
        let share = if random.uniform() < 0.5 { -share } else { share };
        let remaining_s = -dwell_s * libm::log(random.uniform());
        Self { share, dwell_s, remaining_s, random }
    }

    /// The factor on the force after a time.
    fn gain_after(&mut self, time_s: f64) -> f64 {
        self.remaining_s -= time_s;
        if self.remaining_s < 0.0 {
            self.share = -self.share;
            self.remaining_s = -self.dwell_s * libm::log(self.random.uniform());
        }
        1.0 + self.share
    }
}

/// Values read at t (1 - rate), straight between samples.
fn read_late(values: &[f64], rate: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1) as f64;
    (0..values.len())
        .map(|n| {
            let at = (n as f64 * (1.0 - rate)).clamp(0.0, last);
            let (low, high) = (at.floor(), at.ceil());
            let (a, b) = (values[low as usize], values[high as usize]);
            a + (at - low) * (b - a)
        })
        .collect()
}

/// The root between zero and `high` of a rising function that is not above zero at zero: false
/// position (Illinois).
fn root(rising: &dyn Fn(f64) -> f64, high: f64) -> f64 {
    let (mut low, mut high) = ((0.0, rising(0.0)), (high, rising(high)));
    if low.1 >= 0.0 {
        return low.0;
    }
    if high.1 <= 0.0 {
        return high.0;
    }
    let close = 1e-12 * high.0;
    let mut last = None;
    for _ in 0..MAX_TRIES {
        let at = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        let miss = rising(at);
        if miss == 0.0 || high.0 - low.0 <= close {
            return at;
        }
        let above = miss > 0.0;
        let moved = (at - if above { high.0 } else { low.0 }).abs();
        if last == Some(above) {
            let stale = if above { &mut low } else { &mut high };
            stale.1 *= 0.5;
        }
        last = Some(above);
        if above {
            high = (at, miss);
        } else {
            low = (at, miss);
        }
        if moved <= close {
            return at;
        }
    }
    0.5 * (low.0 + high.0)
}
