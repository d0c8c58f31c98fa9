//! The verdict in words.

use super::{IdentifyResult, Verdict};
use report::significant;

impl IdentifyResult {
    /// The verdict in a sentence without its full stop.
    pub fn sentence(&self) -> String {
        let names: Vec<String> = self
            .effects
            .iter()
            .map(|effect| match effect.alternatives.as_slice() {
                [] => effect.name.to_owned(),
                others => format!("{} (or {})", effect.name, others.join(", or ")),
            })
            .collect();
        let unexplained = self.unexplained.as_ref().map_or(String::new(), |part| {
            format!(
                "{} N rms are unexplained, {}",
                significant(part.rms_n, 3),
                place(part.coordinate)
            )
        });
        let not_judged = self.not_judged.as_deref().unwrap_or_default();
        let unknown = if self.noise_floor_n.is_none() { " (noise floor unknown)" } else { "" };
        match self.verdict {
            Verdict::NoMissingEffect => format!("no effect is missing{unknown}"),
            Verdict::NotJudged => format!("not judged: {not_judged}"),
            Verdict::EffectsFound if !not_judged.is_empty() => {
                format!("missing: {}; not judged: {not_judged}", names.join(", "))
            }
            Verdict::EffectsFound => format!("missing: {}", names.join(", ")),
            Verdict::Unexplained => unexplained,
            Verdict::EffectsFoundAndUnexplained => {
                format!("missing: {}; {unexplained}", names.join(", "))
            }
        }
    }
}

/// Where structure was found.
pub(crate) fn place(coordinate: &str) -> String {
    match coordinate {
        "test" => "in one test".to_owned(),
        "time" => "in a few short stretches".to_owned(),
        "motion" => "and follow from the motion".to_owned(),
        "size_of_the_force" => "and change with the force".to_owned(),
        other => format!("over {}", other.replace('_', " ")),
    }
}
