//! The prefix that reads best: kN for 18 000 N, mm for 0.0035 m.

use report::significant;

/// A factor from SI and the unit with its prefix.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Prefixed {
    factor: f64,
    /// The unit with its prefix.
    pub(super) unit: String,
}

const PREFIXES: [(f64, &str); 5] = [(1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")];

impl Prefixed {
    /// For values up to this size, in an SI unit.
    pub(super) fn for_size(unit: &str, largest: f64) -> Self {
        let pretty = unit.replace("s2", "s²").replace("m2", "m²");
        // Seconds have no prefix above one, and compound units without a plain first unit have
        // none.
        let (upwards, downwards) = match unit.split([' ', '/']).next() {
            Some("N") => (true, true),
            Some("m" | "s") => (false, true),
            _ => (false, false),
        };
        let fits = |size: f64| {
            // Up to 2000 N the unit stays newton.
            let least = if size > 1.0 { 2.0 * size } else { size };
            largest.abs() >= least && (upwards || size <= 1.0) && (downwards || size >= 1.0)
        };
        let found = PREFIXES.iter().find(|(size, _)| fits(*size));
        let least = if downwards { 4 } else { 2 };
        let (size, prefix) = match found {
            Some(found) => *found,
            None if largest == 0.0 => PREFIXES[2],
            None => PREFIXES[least],
        };
        Self { factor: 1.0 / size, unit: format!("{prefix}{pretty}") }
    }

    /// For the largest of some values.
    pub(super) fn for_all<'a>(unit: &str, values: impl IntoIterator<Item = &'a f64>) -> Self {
        Self::for_size(unit, values.into_iter().fold(0.0, |most: f64, value| most.max(value.abs())))
    }

    /// One value.
    pub(super) fn value(&self, si: f64) -> f64 {
        si * self.factor
    }

    /// Many values.
    pub(super) fn values(&self, si: &[f64]) -> Vec<f64> {
        si.iter().map(|value| self.value(*value)).collect()
    }
}

/// A value in words: `155 N`, `1.02 MN s/m`.
pub(super) fn quantity(si: f64, unit: &str) -> String {
    let prefixed = Prefixed::for_size(unit, si);
    with_unit(significant(prefixed.value(si), 3), &prefixed.unit)
}

/// A value with its standard deviation: `155 ± 3 N`.
pub(super) fn uncertain(si: f64, std: Option<f64>, unit: &str) -> String {
    let Some(std) = std.filter(|std| *std > 0.0 && std.is_finite()) else {
        return quantity(si, unit);
    };
    let prefixed = Prefixed::for_size(unit, si.abs().max(std));
    let (value, std) = (prefixed.value(si), prefixed.value(std));
    // Two digits of a deviation that starts with a one, else one.
    let decade = libm::floor(libm::log10(std));
    let leading = std / libm::exp10(decade);
    let decimals = (if leading < 2.0 { 1.0 } else { 0.0 } - decade).clamp(0.0, 9.0) as usize;
    with_unit(format!("{value:.decimals$}\u{a0}±\u{a0}{std:.decimals$}"), &prefixed.unit)
}

fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { number } else { format!("{number}\u{a0}{unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With plain spaces.
    fn said(text: &str) -> String {
        text.replace('\u{a0}', " ")
    }

    #[test]
    fn quantities_read_as_they_are_said() {
        for (value, unit, expected) in [
            (155.0, "N", "155 N"),
            (18_012.0, "N", "18.0 kN"),
            (1500.0, "N", "1500 N"),
            (12.5e6, "N/m", "12.5 MN/m"),
            (1.02e6, "N s/m", "1020 kN s/m"),
            (3.46e-3, "m", "3.46 mm"),
            (0.176, "m/s", "176 mm/s"),
            (40e-6, "m", "40.0 µm"),
            (900.0, "s", "900 s"),
            (0.05, "1", "0.0500"),
            (2.0, "1/m", "2.00 1/m"),
            (3000.0, "N s2/m2", "3.00 kN s²/m²"),
            (0.0, "m", "0 m"),
            (1e-9, "m", "0.00100 µm"),
        ] {
            assert_eq!(said(&quantity(value, unit)), expected);
        }
    }

    #[test]
    fn a_deviation_says_how_many_digits_count() {
        for (value, std, unit, expected) in [
            (155.23, 3.1, "N", "155 ± 3 N"),
            (155.23, 1.44, "N", "155.2 ± 1.4 N"),
            (1.0e6, 2.0e3, "N s/m", "1000 ± 2 kN s/m"),
            (0.051_23, 0.000_4, "1", "0.0512 ± 0.0004"),
            (-2.0e-4, 2.3e-5, "m", "-200 ± 23 µm"),
        ] {
            assert_eq!(said(&uncertain(value, Some(std), unit)), expected);
        }
        assert_eq!(said(&uncertain(155.0, None, "N")), "155 N");
    }
}
