//! Values of options: their ranges, and what a value outside one is answered with.

use std::fmt;

/// A value that an option does not take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ValueError {
    expected: String,
}

impl ValueError {
    /// The error of a value, by what was expected instead.
    pub(crate) const fn new(expected: String) -> Self {
        Self { expected }
    }
}

impl fmt::Display for ValueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}", self.expected)
    }
}

impl std::error::Error for ValueError {}

/// Parses a finite number that a condition holds for; `expected` names it in the error.
pub(crate) fn number(
    expected: &'static str,
    holds: fn(f64) -> bool,
) -> impl Fn(&str) -> Result<f64, ValueError> + Clone + Send + Sync + 'static {
    move |text| match text.parse() {
        Ok(value) if f64::is_finite(value) && holds(value) => Ok(value),
        _ => Err(ValueError { expected: expected.to_owned() }),
    }
}

/// Parses a whole number from `low` to `high`.
pub(crate) fn whole<T: TryFrom<u64>>(
    low: u64,
    high: u64,
) -> impl Fn(&str) -> Result<T, ValueError> + Clone + Send + Sync + 'static {
    move |text| {
        let value = text.parse().ok().filter(|value| (low..=high).contains(value));
        let error = || ValueError { expected: format!("a whole number from {low} to {high}") };
        value.and_then(|value| T::try_from(value).ok()).ok_or_else(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_outside_their_range_are_refused_with_it() {
        let duration = number("a duration over 0 s", |s| s > 0.0);
        assert_eq!(duration("2.5"), Ok(2.5));
        for text in ["-1", "0", "nan", "inf", "1 s", ""] {
            let error = duration(text).unwrap_err();
            assert_eq!(error.to_string(), "expected a duration over 0 s", "{text}");
        }
        let cases = whole::<usize>(1, 20);
        assert_eq!(cases("20"), Ok(20));
        for text in ["0", "21", "-1", "1.5", "99999999999999999999"] {
            let error = cases(text).unwrap_err();
            assert_eq!(error.to_string(), "expected a whole number from 1 to 20", "{text}");
        }
        assert!(whole::<u8>(0, 1000)("300").is_err());
    }
}
