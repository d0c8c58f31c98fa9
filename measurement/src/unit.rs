//! Units of laboratories, turned into SI: `si = factor * (reading + shift)`.
//!
//! A unit is found by its symbol (`kN`, `mm`, `in/s`), or by a name that a program writes (`Sec`,
//! `kip`, `inches`, `Newton`). Case matters only where it makes another unit: `mN` is not `MN`, and
//! `Ms` and `Mm`, which would be millions, are no units here.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Time, s.
    Time,
    /// Displacement, m.
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Force, N.
    Force,
    /// Temperature, degrees Celsius.
    Temperature,
    /// Acceleration, m/s2.
    Acceleration,
}

/// A unit of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    factor: f64,
    shift: f64,
}

type Named = (&'static str, f64);

const TIME: &[Named] = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)];
const DISPLACEMENT: &[Named] =
    &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254)];
const VELOCITY: &[Named] =
    &[("m/s", 1.0), ("cm/s", 1e-2), ("mm/s", 1e-3), ("um/s", 1e-6), ("in/s", 0.0254)];
/// Pound-force and kilogram-force by the standard acceleration 9.80665 m/s2.
const FORCE: &[Named] = &[
    ("N", 1.0),
    ("kN", 1e3),
    ("MN", 1e6),
    ("daN", 10.0),
    ("lbf", 4.448_221_615_260_5),
    ("kgf", 9.806_65),
    ("kip", 4_448.221_615_260_5),
    ("tonf", TONF_N),
    ("mN", 1e-3),
];
const TEMPERATURE: &[Named] = &[("degC", 1.0), ("degF", 5.0 / 9.0), ("K", 1.0)];

/// The metric ton-force; that of 2000 pounds is 9 % less.
const TONF_N: f64 = 9_806.65;

/// Other names of times, in small letters.
const TIME_NAMES: &[Named] = &[
    ("sec", 1.0),
    ("secs", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("sek", 1.0),
    ("sekunde", 1.0),
    ("sekunden", 1.0),
    ("seconde", 1.0),
    ("secondes", 1.0),
    ("msec", 1e-3),
    ("msecs", 1e-3),
    ("msek", 1e-3),
    ("millisec", 1e-3),
    ("millisecs", 1e-3),
    ("millis", 1e-3),
    ("millisecond", 1e-3),
    ("milliseconds", 1e-3),
    ("millisekunde", 1e-3),
    ("millisekunden", 1e-3),
    ("milliseconde", 1e-3),
    ("millisecondes", 1e-3),
    ("usec", 1e-6),
    ("usecs", 1e-6),
    ("microsec", 1e-6),
    ("microsecond", 1e-6),
    ("microseconds", 1e-6),
    ("mikrosekunden", 1e-6),
    ("ns", 1e-9),
    ("nsec", 1e-9),
    ("nanosecond", 1e-9),
    ("nanoseconds", 1e-9),
    ("mins", 60.0),
    ("minute", 60.0),
    ("minutes", 60.0),
    ("minuten", 60.0),
    ("h", 3600.0),
    ("hr", 3600.0),
    ("hrs", 3600.0),
    ("hour", 3600.0),
    ("hours", 3600.0),
    ("stunden", 3600.0),
    ("heures", 3600.0),
    ("d", 86_400.0),
    ("day", 86_400.0),
    ("days", 86_400.0),
];
/// Other names of lengths.
const LENGTH_NAMES: &[Named] = &[
    ("meter", 1.0),
    ("meters", 1.0),
    ("metre", 1.0),
    ("metres", 1.0),
    ("centimeter", 1e-2),
    ("centimeters", 1e-2),
    ("centimetre", 1e-2),
    ("centimetres", 1e-2),
    ("millimeter", 1e-3),
    ("millimeters", 1e-3),
    ("millimetre", 1e-3),
    ("millimetres", 1e-3),
    ("micron", 1e-6),
    ("microns", 1e-6),
    ("micrometer", 1e-6),
    ("micrometers", 1e-6),
    ("micrometre", 1e-6),
    ("micrometres", 1e-6),
    ("mikrometer", 1e-6),
    ("nm", 1e-9),
    ("inch", 0.0254),
    ("inches", 0.0254),
    ("ins", 0.0254),
    ("\"", 0.0254),
    ("\u{2033}", 0.0254),
    ("zoll", 0.0254),
    ("pouce", 0.0254),
    ("pouces", 0.0254),
    ("mil", 2.54e-5),
    ("mils", 2.54e-5),
    ("thou", 2.54e-5),
    ("ft", 0.3048),
    ("foot", 0.3048),
    ("feet", 0.3048),
];
/// Velocities that are not a length over a time.
const VELOCITY_NAMES: &[Named] = &[
    ("ips", 0.0254),
    ("fps", 0.3048),
    ("mps", 1.0),
    ("mmps", 1e-3),
    ("km/h", 1.0 / 3.6),
    ("kmh", 1.0 / 3.6),
    ("kph", 1.0 / 3.6),
    ("mph", 0.447_04),
];
const FORCE_NAMES: &[Named] = &[
    ("newton", 1.0),
    ("newtons", 1.0),
    ("kilonewton", 1e3),
    ("kilonewtons", 1e3),
    ("meganewton", 1e6),
    ("meganewtons", 1e6),
    ("millinewton", 1e-3),
    ("millinewtons", 1e-3),
    ("decanewton", 10.0),
    ("decanewtons", 10.0),
    ("lb", 4.448_221_615_260_5),
    ("lbs", 4.448_221_615_260_5),
    ("lbsf", 4.448_221_615_260_5),
    ("lb-f", 4.448_221_615_260_5),
    ("lb_f", 4.448_221_615_260_5),
    ("lb.", 4.448_221_615_260_5),
    ("lbs.", 4.448_221_615_260_5),
    ("pound", 4.448_221_615_260_5),
    ("pounds", 4.448_221_615_260_5),
    ("pound-force", 4.448_221_615_260_5),
    ("pounds-force", 4.448_221_615_260_5),
    ("pound force", 4.448_221_615_260_5),
    ("kips", 4_448.221_615_260_5),
    ("klbf", 4_448.221_615_260_5),
    ("klb", 4_448.221_615_260_5),
    ("klbs", 4_448.221_615_260_5),
    ("kipf", 4_448.221_615_260_5),
    ("ozf", 0.278_013_850_953_781_2),
    ("gf", 9.806_65e-3),
    ("kg", 9.806_65),
    ("kgs", 9.806_65),
    ("kg-f", 9.806_65),
    ("kg_f", 9.806_65),
    ("kgforce", 9.806_65),
    ("kilogram", 9.806_65),
    ("kilograms", 9.806_65),
    ("kilogram-force", 9.806_65),
    ("kp", 9.806_65),
    ("kilopond", 9.806_65),
    ("tf", TONF_N),
    ("ton", TONF_N),
    ("tons", TONF_N),
    ("tonne", TONF_N),
    ("tonnes", TONF_N),
    ("tonsf", TONF_N),
    ("ton-force", TONF_N),
    ("tonne-force", TONF_N),
    ("ustonf", 8_896.443_230_521),
    ("us tonf", 8_896.443_230_521),
    ("uktonf", 9_964.016_418_183_52),
    ("uk tonf", 9_964.016_418_183_52),
];
const TEMPERATURE_NAMES: &[Named] = &[
    ("c", 1.0),
    ("celsius", 1.0),
    ("degcelsius", 1.0),
    ("degc.", 1.0),
    ("f", 5.0 / 9.0),
    ("fahrenheit", 5.0 / 9.0),
    ("degfahrenheit", 5.0 / 9.0),
    ("kelvin", 1.0),
    ("degk", 1.0),
];
/// Standard gravity is 9.80665 m/s2.
const ACCELERATION: &[Named] =
    &[("m/s2", 1.0), ("m/s^2", 1.0), ("mm/s2", 1e-3), ("g", 9.806_65), ("mg", 9.806_65e-3)];

impl Kind {
    /// The channels of a record of a damper.
    pub(crate) const ALL: [Self; 5] =
        [Self::Time, Self::Displacement, Self::Velocity, Self::Force, Self::Temperature];

    /// Its name in messages and mappings.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Force => "force",
            Self::Temperature => "temperature",
            Self::Acceleration => "acceleration",
        }
    }

    /// Its unit in this project.
    pub(crate) const fn si_name(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Force => "N",
            Self::Temperature => "degC",
            Self::Acceleration => "m/s2",
        }
    }

    const fn table(self) -> &'static [Named] {
        match self {
            Self::Time => TIME,
            Self::Displacement => DISPLACEMENT,
            Self::Velocity => VELOCITY,
            Self::Force => FORCE,
            Self::Temperature => TEMPERATURE,
            Self::Acceleration => ACCELERATION,
        }
    }

    const fn other_names(self) -> &'static [Named] {
        match self {
            Self::Time => TIME_NAMES,
            Self::Displacement => LENGTH_NAMES,
            Self::Velocity => VELOCITY_NAMES,
            Self::Force => FORCE_NAMES,
            Self::Temperature => TEMPERATURE_NAMES,
            Self::Acceleration => &[],
        }
    }

    /// Names of the units that it knows.
    pub(crate) fn names(self) -> String {
        let names: Vec<&str> = self.table().iter().map(|(name, _)| *name).collect();
        names.join(", ")
    }

    /// The symbol of a unit, if it has one here.
    pub(crate) fn symbol(self, name: &str) -> Option<&'static str> {
        let plain = plain(name);
        let alike = |(symbol, _): &&Named| symbol.eq_ignore_ascii_case(&plain);
        let exact = self.table().iter().find(|(symbol, _)| *symbol == plain);
        exact.or_else(|| self.table().iter().find(alike)).map(|(symbol, _)| *symbol)
    }

    /// The unit of this name, as programs spell it.
    pub(crate) fn unit(self, name: &str) -> Option<Unit> {
        let plain = plain(name);
        let factor = match self.simple(&plain) {
            Some((_, factor)) => factor,
            None if self == Self::Velocity => quotient(&plain)?,
            None => return None,
        };
        let small = plain.to_lowercase();
        let shift = match (self, small.trim_start_matches("deg")) {
            (Self::Temperature, "f" | "fahrenheit") => -32.0,
            (Self::Temperature, "k" | "kelvin") => -273.15,
            _ => 0.0,
        };
        Some(Unit { factor, shift })
    }

    /// A unit that is one name.
    fn simple(self, plain: &str) -> Option<Named> {
        if let Some(found) = self.table().iter().find(|(name, _)| *name == plain) {
            return Some(*found);
        }
        // A capital M before a small letter is mega: Mm and Ms are not mm and ms.
        let mega = plain.starts_with("Mm") || plain == "Ms";
        let small = plain.to_lowercase();
        if mega || (small == "mn" && plain != "MN") {
            return None;
        }
        let alike = |(name, _): &&Named| name.to_lowercase() == small;
        self.table().iter().find(alike).or_else(|| self.other_names().iter().find(alike)).copied()
    }
}

/// A unit's text without brackets and blanks, with the signs for micro, degree and powers as
/// letters.
fn plain(name: &str) -> String {
    let brackets = ['[', ']', '(', ')', '{', '}', '<', '>'];
    let plain = name.trim().trim_matches(brackets).trim();
    let plain = plain.replace(['µ', 'μ'], "u").replace("Â", "").replace('℃', "degC");
    let plain = plain.replace('℉', "degF").replace(['°', 'º'], "deg");
    let small = plain.to_lowercase();
    for word in ["degrees ", "degree ", "grad ", "deg. ", "deg ", "deg_"] {
        // Lower case of these letters has their length.
        if let Some(rest) = small.strip_prefix(word) {
            return format!("deg{}", plain.get(plain.len() - rest.len()..).unwrap_or(rest));
        }
    }
    plain
}

/// A length over a time: `mm/sec`, `in per s`, `m.s-1`, `mm·s⁻¹`.
fn quotient(plain: &str) -> Option<f64> {
    let plain = plain.replace("⁻¹", "-1").replace(['^', '*', '·', '.'], " ");
    let (length, time) = match plain.split_once('/').or_else(|| plain.split_once(" per ")) {
        Some(pair) => pair,
        None => plain.strip_suffix("-1")?.trim().rsplit_once(' ')?,
    };
    let (_, length) = Kind::Displacement.simple(length.trim())?;
    let (_, time) = Kind::Time.simple(time.trim())?;
    Some(length / time)
}

impl Unit {
    /// The unit that this project uses.
    pub(crate) const SI: Self = Self { factor: 1.0, shift: 0.0 };

    /// A reading in the project's unit.
    pub(crate) fn si(self, reading: f64) -> f64 {
        self.factor * (reading + self.shift)
    }

    /// Size of a difference of one in the project's unit.
    pub(crate) fn factor(self) -> f64 {
        self.factor
    }

    /// What has to be said about a unit that others read as another one.
    pub(crate) fn remark(self) -> Option<&'static str> {
        (self.factor == TONF_N)
            .then_some("a ton-force is taken as 1000 kgf; the one of 2000 lbf is unit = \"ustonf\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_unit_is_found_by_its_own_name() {
        for kind in Kind::ALL.into_iter().chain([Kind::Acceleration]) {
            for (name, factor) in kind.table() {
                assert_eq!(kind.unit(name).unwrap().factor(), *factor);
                assert!(kind.names().contains(name));
            }
            for (name, factor) in kind.other_names() {
                assert_eq!(kind.unit(name).unwrap().factor(), *factor, "{name}");
                assert_eq!(*name, name.to_lowercase());
            }
            assert_eq!(kind.unit("furlong"), None);
            assert_eq!(kind.unit(""), None);
        }
    }

    #[test]
    fn laboratory_spellings_mean_what_they_say() {
        assert_eq!(Kind::Force.unit("[kN]").unwrap().si(18.0), 18.0e3);
        assert_eq!(Kind::Temperature.unit("°F").unwrap().si(68.0), 20.0);
        assert_eq!(Kind::Displacement.unit("µm").unwrap().si(1e6), 1.0);
        assert_eq!(Kind::Displacement.unit(" (mm) ").unwrap().si(25.0), 0.025);
        assert!((Kind::Force.unit("lbf").unwrap().si(1000.0) - 4_448.221_615).abs() < 1e-6);
        assert_eq!(Kind::Temperature.unit("K").unwrap().si(293.15), 20.0);
        assert_eq!(Kind::Temperature.unit("° C").unwrap().si(20.0), 20.0);
        assert_eq!(Kind::Velocity.unit("mm/s").unwrap().si(250.0), 0.25);
    }

    #[test]
    fn units_as_programs_spell_them_were_refused() {
        for (kind, name, factor) in [
            (Kind::Time, "Sec", 1.0),
            (Kind::Time, "Seconds", 1.0),
            (Kind::Time, "msec", 1e-3),
            (Kind::Time, "MSEC", 1e-3),
            (Kind::Time, "S", 1.0),
            (Kind::Time, "hr", 3600.0),
            (Kind::Displacement, "MM", 1e-3),
            (Kind::Displacement, "inches", 0.0254),
            (Kind::Displacement, "Inch", 0.0254),
            (Kind::Displacement, "mils", 25.4e-6),
            (Kind::Velocity, "ips", 0.0254),
            (Kind::Velocity, "in/sec", 0.0254),
            (Kind::Velocity, "Inches/Second", 0.0254),
            (Kind::Velocity, "mm per sec", 1e-3),
            (Kind::Velocity, "mm·s⁻¹", 1e-3),
            (Kind::Velocity, "m s-1", 1.0),
            (Kind::Velocity, "m/min", 1.0 / 60.0),
            (Kind::Velocity, "MM/SEC", 1e-3),
            (Kind::Force, "KN", 1e3),
            (Kind::Force, "Newton", 1.0),
            (Kind::Force, "kip", 4_448.221_615_260_5),
            (Kind::Force, "Kips", 4_448.221_615_260_5),
            (Kind::Force, "lbs", 4.448_221_615_260_5),
            (Kind::Force, "LB", 4.448_221_615_260_5),
            (Kind::Force, "kg", 9.806_65),
            (Kind::Force, "tonf", 9_806.65),
            (Kind::Force, "DaN", 10.0),
            (Kind::Temperature, "F", 5.0 / 9.0),
            (Kind::Temperature, "DEG C", 1.0),
            (Kind::Temperature, "degrees F", 5.0 / 9.0),
            (Kind::Temperature, "Â°C", 1.0),
            (Kind::Temperature, "Celsius", 1.0),
        ] {
            let unit = kind.unit(name).unwrap_or_else(|| panic!("{name}"));
            assert!((unit.factor() / factor - 1.0).abs() < 1e-12, "{name}: {unit:?}");
        }
        assert_eq!(Kind::Temperature.unit("Fahrenheit").unwrap().si(68.0), 20.0);
        assert_eq!(Kind::Temperature.unit("Kelvin").unwrap().si(293.15), 20.0);
        assert!(
            Kind::Force.unit("t").is_none() && Kind::Force.unit("Tonf").unwrap().remark().is_some()
        );
    }

    #[test]
    fn case_counts_where_it_makes_another_unit() {
        assert_eq!(Kind::Force.unit("mN").unwrap().factor(), 1e-3);
        assert_eq!(Kind::Force.unit("MN").unwrap().factor(), 1e6);
        assert_eq!(Kind::Time.unit("ms").unwrap().factor(), 1e-3);
        for (kind, name) in [
            (Kind::Force, "mn"),
            (Kind::Force, "Mn"),
            (Kind::Time, "Ms"),
            (Kind::Displacement, "Mm"),
            (Kind::Velocity, "Mm/s"),
            (Kind::Velocity, "mm/Ms"),
            (Kind::Velocity, "mm"),
        ] {
            assert_eq!(kind.unit(name), None, "{name}");
        }
    }
}
