//! The verdict in plain words, and names without underscores.

use super::prefix::{quantity, uncertain};
use crate::identify::Identification;
use crate::judged::Judged;
use crate::result::{EffectFound, Errors, IdentifyResult, place};
use report::significant;

/// The title of the page.
pub(super) fn title(result: &IdentifyResult) -> String {
    let names: Vec<String> = result.effects.iter().map(group).collect();
    let unexplained = result.unexplained.is_some();
    let verdict = match (names.len(), unexplained) {
        (0, false) if result.not_judged.is_some() => "not judged".to_owned(),
        (0, false) => "nothing is missing".to_owned(),
        (0, true) => "structure without a name remains".to_owned(),
        (count, unexplained) => {
            let are = if count == 1 { "is" } else { "are" };
            let more = if unexplained { ", and structure remains" } else { "" };
            format!("{} {are} missing{more}", listed(&names))
        }
    };
    let interrupted = if result.interrupted { " (interrupted)" } else { "" };
    format!("Damper identification: {verdict}{interrupted}")
}

/// Where structure is seen: follows "120 N rms".
pub(super) fn seen(coordinate: &str) -> String {
    match coordinate {
        "phase" => "that repeat in every cycle".to_owned(),
        "motion" => "that follow from the motion".to_owned(),
        "size_of_the_force" => {
            "that do not follow from the motion and change with the force".to_owned()
        }
        "frequency" => "in lines of the spectrum".to_owned(),
        "held_out_tests" => "in the tests held out".to_owned(),
        other => place(other),
    }
}

/// True where lines remain in the spectrum: they do not repeat with the cycle, so the noise floor
/// includes them.
pub(super) fn floor_has_lines(result: &IdentifyResult) -> bool {
    result.unexplained.as_ref().is_some_and(|part| part.coordinate == "frequency")
}

/// An effect with its rivals.
fn group(effect: &EffectFound) -> String {
    let rivals = effect.alternatives.iter().map(|name| format!(" or {}", spoken(name)));
    format!("{}{}", spoken(effect.name), rivals.collect::<String>())
}

/// The verdict in one or two sentences.
pub(super) fn sentence(identification: &Identification) -> String {
    let result = &identification.result;
    let noise_n = result.noise_floor_n.or(result.noise_at_least_n);
    let noise = match (result.noise_floor_n, result.noise_at_least_n) {
        (Some(floor_n), _) => quantity(floor_n, "N"),
        (None, Some(at_least_n)) => format!("at least {}", quantity(at_least_n, "N")),
        (None, None) => "of unknown size".to_owned(),
    };
    let left = result
        .unexplained
        .as_ref()
        .map(|part| format!("{} rms {}", quantity(part.rms_n, "N"), seen(part.coordinate)));
    let effects: Vec<String> = result.effects.iter().map(effect).collect();
    if effects.is_empty() {
        if let Some(why) = &result.not_judged {
            return format!("These records do not show whether an effect is missing: {why}.");
        }
        return match left {
            None if noise_n.is_none() => format!(
                "The nominal model lacks nothing that these records can show: its residual, {} \
                 rms, follows neither the motion nor the force. The noise floor is unknown.",
                quantity(identification.residual_before.rms_n, "N")
            ),
            None => format!(
                "The nominal model lacks nothing that these records can show: its residual, {} \
                 rms, is noise ({noise}).",
                quantity(identification.residual_before.rms_n, "N")
            ),
            Some(left) => {
                let at_noise = if floor_has_lines(result) {
                    String::new()
                } else {
                    format!(", where the noise is {noise}")
                };
                format!(
                    "The residual has structure that no effect of the catalogue explains: \
                     {left}{at_noise}."
                )
            }
        };
    }
    let verb = if effects.len() == 1 { "explains" } else { "together explain" };
    let text = match explained(identification) {
        // It can happen, and then the reader has to know.
        Explained::BeyondNoise(share) | Explained::OfAll(share) if share <= 0.0 => format!(
            "{} {} on left-out pieces, but not on the tests held out.",
            listed(&effects),
            if effects.len() == 1 { "gains" } else { "gain" }
        ),
        Explained::BeyondNoise(share) => format!(
            "{} {verb} {} of the residual of the refitted model beyond noise.",
            listed(&effects),
            if share > 0.99 {
                "more than 99\u{a0}%".to_owned()
            } else {
                format!("{:.0}\u{a0}%", 100.0 * share)
            }
        ),
        Explained::OfAll(share) => format!(
            "{} {verb} {:.0}\u{a0}% of the squared error of the refitted model.",
            listed(&effects),
            100.0 * share
        ),
    };
    let rest = left.map_or(String::new(), |left| {
        format!(" The residual has structure that nothing in the catalogue explains: {left}.")
    });
    capitalised(&(text + &rest))
}

/// The squared error that effects remove.
enum Explained {
    /// Of what is beyond the noise floor.
    BeyondNoise(f64),
    /// Of all of it, where these errors are no larger than the floor of the fitted tests.
    OfAll(f64),
}

/// On tests held out, or on pieces left out of the fit where none are.
fn explained(identification: &Identification) -> Explained {
    let errors = &identification.result.errors;
    let held = |errors: &Option<Errors>| errors.as_ref()?.holdout_rmse_n;
    let pair = held(&errors.refitted).zip(held(&errors.with_effects));
    let (before, after) = pair.map_or_else(
        || {
            let samples = identification.train.counted_samples().max(1) as f64;
            let of = |judged: &Judged| judged.left_out.total_n2() / samples;
            (of(&identification.findings.refitted), of(&identification.findings.with_effects))
        },
        |(before, after)| (before * before, after * after),
    );
    let floor = identification.result.noise_floor_n.map(|floor_n| floor_n * floor_n);
    if let Some(floor) = floor.filter(|floor| *floor < 0.9 * before) {
        Explained::BeyondNoise(((before - after) / (before - floor)).min(1.0))
    } else {
        Explained::OfAll(1.0 - after / before.max(f64::MIN_POSITIVE))
    }
}

/// An effect with its first parameter and its alternatives.
fn effect(effect: &EffectFound) -> String {
    let info =
        firmware_core::damper::effects::CATALOGUE.iter().find(|info| info.name == effect.name);
    let first = info.and_then(|info| {
        let name = info.parameters.first()?.name;
        let value = effect.parameters.get(name)?;
        Some(format!(" ({} {})", parameter(name), uncertain(value.value, value.std, value.unit)))
    });
    let rivals: Vec<String> = effect.alternatives.iter().map(|name| spoken(name)).collect();
    let rivals = match rivals.len() {
        0 => String::new(),
        _ => format!(", or {} (these records cannot distinguish them),", rivals.join(" or ")),
    };
    format!("{}{}{rivals}", spoken(effect.name), first.unwrap_or_default())
}

/// `seal_friction` in words.
pub(super) fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// The name of a parameter without the unit at its end.
pub(super) fn parameter(name: &str) -> String {
    const UNITS: [&str; 13] = [
        "_n_s2_per_m2",
        "_n_s_per_m",
        "_n_per_m",
        "_m_per_s",
        "_per_m2",
        "_per_m",
        "_per_k",
        "_n",
        "_m",
        "_s",
        "_kg",
        "_k",
        "_hz",
    ];
    let bare = UNITS.iter().find_map(|unit| name.strip_suffix(unit));
    spoken(bare.unwrap_or(name))
}

/// One, two and three.
pub(super) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let Some((last, others)) = names.split_last() else { return String::new() };
    if others.is_empty() {
        return last.as_ref().to_owned();
    }
    let others: Vec<&str> = others.iter().map(AsRef::as_ref).collect();
    format!("{} and {}", others.join(", "), last.as_ref())
}

/// With a capital first letter.
pub(super) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A share in percent, three digits.
pub(super) fn percent(share: f64) -> String {
    format!("{}\u{a0}%", significant(100.0 * share, 3))
}

/// A probability: small ones have no exact size.
pub(super) fn probability(p: f64) -> String {
    if p < 1e-6 {
        "p\u{a0}<\u{a0}1e-6".to_owned()
    } else {
        format!("p\u{a0}=\u{a0}{}", significant(p, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_said_without_their_unit() {
        assert_eq!(parameter("coulomb_n"), "coulomb");
        assert_eq!(parameter("stribeck_m_per_s"), "stribeck");
        assert_eq!(parameter("damping_asymmetry"), "damping asymmetry");
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
        assert_eq!(capitalised("seal"), "Seal");
    }
}
