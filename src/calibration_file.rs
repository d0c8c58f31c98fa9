//! `calibration.toml`: what is known of a rig's load cell, its stiffness and its end mass.
//!
//! ```toml
//! format = 1
//! node = 1
//!
//! [bar]                                       # a rigid bar
//! date = "2026-11-29"
//! certificate = "K-2041"
//! stiffness_n_per_m = 90.9e6                  # from the displacement sensor to the ground
//! stiffness_error_n_per_m = 12e3
//! skew_s = 0.4e-3                             # how late the force is against the displacement
//! skew_error_s = 2e-6
//! residual = 1e-3
//!
//! [end_mass]                                  # a dry run
//! [load_cell]                                 # force = gain (reading - offset_n)
//! ```
//! Every part has the date and the certificate of its own day. A later calibration replaces its own
//! part and keeps the others. All `_error` values are standard errors.
//!
//! The stiffness is that of fixture and bar in series where the displacement is measured at the
//! ram, and of the bar alone where it is measured across the eyes. Which of them, this program is
//! not told. Files of earlier versions call the part `[fixture]`.

use crate::date::Date;
use crate::error::CommandError;
use can_protocol::Node;
use files::{number, quoted};
use hil_host::calibration::{BarFit, EndMassFit, GainFit, Reading};
use scenario::source::Source;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file of a calibration.
pub(crate) const CALIBRATION: &str = "calibration.toml";

/// Version of the file.
const FORMAT: u32 = 1;

/// Days by which the date of another time zone may be ahead.
const DAYS_AHEAD: i64 = 1;

/// A value of the file with its key.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Entry {
    key: &'static str,
    value: f64,
    /// Whether it is above zero; an error may be zero.
    is_size: bool,
}

impl Entry {
    fn is_wrong(&self) -> bool {
        let is_inside = if self.is_size { self.value > 0.0 } else { self.value >= 0.0 };
        !(is_inside && self.value.is_finite())
    }
}

/// What is known of a rig.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CalibrationFile {
    format: u32,
    node: u8,
    #[serde(alias = "fixture")]
    bar: Option<Bar>,
    end_mass: Option<EndMass>,
    load_cell: Option<LoadCell>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Bar {
    date: String,
    certificate: Option<String>,
    stiffness_n_per_m: f64,
    stiffness_error_n_per_m: f64,
    skew_s: f64,
    skew_error_s: f64,
    residual: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct EndMass {
    date: String,
    certificate: Option<String>,
    mass_kg: f64,
    mass_error_kg: f64,
    residual: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LoadCell {
    date: String,
    certificate: Option<String>,
    /// None where a zero is all that was read.
    gain: Option<f64>,
    gain_error: Option<f64>,
    /// None where a single reading leaves the offset open.
    offset_n: Option<f64>,
    offset_error_n: Option<f64>,
    reading: Vec<Reading>,
}

impl CalibrationFile {
    /// Nothing yet of a rig.
    pub(crate) fn empty(node: Node) -> Self {
        let node = node.number();
        Self { format: FORMAT, node, bar: None, end_mass: None, load_cell: None }
    }

    /// Reads the calibration of a rig with one of these nodes.
    ///
    /// # Errors
    /// A file that is none, or that of another rig.
    pub(crate) fn load(path: &Path, nodes: &[u8]) -> Result<Self, CommandError> {
        let source = Source::read(path)?;
        let file: Self = source.parse()?;
        let refused = |found: String, expected: String| {
            Err(CommandError::Input { file: path.to_owned(), found, expected })
        };
        if file.format != FORMAT {
            return refused(format!("format = {}", file.format), FORMAT.to_string());
        }
        if !nodes.contains(&file.node) {
            let known: Vec<String> = nodes.iter().map(u8::to_string).collect();
            return refused(
                format!("the calibration of node {}", file.node),
                format!("node {}", known.join(" or ")),
            );
        }
        if let Some(date) =
            file.dates().map(|(_, date)| date).find(|date| date.parse::<Date>().is_err())
        {
            return refused(
                format!("date = \"{}\"", quoted(date)),
                "a day such as 2026-11-29".to_owned(),
            );
        }
        let today = Date::today();
        let is_ahead =
            |date: &str| date.parse::<Date>().is_ok_and(|date| today.days_until(date) > DAYS_AHEAD);
        if let Some((part, date)) = file.dates().find(|(_, date)| is_ahead(date)) {
            return refused(
                format!("date = \"{}\" of the {part}", quoted(date)),
                "a day that has been".to_owned(),
            );
        }
        if let Some(Entry { key, value, is_size }) = file.values().find(Entry::is_wrong) {
            let expected = if is_size { "a number above 0" } else { "a number from 0 on" };
            return refused(format!("{key} = {}", number(value)), expected.to_owned());
        }
        if file.dates().next().is_none() {
            let expected = "[bar], [end_mass] or [load_cell]";
            return refused("no part".to_owned(), expected.to_owned());
        }
        Ok(file)
    }

    /// Its values that cannot have any sign, with their keys.
    fn values(&self) -> impl Iterator<Item = Entry> {
        let size = |key, value| Entry { key, value, is_size: true };
        let error = |key, value| Entry { key, value, is_size: false };
        let bar = self.bar.iter().flat_map(move |part| {
            [
                size("stiffness_n_per_m", part.stiffness_n_per_m),
                error("stiffness_error_n_per_m", part.stiffness_error_n_per_m),
                // A force may be early: its size says whether it is a number.
                error("skew_s", part.skew_s.abs()),
                error("skew_error_s", part.skew_error_s),
                error("residual", part.residual),
            ]
        });
        let end_mass = self.end_mass.iter().flat_map(move |part| {
            [
                error("mass_kg", part.mass_kg),
                error("mass_error_kg", part.mass_error_kg),
                error("residual", part.residual),
            ]
        });
        let load_cell = self.load_cell.iter().flat_map(move |part| {
            let values = [
                part.gain.map(|gain| size("gain", gain)),
                part.gain_error.map(|value| error("gain_error", value)),
                part.offset_n.map(|offset_n| error("offset_n", offset_n.abs())),
                part.offset_error_n.map(|value| error("offset_error_n", value)),
            ];
            values.into_iter().flatten()
        });
        bar.chain(end_mass).chain(load_cell)
    }

    /// With what a bar has shown today.
    pub(crate) fn with_bar(self, fit: &BarFit, certificate: Option<&str>) -> Self {
        let (date, certificate) = (Date::today().to_string(), certificate.map(str::to_owned));
        let BarFit {
            stiffness_n_per_m,
            stiffness_error_n_per_m,
            skew_s,
            skew_error_s,
            residual,
            ..
        } = *fit;
        let bar = Bar {
            date,
            certificate,
            stiffness_n_per_m,
            stiffness_error_n_per_m,
            skew_s,
            skew_error_s,
            residual,
        };
        Self { bar: Some(bar), ..self }
    }

    /// With the end mass as a dry run has shown it today.
    pub(crate) fn with_end_mass(self, fit: EndMassFit, certificate: Option<&str>) -> Self {
        let (date, certificate) = (Date::today().to_string(), certificate.map(str::to_owned));
        let EndMassFit { mass_kg, mass_error_kg, residual } = fit;
        let end_mass = EndMass { date, certificate, mass_kg, mass_error_kg, residual };
        Self { end_mass: Some(end_mass), ..self }
    }

    /// The readings of the load cell so far.
    pub(crate) fn readings(&self) -> Vec<Reading> {
        self.load_cell.iter().flat_map(|cell| &cell.reading).copied().collect()
    }

    /// With the load cell as these readings show it today, as far as they do.
    pub(crate) fn with_readings(
        self,
        fit: Option<GainFit>,
        readings: &[Reading],
        certificate: Option<&str>,
    ) -> Self {
        let (date, certificate) = (Date::today().to_string(), certificate.map(str::to_owned));
        let load_cell = LoadCell {
            date,
            certificate,
            gain: fit.map(|fit| fit.gain),
            gain_error: fit.map(|fit| fit.gain_error),
            offset_n: fit.and_then(|fit| fit.offset_error_n.map(|_| fit.offset_n)),
            offset_error_n: fit.and_then(|fit| fit.offset_error_n),
            reading: readings.to_vec(),
        };
        Self { load_cell: Some(load_cell), ..self }
    }

    /// The file.
    ///
    /// # Errors
    /// Never: every value has a form in TOML.
    pub(crate) fn to_toml(&self) -> Result<String, CommandError> {
        let text = toml::to_string(self)
            .map_err(|why| CommandError::File(CALIBRATION.into(), std::io::Error::other(why)))?;
        Ok(format!("# Written by yawbench characterise --calibrate.\n{text}"))
    }

    /// Parts with their dates.
    fn dates(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let bar = self.bar.iter().map(|part| ("stiffness by a bar", part.date.as_str()));
        let end_mass = self.end_mass.iter().map(|part| ("end mass", part.date.as_str()));
        let load_cell = self.load_cell.iter().map(|part| ("load cell", part.date.as_str()));
        bar.chain(end_mass).chain(load_cell)
    }

    /// One line for every part that is older than so many days.
    pub(crate) fn old(&self, days: f64) -> Vec<String> {
        let today = Date::today();
        let age = |(part, date): (&'static str, &str)| {
            let age_days = date.parse::<Date>().ok()?.days_until(today);
            (age_days as f64 > days).then(|| {
                let most = number(days);
                format!(
                    "the calibration of the {part} is of {date}, {age_days} days old, expected at \
                     most {most}"
                )
            })
        };
        self.dates().filter_map(age).collect()
    }

    /// The node of its rig.
    pub(crate) fn node(&self) -> u8 {
        self.node
    }

    /// One line for every part, for records.
    pub(crate) fn lines(&self) -> Vec<String> {
        let of = |date: &str, certificate: &Option<String>| match certificate {
            Some(certificate) => format!("{date}, certificate {certificate}"),
            None => date.to_owned(),
        };
        let bar = self.bar.as_ref().map(|part| {
            format!(
                "rigid bar of {}: {:.2} +- {:.2} MN/m from the displacement sensor to the ground \
                 (fixture and bar; across the eyes the bar alone), force {:.3} +- {:.3} ms late",
                of(&part.date, &part.certificate),
                1e-6 * part.stiffness_n_per_m,
                1e-6 * part.stiffness_error_n_per_m,
                1e3 * part.skew_s,
                1e3 * part.skew_error_s
            )
        });
        let end_mass = self.end_mass.as_ref().map(|part| {
            let of = of(&part.date, &part.certificate);
            format!("end mass of {of}: {:.3} +- {:.3} kg", part.mass_kg, part.mass_error_kg)
        });
        let load_cell = self.load_cell.as_ref().map(|part| {
            let known = |value: Option<f64>, error: Option<f64>| value.zip(error);
            let gain = match known(part.gain, part.gain_error) {
                Some((gain, error)) => format!("gain {gain:.5} +- {error:.5}"),
                None => "gain not known".to_owned(),
            };
            let offset = match known(part.offset_n, part.offset_error_n) {
                Some((offset_n, error_n)) => format!("offset {offset_n:.1} +- {error_n:.1} N"),
                None => "offset not known".to_owned(),
            };
            format!("load cell of {}: {gain}, {offset}", of(&part.date, &part.certificate))
        });
        bar.into_iter().chain(end_mass).chain(load_cell).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_keeps_its_other_parts_and_says_what_is_old() {
        let node = Node::ALL[0];
        let mass = EndMassFit { mass_kg: 10.0, mass_error_kg: 0.02, residual: 0.01 };
        let readings = [Reading { reference_n: 5000.0, reading_n: 4900.0, error_n: 1.0 }];
        let gain = GainFit::of(&readings).unwrap();
        let file = CalibrationFile::empty(node).with_end_mass(mass, Some("K-1")).with_readings(
            Some(gain),
            &readings,
            None,
        );
        let text = file.to_toml().unwrap();
        let read: CalibrationFile =
            Source::from_text(Path::new("calibration.toml"), &text).parse().unwrap();
        assert_eq!(read, file);
        assert_eq!(read.readings(), readings);
        assert_eq!(read.values().find(Entry::is_wrong), None);
        let lines = read.lines();
        assert!(lines[0].starts_with("end mass of ") && lines[0].contains("certificate K-1"));
        assert!(lines[1].contains("offset not known"), "{lines:?}");
        assert_eq!(file.old(1.0), Vec::<String>::new());
        let end_mass =
            file.end_mass.clone().map(|part| EndMass { date: "2001-02-03".to_owned(), ..part });
        let old = CalibrationFile { end_mass, ..file }.old(365.0);
        assert!(old.len() == 1 && old[0].contains("end mass is of 2001-02-03"), "{old:?}");
    }

    #[test]
    fn a_calibration_that_cannot_be_right_stood_in_the_report() {
        let name = format!("calibration-{}.toml", std::process::id());
        let path = std::env::temp_dir().join(name);
        let fixture = "format = 1\nnode = 1\n[bar]\ndate = \"2026-11-29\"\n\
                       stiffness_n_per_m = 90e6\nstiffness_error_n_per_m = 1e4\n\
                       skew_s = -4e-4\nskew_error_s = 2e-6\nresidual = 1e-3\n";
        let load = |text: &str| {
            std::fs::write(&path, text).unwrap();
            CalibrationFile::load(&path, &[1])
        };
        assert!(load(fixture).is_ok());
        for (from, to, found) in [
            ("90e6", "nan", "stiffness_n_per_m = NaN"),
            ("90e6", "-5.0", "stiffness_n_per_m = -5"),
            ("1e4", "inf", "stiffness_error_n_per_m = inf"),
            ("-4e-4", "nan", "skew_s = NaN"),
            ("1e-3", "-1.0", "residual = -1"),
            ("2026-11-29", "2099-01-01", "2099-01-01"),
        ] {
            let why = load(&fixture.replace(from, to)).unwrap_err().to_string();
            assert!(why.contains(found), "{why}");
        }
        let why = load("format = 1\nnode = 1\n").unwrap_err().to_string();
        assert!(why.contains("no part"), "{why}");
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_bar_is_not_taken_for_the_fixture_and_files_that_did_are_read() {
        let of = |part: &str| -> CalibrationFile {
            let text = format!(
                "format = 1\nnode = 1\n[{part}]\ndate = \"2026-11-29\"\nskew_s = 4e-4\n\
                 stiffness_n_per_m = 993e6\nstiffness_error_n_per_m = 1e4\nskew_error_s = 2e-6\n\
                 residual = 1e-3\n"
            );
            Source::from_text(Path::new("calibration.toml"), &text).parse().unwrap()
        };
        assert_eq!(of("bar"), of("fixture"));
        let said = of("bar").lines().concat();
        assert!(
            said.starts_with("rigid bar of 2026-11-29: 993.00 +- 0.01 MN/m from the"),
            "{said}"
        );
        assert!(said.contains("across the eyes the bar alone"), "{said}");
    }
}
