//! The text of a cell as a number.
//!
//! Digits may be grouped by threes, as spreadsheets of many countries write them: `4.201,73`,
//! `4 201,73`, `4'201.73`, `4,201.73`. A mark that does not stand between groups of three digits
//! makes the cell no number.

use crate::layout::Decimal;

/// Marks between groups of three digits in any country: blanks (plain, no-break, narrow no-break,
/// thin) and apostrophes.
const GROUP_MARKS: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];

/// A number and the size of its last digit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Number {
    pub(crate) value: f64,
    pub(crate) last_digit: f64,
}

impl Number {
    /// The number of a cell; not a number and infinities are numbers here. `declared` is false
    /// where nobody said that the decimal mark is a point: `4,201` alone may then be either.
    pub(crate) fn of(cell: &str, decimal: Decimal, declared: bool) -> Option<Self> {
        // The usual cell first: it needs no other text.
        if let (Decimal::Point, Ok(value)) = (decimal, cell.parse::<f64>()) {
            return Some(Self { value, last_digit: last_digit(cell) });
        }
        let plain = ungrouped(cell, decimal, declared)?;
        let value = plain.parse().ok()?;
        Some(Self { value, last_digit: last_digit(&plain) })
    }
}

/// Size of the last digit of a plain number; zero for what has no digits.
fn last_digit(plain: &str) -> f64 {
    let (mantissa, exponent) = match plain.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse().unwrap_or(0)),
        None => (plain, 0),
    };
    if !mantissa.contains(|c: char| c.is_ascii_digit()) {
        return 0.0;
    }
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    libm::pow(10.0, f64::from(exponent) - decimals as f64)
}

/// A number with a decimal point and without marks between its groups.
fn ungrouped(cell: &str, decimal: Decimal, declared: bool) -> Option<String> {
    let (sign, unsigned) = match cell.strip_prefix(['-', '\u{2212}']) {
        Some(rest) => ("-", rest),
        None => ("", cell.strip_prefix('+').unwrap_or(cell)),
    };
    let at = unsigned.find(['e', 'E', 'd', 'D']).unwrap_or(unsigned.len());
    let (mantissa, power) = unsigned.split_at_checked(at)?;
    let (mark, other) = match decimal {
        Decimal::Point => ('.', ','),
        Decimal::Comma => (',', '.'),
    };
    let (whole, decimals) = match mantissa.split_once(mark) {
        Some((whole, decimals)) => (whole, Some(decimals)),
        None => (mantissa, None),
    };
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if decimals.is_some_and(|decimals| !is_digits(decimals)) {
        return None;
    }
    let mut number = sign.to_owned();
    match whole.chars().find(|c| *c == other || GROUP_MARKS.contains(c)) {
        None => number.push_str(whole),
        Some(group) => {
            let groups: Vec<&str> = whole.split(group).collect();
            let (first, rest) = groups.split_first()?;
            let threes = rest.iter().all(|three| three.len() == 3 && is_digits(three));
            let leads = (1..=3).contains(&first.len()) && is_digits(first);
            // A group of thousands never begins with a zero: 0.125 is no number of thousands.
            if !threes || !leads || first.starts_with('0') {
                return None;
            }
            let either = group == other && decimals.is_none() && rest.len() == 1;
            if either && !declared {
                return None;
            }
            number.extend(groups);
        }
    }
    if let Some(decimals) = decimals {
        number.push('.');
        number.push_str(decimals);
    }
    if let Some(exponent) = power.get(1..) {
        number.push('e');
        number.push_str(exponent);
    }
    Some(number)
}

/// A number in a message with a fixed number of decimals; short where it is very large.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() < 1e12 {
        format!("{value:.decimals$}")
    } else {
        files::number(value).to_string()
    }
}

/// A time stamp in a message: with all its digits, unless there are hundreds of zeros.
pub(crate) fn of_stamp(stamp_s: f64) -> String {
    if stamp_s == 0.0 || (1e-9..1e15).contains(&stamp_s.abs()) {
        stamp_s.to_string()
    } else {
        files::number(stamp_s).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(cell: &str, decimal: Decimal) -> Option<f64> {
        Number::of(cell, decimal, true).map(|number| number.value)
    }

    #[test]
    fn thousands_are_read_as_every_country_writes_them() {
        for cell in [
            "4.201,73",
            "4201,73",
            "4 201,73",
            "4\u{a0}201,73",
            "4\u{202f}201,73",
            "4'201,73",
            "4\u{2019}201,73",
            "+4.201,73",
            "4,20173e3",
            "4,20173D+03",
        ] {
            assert_eq!(value(cell, Decimal::Comma), Some(4201.73), "{cell}");
        }
        for cell in ["4,201.73", "4201.73", "4 201.73", "4'201.73", "4.20173E3"] {
            assert_eq!(value(cell, Decimal::Point), Some(4201.73), "{cell}");
        }
        assert_eq!(value("-1.234.567,5", Decimal::Comma), Some(-1_234_567.5));
        assert_eq!(value("\u{2212}0,5", Decimal::Comma), Some(-0.5));
        assert_eq!(value(",5", Decimal::Comma), Some(0.5));
        assert_eq!(value("12.345", Decimal::Comma), Some(12345.0));
    }

    #[test]
    fn a_mark_that_separates_no_thousands_is_an_error() {
        for cell in [
            "0.125",
            "4.20,73",
            "42.01",
            "4.2010",
            "1234.567",
            "1.234.56",
            "1,5.000",
            "4 20",
            "4,,2",
            "1.234 567,8",
            "",
            "-",
            "1 ",
            "0.500,1",
        ] {
            assert_eq!(value(cell, Decimal::Comma), None, "{cell}");
        }
        assert_eq!(value("0,0010", Decimal::Point), None);
    }

    #[test]
    fn one_comma_may_be_either_until_it_is_declared() {
        let undeclared = |cell| Number::of(cell, Decimal::Point, false).map(|n| n.value);
        assert_eq!(undeclared("4,201"), None);
        assert_eq!(value("4,201", Decimal::Point), Some(4201.0));
        assert_eq!(undeclared("4,201.5"), Some(4201.5));
        assert_eq!(undeclared("1,234,567"), Some(1_234_567.0));
    }

    #[test]
    fn the_last_digit_is_that_of_each_number() {
        for (cell, digit) in [
            ("0.0003328", 1e-7),
            ("3.9923", 1e-4),
            ("12", 1.0),
            ("1e-05", 1e-5),
            ("1.50E-3", 1e-5),
            ("2.5e2", 10.0),
        ] {
            let found = Number::of(cell, Decimal::Point, false).unwrap().last_digit;
            assert!((found / digit - 1.0).abs() < 1e-12, "{cell}: {found}");
        }
        assert_eq!(Number::of("1.234,5", Decimal::Comma, true).unwrap().last_digit, 0.1);
        assert_eq!(Number::of("NaN", Decimal::Point, true).unwrap().last_digit, 0.0);
    }
}
