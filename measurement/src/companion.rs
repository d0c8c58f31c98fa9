//! The mapping next to a file: `sine.toml` for `sine.csv`.
//!
//! A CSV file with names in line 1 and nothing else opens in any program. What else is to be known
//! about it, such as the side that is extension, is in a mapping of the same stem. Another TOML
//! file may have that stem too, such as a model of the damper; a companion is recognised by its
//! marker, the line `mapping_for = "sine.csv"` before its first table.

use crate::error::MeasurementError;
use crate::layout::Extension;
use files::input::{self, Limit};
use files::quoted;
use scenario::source::Source;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The key that makes a TOML file a companion.
pub(crate) const MARKER: &str = "mapping_for";

/// What a CSV file with this project's columns cannot say about itself.
///
/// ```
/// use measurement::mapping::{Companion, Extension};
/// let extension = Extension::Positive;
/// let companion = Companion { specimen: None, notes: Vec::new(), extension, temperature: true };
/// assert!(companion.to_toml("sine.csv").contains("\nmapping_for = \"sine.csv\"\n"));
/// assert_eq!(Companion::name_for("sine.csv"), "sine.toml");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Companion {
    /// What was tested.
    pub specimen: Option<String>,
    /// What else is known of the test; for people.
    pub notes: Vec<String>,
    /// Which sign means extension.
    pub extension: Extension,
    /// There is a column `temperature_degc`.
    pub temperature: bool,
}

impl Companion {
    /// The name of the companion of a file.
    pub fn name_for(file: &str) -> String {
        path_for(Path::new(file)).display().to_string()
    }

    /// The companion as a mapping for a file of this name.
    pub fn to_toml(&self, file: &str) -> String {
        let text = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let mut toml = format!("# What {} cannot say about itself.\n", quoted(file));
        // Writing to a string cannot fail.
        let _ = writeln!(toml, "{MARKER} = {}", text(file));
        if let Some(specimen) = &self.specimen {
            let _ = writeln!(toml, "specimen = {}", text(specimen));
        }
        if !self.notes.is_empty() {
            toml.push_str("notes = [\n");
            for note in &self.notes {
                let _ = writeln!(toml, "    {},", text(note));
            }
            toml.push_str("]\n");
        }
        let _ = writeln!(toml, "extension = \"{}\"", self.extension.name());
        if self.temperature {
            toml.push_str("\n[temperature]\ncolumn = \"temperature_degc\"\nunit = \"degC\"\n");
        }
        toml
    }
}

/// The mapping of the same stem, if there is one and it is meant for this file.
///
/// # Errors
/// The mapping was made for a file of another name that is not there: one of the two was renamed.
pub(crate) fn find(file: &Path) -> Result<Option<Source>, MeasurementError> {
    let path = path_for(file);
    // Anything that is no readable text is not a companion: the stem alone claims nothing.
    let is_other = path == file || !path.is_file();
    let text = (!is_other).then(|| input::read_text(&path, Limit::Text).ok()).flatten();
    let Some(source) = text.map(|text| Source::from_text(&path, &text)) else { return Ok(None) };
    let Some(named) = marked_for(source.text()) else { return Ok(None) };
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = name.unwrap_or_default();
    if named == name {
        return Ok(Some(source));
    }
    if file.with_file_name(&named).is_file() {
        return Ok(None);
    }
    Err(MeasurementError::File {
        file: path,
        found: format!("{MARKER} = \"{}\"", quoted(&named)),
        expected: format!("\"{}\": one of the two files was renamed", quoted(&name)),
    })
}

fn path_for(file: &Path) -> PathBuf {
    file.with_extension("toml")
}

/// The file that a text says it is the mapping for.
fn marked_for(text: &str) -> Option<String> {
    let top = text.lines().map(str::trim).take_while(|line| !line.starts_with('['));
    let marker = |line: &str| {
        let value = line.strip_prefix(MARKER)?.trim_start().strip_prefix('=')?;
        Some(value.trim().to_owned())
    };
    let value = top.into_iter().find_map(marker)?;
    let table: Result<toml::Table, _> = toml::from_str(&format!("{MARKER} = {value}"));
    // A marker without a text is a companion all the same; reading it says what is wrong.
    Some(match table.ok().and_then(|table| table.get(MARKER)?.as_str().map(str::to_owned)) {
        Some(name) => name,
        None => value,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_companion_is_known_by_its_marker_alone() {
        for (text, named) in [
            ("mapping_for = \"a.csv\"\n", Some("a.csv")),
            ("# a\n  mapping_for='a b.csv' # why\n", Some("a b.csv")),
            ("mapping_for = 3\n", Some("3")),
            ("title = \"a\"\n[damper]\nmapping_for = \"a.csv\"\n", None),
            ("mapping_for_what = \"a.csv\"\n", None),
            ("", None),
        ] {
            assert_eq!(marked_for(text).as_deref(), named, "{text}");
        }
    }

    #[test]
    fn any_name_and_specimen_survive_toml() {
        let companion = Companion {
            specimen: Some("a \"new\"\n\u{1b}[31m one".to_owned()),
            notes: vec!["upright".to_owned(), "a \"b\"\nc".to_owned()],
            extension: Extension::Unknown,
            temperature: true,
        };
        let text = companion.to_toml("odd \"name\".csv");
        assert_eq!(marked_for(&text).as_deref(), Some("odd \"name\".csv"));
        let table: toml::Table = toml::from_str(&text).unwrap();
        assert_eq!(table["specimen"].as_str(), companion.specimen.as_deref());
        assert_eq!(table["notes"][1].as_str(), Some("a \"b\"\nc"));
        assert_eq!(table["extension"].as_str(), Some("unknown"));
    }
}
