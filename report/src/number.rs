//! Numbers as people and files read them.

/// `value` with a number of significant digits: `0.01235`, `12.35`, `-1.2e-8`.
///
/// Digits before the decimal point are never dropped (a count stays a count); below 1e-4 and from
/// 1e9 on the exponent form is used, which spreadsheets read too.
///
/// ```
/// assert_eq!(report::significant(3.46159e-3, 3), "0.00346");
/// assert_eq!(report::significant(18_012.4, 4), "18012");
/// assert_eq!(report::significant(7.568e-5, 4), "7.568e-5");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return if value.is_nan() { "NaN".to_owned() } else { format!("{value}") };
    }
    let digits = digits.clamp(1, 17);
    let rounded = format!("{value:.*e}", digits - 1);
    let exponent = exponent_of(&rounded);
    if !(-4..9).contains(&exponent) {
        return rounded;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The decimal exponent of a value: 3 for 1234, -2 for 0.05. Exact, as the printed digits are.
pub(crate) fn decade(value: f64) -> i32 {
    exponent_of(&format!("{value:e}"))
}

fn exponent_of(printed: &str) -> i32 {
    printed.rsplit_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// `value` rounded to a number of decimals (which may be below zero: to tens, to hundreds).
pub(crate) fn round_to_decimals(value: f64, decimals: i32) -> f64 {
    if decimals >= 0 {
        let decimals = decimals as usize;
        return format!("{value:.decimals$}").parse().unwrap_or(value);
    }
    let digits_kept = decade(value) + decimals;
    if digits_kept < 0 {
        return 0.0;
    }
    format!("{value:.*e}", digits_kept as usize).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{decade, round_to_decimals, significant};

    #[test]
    fn tables_show_significant_digits() {
        for (value, digits, expected) in [
            (0.0, 4, "0"),
            (-0.0, 4, "0"),
            (18_012.4, 4, "18012"),
            (30_000.0, 3, "30000"),
            (9.9996, 4, "10.00"),
            (0.999_96, 4, "1.000"),
            (-1.234_56e-8, 3, "-1.23e-8"),
            (1.0e12, 2, "1.0e12"),
            (f64::NAN, 3, "NaN"),
            (f64::NEG_INFINITY, 3, "-inf"),
        ] {
            assert_eq!(significant(value, digits), expected, "{value}");
        }
    }

    #[test]
    fn decades_are_exact_at_powers_of_ten() {
        for exponent in -300..=300 {
            let power: f64 = format!("1e{exponent}").parse().expect("a number");
            assert_eq!(decade(power), exponent);
            assert_eq!(decade(-9.99 * power), exponent);
        }
    }

    #[test]
    fn rounding_takes_decimals_of_either_sign() {
        assert_eq!(round_to_decimals(12_345.678_9, 2), 12_345.68);
        assert_eq!(round_to_decimals(12_345.678_9, -2), 12_300.0);
        assert_eq!(round_to_decimals(12.0, -3), 0.0);
    }
}
