//! The identified damper as a model file that scenarios load, and the same with an empirical map.

use super::empirical::FittedMap;
use super::identify::Identification;
use firmware_core::damper::Damper;
use scenario::damper::DamperFile;
use scenario::quantity::Provenance;
use std::collections::BTreeMap;

/// Name of the file of the identified damper.
pub const MODEL: &str = "model.toml";
/// Name of the file of the same damper with an empirical map.
pub const MODEL_WITH_MAP: &str = "model-empirical.toml";

impl Identification {
    /// The text of [`MODEL`].
    pub fn model_text(&self) -> String {
        self.text_of(&self.damper, "")
    }

    /// The text of [`MODEL_WITH_MAP`], if a map is kept.
    pub fn model_with_map_text(&self) -> Option<String> {
        let FittedMap { damper, map, .. } = self.kept_map()?;
        let more = format!(
            "\nEmpirical, no physics: a map over {} is added to the identified damper of {MODEL}.\n\
             It is valid only inside the range of the records.",
            map.coordinate().name()
        );
        Some(self.text_of(damper, &more))
    }

    fn text_of(&self, damper: &Damper, more: &str) -> String {
        let interrupted = if self.result.interrupted { " (search interrupted)" } else { "" };
        let verdict = self.result.sentence();
        let heading = format!("Identified from measured records: {verdict}{interrupted}.{more}");
        let notes = self.deviations();
        DamperFile::from_damper(damper, Provenance::Identified, &notes).to_model(&heading)
    }

    /// The standard deviation of every parameter, as a note.
    fn deviations(&self) -> BTreeMap<String, String> {
        let note = |std: Option<f64>| match std {
            Some(std) => format!("+- {std:.3e}"),
            None => "not fixed by the records".to_owned(),
        };
        let result = &self.result;
        let nominal = result.nominal.iter().map(|(name, value)| (name.clone(), note(value.std)));
        let of_effects = result.effects.iter().flat_map(|effect| {
            let parameters = effect.parameters.iter();
            parameters
                .map(move |(name, value)| (format!("{}.{name}", effect.name), note(value.std)))
        });
        nominal.chain(of_effects).collect()
    }
}
