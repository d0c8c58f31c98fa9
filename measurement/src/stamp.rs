//! Dates and times of day as seconds since the first.
//!
//! `2021-03-04 10:11:12.000` (blank or `T`), `04.03.2021 10:11:12,5`, `3/4/2021 3:05:31.25 PM`,
//! `[H:]MM:SS.fff`, `10:11:12:345`. A date that is the same in every row does not matter, however
//! it is written. Where it changes, `3/4` is the day or the month, whichever leaves the smaller
//! gaps. A time of day without a date that falls by more than half a day has passed midnight. An
//! offset from UTC is left out.

use std::num::ParseIntError;

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// The stamps of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stamps {
    /// Seconds since the first stamp.
    pub(crate) seconds: Vec<f64>,
    /// Size of the last digit of each, s.
    pub(crate) last_digits_s: Vec<f64>,
    /// Midnight was passed without a date.
    pub(crate) passed_midnight: bool,
}

/// A time of day with its date, if there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stamp<'a> {
    date: &'a str,
    seconds: f64,
    last_digit_s: f64,
}

/// True for a date with a time, or a time of day.
pub(crate) fn is_stamp(cell: &str) -> bool {
    Stamp::of(cell).is_some()
}

/// The stamps of all cells.
///
/// # Errors
/// The index of the first cell that is no stamp, or whose date cannot be read.
pub(crate) fn stamps<'a>(cells: impl Iterator<Item = &'a str>) -> Result<Stamps, usize> {
    let mut all = Vec::new();
    for (index, cell) in cells.enumerate() {
        all.push(Stamp::of(cell).ok_or(index)?);
    }
    let days = days_of(&all)?;
    let mut seconds: Vec<f64> = Vec::with_capacity(all.len());
    let (mut passed, mut before) = (0.0, f64::NEG_INFINITY);
    for (stamp, day) in all.iter().zip(&days) {
        if stamp.date.is_empty() && stamp.seconds < before - 0.5 * DAY_S {
            passed += DAY_S;
        }
        before = stamp.seconds;
        seconds.push(day * DAY_S + passed + stamp.seconds);
    }
    let first = seconds.first().copied().unwrap_or(0.0);
    for value in &mut seconds {
        *value -= first;
    }
    Ok(Stamps {
        seconds,
        last_digits_s: all.iter().map(|stamp| stamp.last_digit_s).collect(),
        passed_midnight: passed > 0.0,
    })
}

impl<'a> Stamp<'a> {
    fn of(cell: &'a str) -> Option<Self> {
        let (cell, half_day_s) = without_half_day(cell.trim());
        let cell = without_zone(cell);
        let begin = cell.find(':')?;
        let before = cell.get(..begin)?;
        let hour = before.rfind(|c: char| !c.is_ascii_digit()).map_or(0, |at| {
            at + before.get(at..).and_then(|rest| rest.chars().next()).map_or(1, char::len_utf8)
        });
        let (date, clock) = cell.split_at_checked(hour)?;
        if !date.is_empty() && !date.contains(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let (clock, date) = match clock.split_once(' ') {
            // The time may stand before the date.
            Some((clock, after)) if date.is_empty() => (clock, after.trim()),
            Some(_) => return None,
            None => (clock, date.trim_end_matches([' ', 'T', ',', '_', '-', '\u{a0}', '/'])),
        };
        let (mut seconds, last_digit_s) = clock_seconds(clock, half_day_s.is_some())?;
        if let Some(half_day_s) = half_day_s {
            // Twelve o'clock is the beginning of its half day.
            seconds = half_day_s + if seconds >= 43_200.0 { seconds - 43_200.0 } else { seconds };
        }
        Some(Self { date, seconds, last_digit_s })
    }
}

/// A text without AM or PM at its end, and the seconds that the half day begins with.
fn without_half_day(cell: &str) -> (&str, Option<f64>) {
    let small = cell.to_ascii_lowercase();
    for (mark, seconds) in [("am", 0.0), ("pm", 43_200.0), ("a.m.", 0.0), ("p.m.", 43_200.0)] {
        if small.ends_with(mark) {
            let rest = cell.get(..cell.len() - mark.len()).unwrap_or(cell);
            return (rest.trim_end(), Some(seconds));
        }
    }
    (cell, None)
}

/// A text without `Z` or an offset from UTC at its end.
fn without_zone(cell: &str) -> &str {
    if let Some(rest) = cell.strip_suffix(['Z', 'z']).or_else(|| cell.strip_suffix(" UTC")) {
        return rest.trim_end();
    }
    let Some(at) = cell.rfind(['+', '-']) else { return cell };
    let (clock, offset) = cell.split_at_checked(at).unwrap_or((cell, ""));
    let digits = offset.bytes().filter(u8::is_ascii_digit).count();
    let is_offset = offset.bytes().skip(1).all(|byte| byte.is_ascii_digit() || byte == b':');
    let is_after_a_time = clock.matches(':').count() >= 2;
    if is_offset && (2..=4).contains(&digits) && is_after_a_time { clock.trim_end() } else { cell }
}

/// Seconds of `[H:]MM:SS[.fff]` or `H:MM:SS:fff`, with the size of the last digit.
fn clock_seconds(clock: &str, has_half_day: bool) -> Option<(f64, f64)> {
    let mut parts: Vec<&str> = clock.split(':').collect();
    let fraction = if parts.len() == 4 { parts.pop() } else { None };
    let last = parts.pop()?;
    let (second, decimals) = match fraction {
        Some(fraction) => (last, fraction),
        None => last.split_once(['.', ',']).unwrap_or((last, "")),
    };
    let whole = |text: &str| -> Option<f64> {
        let is_whole = (1..=4).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        is_whole.then(|| text.parse::<u32>().ok().map(f64::from))?
    };
    let (hour, minute, second) = match parts.as_slice() {
        [minute] if has_half_day => (whole(minute)?, whole(second)?, 0.0),
        [minute] => (0.0, whole(minute)?, whole(second)?),
        [hour, minute] => (whole(hour)?, whole(minute)?, whole(second)?),
        _ => return None,
    };
    if second >= 61.0 || (parts.len() == 2 && minute >= 60.0) {
        return None;
    }
    let digits = decimals.bytes().all(|byte| byte.is_ascii_digit());
    let part = if decimals.is_empty() { 0.0 } else { format!("0.{decimals}").parse().ok()? };
    let last_digit_s = libm::pow(10.0, -(decimals.len() as f64));
    digits.then_some((3600.0 * hour + 60.0 * minute + second + part, last_digit_s))
}

/// The order of day, month and year in a date whose first number is not the year.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    DayFirst,
    MonthFirst,
}

/// Days since the first stamp's date.
fn days_of(stamps: &[Stamp<'_>]) -> Result<Vec<f64>, usize> {
    let first = stamps.first().map_or("", |stamp| stamp.date);
    let Some(changed) = stamps.iter().position(|stamp| stamp.date != first) else {
        return Ok(vec![0.0; stamps.len()]);
    };
    // The largest step in time under each order of day and month.
    let read = |order: Order| -> Option<(f64, Vec<f64>)> {
        let day = |stamp: &Stamp<'_>| day_number(stamp.date, order);
        let days: Vec<f64> = stamps.iter().map(day).collect::<Option<_>>()?;
        let at = |(stamp, day): (&Stamp<'_>, &f64)| day * DAY_S + stamp.seconds;
        let seconds: Vec<f64> = stamps.iter().zip(&days).map(at).collect();
        let steps = seconds.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        Some((steps.fold(0.0, f64::max), days))
    };
    let orders = [Order::DayFirst, Order::MonthFirst].into_iter().filter_map(read);
    let best = orders.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(changed)?.1;
    let first = best.first().copied().unwrap_or(0.0);
    Ok(best.into_iter().map(|day| day - first).collect())
}

/// Beginnings of months' names in English, German and French.
const MONTHS: [&[&str]; 12] = [
    &["jan"],
    &["feb", "fev", "fév"],
    &["mar", "mrz", "mär"],
    &["apr", "avr"],
    &["may", "mai"],
    &["jun", "juin"],
    &["jul", "juil"],
    &["aug", "aou", "aoû"],
    &["sep"],
    &["oct", "okt"],
    &["nov"],
    &["dec", "dez", "déc"],
];

/// The number of the day of a date.
fn day_number(date: &str, order: Order) -> Option<f64> {
    let parts: Vec<&str> =
        date.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()).collect();
    let number = |text: &str| -> Result<i64, ParseIntError> { text.parse() };
    let named = |text: &str| {
        let small = text.to_lowercase();
        let begins = |month: &&[&str]| month.iter().any(|name| small.starts_with(name));
        MONTHS.iter().position(begins).map(|index| index as i64 + 1)
    };
    let is_name = |part: &&str| part.chars().any(char::is_alphabetic);
    // A day of the week in front is no part of the date.
    let parts: Vec<&str> =
        parts.into_iter().filter(|part| !is_name(part) || named(part).is_some()).collect();
    let (year, month, day) = match parts.as_slice() {
        [all] if all.len() == 8 => {
            (number(all.get(..4)?).ok()?, number(all.get(4..6)?).ok()?, number(all.get(6..)?).ok()?)
        }
        [year, month, day] if year.len() == 4 => {
            let month = number(month).ok().or_else(|| named(month))?;
            (number(year).ok()?, month, number(day).ok()?)
        }
        [day, month, year] if is_name(month) => {
            (number(year).ok()?, named(month)?, number(day).ok()?)
        }
        [month, day, year] if is_name(month) => {
            (number(year).ok()?, named(month)?, number(day).ok()?)
        }
        [a, b, year] => {
            let (a, b, year) = (number(a).ok()?, number(b).ok()?, number(year).ok()?);
            // Points stand between day, month and year only in countries that begin with the day.
            let day_first = order == Order::DayFirst || date.contains('.');
            if day_first { (year, b, a) } else { (year, a, b) }
        }
        _ => return None,
    };
    let is_date = (1..=12).contains(&month) && (1..=31).contains(&day);
    is_date.then(|| days_from_civil(year, month, day) as f64)
}

/// Days since the beginning of the era in the Gregorian calendar.
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    // The year begins in March, so that its last day is the one that may be missing.
    let year = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + of_year
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(cells: &[&str]) -> Vec<f64> {
        stamps(cells.iter().copied()).unwrap().seconds
    }

    #[test]
    fn dates_and_times_of_day_were_no_numbers() {
        for cells in [
            ["2021-03-04 10:11:12.000", "2021-03-04 10:11:12.250"],
            ["2021-03-04T10:11:12.000Z", "2021-03-04T10:11:12.250Z"],
            ["2021-03-04T10:11:12.000+01:00", "2021-03-04T10:11:12.250+01:00"],
            ["04.03.2021 10:11:12,000", "04.03.2021 10:11:12,250"],
            ["04.03.2021,10:11:12.000", "04.03.2021,10:11:12.250"],
            ["3/4/2021 3:05:31.000 PM", "3/4/2021 3:05:31.250 PM"],
            ["04-Mar-2021 10:11:12.000", "04-Mar-2021 10:11:12.250"],
            ["Thu Mar 4 2021 10:11:12.000", "Thu Mar 4 2021 10:11:12.250"],
            ["10:11:12.000", "10:11:12.250"],
            ["10:11:12:000", "10:11:12:250"],
            ["00:12.000", "00:12.250"],
            ["59:59.875", "1:00:00.125"],
            ["11:59:59.875 AM", "12:00:00.125 PM"],
            ["12:59:59.875 pm", "1:00:00.125 pm"],
            ["10:11:12.000 04/03/2021", "10:11:12.250 04/03/2021"],
            ["49:59:59.875", "50:00:00.125"],
        ] {
            let found = seconds(&cells);
            assert!((found[1] - 0.25).abs() < 1e-9, "{cells:?}: {found:?}");
        }
    }

    #[test]
    fn midnight_and_the_end_of_a_month_are_passed() {
        for cells in [
            ["23:59:59.9", "00:00:00.1"],
            ["11:59:59.9 PM", "12:00:00.1 AM"],
            ["2021-02-28 23:59:59.9", "2021-03-01 00:00:00.1"],
            ["31.12.2021 23:59:59.9", "01.01.2022 00:00:00.1"],
            // March the fourth to the fifth, and the third of April to the third of May.
            ["03/04/2021 23:59:59.9", "03/05/2021 00:00:00.1"],
            ["04/03/2021 23:59:59.9", "05/03/2021 00:00:00.1"],
            ["30-Apr-2021 23:59:59.9", "01-Mai-2021 00:00:00.1"],
            ["20200228 23:59:59.9", "20200229 00:00:00.1"],
        ] {
            let found = seconds(&cells);
            assert!((found[1] - 0.2).abs() < 1e-9, "{cells:?}: {found:?}");
        }
        assert!(stamps(["23:59:59.9", "00:00:00.1"].into_iter()).unwrap().passed_midnight);
    }

    #[test]
    fn every_stamp_knows_its_own_last_digit() {
        let found = stamps(["10:11:12", "10:11:12.5", "10:11:12.625"].into_iter()).unwrap();
        assert_eq!(found.last_digits_s, [1.0, 0.1, 0.001]);
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for cell in [
            "",
            "12",
            "4.5",
            "2021-03-04",
            "a:b",
            "10:11:12.5x",
            "10:61:12",
            "1:2:3:4:5",
            "-1:00:00",
            "Time: 5",
            "10:11:99",
            "::",
        ] {
            assert!(!is_stamp(cell), "{cell}");
        }
        assert_eq!(stamps(["10:11:12", "x"].into_iter()), Err(1));
    }
}
