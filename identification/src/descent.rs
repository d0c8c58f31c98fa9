//! Least squares on simulations: Levenberg-Marquardt on sums over the samples, with few
//! derivatives.
//!
//! ```text
//! (J'J + l diag(J'J)) s = -J'r                 J_k = (r(u + h e_k) - r(u)) / h
//! J <- J + (r(u + s) - r(u) - J s) s' / s's    after a step (Broyden 1965)
//! ```
//!
//! A derivative is one simulation per coordinate, so the sensitivities of one place serve for
//! several steps: each step corrects them by what it has found (Broyden). They are computed anew
//! when a step falls short of its forecast or does not reduce the error, and, where the minimum is
//! wanted, once more before the end. Sums J'J in place of an orthogonal decomposition square the
//! condition number; the columns are scaled to equal length first, and directions with less than
//! 1e-11 of the largest eigenvalue stay where they are ([`super::gram`]).
//!
//! Sums are formed in the order of the coordinates and samples, so the result does not depend on
//! the number of cores.

use super::gram::{Gram, dot};
use nalgebra::DVector;
use rayon::prelude::*;

/// Longest step in a coordinate.
const LONGEST_STEP: f64 = 4.0;
/// Damping of the first step, and the largest: beyond it no step is left.
const DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e9;
const LEAST_DAMPING: f64 = 1e-9;
/// A step that gains less than this share of its forecast asks for new sensitivities; one that
/// gains more than the other allows a longer step. So does the last of several steps.
const MOST_STEPS: usize = 8;
const POOR: f64 = 0.5;
const GOOD: f64 = 0.8;

/// A sum of squares over simulated samples.
pub(crate) trait LeastSquares: Sync {
    /// Step of a derivative.
    const DERIVATIVE_STEP: f64;

    /// Model less measurement at every counted sample; none where these coordinates make no model.
    fn residual(&self, free: &[f64]) -> Option<Vec<f64>>;

    /// True once the work is to end.
    fn is_stopped(&self) -> bool {
        false
    }
}

/// How far a descent goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// Most times that sensitivities are computed; steps that are tried, at most so many times the
    /// number of coordinates plus one.
    pub(crate) patience: usize,
    /// Relative gain of a step below which it ends.
    pub(crate) gain: f64,
    /// Ends on sensitivities of its last place only.
    pub(crate) to_minimum: bool,
}

/// Descends from given coordinates; none where they make no model or the work is stopped.
pub(crate) fn descend<P: LeastSquares>(
    problem: &P,
    mut free: Vec<f64>,
    limits: Limits,
) -> Option<Vec<f64>> {
    let mut residual = problem.residual(&free)?;
    let mut squares = sum_of_squares(&residual);
    let mut slopes = Slopes::at(problem, &free, &residual)?;
    let (mut damping, mut computed) = (DAMPING, 1);
    for _ in 0..limits.patience * (free.len() + 1) {
        if problem.is_stopped() {
            return None;
        }
        let (step, forecast) =
            slopes.step(&residual, damping, limits.gain * squares / LONGEST_STEP);
        let worth_it = forecast > limits.gain * squares;
        let tried = DVector::from_column_slice(&free) + &step;
        let there = if worth_it { problem.residual(tried.as_slice()) } else { None };
        let now = there.as_deref().map_or(f64::INFINITY, sum_of_squares);
        let gained = squares - now;
        let done = !worth_it || (0.0..limits.gain * squares).contains(&gained);
        if let Some(there) = there.filter(|_| gained > 0.0) {
            slopes.learn(&step, &residual, &there);
            (free, residual, squares) = (tried.as_slice().to_vec(), there, now);
            damping = match gained / forecast {
                ratio if ratio > GOOD => (0.1 * damping).max(LEAST_DAMPING),
                ratio if ratio < POOR => 4.0 * damping,
                _ => damping,
            };
        }
        let refresh = if done {
            if slopes.are_fresh() || !limits.to_minimum {
                break;
            }
            true
        } else {
            (gained < POOR * forecast && !slopes.are_fresh()) || slopes.steps >= MOST_STEPS
        };
        if refresh {
            computed += 1;
            if computed > limits.patience {
                break;
            }
            slopes = Slopes::at(problem, &free, &residual)?;
        } else if gained <= 0.0 || gained.is_nan() {
            damping *= 10.0;
            if damping > MOST_DAMPING {
                break;
            }
        }
    }
    (!problem.is_stopped()).then_some(free)
}

/// Change of the residual per change of each coordinate; zero where there is no model on either
/// side.
pub(crate) fn columns<P: LeastSquares>(
    problem: &P,
    free: &[f64],
    residual: &[f64],
) -> Vec<Vec<f64>> {
    let column = |index: usize| {
        // The other side, if there is no model on the first.
        let sides = [P::DERIVATIVE_STEP, -P::DERIVATIVE_STEP];
        let shifted = sides.into_iter().find_map(|step| {
            let mut shifted = free.to_vec();
            shifted[index] += step;
            problem.residual(&shifted).map(|there| (there, step))
        });
        let Some((mut there, step)) = shifted else { return vec![0.0; residual.len()] };
        for (there, here) in there.iter_mut().zip(residual) {
            *there = (*there - here) / step;
        }
        there
    };
    (0..free.len()).into_par_iter().map(column).collect()
}

/// Columns of derivatives, and their products with each other.
struct Slopes {
    columns: Vec<Vec<f64>>,
    products: Gram,
    /// Steps since they were differences of simulations.
    steps: usize,
}

impl Slopes {
    fn at<P: LeastSquares>(problem: &P, free: &[f64], residual: &[f64]) -> Option<Self> {
        let columns = columns(problem, free, residual);
        if problem.is_stopped() {
            return None;
        }
        let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let products = Gram::over(&views, residual);
        Some(Self { columns, products, steps: 0 })
    }

    fn are_fresh(&self) -> bool {
        self.steps == 0
    }

    /// The step from here, and by how much the sum of squares falls if all is linear.
    fn step(&self, residual: &[f64], damping: f64, idle: f64) -> (DVector<f64>, f64) {
        debug_assert!(damping > 0.0, "{damping}");
        let mut here = self.products.clone();
        here.residual = -self.toward(residual);
        let step = here.step_within(damping, idle, LONGEST_STEP);
        let forecast = here.fall(&step);
        (step, forecast)
    }

    fn toward(&self, residual: &[f64]) -> DVector<f64> {
        let products: Vec<f64> = self.columns.par_iter().map(|c| dot(c, residual)).collect();
        DVector::from_vec(products)
    }

    /// Corrects the derivatives along a step by the residual that was found at its end.
    fn learn(&mut self, step: &DVector<f64>, from: &[f64], to: &[f64]) {
        let length2 = step.norm_squared();
        if length2 <= 0.0 {
            return;
        }
        let mut missed: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        for (column, share) in self.columns.iter().zip(step.iter()) {
            for (missed, slope) in missed.iter_mut().zip(column) {
                *missed -= share * slope;
            }
        }
        let before = self.toward(&missed);
        let step_over = step / length2;
        let cross = &before * step_over.transpose();
        self.products.columns += &cross + cross.transpose();
        self.products.columns += &step_over * step_over.transpose() * sum_of_squares(&missed);
        self.columns.par_iter_mut().enumerate().for_each(|(index, column)| {
            for (slope, missed) in column.iter_mut().zip(&missed) {
                *slope += missed * step_over[index];
            }
        });
        self.steps += 1;
    }
}

fn sum_of_squares(values: &[f64]) -> f64 {
    dot(values, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Rosenbrock's valley, minimum at (1, 1).
    struct Valley {
        evaluations: AtomicUsize,
    }

    impl LeastSquares for Valley {
        const DERIVATIVE_STEP: f64 = 1e-6;

        fn residual(&self, free: &[f64]) -> Option<Vec<f64>> {
            self.evaluations.fetch_add(1, Ordering::Relaxed);
            // No model beyond x = 3.
            (free[0] < 3.0).then(|| vec![10.0 * (free[1] - free[0] * free[0]), 1.0 - free[0]])
        }
    }

    const MINIMUM: Limits = Limits { patience: 60, gain: 1e-12, to_minimum: true };

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let valley = Valley { evaluations: AtomicUsize::new(0) };
        let end = descend(&valley, vec![-1.2, 1.0], MINIMUM).unwrap();
        assert!((end[0] - 1.0).abs() < 1e-5 && (end[1] - 1.0).abs() < 1e-5, "{end:?}");
    }

    #[test]
    fn a_start_without_a_model_has_no_end() {
        let valley = Valley { evaluations: AtomicUsize::new(0) };
        assert!(descend(&valley, vec![4.0, 1.0], MINIMUM).is_none());
        // Next to the edge the derivative is taken on the other side.
        let end = descend(&valley, vec![3.0 - 1e-7, 9.0], MINIMUM).unwrap();
        assert!((end[0] - 1.0).abs() < 1e-5, "{end:?}");
    }

    /// Eight exponentials on 40 samples: nearly linear, so one set of derivatives serves for most
    /// steps.
    struct Nearly {
        evaluations: AtomicUsize,
    }

    impl LeastSquares for Nearly {
        const DERIVATIVE_STEP: f64 = 1e-5;

        fn residual(&self, free: &[f64]) -> Option<Vec<f64>> {
            self.evaluations.fetch_add(1, Ordering::Relaxed);
            // The third amplitude is e^0.3 in truth, all others 1.
            let at = |n: usize| {
                let terms = free.iter().enumerate().map(|(k, u)| {
                    let truth = if k == 2 { 0.3 } else { 0.0 };
                    let wave = libm::sin((k + 1) as f64 * n as f64 * 0.07);
                    (libm::exp(0.3 * u) - libm::exp(truth)) * wave
                });
                terms.sum::<f64>()
            };
            Some((0..40).map(at).collect())
        }
    }

    #[test]
    fn derivatives_serve_for_several_steps() {
        let nearly = Nearly { evaluations: AtomicUsize::new(0) };
        let limits = Limits { patience: 20, gain: 1e-8, to_minimum: false };
        let end = descend(&nearly, vec![0.0; 8], limits).unwrap();
        assert!((end[2] - 1.0).abs() < 1e-3 && end[5].abs() < 1e-3, "{end:?}");
        let evaluations = nearly.evaluations.load(Ordering::Relaxed);
        assert!(evaluations < 30, "{evaluations}");
    }
}
