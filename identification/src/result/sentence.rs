//! The verdict in words.

use super::{IdentifyResult, Verdict};

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
            format!("{:.4} N rms are unexplained, over {}", part.rms_n, part.coordinate)
        });
        match self.verdict {
            Verdict::NoMissingEffect => "no effect is missing".to_owned(),
            Verdict::EffectsFound => format!("missing: {}", names.join(", ")),
            Verdict::Unexplained => unexplained,
            Verdict::EffectsFoundAndUnexplained => {
                format!("missing: {}; {unexplained}", names.join(", "))
            }
        }
    }
}
