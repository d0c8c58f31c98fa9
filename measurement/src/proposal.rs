//! A mapping for a file, as far as the file explains itself, with the open questions.

use crate::commas;
use crate::companion::MARKER;
use crate::error::MeasurementError;
use crate::layout::{Decimal, OPEN, Separator};
use crate::recognition::{self, Recognised};
use crate::text::Text;
use crate::unit::Kind;
use files::quoted;
use std::fmt::Write as _;
use std::path::Path;

/// A mapping in TOML for a file: what was understood of it, and a comment `QUESTION` for what was
/// not. A mapping without open questions can be used as it is.
///
/// # Errors
/// The file cannot be read, or holds no rows of numbers.
pub fn propose_mapping(path: &Path) -> Result<String, MeasurementError> {
    let text = Text::read(path)?;
    commas::check(path, &text.content)?;
    let found = recognition::recognised(&text.content).ok_or_else(|| MeasurementError::File {
        file: path.to_owned(),
        found: "no rows of numbers under any separator".to_owned(),
        expected: "at least five rows with two numbers each".to_owned(),
    })?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    Ok(proposal(&found, &name.unwrap_or_default()))
}

fn proposal(found: &Recognised, file: &str) -> String {
    let mut lines = vec![
        format!("# Proposed for {}. Lines with QUESTION need an answer.", quoted(file)),
        format!("{MARKER} = {}", string(file)),
    ];
    if found.separator != Separator::Comma {
        lines.push(format!("separator = \"{}\"", found.separator.name()));
    }
    match (found.decimal, found.decimal_is_certain) {
        (Decimal::Comma, true) => lines.push("decimal = \"comma\"".to_owned()),
        (Decimal::Comma, false) => {
            lines.push(
                "# QUESTION: is the comma a decimal mark, or does it group thousands?".to_owned(),
            );
            lines.push("decimal = \"comma\"                # or \"point\"".to_owned());
        }
        (Decimal::Point, _) => {}
    }
    if found.skip_lines > 0 {
        lines.push(format!("skip_lines = {}", found.skip_lines));
    }
    if found.names.is_empty() || found.is_named_in_comment {
        lines.push(
            "header = false                   # columns are called \"1\", \"2\", ...".to_owned(),
        );
    }
    if has_units_row(found) {
        lines.push("units_row = true".to_owned());
    }
    if found.skip_below_names > 0 {
        lines.push(format!("skip_below_names = {}", found.skip_below_names));
    }
    if let Some(rate_hz) = rate_hz(found) {
        lines.push(format!("sample_rate_hz = {rate_hz:?}           # 1/Delta_X of the preamble"));
    }
    if found.comes_again {
        lines.push("# The row of names comes again: every block becomes a test.".to_owned());
    }
    lines.push("# QUESTION: which sign means extension, positive or negative?".to_owned());
    lines.push("extension = \"unknown\"".to_owned());
    lines.push("# specimen = \"damper 7\"         # what was tested".to_owned());
    lines.push(format!("\n# Columns: {}", columns(found)));
    for kind in Kind::ALL {
        lines.extend(table(found, kind));
    }
    lines.join("\n") + "\n"
}

/// The units stand in a row of their own.
fn has_units_row(found: &Recognised) -> bool {
    found.units.is_some() && !found.is_named_in_comment
}

/// The rate, where it takes the place of a column of time.
fn rate_hz(found: &Recognised) -> Option<f64> {
    found.rate_hz.filter(|_| found.column(Kind::Time) == Err(Vec::new()))
}

/// The columns of a file with their first cells.
fn columns(found: &Recognised) -> String {
    let name = |at: usize| match found.names.get(at) {
        Some(name) => name.clone(),
        None => (at + 1).to_string(),
    };
    let cell = |at: usize| found.first.get(at).cloned().unwrap_or_default();
    let count = found.names.len().max(found.first.len());
    let each = (0..count).map(|at| format!("\"{}\" ({})", quoted(&name(at)), quoted(&cell(at))));
    each.collect::<Vec<_>>().join(", ")
}

/// The table of a kind.
fn table(found: &Recognised, kind: Kind) -> Vec<String> {
    let mut lines = Vec::new();
    if kind == Kind::Time && rate_hz(found).is_some() {
        return lines;
    }
    let has_velocity = found.column(Kind::Velocity).is_ok();
    match found.column(kind) {
        Ok(at) => {
            let unit = found.named(at).1;
            lines.push(format!("[{}]", kind.name()));
            lines.push(format!("column = {}", string(&found.key(at))));
            if let Some(raw) = found.raw(at) {
                let usual = usual(kind);
                lines.push(format!("unit = \"{usual}\""));
                lines.push(format!(
                    "# QUESTION: how many {usual} is one {}? value = scale * (reading - offset)",
                    quoted(raw)
                ));
                lines.push("scale = nan\noffset = 0.0".to_owned());
                return lines;
            }
            lines.extend(match unit {
                // The row of units says it.
                Some(_) if has_units_row(found) => None,
                Some(unit) => Some(format!("unit = {}", string(unit))),
                None if found.is_stamped(at) => None,
                None => Some(format!(
                    "# QUESTION: which unit? one of {}; SI without an answer\n# unit = \"{}\"",
                    kind.names(),
                    usual(kind)
                )),
            });
            if unit.is_none() && matches!(kind, Kind::Displacement | Kind::Force) {
                lines.push(
                    "# of counts or volts: value = scale * (reading - offset)\n# scale = 1.0\n\
                     # offset = 0.0"
                        .to_owned(),
                );
            }
        }
        Err(several) if several.is_empty() => {
            let question = match kind {
                Kind::Velocity | Kind::Temperature => return lines,
                Kind::Displacement if has_velocity => {
                    lines
                        .push("# There is no displacement: the velocity is integrated.".to_owned());
                    return lines;
                }
                Kind::Time => {
                    "which column is the time? Without one: sample_rate_hz = ... at the top, \
                     and no [time]"
                }
                Kind::Displacement => "which column is the displacement?",
                _ => "which column is the force?",
            };
            lines.push(format!("# QUESTION: {question}"));
            lines.push(format!("[{}]", kind.name()));
            lines.push(format!("column = \"{OPEN}\""));
            lines.push(format!("unit = \"{}\"", usual(kind)));
        }
        Err(several) => {
            let names: Vec<String> = several.iter().map(|at| string(&found.key(*at))).collect();
            let question = format!("which one of {} is the {}?", names.join(", "), kind.name());
            lines.push(format!("# QUESTION: {}", quoted(&question)));
            if kind == Kind::Force {
                lines
                    .push("# A list in force_column, at the top, makes a test of each.".to_owned());
            }
            lines.push(format!("[{}]", kind.name()));
            lines.push(format!("column = {}", names.first().map_or(OPEN, String::as_str)));
            let unit = several.first().and_then(|at| found.named(*at).1);
            lines.extend(unit.map(|unit| format!("unit = {}", string(unit))));
        }
    }
    lines
}

/// The unit that laboratories mostly use.
const fn usual(kind: Kind) -> &'static str {
    match kind {
        Kind::Time => "s",
        Kind::Displacement => "mm",
        Kind::Velocity => "mm/s",
        Kind::Force => "kN",
        Kind::Temperature => "degC",
        Kind::Acceleration => "m/s2",
    }
}

/// A text as TOML.
fn string(text: &str) -> String {
    let mut shown = String::new();
    // Writing to a string cannot fail.
    let _ = write!(shown, "{}", toml::Value::String(text.to_owned()));
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::Mapping;
    use scenario::source::Source;

    fn proposed(head: &str, row: impl Fn(usize) -> String) -> String {
        let rows: Vec<String> = (0..50).map(row).collect();
        let text = format!("{head}{}\n", rows.join("\n"));
        let found = recognition::recognised(&text).unwrap();
        let toml = proposal(&found, "a.csv");
        let source = Source::from_text(Path::new("a.toml"), &toml);
        let mapping: Mapping = source.parse().unwrap_or_else(|error| panic!("{error}\n{toml}"));
        mapping.layout(&source, Path::new("a.csv")).unwrap();
        toml
    }

    #[test]
    fn what_a_file_says_is_in_the_mapping() {
        let toml = proposed("Rig 3\nZeit;Weg;Kraft\ns;mm;kN\n", |n| {
            format!("{:.4};{};4,5", n as f64 * 1e-3, n).replace('.', ",")
        });
        for line in [
            "separator = \"semicolon\"",
            "decimal = \"comma\"",
            "skip_lines = 1",
            "units_row = true",
            "column = \"Zeit\"",
            "column = \"Weg\"",
            "column = \"Kraft\"",
        ] {
            assert!(toml.lines().any(|other| other == line), "no {line} in\n{toml}");
        }
        assert_eq!(toml.matches("QUESTION").count(), 2, "{toml}");
    }

    #[test]
    fn what_a_file_does_not_say_is_a_question() {
        let toml = proposed("time_ms,Kraft_raw,Weg_raw\n", |n| format!("{n},932,512"));
        assert_eq!(toml.matches("# QUESTION: which unit?").count(), 2, "{toml}");
        assert!(toml.contains("unit = \"ms\"") && toml.contains("# scale = 1.0"));
        let toml = proposed("", |n| format!("{n}\t5.5\t6.5"));
        assert!(toml.contains("header = false") && toml.contains("column = \"?\""), "{toml}");
        let toml = proposed("Time (s),Disp (mm),Force A (N),Force B (N)\n", |n| {
            format!("{n},1.0,2.0,3.0")
        });
        assert!(toml.contains("which one of"), "{toml}");
    }
}
