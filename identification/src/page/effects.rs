//! The effects that were added: equation, parameters, contribution to the force, and evidence.

use super::curves::{Which, over_time};
use super::models::deviation;
use super::prefix::{Prefixed, uncertain};
use super::shown::{Shown, worst_stretch};
use super::words::{capitalised, listed, percent, probability, spoken};
use crate::grey_box::{GreyBox, NOMINAL};
use crate::identify::Identification;
use crate::result::EffectFound;
use crate::simulation::simulate;
use firmware_core::damper::effects::CATALOGUE;
use report::{Cell, Plot, Section, Table, Tile};
use signal::statistics::rms;

/// The effects, one after the other.
pub(super) fn section(identification: &Identification, worst: Option<&Shown<'_>>) -> Section {
    let effects = &identification.result.effects;
    let names: Vec<String> = effects.iter().map(|effect| spoken(effect.name)).collect();
    let heading = match names.len() {
        0 => "No effect was added".to_owned(),
        1 => format!("The effect that was added: {}", names[0]),
        _ => format!("The effects that were added: {}", listed(&names)),
    };
    let mut section = Section::new(&heading);
    if effects.is_empty() {
        return section.text(if identification.result.unexplained.is_some() {
            "No effect of the catalogue passed all tests, so none was added: the structure in the \
             residual has no name."
        } else {
            "The refitted model is the final one."
        });
    }
    for (index, effect) in effects.iter().enumerate() {
        section = one(section, identification, index, effect);
    }
    if let Some(shown) = worst {
        let which = Which { refitted: true, with_effects: true, datasheet: false };
        section = section.heading("The model before and after").plot(over_time(
            &format!("Force in {}", shown.title()),
            shown,
            which,
        ));
    }
    section
}

fn one(
    section: Section,
    identification: &Identification,
    index: usize,
    effect: &EffectFound,
) -> Section {
    let info = CATALOGUE.iter().find(|info| info.name == effect.name);
    let lone = identification.result.effects.len() == 1;
    let section = if lone { section } else { section.heading(&capitalised(&spoken(effect.name))) };
    let mut section = section
        .text(&format!("It sits {}.", place(effect.place)))
        .preformatted(effect.equation)
        .tiles([
            Tile::text("gain on left-out pieces", &percent(effect.evidence.holdout_gain)),
            Tile::text("pieces improved or unchanged", &percent(effect.evidence.tests_improved)),
            Tile::text("by chance", &probability(effect.evidence.p_value)),
        ]);
    let mut table = Table::new(&format!("Parameters of {}", spoken(effect.name)))
        .text("parameter")
        .text("meaning")
        .text("is")
        .number("value", "")
        .number_with_digits("std", "", 2)
        .text("unit");
    // In the order of the catalogue, which is that of the equation.
    for row in info.map_or(&[][..], |info| info.parameters) {
        let Some(value) = effect.parameters.get(row.name) else { continue };
        table = table.row([
            Cell::from(row.name),
            row.meaning.into(),
            uncertain(value.value, value.std, value.unit).into(),
            value.value.into(),
            deviation(value.std),
            value.unit.into(),
        ]);
    }
    section = section.table(table).plots(contribution(identification, index, effect));
    if let Some(direction) = effect.direction {
        section = section.text(&format!("Direction: {direction}."));
    }
    if effect.alternatives.is_empty() {
        return section
            .text("These records distinguish it from every other effect that they can show.");
    }
    let rivals: Vec<String> = effect.alternatives.iter().map(|name| spoken(name)).collect();
    section.warning(&format!(
        "These records cannot distinguish it from {}: with either the model predicts as well. It \
         was chosen for fewer parameters or a smaller error, which does not prove it.",
        listed(&rivals)
    ))
}

/// The contribution of the effect to the force: the final model less the same without it, in the
/// test where that is largest.
fn contribution(identification: &Identification, index: usize, effect: &EffectFound) -> Vec<Plot> {
    let fit = identification.findings.with_effects.fit();
    let tests = &identification.train;
    let mut without = GreyBox::nominal(&tests.scale);
    let mut values = fit.values[..NOMINAL.len()].to_vec();
    for (k, other) in fit.model.effects.iter().enumerate() {
        if k != index {
            without = without.with(other, &tests.scale);
            values.extend(&fit.values[fit.model.range_of(k)]);
        }
    }
    let Some(damper) = without.damper(&values) else { return Vec::new() };
    let each = tests.tests.iter().enumerate().map(|(t, test)| {
        let simulated = simulate(&damper, test, fit.starts_m[t]);
        let change: Vec<f64> = fit.force_n[t].iter().zip(&simulated).map(|(a, b)| a - b).collect();
        (rms(&change[test.counted()]), test, simulated, change)
    });
    let Some((_, test, simulated, change)) = each.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Vec::new();
    };
    let record = &test.record;
    let stretch = worst_stretch(test, &simulated);
    let force = Prefixed::for_all("N", &change[stretch.clone()]);
    let y = force.values(&change[stretch.clone()]);
    let axes = [
        ("displacement", "m", &record.displacement_m),
        ("velocity", "m/s", &record.velocity_m_per_s),
    ];
    let plots = axes.map(|(name, unit, values)| {
        let prefixed = Prefixed::for_all(unit, &values[stretch.clone()]);
        Plot::new(&format!("What {} adds, over {name}", spoken(effect.name)))
            .x(name, &prefixed.unit)
            .y("force added", &force.unit)
            .line(&spoken(effect.name), &prefixed.values(&values[stretch.clone()]), &y)
            .caption(&format!(
                "The final model less the same model without {}, in {}.",
                spoken(effect.name),
                record.name
            ))
            .height_px(300)
    });
    plots.into()
}

fn place(name: &str) -> &'static str {
    match name {
        "inboard" => "inboard, parallel to the oil and inside the attachment, which filters it",
        "attachment" => "in the attachment, in series with the oil",
        "parallel" => "parallel to the whole damper, between its eyes",
        "sensor" => {
            "between the force and its reading: it belongs to the bench and not to the damper"
        }
        _ => "in the damper",
    }
}
