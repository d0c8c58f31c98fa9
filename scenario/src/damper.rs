//! A damper in a file: the nominal parameters, the effects that it has beyond them, and, where
//! the user asked for one, an empirical map (`crate::empirical`).
//!
//! Values stand in the `[damper]` of a scenario, a slot or a rig, or in a file of their own, a
//! **model**, that `file` names:
//! ```toml
//! [damper]
//! file = "model.toml"       # relative to this file; keys given here override it
//! clearance_2a_m = 4.0e-3
//! ```
//! A model holds one `[damper]`, so it is a rig file too. What [`DamperFile::to_model`] writes is
//! read back to the same bits: numbers stand with as many digits as it takes.

pub use crate::empirical::{EmpiricalFile, Over};

use crate::datasheet::C2_SHARE;
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::kind::Kind;
use crate::quantity::{Provenance, Quantity};
use crate::source::Source;
use files::{did_you_mean, quoted};
use firmware_core::damper::effects::{CATALOGUE, Effect};
use firmware_core::damper::{Damper, Nominal};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// A damper. What is absent keeps the value of a new SS9 yaw damper (calibrated, not its maker's).
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct DamperFile {
    /// A model file with the values that are absent here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Damping below relief.
    pub ce_n_s_per_m: Option<Quantity>,
    /// Effective series stiffness.
    pub ke_n_per_m: Option<Quantity>,
    /// Total clearance.
    pub clearance_2a_m: Option<Quantity>,
    /// Force at which the relief valve opens.
    pub f_relief_n: Option<Quantity>,
    /// Slope beyond relief.
    pub c2_n_s_per_m: Option<Quantity>,
    /// Effects beyond the nominal model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effect: Vec<EffectFile>,
    /// A map added to all of them that is no physics.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub empirical: Option<EmpiricalFile>,
}

/// An effect by name with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectFile {
    /// Its name in the catalogue.
    pub name: String,
    /// Its parameters by the names of its table.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, Quantity>,
}

impl<'de> Deserialize<'de> for EffectFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(EffectTable)
    }
}

/// Reads `name` as text and every other key as a quantity, keeping their places in the file.
struct EffectTable;

impl<'de> Visitor<'de> for EffectTable {
    type Value = EffectFile;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a table with the name of an effect and its parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<EffectFile, A::Error> {
        let (mut name, mut parameters) = (None, BTreeMap::new());
        while let Some(key) = map.next_key::<String>()? {
            if key == "name" {
                name = Some(map.next_value()?);
            } else {
                parameters.insert(key, map.next_value()?);
            }
        }
        let name = name.ok_or_else(|| A::Error::missing_field("name"))?;
        Ok(EffectFile { name, parameters })
    }
}

impl DamperFile {
    /// The values of [`Nominal::NEW`], each written out.
    pub fn new_damper() -> Self {
        let plain = |value| Some(Quantity::plain(value));
        Self {
            file: None,
            ce_n_s_per_m: plain(Nominal::NEW.ce_n_s_per_m),
            ke_n_per_m: plain(Nominal::NEW.ke_n_per_m),
            clearance_2a_m: plain(Nominal::NEW.clearance_2a_m),
            f_relief_n: plain(Nominal::NEW.f_relief_n),
            c2_n_s_per_m: plain(Nominal::NEW.c2_n_s_per_m),
            effect: Vec::new(),
            empirical: None,
        }
    }

    /// This damper with another one's values wherever it has none.
    #[must_use]
    pub fn over(&self, base: &Self) -> Self {
        Self {
            file: self.file.clone().or(base.file.clone()),
            ce_n_s_per_m: self.ce_n_s_per_m.clone().or(base.ce_n_s_per_m.clone()),
            ke_n_per_m: self.ke_n_per_m.clone().or(base.ke_n_per_m.clone()),
            clearance_2a_m: self.clearance_2a_m.clone().or(base.clearance_2a_m.clone()),
            f_relief_n: self.f_relief_n.clone().or(base.f_relief_n.clone()),
            c2_n_s_per_m: self.c2_n_s_per_m.clone().or(base.c2_n_s_per_m.clone()),
            effect: if self.effect.is_empty() { base.effect.clone() } else { self.effect.clone() },
            empirical: self.empirical.clone().or(base.empirical.clone()),
        }
    }

    /// This damper with the values of the model file that it names, which is noted as the input
    /// `role`; without `file`, as it is.
    ///
    /// # Errors
    /// The model cannot be read, or is no damper that can be, with its own file and line.
    pub(crate) fn resolved(
        self,
        source: &Source,
        role: &str,
        inputs: &mut Inputs,
    ) -> Result<Self, ScenarioError> {
        let Some(file) = &self.file else { return Ok(self) };
        let model = source.named("[damper] file", file)?;
        inputs.note(role, model.content_hash());
        Ok(Self { file: None, ..self.over(&Self::model(&model)?) })
    }

    /// Reads a model file: a `[damper]`, and a `name` if it has one. With Ce and no C2 it gets that
    /// of a datasheet, 0.06 Ce.
    ///
    /// # Errors
    /// It cannot be read, or is no damper that can be, with file and line.
    pub fn load_model(path: &Path) -> Result<Self, ScenarioError> {
        Self::model(&Source::read(path)?)
    }

    fn model(source: &Source) -> Result<Self, ScenarioError> {
        let ModelFile { name: _, mut damper } = source.parse_as(Kind::DamperModel)?;
        if damper.file.is_some() {
            return Err(source.whole_error("a model names another file, expected values"));
        }
        if let (Some(ce), None) = (&damper.ce_n_s_per_m, &damper.c2_n_s_per_m) {
            let note = format!("{C2_SHARE} Ce, by default");
            let c2 = Quantity::plain(C2_SHARE * ce.value);
            damper.c2_n_s_per_m = Some(c2.with_provenance(Provenance::Estimated, Some(note)));
        }
        damper.build(source)?;
        Ok(damper)
    }

    /// The values of a damper. `notes` go to values by their names, those of effects as
    /// `effect.parameter`.
    pub fn from_damper(
        damper: &Damper,
        provenance: Provenance,
        notes: &BTreeMap<String, String>,
    ) -> Self {
        let noted = |key: &str, value| {
            Quantity::plain(value).with_provenance(provenance, notes.get(key).cloned())
        };
        let nominal = damper.nominal();
        let effect = |effect: &Effect| {
            let (name, values) = (effect.name(), effect.values());
            let rows = effect.parameters().iter().zip(values);
            let entry = |(row, value): (&firmware_core::damper::effects::Parameter, f64)| {
                (row.name.to_owned(), noted(&format!("{name}.{}", row.name), value))
            };
            EffectFile { name: name.to_owned(), parameters: rows.map(entry).collect() }
        };
        Self {
            file: None,
            ce_n_s_per_m: Some(noted("ce_n_s_per_m", nominal.ce_n_s_per_m)),
            ke_n_per_m: Some(noted("ke_n_per_m", nominal.ke_n_per_m)),
            clearance_2a_m: Some(noted("clearance_2a_m", nominal.clearance_2a_m)),
            f_relief_n: Some(noted("f_relief_n", nominal.f_relief_n)),
            c2_n_s_per_m: Some(noted("c2_n_s_per_m", nominal.c2_n_s_per_m)),
            effect: damper.effects().iter().map(effect).collect(),
            empirical: damper.empirical().map(EmpiricalFile::from_map),
        }
    }

    /// The text of a model file with `heading` as comment lines at its top.
    pub fn to_model(&self, heading: &str) -> String {
        let mut text = String::new();
        for line in heading.lines() {
            text.push_str(if line.is_empty() { "#" } else { "# " });
            text.push_str(line);
            text.push('\n');
        }
        text.push_str("[damper]\n");
        let values = [
            ("ce_n_s_per_m", &self.ce_n_s_per_m),
            ("ke_n_per_m", &self.ke_n_per_m),
            ("clearance_2a_m", &self.clearance_2a_m),
            ("f_relief_n", &self.f_relief_n),
            ("c2_n_s_per_m", &self.c2_n_s_per_m),
        ];
        for (key, value) in values {
            if let Some(value) = value {
                write_quantity(&mut text, key, value);
            }
        }
        for effect in &self.effect {
            let name = toml::Value::String(effect.name.clone());
            let _ = writeln!(text, "\n[[damper.effect]]\nname = {name}");
            let info = CATALOGUE.iter().find(|info| info.name == effect.name);
            // In the order of the table, which reads better than the alphabet.
            let place = |key: &str| {
                info.and_then(|info| info.parameters.iter().position(|row| row.name == key))
            };
            let mut values: Vec<_> = effect.parameters.iter().collect();
            values.sort_by_key(|(key, _)| place(key));
            for (key, value) in values {
                write_quantity(&mut text, key, value);
            }
        }
        if let Some(map) = &self.empirical {
            map.write(&mut text);
        }
        text
    }

    /// Builds the damper.
    ///
    /// # Errors
    /// A value that no damper can have, an unknown effect or parameter, with file and line.
    pub fn build(&self, source: &Source) -> Result<Damper, ScenarioError> {
        if self.file.is_some() {
            let inputs = &mut Inputs::default();
            return self.clone().resolved(source, "damper", inputs)?.build(source);
        }
        let mut nominal = Nominal::NEW;
        let given = [
            (&self.ce_n_s_per_m, &mut nominal.ce_n_s_per_m, "ce_n_s_per_m", true),
            (&self.ke_n_per_m, &mut nominal.ke_n_per_m, "ke_n_per_m", true),
            (&self.clearance_2a_m, &mut nominal.clearance_2a_m, "clearance_2a_m", false),
            (&self.f_relief_n, &mut nominal.f_relief_n, "f_relief_n", true),
            (&self.c2_n_s_per_m, &mut nominal.c2_n_s_per_m, "c2_n_s_per_m", false),
        ];
        let mut place = None;
        for (value, slot, key, above_zero) in given {
            if let Some(value) = value {
                *slot = if key == "f_relief_n" {
                    let expected = "a positive number, or inf for a damper without relief";
                    value.within(source, key, f64::MIN_POSITIVE, f64::INFINITY, expected)?
                } else if above_zero {
                    value.positive(source, key)?
                } else {
                    value.not_negative(source, key)?
                };
                place = Some(value);
            }
        }
        let located = |message: String| match place {
            Some(value) => value.error(source, message),
            None => source.whole_error(message),
        };
        nominal.validate().map_err(|error| located(error.to_string()))?;
        let effects =
            self.effect.iter().map(|effect| effect.build(source)).collect::<Result<Vec<_>, _>>()?;
        let damper = Damper::new(nominal, &effects).map_err(|error| located(error.to_string()))?;
        Ok(match &self.empirical {
            Some(map) => damper.with_empirical(map.build(source)?),
            None => damper,
        })
    }
}

/// A damper in a file of its own.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelFile {
    /// What a rig file may say about itself.
    name: Option<String>,
    damper: DamperFile,
}

/// One line `key = ...`; `{:?}` writes the fewest digits that give the same number again.
fn write_quantity(text: &mut String, key: &str, quantity: &Quantity) {
    let value = quantity.value;
    let _ = match (&quantity.provenance, &quantity.note) {
        (None, None) => writeln!(text, "{key} = {value:?}"),
        (provenance, note) => {
            let _ = write!(text, "{key} = {{ value = {value:?}");
            if let Some(provenance) = provenance {
                let _ = write!(text, ", provenance = \"{}\"", provenance.name());
            }
            if let Some(note) = note {
                let _ = write!(text, ", note = {}", toml::Value::String(note.clone()));
            }
            writeln!(text, " }}")
        }
    };
}

impl EffectFile {
    fn build(&self, source: &Source) -> Result<Effect, ScenarioError> {
        let Some(info) = CATALOGUE.iter().find(|info| info.name == self.name) else {
            let known: Vec<&str> = CATALOGUE.iter().map(|info| info.name).collect();
            return Err(source.whole_error(format!(
                "effect \"{}\" is not known, expected one of {}{}",
                quoted(&self.name),
                known.join(", "),
                did_you_mean(&self.name, known.iter().copied())
            )));
        };
        let mut values = Vec::new();
        for row in info.parameters {
            let value = self.parameters.get(row.name).ok_or_else(|| {
                source.whole_error(format!(
                    "effect \"{}\" has no {}: {} ({})",
                    self.name,
                    row.name,
                    row.meaning,
                    row.unit.symbol()
                ))
            })?;
            values.push(value.finite(source, row.name)?);
        }
        if let Some((extra, value)) = self
            .parameters
            .iter()
            .find(|(key, _)| info.parameters.iter().all(|row| row.name != *key))
        {
            let known: Vec<&str> = info.parameters.iter().map(|row| row.name).collect();
            return Err(value.error(
                source,
                format!(
                    "effect \"{}\": unknown key `{}`, expected {}{}",
                    self.name,
                    quoted(extra),
                    known.join(", "),
                    did_you_mean(extra, known.iter().copied())
                ),
            ));
        }
        Effect::from_values(info.name, &values).map_err(|error| {
            let near = self.parameters.values().next();
            match near {
                Some(value) => value.error(source, error.to_string()),
                None => source.whole_error(error.to_string()),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::RigFile;
    use firmware_core::damper::effects::Values;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const SEED: u64 = 20;

    fn read_back(text: &str) -> Result<Damper, ScenarioError> {
        let source = Source::from_text(Path::new("model.toml"), text);
        let ModelFile { name: _, damper } = source.parse()?;
        damper.build(&source)
    }

    #[test]
    fn what_is_written_is_read_back_to_the_same_bits() {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        // Numbers with all their bits set at random, over many sizes.
        let mut number = |low: f64, high: f64| {
            let share = random.next_u64() as f64 / 2f64.powi(64);
            low + (high - low) * share * share * share
        };
        let mut written = 0;
        for trial in 0..200 {
            let nominal = Nominal {
                ce_n_s_per_m: number(1.0, 1e9),
                ke_n_per_m: number(1e2, 1e12),
                clearance_2a_m: if trial % 3 == 0 { 0.0 } else { number(1e-9, 1e-2) },
                f_relief_n: if trial % 5 == 0 { f64::INFINITY } else { number(1.0, 1e7) },
                c2_n_s_per_m: if trial % 7 == 0 { 0.0 } else { number(1e-3, 1e6) },
            };
            let effects: Vec<Effect> = CATALOGUE
                .iter()
                .skip(trial % CATALOGUE.len())
                .take(trial % 4)
                .filter_map(|info| {
                    let scale = nominal.scale();
                    let value = |row: &firmware_core::damper::effects::Parameter| {
                        let (lower, upper) = row.bounds(&scale);
                        let usual = row.usual(&scale);
                        number(lower.max(0.9 * usual), upper.min(1.1 * usual))
                    };
                    let values: Values = info.parameters.iter().map(value).collect();
                    Effect::from_values(info.name, &values).ok()
                })
                .collect();
            // Not every mixture has rising laws.
            let Ok(damper) = Damper::new(nominal, &effects) else { continue };
            let notes = BTreeMap::from([("ke_n_per_m".to_owned(), "+- 3 % \"95 %\"\n".to_owned())]);
            let file = DamperFile::from_damper(&damper, Provenance::Identified, &notes);
            let text = file.to_model("identified\n\nfrom a.csv");
            let again =
                read_back(&text).unwrap_or_else(|error| panic!("seed {SEED}: {error}\n{text}"));
            assert_eq!(again, damper, "seed {SEED}, trial {trial}\n{text}");
            assert_eq!(again.nominal().ke_n_per_m.to_bits(), nominal.ke_n_per_m.to_bits());
            for (one, other) in again.effects().iter().zip(damper.effects()) {
                for (a, b) in one.values().iter().zip(other.values()) {
                    assert_eq!(a.to_bits(), b.to_bits(), "{}", one.name());
                }
            }
            written += 1;
        }
        assert!(written > 150, "{written}");
    }

    #[test]
    fn a_model_reads_well() {
        let mut file = DamperFile::new_damper();
        file.ke_n_per_m =
            Some(Quantity::plain(1.25e7).with_provenance(Provenance::Identified, None));
        file.effect.push(EffectFile {
            name: "asymmetric_damping".to_owned(),
            parameters: BTreeMap::new(),
        });
        let text = file.to_model("A damper.\n\nOf no maker.");
        assert_eq!(
            text,
            "# A damper.\n#\n# Of no maker.\n[damper]\nce_n_s_per_m = 1000000.0\n\
             ke_n_per_m = { value = 12500000.0, provenance = \"identified\" }\n\
             clearance_2a_m = 0.0002\nf_relief_n = 18000.0\nc2_n_s_per_m = 80000.0\n\n\
             [[damper.effect]]\nname = \"asymmetric_damping\"\n"
        );
    }

    #[test]
    fn a_model_is_named_by_a_scenario_and_is_a_rig_of_its_own() {
        let folder = std::env::temp_dir().join(format!("yawbench-model-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let nominal = Nominal { ke_n_per_m: 9.87e6, ..Nominal::NEW };
        let damper = Damper::new(nominal, &[]).unwrap();
        let file = DamperFile::from_damper(&damper, Provenance::Identified, &BTreeMap::new());
        std::fs::write(folder.join("model.toml"), file.to_model("")).unwrap();
        let rig = RigFile::load(&folder.join("model.toml")).unwrap();
        assert_eq!(rig.damper, damper);

        let text = "file = \"model.toml\"\nclearance_2a_m = 4e-3\n";
        let source = Source::from_text(&folder.join("run.toml"), text);
        let worn: DamperFile = source.parse().unwrap();
        let worn = worn.resolved(&source, "damper", &mut Inputs::default()).unwrap();
        assert_eq!(worn.file, None);
        let built = worn.build(&source).unwrap();
        assert_eq!(*built.nominal(), Nominal { clearance_2a_m: 4e-3, ..nominal });

        std::fs::write(folder.join("bad.toml"), "[damper]\n\nke_n_per_m = -1.0\n").unwrap();
        let source = Source::from_text(&folder.join("run.toml"), "file = \"bad.toml\"\n");
        let bad: DamperFile = source.parse().unwrap();
        let error = bad.resolved(&source, "damper", &mut Inputs::default()).unwrap_err();
        let at = error.place().unwrap();
        assert_eq!((&at.file, at.line), (&folder.join("bad.toml"), Some(3)));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
