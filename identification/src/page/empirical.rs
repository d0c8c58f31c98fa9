//! The empirical map, where it was asked for: last, and separate from everything that has a name.

use super::coordinates::{branches, name_of, present};
use super::prefix::{Prefixed, quantity};
use super::words::capitalised;
use crate::empirical::{Empirical, FittedMap};
use crate::identify::Identification;
use crate::result::Errors;
use crate::tables::{EMPIRICAL_MAP, REFITTED, WITH_EFFECTS};
use firmware_core::damper::MapKnot;
use report::{Cell, Plot, Section, Table};

/// The curve that it was fitted to.
const LEFT: &str = "mean residual";

/// The map, kept or not; none where it was not asked for.
pub(super) fn section(identification: &Identification) -> Option<Section> {
    let tried = identification.empirical.as_ref()?;
    let mut section = Section::new("An empirical map (no physics)").text(
        "Asked for with --empirical: after the search for named effects, a smooth curve is \
         fitted to the residual, over the coordinate that explains most of it. It describes and \
         explains nothing. It changes neither the verdict nor the effects, and does not make \
         unexplained structure explained.",
    );
    section = if tried.kept {
        section.note(
            "Kept, in model-empirical.toml: no physics, valid only inside the range of these \
             records, constant beyond its ends, without a balance of energy.",
        )
    } else {
        section.note(&format!("Not kept: {}.", tried.why))
    };
    let Some(fitted) = &tried.fitted else { return Some(section) };
    if tried.kept {
        section = section.text(&format!("It {}.", tried.why));
    }
    Some(section.plot(curve(identification, fitted)?).table(errors(identification, tried, fitted)))
}

/// Both branches over the coordinate, with the residual of the model without it behind them.
fn curve(identification: &Identification, fitted: &FittedMap) -> Option<Plot> {
    let over = fitted.map.coordinate();
    let left = &identification.residual_after.maps;
    let residual = left.iter().find(|map| map.coordinate.of_a_damper() == Some(over))?;
    let declared = identification.train.tests.iter().all(|test| test.record.direction_declared);
    let (name, unit) = name_of(residual.coordinate);
    let (upper, lower) = branches(residual.coordinate, declared);
    let all = |of: fn(&MapKnot) -> f64| fitted.map.knots().iter().map(of).collect::<Vec<f64>>();
    let (at, upper_n, lower_n) = (all(|k| k.at), all(|k| k.upper_n), all(|k| k.lower_n));
    let x = Prefixed::for_all(unit, &at);
    let force = Prefixed::for_all("N", upper_n.iter().chain(&lower_n));
    let mut plot = Plot::new(&format!("{} over {name}", capitalised(EMPIRICAL_MAP)))
        .palette(&[upper, lower])
        .x(name, &x.unit)
        .y("force added", &force.unit)
        .caption(&format!(
            "Straight between its {} knots. Grey: the mean residual in bins of equal content. The \
             branch changes at {} in the other direction.",
            at.len(),
            quantity(fitted.map.reversal_m_per_s(), "m/s")
        ));
    for means in [&residual.upper_n, &residual.lower_n] {
        let (at, mean_n) = present(&residual.centres, means);
        plot = plot.backdrop(LEFT, &x.values(&at), &force.values(&mean_n));
    }
    for (branch, values_n) in [(upper, &upper_n), (lower, &lower_n)] {
        plot = plot.line(branch, &x.values(&at), &force.values(values_n));
    }
    Some(plot)
}

/// The error without the map and with it.
fn errors(identification: &Identification, tried: &Empirical, fitted: &FittedMap) -> Table {
    let result = &identification.result;
    let before = if result.effects.is_empty() { REFITTED } else { WITH_EFFECTS };
    let row = |name: &str, errors: Option<Errors>, gain: Cell| {
        [
            Cell::from(name),
            errors.map(|errors| errors.train_rmse_n).into(),
            errors.map(|errors| 100.0 * errors.train_nrmse).into(),
            errors.and_then(|errors| errors.holdout_rmse_n).into(),
            errors.and_then(|errors| errors.holdout_nrmse).map(|share| 100.0 * share).into(),
            gain,
        ]
    };
    let with_map = result.empirical.as_ref().and_then(|part| part.errors);
    let kept = if tried.kept { "kept" } else { "not kept" };
    Table::new("Error of free-run simulation, without the map and with it")
        .text("model")
        .number("training tests, rms", "N")
        .number_with_digits("of the force", "%", 3)
        .number("hold-out, rms", "N")
        .number_with_digits("of the force", "%", 3)
        .number_with_digits("squared error removed on left-out pieces", "%", 3)
        .row(row(before, result.errors.with_effects, Cell::Empty))
        .row(row(
            &format!("{EMPIRICAL_MAP}, {kept}"),
            with_map,
            (100.0 * fitted.holdout_gain).into(),
        ))
}
