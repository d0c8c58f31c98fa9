//! A mapping: how the columns of another laboratory's files become displacement and force.
//!
//! ```toml
//! separator = "semicolon"        # comma | semicolon | tab | whitespace
//! decimal = "comma"              # point | comma
//! comment = "#"                  # lines that begin with it are skipped
//! skip_lines = 12                # lines before the row of names
//! header = true                  # false: columns are called "1", "2", ...
//! units_row = true               # a row below the names holds units
//! skip_below_names = 1           # rows below the names that hold neither units nor numbers
//! extension = "negative"         # which sign means extension: positive | negative | unknown
//! split_by = ["test"]            # one test per value, in order of appearance
//! where = { voltage_V = 0.871 }  # only these rows; a list means any of them
//! force_column = "force_N_0.4A"  # a choice among force columns; a list makes one test of each
//! sample_rate_hz = 200.0         # instead of a time column
//! specimen = "damper 7"          # what was tested
//!
//! [time]
//! column = "t_ms"
//! unit = "ms"
//! [displacement]
//! column = "stroke_mm"
//! unit = "mm"
//! offset = 12.5                  # the reading that means zero, in the file's unit
//! [force]
//! column = "load_kN"
//! unit = "kN"
//! sign = -1
//! scale = 10.0                   # of counts or volts: value = scale * (reading - offset)
//! [destroyed]                    # effects that no longer show, and what was done to the records
//! force_offset = "the mean was subtracted"
//! ```
//! `[velocity]`, `[temperature]` and `[acceleration]` likewise; the last one is for a body on a
//! damper (`[on_mass]`, [`crate::body_record`]) and is then its motion instead of the displacement.
//! Columns that are not named keep the names of this project, `time_s`, `displacement_m`,
//! `force_n`; units that are not named come from the units row, or are SI. With `scale` a unit is
//! that of the scaled value, and a units row is not used.
//!
//! Units may be spelled as programs do (`Sec`, `kip`, `lbs`, `inches`, `ips`). A time column may
//! hold dates and times of day; they become seconds since the first. Where a file has a velocity
//! and no displacement, the velocity is integrated. Digits may be grouped by threes. A file whose
//! block of names comes again holds several tests: `NAME-1`, `NAME-2`. `extension = "negative"`
//! turns the signs of displacement, velocity and force, so that positive is extension and tension.
//! Numbers in `where` match within 0.1 %.
//!
//! One mapping may serve files of different layout: `[[file]]` tables with `named = "*quake*"`
//! hold the same keys for the files whose names fit, and override those at the top.
//!
//! A mapping that begins with `mapping_for = "sine.csv"` is found without being named when
//! `sine.csv` is read from the same folder, if it has the same stem: `sine.toml`
//! ([`Companion`] writes one).

pub use crate::companion::Companion;
pub use crate::layout::Extension;

use crate::drive::{BodyStart, OnMass};
use crate::error::MeasurementError;
use crate::layout::{Decimal, Layout, OPEN, OptionalReading, Reading, Separator, Wanted};
use crate::suspicion::RATE_MOST_HZ;
use crate::unit::Kind;
use files::quoted;
use firmware_core::damper::effects::CATALOGUE;
use scenario::source::{ScenarioError, Source};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// A mapping as its file states it.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Mapping {
    /// The file that the mapping is for, where it is to be found by its stem.
    #[serde(rename = "mapping_for")]
    made_for: Option<String>,
    /// What was tested.
    specimen: Option<String>,
    /// What people should know of the test; nothing depends on it.
    #[serde(rename = "notes")]
    _notes: Option<Vec<String>>,
    /// What separates two cells.
    separator: Option<Separator>,
    /// What precedes the decimals.
    decimal: Option<Decimal>,
    /// Beginning of a comment line.
    comment: Option<String>,
    /// Lines before the row of names.
    skip_lines: Option<usize>,
    /// There is a row of names.
    header: Option<bool>,
    /// There is a row of units below the names.
    units_row: Option<bool>,
    /// Rows below the names that hold neither units nor numbers.
    skip_below_names: Option<usize>,
    /// Which sign of the file means extension.
    extension: Option<Extension>,
    /// Columns whose values separate the tests of a file.
    split_by: Option<Spanned<Vec<String>>>,
    /// Values that a row must have.
    #[serde(rename = "where")]
    only: Option<Spanned<BTreeMap<String, Wanted>>>,
    /// Force columns instead of the one of `[force]`.
    force_column: Option<Spanned<OneOrMany>>,
    /// Sampling rate of a file without time.
    sample_rate_hz: Option<Spanned<f64>>,
    /// Time.
    time: Option<Column>,
    /// Displacement.
    displacement: Option<Column>,
    /// Force.
    force: Option<Column>,
    /// Velocity.
    velocity: Option<Column>,
    /// Temperature.
    temperature: Option<Column>,
    /// Acceleration of a body.
    acceleration: Option<Column>,
    /// How a body was driven.
    on_mass: Option<Spanned<OnMass>>,
    /// Effects that the laboratory's processing has destroyed, and how.
    destroyed: Option<BTreeMap<Spanned<String>, String>>,
    /// Names of the files that a `[[file]]` table is for, `*` for anything.
    named: Option<String>,
    /// Layouts of single files.
    #[serde(default)]
    file: Vec<Mapping>,
}

/// One column.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Column {
    /// Its name in the file.
    #[serde(rename = "column")]
    name: Option<Spanned<String>>,
    /// Its unit.
    unit: Option<Spanned<String>>,
    /// The reading that means zero, in the file's unit.
    offset: Option<Spanned<f64>>,
    /// What one of the reading is, in the unit or in SI.
    scale: Option<Spanned<f64>>,
    /// 1 or -1.
    sign: Option<Spanned<f64>>,
}

/// One name or several.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

impl Mapping {
    /// Reads a mapping.
    ///
    /// # Errors
    /// The first thing that does not fit, with file and line.
    pub(crate) fn load(path: &Path) -> Result<(Self, Source), MeasurementError> {
        let source = Source::read(path)?;
        let mapping = source.parse()?;
        Ok((mapping, source))
    }

    /// The layout of one file: that of the first `[[file]]` table whose `named` fits, over the keys
    /// at the top.
    ///
    /// # Errors
    /// A value that cannot be, with the mapping's file and line.
    pub(crate) fn layout(&self, source: &Source, file: &Path) -> Result<Layout, ScenarioError> {
        if self.named.is_some() {
            return Err(source.whole_error("named belongs in a [[file]] table only"));
        }
        if self.file.iter().any(|one| one.made_for.is_some()) {
            return Err(source.whole_error("mapping_for in a [[file]] table, expected at the top"));
        }
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or_default();
        let fits = |one: &&Self| one.named.as_deref().is_some_and(|named| is_like(&name, named));
        if let Some(one) = self.file.iter().find(|one| one.named.is_none() || !one.file.is_empty())
        {
            let what = if one.file.is_empty() { "without named" } else { "inside another" };
            return Err(source.whole_error(format!("[[file]] {what}, expected named = \"*part*\"")));
        }
        match self.file.iter().find(fits) {
            Some(own) => own.over(self).checked(source),
            None => Self { file: Vec::new(), ..self.clone() }.checked(source),
        }
    }

    fn over(&self, base: &Self) -> Self {
        let base = base.clone();
        let own = self.clone();
        Self {
            made_for: base.made_for,
            specimen: own.specimen.or(base.specimen),
            _notes: None,
            separator: own.separator.or(base.separator),
            decimal: own.decimal.or(base.decimal),
            comment: own.comment.or(base.comment),
            skip_lines: own.skip_lines.or(base.skip_lines),
            header: own.header.or(base.header),
            units_row: own.units_row.or(base.units_row),
            skip_below_names: own.skip_below_names.or(base.skip_below_names),
            extension: own.extension.or(base.extension),
            split_by: own.split_by.or(base.split_by),
            only: own.only.or(base.only),
            force_column: own.force_column.or(base.force_column),
            sample_rate_hz: own.sample_rate_hz.or(base.sample_rate_hz),
            time: own.time.or(base.time),
            displacement: own.displacement.or(base.displacement),
            force: own.force.or(base.force),
            velocity: own.velocity.or(base.velocity),
            temperature: own.temperature.or(base.temperature),
            acceleration: own.acceleration.or(base.acceleration),
            on_mass: own.on_mass.or(base.on_mass),
            destroyed: own.destroyed.or(base.destroyed),
            named: None,
            file: Vec::new(),
        }
    }

    fn checked(&self, source: &Source) -> Result<Layout, ScenarioError> {
        let comment = self.comment.clone().unwrap_or_else(|| "#".to_owned());
        let rate = match &self.sample_rate_hz {
            Some(rate) => Some(self::rate(source, rate, "sample_rate_hz")?),
            None => None,
        };
        if let (Some(rate), Some(_)) = (&self.sample_rate_hz, &self.time) {
            return Err(
                source.error(&rate.span(), "sample_rate_hz and [time], expected one of them")
            );
        }
        let header = self.header.unwrap_or(true);
        let separator = self.separator.unwrap_or_default();
        let read = |column: &Option<Column>, kind, name: &str| {
            reading(source, column.as_ref(), kind, name)
        };
        let mut force = vec![read(&self.force, Kind::Force, "force_n")?];
        if let Some(chosen) = &self.force_column {
            let names = match chosen.get_ref() {
                OneOrMany::One(name) => std::slice::from_ref(name),
                OneOrMany::Many(names) => names.as_slice(),
            };
            if names.is_empty() {
                return Err(source.error(&chosen.span(), "force_column is empty, expected a name"));
            }
            let of = |name: &String| {
                let first = force.first().cloned();
                first.map(|reading| Reading { column: name.clone(), ..reading })
            };
            force = names.iter().filter_map(of).collect();
        }
        self.refuse_shared_columns(source)?;
        let own_columns = [&self.displacement, &self.force].iter().all(|column| column.is_none())
            && self.force_column.is_none();
        Ok(Layout {
            separator,
            decimal: self.decimal,
            comment,
            skip_lines: self.skip_lines.unwrap_or(0),
            header,
            units_row: self.units_row.unwrap_or(false),
            skip_below_names: self.skip_below_names.unwrap_or(0),
            names: Vec::new(),
            extension: self.extension,
            own_columns,
            split_by: self.split_by.as_ref().map(|by| by.get_ref().clone()).unwrap_or_default(),
            only: self.only.as_ref().map(|only| only.get_ref().clone()).unwrap_or_default(),
            sample_rate_hz: rate,
            time: read(&self.time, Kind::Time, "time_s")?,
            displacement: OptionalReading {
                reading: read(&self.displacement, Kind::Displacement, "displacement_m")?,
                required: self.displacement.is_some(),
            },
            force,
            velocity: OptionalReading {
                reading: read(&self.velocity, Kind::Velocity, "velocity_m_per_s")?,
                required: self.velocity.is_some(),
            },
            temperature: OptionalReading {
                reading: read(&self.temperature, Kind::Temperature, "temperature_degc")?,
                required: self.temperature.is_some(),
            },
            acceleration: match &self.acceleration {
                Some(_) => {
                    Some(read(&self.acceleration, Kind::Acceleration, "acceleration_m_per_s2")?)
                }
                None => None,
            },
            on_mass: on_mass(source, self.on_mass.as_ref())?,
            destroyed: destroyed(source, self.destroyed.as_ref())?,
            specimen: self.specimen.as_ref().map(|specimen| quoted(specimen).to_string()),
            understood: None,
        })
    }
}

impl Mapping {
    /// Refuses one column for two signals.
    fn refuse_shared_columns(&self, source: &Source) -> Result<(), ScenarioError> {
        let of = |key: &'static str, column: &Option<Column>, name: &str| {
            let given = column.as_ref().and_then(|column| column.name.as_ref());
            let column = given.map_or(name, |given| given.get_ref()).to_owned();
            (key, column, given.map(Spanned::span))
        };
        let mut all = vec![of("displacement", &self.displacement, "displacement_m")];
        if self.sample_rate_hz.is_none() {
            all.push(of("time", &self.time, "time_s"));
        }
        match &self.force_column {
            Some(chosen) => {
                let names = match chosen.get_ref() {
                    OneOrMany::One(name) => std::slice::from_ref(name),
                    OneOrMany::Many(names) => names.as_slice(),
                };
                let span = || Some(chosen.span());
                all.extend(names.iter().map(|name| ("force", name.clone(), span())));
            }
            None => all.push(of("force", &self.force, "force_n")),
        }
        all.push(of("velocity", &self.velocity, "velocity_m_per_s"));
        all.push(of("temperature", &self.temperature, "temperature_degc"));
        if self.acceleration.is_some() {
            all.push(of("acceleration", &self.acceleration, "acceleration_m_per_s2"));
        }
        // Open questions of a proposal.
        all.retain(|(_, column, _)| column != OPEN);
        for (index, (key, column, span)) in all.iter().enumerate() {
            let same = |other: &&(&str, String, _)| other.1 == *column && other.0 != *key;
            let Some((other, _, span_of_other)) = all[..index].iter().find(same) else { continue };
            let Some(span) = span.as_ref().or(span_of_other.as_ref()) else { continue };
            let message = format!(
                "column \"{}\" for {other} and {key}, expected a column for each",
                quoted(column)
            );
            return Err(source.error(span, message));
        }
        Ok(())
    }
}

fn reading(
    source: &Source,
    column: Option<&Column>,
    kind: Kind,
    name: &str,
) -> Result<Reading, ScenarioError> {
    let Some(given) = column else {
        return Ok(Reading::plain(kind, name));
    };
    let unit = match &given.unit {
        Some(unit) => Some(kind.unit(unit.get_ref()).ok_or_else(|| {
            let (found, known) = (quoted(unit.get_ref()), kind.names());
            let message = format!("unit = \"{found}\", expected one of {known}");
            source.error(&unit.span(), message)
        })?),
        None => None,
    };
    let sign = match &given.sign {
        Some(sign) if sign.get_ref().abs() != 1.0 => {
            let found = files::number(*sign.get_ref());
            let message = format!("sign = {found}, expected 1 or -1");
            return Err(source.error(&sign.span(), message));
        }
        Some(sign) => *sign.get_ref(),
        None => 1.0,
    };
    let offset = match &given.offset {
        Some(offset) if !offset.get_ref().is_finite() => {
            let message = format!("offset = {}, expected a finite number", offset.get_ref());
            return Err(source.error(&offset.span(), message));
        }
        Some(offset) => *offset.get_ref(),
        None => 0.0,
    };
    let scale = match &given.scale {
        Some(scale) if !scale.get_ref().is_finite() || *scale.get_ref() == 0.0 => {
            let message = format!("scale = {}, expected a finite number, not 0", scale.get_ref());
            return Err(source.error(&scale.span(), message));
        }
        Some(scale) => Some(*scale.get_ref()),
        None => None,
    };
    let column = given.name.as_ref().map_or(name, |column| column.get_ref()).to_owned();
    Ok(Reading { kind, column, unit, offset, scale, sign })
}

/// How a body was driven, with the length of a period where it is periodic.
fn on_mass(source: &Source, given: Option<&Spanned<OnMass>>) -> Result<OnMass, ScenarioError> {
    let Some(given) = given else { return Ok(OnMass::default()) };
    let OnMass { start, period_samples, .. } = *given.get_ref();
    if let Some(length) = period_samples.filter(|length| *length < 16) {
        let message = format!("period_samples = {length}, expected 16 or more");
        return Err(source.error(&given.span(), message));
    }
    match (start, period_samples) {
        (Some(BodyStart::Periodic), None) => Err(source
            .error(&given.span(), "start = \"periodic\" without period_samples, expected both")),
        (Some(BodyStart::Rest | BodyStart::Moving), Some(_)) => Err(source.error(
            &given.span(),
            "period_samples with another start, expected start = \"periodic\" or none",
        )),
        _ => Ok(*given.get_ref()),
    }
}

/// Effects of the catalogue, each with the reason why these records no longer show it.
fn destroyed(
    source: &Source,
    given: Option<&BTreeMap<Spanned<String>, String>>,
) -> Result<BTreeMap<&'static str, String>, ScenarioError> {
    let each = given.into_iter().flatten().map(|(name, why)| {
        let known = CATALOGUE.iter().find(|info| info.name == name.get_ref());
        let info = known.ok_or_else(|| {
            let names: Vec<&str> = CATALOGUE.iter().map(|info| info.name).collect();
            let (found, known) = (quoted(name.get_ref()), names.join(", "));
            let message = format!("no effect \"{found}\", expected one of {known}");
            source.error(&name.span(), message)
        })?;
        if why.trim().is_empty() {
            let message = format!("{} = \"\", expected what destroyed it", info.name);
            return Err(source.error(&name.span(), message));
        }
        Ok((info.name, quoted(why).to_string()))
    });
    each.collect()
}

fn rate(source: &Source, value: &Spanned<f64>, key: &str) -> Result<f64, ScenarioError> {
    let number = *value.get_ref();
    if number > 0.0 && number <= RATE_MOST_HZ {
        return Ok(number);
    }
    let found = files::number(number);
    let message = format!("{key} = {found}, expected a positive number, at most {RATE_MOST_HZ}");
    Err(source.error(&value.span(), message))
}

/// A name against a pattern with `*` for any text.
fn is_like(name: &str, pattern: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or("");
    let Some(mut rest) = name.strip_prefix(first) else { return false };
    let mut last = None;
    for part in parts {
        if let Some(middle) = last.replace(part) {
            let Some(at) = rest.find(middle) else { return false };
            rest = rest.get(at + middle.len()..).unwrap_or("");
        }
    }
    match last {
        Some(last) => rest.ends_with(last),
        None => rest.is_empty(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str, file: &str) -> Result<Layout, String> {
        let source = Source::from_text(Path::new("map.toml"), text);
        let mapping: Mapping = source.parse().map_err(|error| error.to_string())?;
        mapping.layout(&source, Path::new(file)).map_err(|error| error.to_string())
    }

    #[test]
    fn what_a_mapping_does_not_say_is_this_projects_own() {
        assert_eq!(layout("", "a.csv").unwrap(), Layout::own());
        let own = Layout::own();
        assert!(own.own_columns && own.time.column == "time_s" && own.force.len() == 1);
        let named = layout("mapping_for = \"a.csv\"\nspecimen = \"damper 7\"\n", "a.csv").unwrap();
        assert_eq!(named.specimen.as_deref(), Some("damper 7"));
        assert_eq!(Layout { specimen: None, ..named }, own);
    }

    #[test]
    fn a_file_table_lies_over_the_top() {
        let text = "extension = \"negative\"\n[displacement]\ncolumn = \"x\"\nunit = \"mm\"\n\
            [[file]]\nnamed = \"*quake.csv\"\nextension = \"positive\"\n\
            force_column = [\"a\", \"b\"]\nforce = { unit = \"kN\" }\n";
        let plain = layout(text, "dir/sine.csv").unwrap();
        assert_eq!((plain.extension, plain.force.len()), (Some(Extension::Negative), 1));
        let quake = layout(text, "dir/earthquake.csv").unwrap();
        assert_eq!(quake.extension, Some(Extension::Positive));
        assert_eq!(quake.displacement, plain.displacement);
        assert_eq!(quake.force[1].column, "b");
        assert_eq!(quake.force[1].unit.unwrap().si(1.0), 1000.0);
    }

    #[test]
    fn a_file_table_says_what_its_own_processing_destroyed() {
        let text = "[destroyed]\nforce_offset = \"zero mean\"\n[[file]]\nnamed = \"q*\"\n\
            destroyed = { clearance_impact = \"smoothed\" }\n";
        let of = |file| layout(text, file).unwrap().destroyed.into_iter().collect::<Vec<_>>();
        assert_eq!(of("a.csv"), [("force_offset", "zero mean".to_owned())]);
        assert_eq!(of("q.csv"), [("clearance_impact", "smoothed".to_owned())]);
    }

    #[test]
    fn one_column_was_taken_for_two_signals() {
        for (text, said) in [
            (
                "[force]\ncolumn = \"displacement_m\"\n",
                "map.toml:2: column \"displacement_m\" for displacement and force, expected a \
                 column for each",
            ),
            (
                "[displacement]\ncolumn = \"a\"\n[temperature]\ncolumn = \"force_n\"\n",
                "map.toml:4: column \"force_n\" for force and temperature, expected",
            ),
            (
                "force_column = [\"a\", \"time_s\"]\n",
                "map.toml:1: column \"time_s\" for time and force, expected",
            ),
            (
                "[displacement]\ncolumn = \"force_n\"\n",
                "map.toml:2: column \"force_n\" for displacement and force, expected",
            ),
        ] {
            let found = layout(text, "a.csv").unwrap_err();
            assert!(found.starts_with(said), "{found}");
        }
        let without_time = "sample_rate_hz = 500\n[displacement]\ncolumn = \"time_s\"\n";
        assert!(layout(without_time, "a.csv").is_ok());
    }

    #[test]
    fn patterns_match_whole_names() {
        for (name, pattern, fits) in [
            ("a.csv", "a.csv", true),
            ("ba.csv", "a.csv", false),
            ("a.csvx", "a.csv", false),
            ("x_quake_1.csv", "*quake*", true),
            ("x_quake_1.csv", "x*1.csv", true),
            ("x_quake_1.csv", "x*2*.csv", false),
            ("aa", "a*a", true),
            ("a", "a*a", false),
        ] {
            assert_eq!(is_like(name, pattern), fits, "{name} {pattern}");
        }
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_line() {
        for (text, line) in [
            ("\nunit = \"mm\"\n", "map.toml:2: unknown field `unit`"),
            ("[force]\nunit = \"mn\"\n", "map.toml:2: unit = \"mn\", expected one of N, kN"),
            ("[force]\nscale = 0\n", "map.toml:2: scale = 0, expected a finite number, not 0"),
            ("[force]\n\nsign = 2\n", "map.toml:3: sign = 2, expected 1 or -1"),
            ("[time]\noffset = nan\n", "map.toml:2: offset = NaN, expected a finite number"),
            ("sample_rate_hz = 0\n", "map.toml:1: sample_rate_hz = 0, expected a positive"),
            ("sample_rate_hz = 9\n[time]\nunit = \"s\"", "map.toml:1: sample_rate_hz and"),
            ("separator = \"space\"\n", "map.toml:1: unknown variant `space`"),
            ("[[file]]\nunits_row = true\n", "map.toml: [[file]] without named"),
            ("force_column = []\n", "map.toml:1: force_column is empty"),
            (
                "[destroyed]\nnoise = \"x\"\n",
                "map.toml:2: no effect \"noise\", expected one of seal",
            ),
            ("[destroyed]\nforce_offset = \" \"\n", "map.toml:2: force_offset = \"\", expected"),
            (
                "[[file]]\nnamed = \"a*\"\nmapping_for = \"a.csv\"\n",
                "map.toml: mapping_for in a [[file]] table",
            ),
            ("[on_mass]\nperiod_samples = 3\n", "map.toml:1: period_samples = 3, expected 16"),
            ("[on_mass]\nstart = \"periodic\"\n", "map.toml:1: start = \"periodic\" without"),
            ("[on_mass]\ninter_sample = \"x\"\n", "map.toml:2: unknown variant `x`"),
            (
                "sample_rate_hz = 1e308\n",
                "map.toml:1: sample_rate_hz = 1e308, expected a positive number, at most 1000000",
            ),
            ("[force]\nsign = 1e308\n", "map.toml:2: sign = 1e308, expected 1 or -1"),
            ("named = \"*\"\n", "map.toml: named belongs in a [[file]] table"),
        ] {
            let found = layout(text, "a.csv").unwrap_err();
            assert!(found.starts_with(line), "{found} / {line}");
        }
    }
}
