//! The result as text for a terminal.

use super::identify::Identification;
use super::model_file::MODEL_WITH_MAP;
use super::result::{EffectFound, EmpiricalPart, Errors, IdentifyResult};
use std::fmt::{self, Write};

impl Identification {
    /// The summary for a terminal.
    pub fn summary(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = write_summary(&mut text, &self.result);
        text
    }
}

fn write_summary(out: &mut impl Write, result: &IdentifyResult) -> fmt::Result {
    if result.interrupted {
        writeln!(out, "interrupted: the findings are those of the search so far")?;
    }
    writeln!(out, "{}\n", result.sentence())?;
    write_errors(out, result)?;
    writeln!(out)?;
    write_nominal(out, result)?;
    for effect in &result.effects {
        write_effect(out, effect)?;
    }
    if let Some(part) = &result.unexplained {
        writeln!(out, "unexplained: {}", part.description)?;
    }
    if let Some(part) = &result.empirical {
        write_map(out, part)?;
    }
    for note in &result.notes {
        writeln!(out, "note: {note}")?;
    }
    Ok(())
}

fn write_errors(out: &mut impl Write, result: &IdentifyResult) -> fmt::Result {
    writeln!(out, "{:<14}{:>14}{:>10}{:>14}{:>10}", "rms error", "train N", "", "hold-out N", "")?;
    let datasheet_given = result.nominal.values().any(|value| value.datasheet.is_some());
    let map = result.empirical.as_ref().filter(|part| part.kept).and_then(|part| part.errors);
    let models = [
        ("datasheet", &result.errors.datasheet),
        ("refitted", &result.errors.refitted),
        ("with effects", &result.errors.with_effects),
        ("empirical map", &map),
    ];
    for (name, errors) in models {
        match errors {
            Some(errors) => write_row_of_errors(out, name, errors)?,
            None if name == "datasheet" && !datasheet_given => {
                writeln!(out, "{name:<14}  none given")?;
            }
            None => {}
        }
    }
    writeln!(out, "{:<14}{:>14.4}", "noise floor", result.noise_floor_n)
}

fn write_row_of_errors(out: &mut impl Write, name: &str, errors: &Errors) -> fmt::Result {
    let train_share = 100.0 * errors.train_nrmse;
    write!(out, "{name:<14}{:>14.4}{train_share:>9.2}%", errors.train_rmse_n)?;
    if let (Some(rmse_n), Some(share)) = (errors.holdout_rmse_n, errors.holdout_nrmse) {
        write!(out, "{rmse_n:>14.4}{:>9.2}%", 100.0 * share)?;
    }
    writeln!(out)
}

fn write_nominal(out: &mut impl Write, result: &IdentifyResult) -> fmt::Result {
    writeln!(out, "{:<34}{:>14}{:>12}{:>14}", "parameter", "identified", "+-", "datasheet")?;
    for (name, value) in &result.nominal {
        let (identified, std) = (number(Some(value.value)), deviation(value.std));
        writeln!(out, "{name:<34}{identified:>14}{std:>12}{:>14}", number(value.datasheet))?;
    }
    Ok(())
}

fn write_effect(out: &mut impl Write, effect: &EffectFound) -> fmt::Result {
    let (gain, p_value) = (100.0 * effect.evidence.holdout_gain, effect.evidence.p_value);
    writeln!(
        out,
        "{} ({}): removes {gain:.1} % of the squared error on left-out tests, p = {p_value:.1e}",
        effect.name, effect.place
    )?;
    for (name, value) in &effect.parameters {
        let (identified, std) = (number(Some(value.value)), deviation(value.std));
        writeln!(out, "  {name:<32}{identified:>14}{std:>12}  {}", value.unit)?;
    }
    if let Some(direction) = effect.direction {
        writeln!(out, "  {direction}")?;
    }
    if let Some(test) = &effect.separating_test {
        let others = effect.alternatives.join(", ");
        writeln!(out, "  cannot be distinguished from {others}: {test}")?;
    }
    Ok(())
}

fn write_map(out: &mut impl Write, part: &EmpiricalPart) -> fmt::Result {
    let over = part.coordinate.map_or(String::new(), |over| format!(" over {over}"));
    if part.kept {
        writeln!(out, "empirical map{over}: {}; it is no physics ({MODEL_WITH_MAP})", part.why)
    } else {
        writeln!(out, "no empirical map{over}: {}", part.why)
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.5e}"))
}

fn deviation(std: Option<f64>) -> String {
    std.map_or("not fixed".to_owned(), |std| format!("{std:.1e}"))
}
