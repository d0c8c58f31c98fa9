//! A day of the calendar, in UTC.
//!
//! Days since 1970-01-01 to a date of the Gregorian calendar and back, by Howard Hinnant's
//! algorithms (chrono-compatible low-level date algorithms, 2013): years begin in March, so that
//! the leap day is their last.

use std::fmt;
use std::str::FromStr;
use std::time::{SystemTime, UNIX_EPOCH};

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Date {
    days: i64,
}

impl Date {
    /// Today; the first day of 1970 where the clock stands before it.
    pub(crate) fn today() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { days: (since.as_secs() / 86_400).cast_signed() }
    }

    /// Days from this one to a later one.
    pub(crate) const fn days_until(self, later: Self) -> i64 {
        later.days - self.days
    }

    const fn of(year: i64, month: i64, day: i64) -> Self {
        let year = if month <= 2 { year - 1 } else { year };
        let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
        let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
        let days = of_era * 365 + of_era / 4 - of_era / 100 + of_year;
        Self { days: era * 146_097 + days - 719_468 }
    }

    const fn calendar(self) -> (i64, i64, i64) {
        let days = self.days + 719_468;
        let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
        let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year + year / 4 - year / 100);
        let month = (5 * of_year + 2) / 153;
        let day = of_year - (153 * month + 2) / 5 + 1;
        let month = if month < 10 { month + 3 } else { month - 9 };
        let year = year + era * 400 + if month <= 2 { 1 } else { 0 };
        (year, month, day)
    }
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (year, month, day) = self.calendar();
        write!(f, "{year:04}-{month:02}-{day:02}")
    }
}

impl FromStr for Date {
    type Err = ();

    /// Reads `2026-11-29`.
    fn from_str(text: &str) -> Result<Self, ()> {
        let numbers: Vec<i64> =
            text.split('-').map(|part| part.parse().map_err(|_| ())).collect::<Result<_, _>>()?;
        let [year, month @ 1..=12, day @ 1..=31] = numbers[..] else { return Err(()) };
        let date = Self::of(year, month, day);
        // The 30th of February is no day.
        if date.to_string() == text { Ok(date) } else { Err(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (text, days) in [
            ("1970-01-01", 0),
            ("1972-02-29", 789),
            ("2000-03-01", 11_017),
            ("2026-11-29", 20_786),
            ("2100-03-01", 47_541),
        ] {
            assert_eq!(text.parse(), Ok(Date { days }), "{text}");
            assert_eq!(Date { days }.to_string(), text);
        }
        for text in ["2026-02-30", "2026-13-01", "2026-1-1", "29.11.2026", "", "a-b-c"] {
            assert_eq!(text.parse::<Date>(), Err(()), "{text}");
        }
        // Every day of a century follows the last.
        for days in 0..36_525 {
            let (year, month, day) = Date { days }.calendar();
            assert_eq!(Date::of(year, month, day).days, days);
        }
    }
}
