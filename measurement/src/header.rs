//! What the name of a column says: what it holds, and its unit.
//!
//! `Time (s)`, `Force [kN]`, `Zeit/s`, `Disp_mm`, `Weg in mm`, `Axial Displacement`, in English,
//! German, French, Italian and Spanish. A unit has to fit what the words say. A name with a word
//! such as command, error or peak is about something else.

use crate::unit::{Kind, Unit};

/// What a name says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// What the column holds.
    pub(crate) kind: Kind,
    /// The unit in the name, as it is written there.
    pub(crate) unit: Option<(String, Unit)>,
}

/// Words of a kind, in small letters; a word matches whole, or as a part of a longer word where it
/// has at least five letters.
const WORDS: [(Kind, &[&str]); 5] = [
    (
        Kind::Time,
        &[
            "time",
            "t",
            "zeit",
            "temps",
            "tempo",
            "tiempo",
            "timestamp",
            "timestamps",
            "date",
            "datum",
            "datetime",
            "uhrzeit",
            "elapsed",
            "clock",
            "laufzeit",
            "messzeit",
            "zeitstempel",
            "seconds",
            "sec",
            "secs",
            "heure",
            "horodatage",
        ],
    ),
    (
        Kind::Displacement,
        &[
            "displacement",
            "disp",
            "displ",
            "dis",
            "dist",
            "distance",
            "position",
            "pos",
            "stroke",
            "travel",
            "x",
            "s",
            "lvdt",
            "deflection",
            "extension",
            "elongation",
            "weg",
            "hub",
            "auslenkung",
            "verschiebung",
            "kolbenweg",
            "dämpferweg",
            "federweg",
            "déplacement",
            "deplacement",
            "course",
            "spostamento",
            "corsa",
            "desplazamiento",
            "carrera",
            "length",
        ],
    ),
    (
        Kind::Force,
        &[
            "force",
            "f",
            "load",
            "loadcell",
            "kraft",
            "dämpferkraft",
            "daempferkraft",
            "effort",
            "charge",
            "forza",
            "carico",
            "fuerza",
            "carga",
            "frc",
        ],
    ),
    (
        Kind::Velocity,
        &[
            "velocity",
            "vel",
            "v",
            "speed",
            "geschwindigkeit",
            "vitesse",
            "velocità",
            "velocita",
            "velocidad",
            "geschw",
        ],
    ),
    (
        Kind::Temperature,
        &[
            "temperature",
            "temp",
            "temperatur",
            "température",
            "temperatura",
            "thermocouple",
            "tc",
            "t",
        ],
    ),
];

/// Words of columns that hold something else than the measured signal.
const OTHER: [&str; 34] = [
    "command",
    "cmd",
    "commanded",
    "setpoint",
    "set",
    "soll",
    "sollwert",
    "target",
    "reference",
    "ref",
    "consigne",
    "error",
    "err",
    "peak",
    "valley",
    "max",
    "min",
    "maximum",
    "minimum",
    "mean",
    "avg",
    "average",
    "rms",
    "count",
    "counter",
    "segment",
    "cycle",
    "cycles",
    "index",
    "drive",
    "output",
    "valve",
    "filtered",
    "desired",
];

/// What a name says, with the unit of a row of units if there is one.
pub(crate) fn read(name: &str, units_row: Option<&str>) -> Option<Header> {
    let (words, in_name) = split(name);
    let words: Vec<String> = words
        .to_lowercase()
        .split(|c: char| !c.is_alphabetic() && c != '\'')
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect();
    if words.iter().any(|word| OTHER.contains(&word.as_str())) {
        return None;
    }
    let said = in_name.as_deref().or(units_row.filter(|unit| !unit.trim().is_empty()));
    // The column of time in measurement files of LabVIEW.
    if name.trim().eq_ignore_ascii_case("x_value") {
        return Some(Header { kind: Kind::Time, unit: None });
    }
    // The unit decides between kinds that the words allow: `temps (s)`, `s (mm)`, `t [degC]`.
    if let Some(said) = said {
        let fits = |kind: &Kind| kind.unit(said).map(|unit| (*kind, unit));
        if let Some((kind, unit)) = kinds(&words).iter().find_map(fits) {
            return Some(Header { kind, unit: Some((said.trim().to_owned(), unit)) });
        }
        return None;
    }
    // Letters alone say too little.
    let long: Vec<String> = words.into_iter().filter(|word| word.chars().count() > 1).collect();
    kinds(&long).first().map(|kind| Header { kind: *kind, unit: None })
}

/// The kinds that words allow, the likeliest first.
fn kinds(words: &[String]) -> Vec<Kind> {
    let mut kinds = Vec::new();
    for whole in [true, false] {
        for (kind, known) in WORDS {
            let fits = |word: &String| {
                known.iter().any(|one| {
                    let inside = one.chars().count() >= 5 && word.contains(one);
                    word == one || (!whole && inside)
                })
            };
            if words.iter().any(fits) && !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
    }
    kinds
}

/// A name without its unit, and the unit.
fn split(name: &str) -> (String, Option<String>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let (Some(from), Some(to)) = (name.rfind(open), name.rfind(close)) else { continue };
        let (before, inside) = (name.get(..from), name.get(from + 1..to));
        let Some((before, inside)) = before.zip(inside.filter(|inside| is_unit(inside))) else {
            continue;
        };
        let after = name.get(to + close.len_utf8()..).unwrap_or("");
        return (format!("{before} {after}"), Some(inside.trim().to_owned()));
    }
    // Without brackets: after a slash, a word `in`, a comma, a colon, an underscore or a blank.
    for mark in ["/", " in ", " en ", ",", ":", "|", ";", "_", "-", " "] {
        // The longest end that is a unit: `v_mm/s`, `v_m_per_s`.
        for (at, _) in name.match_indices(mark) {
            let (Some(before), Some(after)) = (name.get(..at), name.get(at + mark.len()..)) else {
                continue;
            };
            let spelled = after.replace("_per_", "/");
            if !before.is_empty() && is_unit(&spelled) {
                return (before.to_owned(), Some(spelled.trim().to_owned()));
            }
        }
    }
    (name.to_owned(), None)
}

fn is_unit(text: &str) -> bool {
    Kind::ALL.iter().any(|kind| kind.unit(text).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(name: &str) -> Option<(Kind, Option<f64>)> {
        read(name, None).map(|header| (header.kind, header.unit.map(|(_, unit)| unit.factor())))
    }

    #[test]
    fn names_as_laboratories_write_them_say_what_they_hold() {
        use Kind::{Displacement, Force, Temperature, Time, Velocity};
        for (name, kind, factor) in [
            ("Time (s)", Time, 1.0),
            ("Force [kN]", Force, 1e3),
            ("Zeit/s", Time, 1.0),
            ("Disp_mm", Displacement, 1e-3),
            ("Weg [mm]", Displacement, 1e-3),
            ("Weg in mm", Displacement, 1e-3),
            ("Kraft [kN]", Force, 1e3),
            ("displacement (in)", Displacement, 0.0254),
            ("friction force (kip)", Force, 4_448.221_615_260_5),
            ("velocity (in/s)", Velocity, 0.0254),
            ("time_ms", Time, 1e-3),
            ("t [s]", Time, 1.0),
            ("s [mm]", Displacement, 1e-3),
            ("F in kN", Force, 1e3),
            ("v (mm/s)", Velocity, 1e-3),
            ("Temps (s)", Time, 1.0),
            ("Déplacement (mm)", Displacement, 1e-3),
            ("Effort (daN)", Force, 10.0),
            ("Dämpferkraft kN", Force, 1e3),
            ("Oil Temp [°C]", Temperature, 1.0),
            ("T [degC]", Temperature, 1.0),
            ("Axial Force, kN", Force, 1e3),
            ("load_lbs", Force, 4.448_221_615_260_5),
            ("velocity_m_per_s", Velocity, 1.0),
            ("force_n", Force, 1.0),
            ("displacement_m", Displacement, 1.0),
            ("temperature_degc", Temperature, 1.0),
            ("Running Time(Sec)", Time, 1.0),
            ("Position (inches)", Displacement, 0.0254),
            ("Position (mm) Ch 1", Displacement, 1e-3),
        ] {
            let (found, unit) = said(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(found, kind, "{name}");
            assert!((unit.unwrap() / factor - 1.0).abs() < 1e-12, "{name}: {unit:?}");
        }
        assert_eq!(said("Axial Force"), Some((Force, None)));
        assert_eq!(said("Timestamp"), Some((Time, None)));
        let row = read("Axial Displacement", Some("mm")).unwrap();
        assert_eq!((row.kind, row.unit.unwrap().1.factor()), (Displacement, 1e-3));
    }

    #[test]
    fn names_that_say_something_else_say_nothing() {
        for name in [
            "Axial Force Command (kN)",
            "Cycle Count",
            "Force Peak [N]",
            "x",
            "F",
            "X 1",
            "Channel 1",
            "Force (mm)",
            "",
            "1",
            "current_A",
            "Time (V)",
        ] {
            assert!(
                said(name).is_none_or(|(_, unit)| unit.is_none() && name == "Time (V)"),
                "{name}"
            );
        }
    }
}
