//! The start of the fit of the nominal damper: a coarse grid over everything possible, then a fit
//! of the best few on the beginnings of the tests.

use super::control::Control;
use super::fit::{Effort, Fit, fit, fit_freely, squares_of};
use super::grey_box::GreyBox;
use super::simulation::simulate;
use super::test_set::TestSet;
use firmware_core::damper::effects::Scale;
use rayon::prelude::*;

/// Part of each test that the search for starts uses, s, after the run-in.
pub(crate) const BEGINNING_S: f64 = 1.5;
/// Other starts that are kept.
const OTHERS: usize = 5;
/// Grid points that are fitted.
const FITTED: usize = 8;
/// Of these, fitted to the whole tests.
const CONTINUED: usize = 6;

/// The nominal damper fitted from many starts.
#[derive(Debug, Clone)]
pub struct NominalFit {
    /// The best fit to the whole tests.
    pub fit: Fit,
    /// Other start parameters, the next best first. Where an effect is large, the best fit without
    /// it may be far from the truth, and one of these nearer.
    pub others: Vec<Vec<f64>>,
}

/// Fits the nominal damper; `given` are start values from a datasheet.
pub fn nominal_fit(
    tests: &TestSet,
    given: Option<&[f64]>,
    control: Control<'_>,
) -> Option<NominalFit> {
    let beginnings = tests.beginnings(BEGINNING_S);
    let model = GreyBox::nominal(&tests.scale);
    let grid = grid(&tests.scale);
    let mut tried: Vec<(f64, usize)> = grid
        .par_iter()
        .enumerate()
        .filter(|_| !control.is_stopped())
        .filter_map(|(index, values)| {
            let damper = model.damper(values)?;
            let force_n: Vec<Vec<f64>> =
                beginnings.tests.iter().map(|test| simulate(&damper, test, 0.0)).collect();
            Some((squares_of(&beginnings, &force_n).iter().sum(), index))
        })
        .collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut starts: Vec<Vec<f64>> = given.iter().map(|values| values.to_vec()).collect();
    starts.extend(tried.iter().take(FITTED).map(|(_, index)| grid[*index].clone()));
    let mut fitted: Vec<Fit> = starts
        .par_iter()
        .filter_map(|start| {
            let start = Fit::evaluate(&model, start, &beginnings)?;
            fit_freely(start, &beginnings, Effort::TRIAL, control)
        })
        .collect();
    fitted.sort_by(|a, b| a.total_n2().total_cmp(&b.total_n2()));
    let mut whole: Vec<Fit> = fitted
        .iter()
        .take(CONTINUED)
        .filter_map(|start| fit(&model, &start.values, tests, Effort::FULL, control))
        .collect();
    whole.sort_by(|a, b| a.total_n2().total_cmp(&b.total_n2()));
    let others = given.iter().map(|values| values.to_vec());
    // Grid points, not fitted ones: a fit without the effect moves them away.
    let others = others.chain(tried.iter().map(|(_, index)| grid[*index].clone()));
    let others = others.take(OTHERS).collect();
    whole.into_iter().next().map(|fit| NominalFit { fit, others })
}

fn grid(scale: &Scale) -> Vec<Vec<f64>> {
    let ce = scale.force_n / scale.velocity_m_per_s;
    let ke = scale.force_n / scale.displacement_m;
    let mut grid = Vec::new();
    for damping in [0.3, 1.0, 3.0, 10.0, 30.0] {
        for stiffness in [1.0, 3.0, 10.0, 100.0] {
            for relief in [0.5, 0.8, 3.0] {
                for slope in [0.02, 0.2] {
                    for clearance in [0.0, 0.2, 0.7] {
                        let two_a = clearance * scale.displacement_m;
                        let f_relief = relief * scale.force_n;
                        let c2 = slope * ce * damping;
                        grid.push(vec![damping * ce, stiffness * ke, two_a, f_relief, c2]);
                    }
                }
            }
        }
    }
    grid
}
