//! One implicit stage of the hydraulic damper.
//!
//! Over the length g of a stage every state is Y = base + g Y'. Three equations remain, for
//! the piston's velocity v and the pressures of both chambers:
//!
//! ```text
//! m (v - v_base)/g + F(v, p1, p2) - F_attachment(x - x_p) = 0          x_p = base + g v
//! W1 s(p1) - V1(x_p) = 0         W1 = base - g (flows out of it)
//! W2 s(p2) - V2(x_p) = 0
//! ```
//!
//! Every term rises (or falls) with its own unknown, so that Newton's method with a halved step
//! where the residual does not decrease finds the one solution. Below the vapour pressure the
//! unknown of a chamber measures its void.

use super::HydraulicDamper;
use super::oil::OilAt;
use super::valve::Chamber;

/// Length of a stage over that of the step: 1 - 1/sqrt(2), which makes two of them L-stable and of
/// second order (Alexander 1977).
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

const ITERATIONS_MAX: u32 = 30;
const BACKTRACKS_MAX: u32 = 8;

/// The differential states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    /// Position of the piston, m.
    pub piston_m: f64,
    /// Its velocity, m/s.
    pub piston_m_per_s: f64,
    /// Liquid on the rod side at one bar, m3.
    pub rod_oil_m3: f64,
    /// Liquid on the cap side at one bar, m3.
    pub cap_oil_m3: f64,
    /// Deflection of the fast branch of the rubber, m.
    pub branch_m: f64,
}

impl Ends {
    /// `self + factor rates`.
    #[must_use]
    pub(super) fn plus(&self, rates: &Self, factor: f64) -> Self {
        Self {
            piston_m: self.piston_m + factor * rates.piston_m,
            piston_m_per_s: self.piston_m_per_s + factor * rates.piston_m_per_s,
            rod_oil_m3: self.rod_oil_m3 + factor * rates.rod_oil_m3,
            cap_oil_m3: self.cap_oil_m3 + factor * rates.cap_oil_m3,
            branch_m: self.branch_m + factor * rates.branch_m,
        }
    }

    /// `factor (self - base)`.
    #[must_use]
    pub(super) fn minus(&self, base: &Self, factor: f64) -> Self {
        let zero = Self {
            piston_m: 0.0,
            piston_m_per_s: 0.0,
            rod_oil_m3: 0.0,
            cap_oil_m3: 0.0,
            branch_m: 0.0,
        };
        zero.plus(self, factor).plus(base, -factor)
    }
}

/// One stage to be solved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage {
    /// Its length g, s.
    pub length_s: f64,
    /// Displacement between the eyes at its end, m.
    pub eye_m: f64,
    /// From where it starts.
    pub base: Ends,
    /// Pressure in the reservoir, Pa.
    pub reservoir_pa: f64,
    /// The oil at its temperature.
    pub oil: OilAt,
}

/// A solved stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solved {
    /// The states at its end.
    pub ends: Ends,
    /// Pressures of rod and cap side, Pa.
    pub pressures_pa: [f64; 2],
    /// Shares of void in rod and cap side.
    pub voids: [f64; 2],
    /// Force of the body, N.
    pub force_n: f64,
    /// Flow into the reservoir, m3/s.
    pub reservoir_m3_per_s: f64,
    /// Heat turned out, W.
    pub heat_w: f64,
    /// Velocity and both pressure unknowns.
    pub unknowns: [f64; 3],
    /// The search has ended as it should.
    pub converged: bool,
}

/// The equations at a guess.
struct Balance {
    residual: [f64; 3],
    slopes: [[f64; 3]; 3],
    /// Size of the residual, each part in its own measure.
    size: f64,
    solved: Solved,
}

impl Stage {
    /// Finds the solution from a guess. `None` where it is not found; with `must` the last guess is
    /// then taken and marked.
    pub(super) fn solve(
        &self,
        damper: &HydraulicDamper,
        guess: [f64; 3],
        must: bool,
    ) -> Option<Solved> {
        let mut unknowns = guess;
        let mut balance = self.balance(damper, unknowns);
        for _ in 0..ITERATIONS_MAX {
            let change = linear(balance.slopes, balance.residual)?;
            let mut share = 1.0;
            for backtrack in 0..=BACKTRACKS_MAX {
                let tried = [0, 1, 2].map(|i| unknowns[i] - share * change[i]);
                let there = self.balance(damper, tried);
                let better = there.size <= (1.0 - 1e-4 * share) * balance.size || there.size < 1e-9;
                if better || backtrack == BACKTRACKS_MAX {
                    unknowns = tried;
                    balance = there;
                    break;
                }
                share *= 0.5;
            }
            let moved = share
                * (change[0].abs() / (1e-9 + 1e-7 * unknowns[0].abs()))
                    .max(change[1].abs() / (1.0 + 1e-7 * unknowns[1].abs()))
                    .max(change[2].abs() / (1.0 + 1e-7 * unknowns[2].abs()));
            if moved < 1.0 && share == 1.0 {
                return Some(Solved { converged: true, ..balance.solved });
            }
        }
        must.then_some(balance.solved)
    }

    fn balance(&self, damper: &HydraulicDamper, unknowns: [f64; 3]) -> Balance {
        let [v, y1, y2] = unknowns;
        let (g, base) = (self.length_s, &self.base);
        let fillings = [self.oil.filling(y1), self.oil.filling(y2)];
        let pressures = fillings.map(|filling| filling.pressure_pa);
        // Below the vapour pressure the unknown moves the void, no longer the pressure.
        let live = fillings.map(|filling| if filling.void > 0.0 { 0.0 } else { 1.0 });
        // Flows into rod side, cap side, reservoir, and their slopes over p1 and p2.
        let mut into = [0.0; 3];
        let mut slopes = [[0.0; 2]; 3];
        let mut heat_w = 0.0;
        let mut pass = |from: usize, to: usize, flow: f64, per_pa: f64, dp: f64| {
            into[from] -= flow;
            into[to] += flow;
            heat_w += flow * dp;
            for (side, sign) in [(from, 1.0), (to, -1.0)] {
                if side < 2 {
                    slopes[from][side] -= sign * per_pa;
                    slopes[to][side] += sign * per_pa;
                }
            }
        };
        let all = [pressures[0], pressures[1], self.reservoir_pa];
        for valve in &damper.valves {
            let (from, to) = (index(valve.from), index(valve.to));
            let dp = all[from] - all[to];
            let flow = valve.throttle.flow(dp, &self.oil);
            pass(from, to, flow.m3_per_s, flow.per_pa, dp);
        }
        let dp = pressures[0] - pressures[1];
        let (leak, dragged_m2) = damper.leakage.flow(damper.bore_m, dp, v, &self.oil);
        pass(0, 1, leak.m3_per_s, leak.per_pa, dp);

        let piston_m = base.piston_m + g * v;
        let volumes = damper.volumes_m3(piston_m);
        let areas = [-damper.ring_m2(), damper.cap_m2()];
        let liquid = [base.rod_oil_m3 + g * into[0], base.cap_oil_m3 + g * into[1]];
        let rub = damper.friction.at(v, dp);
        let pull = damper.attachment.pull(self.eye_m - piston_m, base.branch_m, g);
        let ambient = super::AMBIENT_PA;
        let force_n = damper.ring_m2() * (pressures[0] - ambient)
            - damper.cap_m2() * (pressures[1] - ambient)
            + rub.force_n;
        let inertia = damper.moving_kg / g;

        let mut residual = [inertia * (v - base.piston_m_per_s) + force_n - pull.force_n, 0.0, 0.0];
        let mut matrix = [[0.0; 3]; 3];
        matrix[0] = [
            inertia + rub.per_velocity + g * pull.stiffness_n_per_m,
            live[0] * (damper.ring_m2() + rub.per_pressure),
            live[1] * (-damper.cap_m2() - rub.per_pressure),
        ];
        let mut size = residual[0].abs() * 1e-3;
        for side in 0..2 {
            let filling = fillings[side];
            let row = side + 1;
            // In pascal: what the chamber's pressure is off.
            let per_volume = -1.0 / (liquid[side] * filling.swell_per_pa);
            residual[row] = (liquid[side] * filling.swell - volumes[side]) * per_volume;
            let dragged = if side == 0 { -dragged_m2 } else { dragged_m2 };
            matrix[row][0] = g * (filling.swell * dragged - areas[side]) * per_volume;
            for other in 0..2 {
                matrix[row][other + 1] =
                    g * filling.swell * slopes[side][other] * live[other] * per_volume;
            }
            matrix[row][row] -= 1.0;
            size += residual[row].abs() * 1e-6;
        }
        let branch_rate = (pull.rubber_m - base.branch_m) / (damper.attachment.branch_s + g);
        let branch_m = base.branch_m + g * branch_rate;
        let branch_n = damper.attachment.branch_n_per_m * (pull.rubber_m - branch_m);
        let solved = Solved {
            ends: Ends {
                piston_m,
                piston_m_per_s: v,
                rod_oil_m3: liquid[0],
                cap_oil_m3: liquid[1],
                branch_m,
            },
            pressures_pa: pressures,
            voids: [0, 1].map(|side| fillings[side].void / fillings[side].swell),
            force_n,
            reservoir_m3_per_s: into[2],
            heat_w: heat_w + rub.force_n * v + branch_n * branch_rate,
            unknowns,
            converged: false,
        };
        Balance { residual, slopes: matrix, size, solved }
    }
}

fn index(chamber: Chamber) -> usize {
    match chamber {
        Chamber::Rod => 0,
        Chamber::Cap => 1,
        Chamber::Reservoir => 2,
    }
}

/// Solves three linear equations by Cramer's rule; `None` for a singular matrix.
fn linear(m: [[f64; 3]; 3], r: [f64; 3]) -> Option<[f64; 3]> {
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(&m);
    let found = [0, 1, 2].map(|column| {
        let mut replaced = m;
        for row in 0..3 {
            replaced[row][column] = r[row];
        }
        determinant(&replaced) / whole
    });
    found.iter().all(|value| value.is_finite()).then_some(found)
}
