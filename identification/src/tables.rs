//! Tables that the page and the terminal share.

use super::identify::Identification;
use super::result::{Errors, IdentifyResult};
use report::{Cell, Table};

/// Name of the maker's model.
pub(crate) const DATASHEET: &str = "datasheet";
/// Name of the nominal model, refitted.
pub(crate) const REFITTED: &str = "refitted";
/// Name of the model with the effects that were found.
pub(crate) const WITH_EFFECTS: &str = "with effects";
/// Name of that model with an empirical map.
pub(crate) const EMPIRICAL_MAP: &str = "empirical map";

/// The models that there are, with their errors; the last one without a map is the refitted model
/// where no effect was added.
pub(crate) fn models(result: &IdentifyResult) -> Vec<(&'static str, Option<Errors>)> {
    let errors = &result.errors;
    let mut models = Vec::new();
    if errors.datasheet.is_some() {
        models.push((DATASHEET, errors.datasheet));
    }
    models.push((REFITTED, errors.refitted));
    if !result.effects.is_empty() {
        models.push((WITH_EFFECTS, errors.with_effects));
    }
    models
}

/// Errors of all models and the noise floor.
pub(crate) fn errors(identification: &Identification) -> Table {
    let result = &identification.result;
    let map = result.empirical.as_ref().filter(|part| part.kept);
    let map = map.map(|part| (EMPIRICAL_MAP, part.errors));
    let percent = |share: Option<f64>| Cell::from(share.map(|share| 100.0 * share));
    let table = Table::new("Error of free-run simulation")
        .text("model")
        .number("training tests, rms", "N")
        .number_with_digits("of the force", "%", 3)
        .number("hold-out, rms", "N")
        .number_with_digits("of the force", "%", 3);
    let rows = models(result).into_iter().chain(map).map(|(name, errors)| {
        [
            Cell::from(name),
            errors.map(|errors| errors.train_rmse_n).into(),
            percent(errors.map(|errors| errors.train_nrmse)),
            errors.and_then(|errors| errors.holdout_rmse_n).into(),
            percent(errors.and_then(|errors| errors.holdout_nrmse)),
        ]
    });
    let (name, noise_n) = match (result.noise_floor_n, result.noise_at_least_n) {
        (Some(floor_n), _) => ("noise floor", Some(floor_n)),
        (None, Some(at_least_n)) => ("noise, at least", Some(at_least_n)),
        (None, None) => ("noise floor unknown", None),
    };
    let share = noise_n.map(|noise_n| noise_n / training_force_n(identification));
    table.rows(rows).row([
        Cell::from(name),
        noise_n.into(),
        percent(share),
        Cell::Empty,
        Cell::Empty,
    ])
}

/// rms of the measured force of the training tests, N.
pub(crate) fn training_force_n(identification: &Identification) -> f64 {
    identification.train.measured_rms_n().unwrap_or(f64::NAN)
}

/// All parameters of the final model, those of effects as `effect.parameter`.
pub(crate) fn parameters(result: &IdentifyResult) -> Table {
    let number = |value: f64| format!("{value:.5e}");
    let deviation = |std: Option<f64>| match std {
        Some(std) => format!("{std:.1e}"),
        None => "not fixed".to_owned(),
    };
    let table = Table::new("Parameters")
        .text("parameter")
        .written("identified", "")
        .written("standard error", "")
        .written("datasheet", "")
        .text("unit");
    let nominal = result.nominal.iter().map(|(name, value)| {
        [
            Cell::from(name.as_str()),
            number(value.value).into(),
            deviation(value.std).into(),
            value.datasheet.map(number).into(),
            value.unit.into(),
        ]
    });
    let of_effects = result.effects.iter().flat_map(|effect| {
        effect.parameters.iter().map(move |(name, value)| {
            [
                Cell::from(format!("{}.{name}", effect.name)),
                number(value.value).into(),
                deviation(value.std).into(),
                Cell::Empty,
                value.unit.into(),
            ]
        })
    });
    table.rows(nominal).rows(of_effects)
}
