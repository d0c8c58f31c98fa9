//! Parameters of an effect that share one value where that is enough.
//!
//! Damping and relief force may be asymmetric each in its own way. Most records show one asymmetry
//! of the whole force: a second parameter then follows the noise, and what it gains on left-out
//! pieces is small and may be chance. The effect keeps its name; its model has one parameter fewer.

use super::control::Control;
use super::evidence::{LEAST_GAIN, evidence};
use super::fit::{Effort, fit};
use super::grey_box::{GreyBox, NOMINAL};
use super::judged::Judged;
use super::test_set::TestSet;
use firmware_core::damper::effects::{CATALOGUE, EffectInfo};
use std::sync::LazyLock;

/// Above this probability the gain of values of their own may be chance.
const MAY_BE_CHANCE: f64 = 0.05;

/// The shorter form of every effect that has one.
static SHORTER: LazyLock<Vec<EffectInfo>> =
    LazyLock::new(|| CATALOGUE.iter().filter_map(EffectInfo::shorter).collect());

/// The model with shared values in every effect where it predicts as well with them.
pub(crate) fn with_shared_values(
    standing: Judged,
    tests: &TestSet,
    control: Control<'_>,
) -> Judged {
    let effects = standing.fit().model.effects.len();
    (0..effects).fold(standing, |standing, index| {
        as_good_with_one(index, &standing, tests, control).unwrap_or(standing)
    })
}

/// The model with one value for all parameters of an effect that may share it, if it is as good.
fn as_good_with_one(
    index: usize,
    standing: &Judged,
    tests: &TestSet,
    control: Control<'_>,
) -> Option<Judged> {
    let fitted = standing.fit();
    let whole = fitted.model.effects.get(index).filter(|info| info.may_share > 0)?;
    let shorter = SHORTER.iter().find(|shorter| shorter.name == whole.name)?;
    let mut model = GreyBox::nominal(&tests.scale);
    let mut values = fitted.values[..NOMINAL.len()].to_vec();
    for (k, effect) in fitted.model.effects.iter().enumerate() {
        let own = &fitted.values[fitted.model.range_of(k)];
        if k != index {
            model = model.with(effect, &tests.scale);
            values.extend(own);
            continue;
        }
        model = model.with(shorter, &tests.scale);
        let (first, shared) = own.split_at(shorter.parameters.len() - 1);
        values.extend(first);
        values.push(shared.iter().sum::<f64>() / shared.len() as f64);
    }
    control.report(&format!("one value in {}", whole.name));
    let simpler = Judged::new(fit(&model, &values, tests, Effort::FULL, control)?, tests)?;
    let own_values = evidence(&simpler, standing, tests);
    let enough = own_values.holdout_gain < LEAST_GAIN && own_values.p_value > MAY_BE_CHANCE;
    enough.then_some(simpler)
}
