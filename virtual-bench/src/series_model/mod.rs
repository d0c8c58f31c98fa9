//! An independent simulation of a series damper: the source of records that the fitted model
//! explains completely.
//!
//! Attachment with clearance 2a and stiffness Ke, in series with a dashpot with relief:
//!
//! ```text
//! F = Ke (e -+ a) outside |e| <= a,  0 inside          e = x(t) - x_d
//! x_d' = F/Ce  up to F_r,   F_r/Ce + (F - F_r)/C2  beyond, odd in F
//! ```
//!
//! It shares no code and no type with the damper of the core, so that a fit by that damper is not
//! tested on its own integration. The displacement x(t) is any function of time. On each of the
//! five straight pieces of its speed the piston moves by one Radau IIA step of two stages (third
//! order, L-stable), which for a straight piece is a closed form,
//!
//! ```text
//! x_d += h (3/4 G_1 + (1/4 + z/6) G_2)/(1 + 2 z/3 + z^2/6)     z = h dv/de
//! G_i = piston speed on the piece at x(t + h/3), x(t + h) with the piston at rest
//! ```
//!
//! and where a step crosses into another piece, the instant is bracketed by bisection and the rest
//! of the step continues from there.
//!
//! [`outside`] holds what may be added: disturbances that no effect of the catalogue describes.
//! [`neighbour`] holds parts that do not quite follow the equation of an effect, and hidden inputs.
//!
//! Limits: a visit to another piece that begins and ends within one step is not seen; take steps of
//! 20 µs. A hard cap (C2 = 0) is a slope of a billionth of Ce.

pub mod neighbour;
mod null_generator;
pub mod outside;

pub use crate::grid::Grid;
pub use null_generator::NullGenerator;

/// Most pieces that one step may cross.
const MAX_CROSSINGS: usize = 64;
/// Halvings of a step to find a crossing: 20 µs to 4e-20 s.
const HALVINGS: u32 = 50;
/// Least slope beyond relief, as a share of Ce.
const LEAST_SLOPE: f64 = 1e-9;

/// The five numbers of a series damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesModel {
    /// Damping below relief Ce, N s/m.
    pub ce_n_s_per_m: f64,
    /// Series stiffness Ke, N/m.
    pub ke_n_per_m: f64,
    /// Total clearance 2a, m.
    pub clearance_2a_m: f64,
    /// Relief force, N; infinite for none.
    pub f_relief_n: f64,
    /// Slope beyond relief C2, N s/m.
    pub c2_n_s_per_m: f64,
}

/// What a simulation gives, one value at the start and after each step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Position of the piston, m.
    pub piston_m: Vec<f64>,
}

impl SeriesModel {
    /// The force over time. The joint starts `start_m` away from the middle of its clearance;
    /// beyond the clearance it starts under force.
    ///
    /// ```
    /// use virtual_bench::series_model::{Grid, SeriesModel};
    /// let damper = SeriesModel {
    ///     ce_n_s_per_m: 1e6,
    ///     ke_n_per_m: 12.5e6,
    ///     clearance_2a_m: 1e-3,
    ///     f_relief_n: 15e3,
    ///     c2_n_s_per_m: 60e3,
    /// };
    /// let grid = Grid { step_s: 20e-6, steps: 100_000 };
    /// // After 2 s at 25 mm/s the dashpot alone carries it: 15 kN + 60 kN s/m * 10 mm/s.
    /// let trace = damper.simulate(&|t| 0.025 * t, grid, 0.0);
    /// assert!((trace.force_n[100_000] - 15.6e3).abs() < 0.01);
    /// ```
    pub fn simulate(&self, x: &dyn Fn(f64) -> f64, grid: Grid, start_m: f64) -> Trace {
        self.simulate_scaled(x, grid, start_m, &|_| 1.0)
    }

    /// The same with a dashpot force that is `scale(piston position)` of its own.
    pub(crate) fn simulate_scaled(
        &self,
        x: &dyn Fn(f64) -> f64,
        grid: Grid,
        start_m: f64,
        scale: &dyn Fn(f64) -> f64,
    ) -> Trace {
        let mut x_start_m = x(0.0);
        let mut piston = x_start_m - start_m;
        let mut travel = 0.0;
        let mut trace = Trace::default();
        trace.force_n.reserve(grid.steps + 1);
        trace.piston_m.reserve(grid.steps + 1);
        let mut known_scale = 1.0;
        let mut pieces = Pieces::new(self, known_scale);
        trace.force_n.push(self.force_n(start_m));
        trace.piston_m.push(piston);
        for step in 0..grid.steps {
            // The factor in the middle of the step, from where the piston is heading.
            let factor = scale(piston + 0.5 * travel);
            if factor != known_scale {
                known_scale = factor;
                pieces = Pieces::new(self, factor);
            }
            let (start_s, end_s) = (step as f64 * grid.step_s, (step + 1) as f64 * grid.step_s);
            let x_end_m = x(end_s);
            let before = piston;
            piston = pieces.advance(x, Span { start_s, end_s, x_start_m, x_end_m }, piston);
            travel = piston - before;
            x_start_m = x_end_m;
            trace.force_n.push(self.force_n(x_end_m - piston));
            trace.piston_m.push(piston);
        }
        debug_assert_eq!(trace.force_n.len(), grid.steps + 1, "a force per step");
        trace
    }

    /// Force at a deflection of the attachment.
    fn force_n(&self, deflection_m: f64) -> f64 {
        let a = 0.5 * self.clearance_2a_m;
        let strain_m = if deflection_m > a {
            deflection_m - a
        } else if deflection_m < -a {
            deflection_m + a
        } else {
            0.0
        };
        self.ke_n_per_m * strain_m
    }
}

/// A straight piece of piston speed over deflection, `speed = at + rate (e - anchor)`.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from_m: f64,
    to_m: f64,
    anchor_m: f64,
    at_m_per_s: f64,
    rate_per_s: f64,
}

/// The five pieces in rising order: relief, dashpot, clearance, dashpot, relief.
#[derive(Debug, Clone, Copy)]
struct Pieces([Piece; 5]);

impl Pieces {
    fn new(model: &SeriesModel, scale: f64) -> Self {
        debug_assert!(scale > 0.0 && model.ce_n_s_per_m > 0.0, "{scale}, {model:?}");
        let ce = scale * model.ce_n_s_per_m;
        let c2 = scale * model.c2_n_s_per_m.max(LEAST_SLOPE * model.ce_n_s_per_m);
        let a = 0.5 * model.clearance_2a_m;
        let open_m = a + scale * model.f_relief_n / model.ke_n_per_m;
        let open_m_per_s = model.f_relief_n / model.ce_n_s_per_m;
        let (below, beyond) = (model.ke_n_per_m / ce, model.ke_n_per_m / c2);
        let piece = |from_m, to_m, anchor_m, at_m_per_s, rate_per_s| Piece {
            from_m,
            to_m,
            anchor_m,
            at_m_per_s,
            rate_per_s,
        };
        Self([
            piece(-f64::INFINITY, -open_m, -open_m, -open_m_per_s, beyond),
            piece(-open_m, -a, -a, 0.0, below),
            piece(-a, a, 0.0, 0.0, 0.0),
            piece(a, open_m, a, 0.0, below),
            piece(open_m, f64::INFINITY, open_m, open_m_per_s, beyond),
        ])
    }

    /// The piston at the end of a span.
    fn advance(&self, x: &dyn Fn(f64) -> f64, span: Span, piston_m: f64) -> f64 {
        let (mut now_s, mut piston) = (span.start_s, piston_m);
        let deflection = span.x_start_m - piston;
        let mut index = self.0.iter().position(|piece| deflection <= piece.to_m).unwrap_or(4);
        for _ in 0..MAX_CROSSINGS {
            let piece = self.0[index];
            let step_s = span.end_s - now_s;
            let arrived = piece.advance(x(now_s + step_s / 3.0), span.x_end_m, step_s, piston);
            if piece.side(span.x_end_m - arrived) == 0 {
                return arrived;
            }
            // The shortest time after which it is outside.
            let after = |time_s: f64| {
                let x_end = x(now_s + time_s);
                let end = piece.advance(x(now_s + time_s / 3.0), x_end, time_s, piston);
                (end, piece.side(x_end - end))
            };
            let (mut inside_s, mut outside_s) = (0.0, step_s);
            for _ in 0..HALVINGS {
                let middle_s = 0.5 * (inside_s + outside_s);
                if after(middle_s).1 == 0 {
                    inside_s = middle_s;
                } else {
                    outside_s = middle_s;
                }
            }
            let (crossed, side) = after(outside_s);
            piston = crossed;
            now_s += outside_s;
            index = index.saturating_add_signed(side).min(4);
        }
        piston
    }
}

/// A step in time with the displacements at both ends.
#[derive(Debug, Clone, Copy)]
struct Span {
    start_s: f64,
    end_s: f64,
    x_start_m: f64,
    x_end_m: f64,
}

impl Piece {
    /// Which side a deflection lies to: below -1, on it 0, above 1.
    fn side(&self, deflection_m: f64) -> isize {
        isize::from(deflection_m > self.to_m) - isize::from(deflection_m < self.from_m)
    }

    /// The piston after one Radau IIA step, from the displacements at a third and the end of it.
    fn advance(&self, x_third_m: f64, x_end_m: f64, step_s: f64, piston_m: f64) -> f64 {
        if self.rate_per_s == 0.0 {
            return piston_m + step_s * self.at_m_per_s;
        }
        let speed = |x_m: f64| self.at_m_per_s + self.rate_per_s * (x_m - piston_m - self.anchor_m);
        let z = step_s * self.rate_per_s;
        let sum = 0.75 * speed(x_third_m) + (0.25 + z / 6.0) * speed(x_end_m);
        piston_m + step_s * sum / (1.0 + z * (2.0 / 3.0 + z / 6.0))
    }
}

#[cfg(test)]
mod tests;
