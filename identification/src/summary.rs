//! The result as text for a terminal.

use super::identify::Identification;
use super::model_file::MODEL_WITH_MAP;
use super::result::{EffectFound, EmpiricalPart, IdentifyResult};
use super::tables;

impl Identification {
    /// The summary for a terminal.
    pub fn summary(&self) -> String {
        let result = &self.result;
        let interrupted = result
            .interrupted
            .then(|| "interrupted: the findings are those of the search so far\n".to_owned());
        let tables = [tables::errors(self), tables::parameters(result)];
        let unexplained = result.unexplained.as_ref();
        let lines = interrupted
            .into_iter()
            .chain([format!("{}\n", result.sentence())])
            .chain(tables.map(|table| format!("\n{}", table.to_text())))
            .chain(["\n".to_owned()])
            .chain(result.effects.iter().map(effect))
            .chain(unexplained.map(|part| format!("unexplained: {}\n", part.description)))
            .chain(resembles(result))
            .chain(result.not_judged.iter().map(|why| format!("not judged: {why}\n")))
            .chain([noise(result)])
            .chain(result.empirical.as_ref().map(map))
            .chain(result.notes.iter().map(|note| format!("note: {note}\n")));
        harmless(&lines.collect::<String>())
    }
}

/// With control characters escaped: names of records come from files.
fn harmless(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c != '\n' && files::quote::acts(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Effects that describe the training tests alone.
fn resembles(result: &IdentifyResult) -> Option<String> {
    let names = result.resembles.join(", ");
    let describe = if result.resembles.len() == 1 { "describes" } else { "describe" };
    (!names.is_empty()).then(|| {
        format!("the residual resembles {names}, which {describe} the training tests alone\n")
    })
}

/// What is known about the noise, and how.
fn noise(result: &IdentifyResult) -> String {
    let method = result.noise_floor_method;
    match (result.noise_floor_n, result.noise_at_least_n) {
        (Some(floor_n), _) => format!("noise floor: {floor_n:.4} N ({method})\n"),
        (None, Some(at_least_n)) => {
            format!("noise floor: unknown, at least {at_least_n:.4} N ({method})\n")
        }
        (None, None) => format!("noise floor: {method}\n"),
    }
}

fn effect(effect: &EffectFound) -> String {
    let EffectFound { name, place, .. } = effect;
    let (gain, p_value) = (100.0 * effect.evidence.holdout_gain, effect.evidence.p_value);
    let mut text = format!(
        "{name} ({place}): removes {gain:.1} % of the squared error on left-out tests, \
         p = {p_value:.1e}\n"
    );
    if let Some(direction) = effect.direction {
        text.extend(["  ", direction, "\n"]);
    }
    if let Some(test) = &effect.separating_test {
        let others = effect.alternatives.join(", ");
        text.extend(["  cannot be distinguished from ", &others, ": ", test, "\n"]);
    }
    text
}

fn map(part: &EmpiricalPart) -> String {
    let over = part.coordinate.map_or(String::new(), |over| format!(" over {over}"));
    if part.kept {
        format!("empirical map{over}: {}; it is no physics ({MODEL_WITH_MAP})\n", part.why)
    } else {
        format!("no empirical map{over}: {}\n", part.why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_sequence_in_a_name_is_shown_and_does_not_act() {
        assert_eq!(harmless("note: \u{1b}[31mred: µm\n"), "note: \\u{1b}[31mred: µm\n");
    }
}
