//! One choice between two sets of parameters that describe the same damper.
//!
//! A valve with three slopes has a relief knee and a stage, and either knee can be either:
//!
//! ```text
//! stage at k > F_r with ratio r   =   relief at k with C2' = r C2, stage at F_r with ratio C2 / Ce
//! ```
//!
//! The canonical stage lies below relief, where its table has its usual size.
//!
//! A parameter that moves nothing, such as the speed at which a friction falls that does not fall,
//! stays wherever the fit has left it. Its canonical value is the usual one.

use super::fit::Fit;
use super::grey_box::{C2, CE, RELIEF};
use super::judged::Judged;
use super::test_set::TestSet;

/// Share by which the squared error may differ.
const SAME: f64 = 1e-9;

/// The same fit in canonical parameters; unchanged where it has them already, or where the
/// canonical ones do not describe the same damper.
pub(crate) fn canonical(fit: Fit, tests: &TestSet) -> Fit {
    let stage = fit.model.effects.iter().position(|info| info.name == "second_valve_stage");
    let Some(start) = stage.map(|effect| fit.model.range_of(effect).start) else { return fit };
    let mut values = fit.values.clone();
    let [knee, ratio] = [values[start], values[start + 1]];
    if knee <= values[RELIEF] || values[C2] <= 0.0 {
        return fit;
    }
    (values[start], values[start + 1]) = (values[RELIEF], values[C2] / values[CE]);
    (values[RELIEF], values[C2]) = (knee, ratio * values[C2]);
    let values = fit.model.values(&fit.model.free(&values));
    match Fit::evaluate(&fit.model, &values, tests) {
        Some(same) if same.total_n2() <= (1.0 + SAME) * fit.total_n2() => same,
        _ => fit,
    }
}

/// Change of force per coordinate, as a share of the force, below which a parameter moves nothing.
const IDLE: f64 = 1e-6;

/// A judged model whose parameters that move nothing, there and at their usual values, have these.
pub(crate) fn with_idle_at_usual(mut judged: Judged, tests: &TestSet) -> Judged {
    let model = judged.fit().model.clone();
    let idle_n2 = (IDLE * tests.rms_force_n()).powi(2) * tests.counted_samples() as f64;
    let largest_n2 = (1.0 + SAME) * judged.fit().total_n2();
    for (index, effect) in model.effects.iter().enumerate() {
        for (row, at) in effect.parameters.iter().zip(model.range_of(index)) {
            let slope = &judged.linearised.slopes[at];
            let pieces = tests.pieces.iter();
            let seen = pieces.flat_map(|piece| &slope[piece.test][piece.samples.clone()]);
            if seen.map(|change| change * change).sum::<f64>() > idle_n2 {
                continue;
            }
            let mut values = judged.fit().values.clone();
            values[at] = row.usual(&tests.scale);
            let moved = Fit::starting_at(&model, &values, &judged.fit().starts_m, tests);
            if moved.is_some_and(|moved| moved.total_n2() <= largest_n2) {
                judged.linearised.fit.values = values;
            }
        }
    }
    judged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grey_box::{GreyBox, vector_of};
    use firmware_core::damper::effects::CATALOGUE;
    use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
    use measurement::{Measurement, Series};

    #[test]
    fn a_stage_above_relief_becomes_one_below() {
        let w = std::f64::consts::TAU * 3.5;
        let motion = |n: usize| {
            let (sin, cos) = libm::sincos(w * n as f64 * 1e-3);
            Motion::new(3.46e-3 * sin, 3.46e-3 * w * cos)
        };
        let damper = Damper::new(Nominal::NEW, &[]).unwrap();
        let mut state = DamperState::starting(motion(0));
        let force_n: Vec<f64> =
            (0..3000).map(|n| damper.advance(&mut state, motion(n), 1e-3)).collect();
        let displacement_m = (0..3000).map(|n| motion(n).displacement_m).collect();
        let series = Series::sampled("a", 1e3, displacement_m, force_n);
        let tests = TestSet::new(vec![Measurement::from_series(series).unwrap()]);
        let stage = CATALOGUE.iter().find(|info| info.name == "second_valve_stage").unwrap();
        let model = GreyBox::nominal(&tests.scale).with(stage, &tests.scale);
        let nominal = Nominal { f_relief_n: 6e3, c2_n_s_per_m: 4e5, ..Nominal::NEW };
        let values = [vector_of(&nominal), vec![15e3, 0.2]].concat();
        let fit = canonical(Fit::evaluate(&model, &values, &tests).unwrap(), &tests);
        for (value, expected) in fit.values[3..].iter().zip([15e3, 8e4, 6e3, 0.4]) {
            assert!((value / expected - 1.0).abs() < 1e-6, "{:?}", fit.values);
        }
    }
}
