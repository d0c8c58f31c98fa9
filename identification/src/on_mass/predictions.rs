//! The motion of every record with its simulations, as CSV files.

use super::identify::OnMass;
use std::fmt::Write as _;

impl OnMass {
    /// Name and content of a CSV file for every record: `time_s`, `force_n`, the measured motion,
    /// and that of the first and of the kept model. Periods are averaged.
    pub fn predictions(&self) -> impl Iterator<Item = (String, String)> + '_ {
        let unit = if self.result.unit == "m" { "m" } else { "m_per_s2" };
        self.shown.iter().map(move |shown| {
            let record = &shown.record;
            let mut text =
                format!("time_s,force_n,measured_{unit},first_model_{unit},kept_model_{unit}\n");
            for sample in 0..record.len() {
                let time_s = sample as f64 * record.step_s;
                let (force_n, motion) = (record.force_n[sample], record.motion[sample]);
                let (first, kept) = (shown.first[sample], shown.kept[sample]);
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{time_s},{force_n},{motion},{first},{kept}");
            }
            (record.name.clone(), text)
        })
    }

    /// The text of `model.toml`, if the kept model has a damper.
    pub fn model_text(&self) -> Option<String> {
        let damper = self.damper.as_ref()?;
        let heading = format!("Identified from the motion of a body: {}.", self.result.sentence());
        let notes = std::collections::BTreeMap::new();
        let file = scenario::damper::DamperFile::from_damper(
            damper,
            scenario::quantity::Provenance::Identified,
            &notes,
        );
        Some(file.to_model(&heading))
    }
}
