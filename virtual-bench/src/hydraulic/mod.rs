//! The full hydraulic damper: the "real" damper of a bench visit, whose records show effects that
//! the fitted model was not written for.
//!
//! ```text
//! eye --[ seat with clearance, rubber ]-- rod, m --[ piston in twin tube ]-- eye with load cell
//!
//! W1' = -(flows out of the rod side)      W1 s(p1) = V1(x_p) = A1 (l - x_p) + dead
//!                                         A1 = A2 - A_r
//! W2' = -(flows out of the cap side)      W2 s(p2) = V2(x_p) = A2 (l + x_p) + dead
//! V_g' = -(flows into the reservoir)      p3 = p30 (V_g0/V_g)^n
//! F = A1 (p1 - pa) - A2 (p2 - pa) + F_f(v, p1 - p2)          m v' = F_attachment(x - x_p) - F
//! C T' = heat of valves, gap, seals and rubber - H (T - Ta)
//! ```
//!
//! W is the liquid in a chamber, counted at one bar, so that oil is kept exactly and cavitation is
//! the end of the curve s(p) (`oil`). Which valves sit between which chambers decides the type:
//! with bidirectional flow the piston throttles both ways and a foot check refills; with
//! unidirectional flow the oil always circulates cap -> rod -> reservoir -> cap. `file` reads a
//! damper from TOML.
//!
//! The structure is a reconstruction from standard damper hydraulics. Parameter sets that come with
//! the project are illustrative: they reach the stiffness and the relief force of a yaw damper of
//! the SS9's class and are no maker's data.
//!
//! Integration (`stage`): two implicit stages of second order, L-stable (SDIRK2), each solved by
//! Newton's method for the piston's velocity and two pressures together; a step that does not
//! converge is halved. Open checks are stiff and need no special care.
//!
//! Limits: massless valves; one temperature for all oil; free air does not dissolve; no
//! cylinder mass; no end stops (volumes stop shrinking at the end of the stroke).

mod attachment;
mod file;
mod friction;
mod oil;
mod stage;
mod valve;

pub use attachment::Attachment;
pub use friction::Friction;
pub use oil::{Filling, Oil, OilAt};
pub use valve::{Chamber, Flow, Leakage, Throttle, Valve};

use crate::specimen::{Load, Response, Specimen};
use firmware_core::damper::HeatBalance;
use stage::{Ends, GAMMA, Stage};
use std::f64::consts::PI;

/// Pressure of the air around, Pa.
pub const AMBIENT_PA: f64 = 101_325.0;

/// Most halvings of a step that does not converge.
const HALVINGS_MAX: u32 = 12;

/// The reservoir with its gas cushion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reservoir {
    /// Volume of the gas at mid-stroke, m3.
    pub gas_m3: f64,
    /// Pressure of the gas at mid-stroke, Pa absolute.
    pub gas_pa: f64,
    /// Polytropic exponent, 1 (slow) to 1.4 (fast).
    pub exponent: f64,
}

/// A hydraulic damper.
#[derive(Debug, Clone, PartialEq)]
pub struct HydraulicDamper {
    /// Diameter of the bore, m.
    pub bore_m: f64,
    /// Diameter of the rod, m.
    pub rod_m: f64,
    /// Travel of the piston from the middle to either end, m.
    pub half_stroke_m: f64,
    /// Volume of the rod side that remains at the end of the stroke, m3.
    pub rod_dead_m3: f64,
    /// The same of the cap side, m3.
    pub cap_dead_m3: f64,
    /// Mass that moves with the rod, kg.
    pub moving_kg: f64,
    /// The reservoir.
    pub reservoir: Reservoir,
    /// The oil.
    pub oil: Oil,
    /// The gap around the piston.
    pub leakage: Leakage,
    /// The seals.
    pub friction: Friction,
    /// Seats and rubber.
    pub attachment: Attachment,
    /// Warming.
    pub heat: HeatBalance,
    /// The valves.
    pub valves: Vec<Valve>,
}

/// The state of the damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Position of the piston, m.
    pub piston_m: f64,
    /// Its velocity, m/s.
    pub piston_m_per_s: f64,
    /// Liquid on the rod side at one bar, m3.
    pub rod_oil_m3: f64,
    /// Liquid on the cap side at one bar, m3.
    pub cap_oil_m3: f64,
    /// Volume of the gas, m3.
    pub gas_m3: f64,
    /// Deflection of the fast branch of the rubber, m.
    pub branch_m: f64,
    /// Temperature of the oil, degrees Celsius.
    pub oil_degc: f64,
    /// Heat generated so far, J.
    pub heat_j: f64,
    /// Pressures on the rod and the cap side, Pa absolute.
    pub pressures_pa: [f64; 2],
    /// Share of void in the rod and the cap side.
    pub voids: [f64; 2],
    /// Force on the load cell, N.
    pub force_n: f64,
    /// Steps that did not converge however short.
    pub unsolved: u32,
    /// Flow into the reservoir, m3/s.
    reservoir_m3_per_s: f64,
    /// Unknowns of the last stage, where the next search begins.
    unknowns: [f64; 3],
}

impl HydraulicDamper {
    /// Area of the bore A2, m2.
    pub fn cap_m2(&self) -> f64 {
        0.25 * PI * self.bore_m * self.bore_m
    }

    /// Area of the rod, m2.
    pub fn rod_m2(&self) -> f64 {
        0.25 * PI * self.rod_m * self.rod_m
    }

    /// Area around the rod A1, m2.
    pub fn ring_m2(&self) -> f64 {
        self.cap_m2() - self.rod_m2()
    }

    /// Volumes of rod and cap side with the piston at a position, m3.
    pub fn volumes_m3(&self, piston_m: f64) -> [f64; 2] {
        let at = piston_m.clamp(-self.half_stroke_m, self.half_stroke_m);
        [
            self.ring_m2() * (self.half_stroke_m - at) + self.rod_dead_m3,
            self.cap_m2() * (self.half_stroke_m + at) + self.cap_dead_m3,
        ]
    }

    /// Pressure of the gas at a volume, Pa.
    pub fn gas_pa(&self, gas_m3: f64) -> f64 {
        let Reservoir { gas_m3: charged_m3, gas_pa, exponent } = self.reservoir;
        gas_pa * libm::pow(charged_m3 / gas_m3.max(1e-3 * charged_m3), exponent)
    }

    /// At rest with the eyes at a displacement, all pressures equal. Without gas preload the joint
    /// is at `start` (-1 to 1) in its clearance, else at the end to which the gas pushes it.
    pub fn at_rest(&self, displacement_m: f64, start: f64, oil_degc: f64) -> State {
        let oil = self.oil.at(oil_degc);
        let a = 0.5 * self.attachment.clearance_2a_m;
        let (mut piston_m, mut force_n, mut pressure, mut gas_m3) = (displacement_m, 0.0, 0.0, 0.0);
        for _ in 0..50 {
            gas_m3 = self.reservoir.gas_m3 + self.rod_m2() * piston_m;
            pressure = self.gas_pa(gas_m3);
            force_n = -self.rod_m2() * (pressure - AMBIENT_PA);
            let play = if force_n.abs() < 1.0 { start * a } else { libm::copysign(a, force_n) };
            piston_m = displacement_m - play - force_n / self.attachment.static_n_per_m();
        }
        let filling = oil.filling(pressure);
        let [rod_m3, cap_m3] = self.volumes_m3(piston_m);
        State {
            piston_m,
            piston_m_per_s: 0.0,
            rod_oil_m3: rod_m3 / filling.swell,
            cap_oil_m3: cap_m3 / filling.swell,
            gas_m3,
            branch_m: force_n / self.attachment.rubber_n_per_m,
            oil_degc,
            heat_j: 0.0,
            pressures_pa: [pressure; 2],
            voids: [0.0; 2],
            force_n,
            unsolved: 0,
            reservoir_m3_per_s: 0.0,
            unknowns: [0.0, pressure, pressure],
        }
    }

    /// Moves the eye from `x(start_s)` to `x(start_s + step_s)`.
    pub fn advance(
        &self,
        state: &mut State,
        x: &dyn Fn(f64) -> f64,
        start_s: f64,
        step_s: f64,
        ambient_degc: f64,
    ) {
        debug_assert!(step_s > 0.0, "a step of {step_s} s");
        self.advance_halving(state, x, [start_s, step_s, ambient_degc], 0);
    }

    fn advance_halving(&self, state: &mut State, x: &dyn Fn(f64) -> f64, at: [f64; 3], depth: u32) {
        let [start_s, step_s, ambient_degc] = at;
        let shortest = depth == HALVINGS_MAX;
        if let Some(arrived) = self.try_step(state, x, at, shortest) {
            *state = arrived;
            return;
        }
        if shortest {
            // No solution: the state stays as it is.
            state.unsolved += 1;
            return;
        }
        let half_s = 0.5 * step_s;
        self.advance_halving(state, x, [start_s, half_s, ambient_degc], depth + 1);
        self.advance_halving(state, x, [start_s + half_s, half_s, ambient_degc], depth + 1);
    }

    /// One step of two stages; `None` where a stage does not converge, unless it has to do.
    fn try_step(
        &self,
        from: &State,
        x: &dyn Fn(f64) -> f64,
        at: [f64; 3],
        must: bool,
    ) -> Option<State> {
        let [start_s, step_s, ambient_degc] = at;
        let oil = self.oil.at(from.oil_degc);
        let g = GAMMA * step_s;
        let first_base = from.ends();
        let first_gas_m3 = from.gas_m3 - g * from.reservoir_m3_per_s;
        let first = Stage {
            length_s: g,
            eye_m: x(start_s + g),
            base: first_base,
            reservoir_pa: self.gas_pa(first_gas_m3),
            oil,
        };
        let middle = first.solve(self, from.unknowns, must)?;
        // From here the second stage starts: what the first rates do in the rest of the step.
        let rest_s = step_s - g;
        let rates = middle.ends.minus(&first_base, 1.0 / g);
        let base = first_base.plus(&rates, rest_s);
        let gas_m3 = from.gas_m3 - rest_s * middle.reservoir_m3_per_s;
        let second = Stage {
            length_s: g,
            eye_m: x(start_s + step_s),
            base,
            reservoir_pa: self.gas_pa(gas_m3 - g * middle.reservoir_m3_per_s),
            oil,
        };
        let end = second.solve(self, middle.unknowns, must)?;
        let heat_j = rest_s * middle.heat_w + g * end.heat_w;
        let cooled_j = step_s * self.heat.cooling_w_per_k * (from.oil_degc - ambient_degc);
        let Ends { piston_m, piston_m_per_s, rod_oil_m3, cap_oil_m3, branch_m } = end.ends;
        Some(State {
            piston_m,
            piston_m_per_s,
            rod_oil_m3,
            cap_oil_m3,
            gas_m3: gas_m3 - g * end.reservoir_m3_per_s,
            branch_m,
            oil_degc: from.oil_degc + (heat_j - cooled_j) / self.heat.capacity_j_per_k,
            heat_j: from.heat_j + heat_j,
            pressures_pa: end.pressures_pa,
            voids: end.voids,
            force_n: end.force_n,
            unsolved: from.unsolved + u32::from(!(middle.converged && end.converged)),
            reservoir_m3_per_s: end.reservoir_m3_per_s,
            unknowns: end.unknowns,
        })
    }
}

impl State {
    fn ends(&self) -> Ends {
        Ends {
            piston_m: self.piston_m,
            piston_m_per_s: self.piston_m_per_s,
            rod_oil_m3: self.rod_oil_m3,
            cap_oil_m3: self.cap_oil_m3,
            branch_m: self.branch_m,
        }
    }
}

impl Specimen for HydraulicDamper {
    fn longest_step_s(&self) -> f64 {
        50e-6
    }

    fn respond(&self, load: &Load<'_>) -> Response {
        let x = |time_s: f64| load.mean_m + load.excitation.displacement_m(time_s);
        let mut state = self.at_rest(x(0.0), load.start, load.start_degc);
        let mut response = Response::default();
        response.force_n.push(state.force_n);
        response.temperature_degc.push(state.oil_degc);
        for step in 0..load.grid.steps {
            if load.is_stopped() {
                break;
            }
            let start_s = step as f64 * load.grid.step_s;
            self.advance(&mut state, &x, start_s, load.grid.step_s, load.ambient_degc);
            response.force_n.push(state.force_n);
            response.temperature_degc.push(state.oil_degc);
        }
        response.doubtful_steps = state.unsolved;
        response
    }
}

#[cfg(test)]
mod tests;
