//! The effects of the catalogue as candidates for the records.

use super::grey_box::GreyBox;
use super::test_set::TestSet;
use firmware_core::damper::effects::{CATALOGUE, EffectInfo};

/// An effect that may be missing, with start values for its parameters.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    /// The effect.
    pub effect: &'static EffectInfo,
    /// Start values in the order of its table; the usual ones first.
    pub starts: Vec<Vec<f64>>,
}

/// All effects that the model does not have yet, that the sampling rate can show, and whose traces
/// the processing of the laboratory has not destroyed in the training records.
pub(crate) fn candidates(model: &GreyBox, tests: &TestSet) -> Vec<Candidate> {
    let has = |info: &EffectInfo| model.effects.iter().any(|effect| effect.name == info.name);
    let rate_hz = tests.lowest_rate_hz();
    CATALOGUE
        .iter()
        .filter(|info| !has(info) && info.needs_rate_hz <= rate_hz)
        .filter(|info| tests.destroyed(info.name).is_none())
        .map(|effect| {
            let usual: Vec<f64> =
                effect.parameters.iter().map(|row| row.usual(&tests.scale)).collect();
            let further = effect.starts.iter().map(|start| {
                let pairs = start.iter().zip(effect.parameters);
                pairs.map(|(share, row)| share * row.unit.natural(&tests.scale)).collect()
            });
            let starts = std::iter::once(usual).chain(further).collect();
            Candidate { effect, starts }
        })
        .collect()
}
