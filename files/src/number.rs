//! A number inside a message: short, whatever its size.

use std::fmt;

/// More digits than this are rounded away: they are noise of a calculation, not what a user wrote.
const DIGITS_MAX: usize = 10;
/// Significant digits of what is rounded.
const DIGITS_ROUNDED: usize = 6;

/// A number that prints in a few characters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(f64);

/// Shows a number: as a user writes it where that is short, else with six significant digits; very
/// large and very small ones with an exponent.
///
/// ```
/// let shown = |value: f64| files::number(value).to_string();
/// assert_eq!([shown(-65440.0), shown(12.5e6), shown(0.005)], ["-65440", "12500000", "0.005"]);
/// assert_eq!([shown(1e300), shown(1e-300), shown(1.0 / 3.0)], ["1e300", "1e-300", "0.333333"]);
/// ```
pub const fn number(value: f64) -> Number {
    Number(value)
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let exact = self.0;
        if exact == 0.0 || !exact.is_finite() {
            return write!(f, "{exact}");
        }
        let shortest = format!("{exact:e}");
        let digits = shortest.chars().take_while(|c| *c != 'e').filter(char::is_ascii_digit);
        let value = if digits.count() > DIGITS_MAX {
            let rounded = format!("{exact:.*e}", DIGITS_ROUNDED - 1);
            rounded.parse().unwrap_or(exact)
        } else {
            exact
        };
        if (1e-4..1e9).contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:e}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_takes_a_line() {
        let extreme = [f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.1 + 0.2, 1e22 / 3.0, 1e9 / 3.0];
        for value in extreme.into_iter().flat_map(|value| [value, -value]) {
            let shown = number(value).to_string();
            assert!(shown.len() <= 13, "{shown}");
        }
        assert_eq!(number(0.1 + 0.2).to_string(), "0.3");
        assert_eq!(number(999_999_999.999_999).to_string(), "1e9");
        assert_eq!(number(f64::NAN).to_string(), "NaN");
        assert_eq!(number(f64::INFINITY).to_string(), "inf");
        assert_eq!(number(-0.0).to_string(), "-0");
    }
}
