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
    /// A unit of the signal and not of what was measured: volts, counts.
    pub(crate) raw: Option<String>,
}

/// Units of signals, in small letters.
const RAW: [&str; 22] = [
    "v", "mv", "uv", "volt", "volts", "mv/v", "v/v", "ma", "pc", "count", "counts", "cts", "digit",
    "digits", "bit", "bits", "lsb", "raw", "adc", "inc", "ticks", "%",
];

/// Words of a kind, in small letters; a word matches whole, or as a part of a longer word where it
/// has at least five letters.
const WORDS: [(Kind, &[&str]); 5] = [
    (
        Kind::Time,
        &[
            "time",
            "t",
            "x",
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
            "čas",
            "czas",
            "tid",
            "tijd",
            "aika",
            "время",
            "时间",
            "時間",
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
            "dráha",
            "zdvih",
            "przemieszczenie",
            "slag",
            "verplaatsing",
            "перемещение",
            "位移",
            "行程",
            "変位",
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
            "síla",
            "siła",
            "kracht",
            "voima",
            "усилие",
            "сила",
            "力",
            "阻尼力",
            "载荷",
            "荷重",
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
            "rychlost",
            "prędkość",
            "snelheid",
            "скорость",
            "速度",
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
            "teplota",
            "температура",
            "温度",
            "tc",
            "t",
        ],
    ),
];

/// Words that end a compound: `Prüfzeit`, `Standardweg`.
const ENDS: [&str; 3] = ["zeit", "weg", "hub"];

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
    let raw = raw_unit(name, units_row);
    let (words, in_name) = match &raw {
        Some((words, _)) => (words.clone(), None),
        None => split(name),
    };
    let words: Vec<String> = words
        .to_lowercase()
        .split(|c: char| !c.is_alphabetic() && c != '\'')
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect();
    if words.iter().any(|word| OTHER.contains(&word.as_str())) {
        return None;
    }
    // The column of time in measurement files of LabVIEW.
    if name.trim().eq_ignore_ascii_case("x_value") {
        return Some(Header { kind: Kind::Time, unit: None, raw: None });
    }
    // A format of the time is no unit: `HH:MM:SS`.
    let is_unit = |unit: &&str| !unit.trim().is_empty() && !unit.to_lowercase().contains("mm:ss");
    let unit_in_row = || units_row.filter(is_unit);
    // The unit decides between kinds that the words allow: `temps (s)`, `s (mm)`, `t [degC]`.
    if let Some(said) = in_name.as_deref().or_else(unit_in_row).filter(|_| raw.is_none()) {
        let fits = |kind: &Kind| kind.unit(said).map(|unit| (*kind, unit));
        // A unit in brackets alone is a name too.
        let allowed = if words.is_empty() && in_name.is_some() {
            vec![Kind::Time, Kind::Displacement, Kind::Velocity, Kind::Force]
        } else {
            kinds(&words)
        };
        let (kind, unit) = allowed.iter().find_map(fits)?;
        return Some(Header { kind, unit: Some((said.trim().to_owned(), unit)), raw: None });
    }
    // Letters alone say too little, but for signs that are words.
    let is_word = |word: &String| word.chars().count() > 1 || !word.is_ascii();
    let long: Vec<String> = words.into_iter().filter(is_word).collect();
    let raw = raw.map(|(_, unit)| unit);
    kinds(&long).first().map(|kind| Header { kind: *kind, unit: None, raw })
}

/// A name without the unit of the signal, and that unit: `Force [V]`, `load_mV`, or `V` below it.
fn raw_unit(name: &str, units_row: Option<&str>) -> Option<(String, String)> {
    let is_raw = |text: &str| {
        let small = text.trim().trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']);
        RAW.contains(&small.to_lowercase().replace(['\u{b5}', '\u{3bc}'], "u").as_str())
    };
    // A unit below the name is that of the values.
    if units_row.is_some_and(is_unit) {
        return None;
    }
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let (Some(from), Some(to)) = (name.rfind(open), name.rfind(close)) else { continue };
        let Some((before, inside)) = name.get(..from).zip(name.get(from + 1..to)) else { continue };
        if is_raw(inside) {
            return Some((before.to_owned(), inside.trim().to_owned()));
        }
    }
    for volts in ["_V", "_mV"] {
        if let Some(before) = name.trim().strip_suffix(volts) {
            return Some((before.to_owned(), volts.replace('_', "")));
        }
    }
    let unit = units_row.filter(|unit| is_raw(unit) && split(name).1.is_none())?;
    Some((name.to_owned(), unit.trim().to_owned()))
}

/// The kinds that words allow, the likeliest first.
fn kinds(words: &[String]) -> Vec<Kind> {
    let mut kinds = Vec::new();
    for whole in [true, false] {
        for (kind, known) in WORDS {
            let fits = |word: &String| {
                known.iter().any(|one| {
                    let inside = one.chars().count() >= 5 && word.contains(one);
                    let at_end = ENDS.contains(one) && word.ends_with(one);
                    word == one || (!whole && (inside || at_end))
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
        for (name, row, raw) in [
            ("Force [V]", None, Some("V")),
            ("Load cell (mV/V)", None, Some("mV/V")),
            ("Kraft_V", None, Some("V")),
            ("Kraft", Some("counts"), Some("counts")),
            ("Force (raw)", Some("kN"), None),
            ("Force V", Some("kN"), None),
        ] {
            let header = read(name, row).unwrap();
            assert_eq!((header.kind, header.raw.as_deref()), (Force, raw), "{name}");
        }
        assert_eq!(read("[s]", None).map(|header| header.kind), Some(Time));
        assert_eq!(read("Time", Some("HH:MM:SS")).map(|header| header.kind), Some(Time));
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
