//! The motion of the ground: a record of the user, or a synthetic one.

use crate::error::RthsError;
use files::{Limit, number, quoted};
use signal::random::Random;
use std::f64::consts::TAU;
use std::path::Path;

/// Duration of the synthetic record of the command, s.
pub const SYNTHETIC_DURATION_S: f64 = 30.0;
/// What every line of a record holds.
const COLUMNS: &str = "time_s,ground_acceleration_m_per_s2";
/// Range of the duration, s.
const DURATION_S: [f64; 2] = [1.0, 600.0];
/// Range of the peak, m/s2.
const PEAK_M_PER_S2: [f64; 2] = [0.01, 100.0];
/// Duration and peak of the record of the published table.
const EL_CENTRO: (f64, f64) = (41.18, 3.135);

/// A record of the acceleration of the ground, linear between its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Time since the first sample, s, and acceleration, m/s2.
    samples: Vec<(f64, f64)>,
}

impl Record {
    /// Reads a CSV file with time and acceleration in its first two columns.
    ///
    /// # Errors
    /// A file that cannot be read, a line without two numbers, a time that does not increase, or
    /// an acceleration or duration that no earthquake has.
    pub fn read(path: &Path) -> Result<Self, RthsError> {
        Self::parse(path, &files::input::read_text(path, Limit::Text)?)
    }

    /// The record of a text; `path` names it in errors.
    fn parse(path: &Path, text: &str) -> Result<Self, RthsError> {
        let wrong = |line: usize, found: String, expected: String| RthsError::Line {
            file: path.to_owned(),
            line,
            found,
            expected,
        };
        let mut samples: Vec<(f64, f64)> = Vec::new();
        let mut first_s = 0.0;
        let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        for (place, (index, line)) in lines.enumerate() {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            let [time, acceleration, ..] = cells.as_slice() else {
                return Err(wrong(index + 1, "one column".to_owned(), COLUMNS.to_owned()));
            };
            if place == 0 && time.parse::<f64>().is_err() {
                continue;
            }
            let value = |cell: &str| {
                let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
                let expected = || "a finite number".to_owned();
                value.ok_or_else(|| wrong(index + 1, format!("\"{}\"", quoted(cell)), expected()))
            };
            let (time_s, acceleration_m_per_s2) = (value(time)?, value(acceleration)?);
            if acceleration_m_per_s2.abs() > PEAK_M_PER_S2[1] {
                let found = format!("{} m/s2", number(acceleration_m_per_s2));
                let expected = format!("at most {} m/s2", number(PEAK_M_PER_S2[1]));
                return Err(wrong(index + 1, found, expected));
            }
            if samples.is_empty() {
                first_s = time_s;
            }
            let since_s = time_s - first_s;
            if let Some((last_s, _)) = samples.last().filter(|(last_s, _)| since_s <= *last_s) {
                let found = format!("time {} s", number(time_s));
                let expected = format!("more than {} s", number(last_s + first_s));
                return Err(wrong(index + 1, found, expected));
            }
            if since_s > DURATION_S[1] {
                let found = format!("{} s since the first sample", number(since_s));
                let expected = format!("at most {} s", number(DURATION_S[1]));
                return Err(wrong(index + 1, found, expected));
            }
            samples.push((since_s, acceleration_m_per_s2));
        }
        let record = Self { samples };
        let whole = |found: String, expected: String| RthsError::Record {
            file: path.to_owned(),
            found,
            expected,
        };
        if record.duration_s() < DURATION_S[0] {
            let found = format!("{} s", number(record.duration_s()));
            return Err(whole(found, format!("at least {} s", number(DURATION_S[0]))));
        }
        if record.peak_m_per_s2() < PEAK_M_PER_S2[0] {
            let found = format!("a peak of {} m/s2", number(record.peak_m_per_s2()));
            return Err(whole(found, format!("at least {} m/s2", number(PEAK_M_PER_S2[0]))));
        }
        Ok(record)
    }

    /// A synthetic record: sines with random phases, with the spectrum of firm ground (Kanai and
    /// Tajimi, 2.5 Hz, damping 0.6), that rise within 2 s and decay from 8 s on. The peak is
    /// 3 m/s2.
    pub fn synthetic(seed: u64, duration_s: f64) -> Self {
        const STEP_S: f64 = 0.02;
        const LINES: u32 = 120;
        let mut random = Random::new(seed, 0);
        let lines: Vec<(f64, f64, f64)> = (1..=LINES)
            .map(|line| {
                let hz = 0.1 * (f64::from(line) + random.uniform() - 0.5);
                let ratio = (hz / 2.5) * (hz / 2.5);
                let damping = 4.0 * 0.6 * 0.6 * ratio;
                let power = (1.0 + damping) / ((1.0 - ratio) * (1.0 - ratio) + damping);
                (TAU * hz, power.sqrt(), TAU * random.uniform())
            })
            .collect();
        let sample = |k: u32| {
            let time_s = f64::from(k) * STEP_S;
            let rise = (time_s / 2.0).min(1.0);
            let decay = libm::exp(-0.3 * (time_s - 8.0).max(0.0));
            let sum: f64 = lines
                .iter()
                .map(|(omega, amplitude, phase)| amplitude * libm::sin(omega * time_s + phase))
                .sum();
            (time_s, rise * rise * decay * sum)
        };
        let mut record = Self { samples: (0..=(duration_s / STEP_S) as u32).map(sample).collect() };
        let scale = 3.0 / record.peak_m_per_s2();
        for (_, acceleration) in &mut record.samples {
            *acceleration *= scale;
        }
        record
    }

    /// The duration, s.
    pub fn duration_s(&self) -> f64 {
        self.samples.last().map_or(0.0, |(time_s, _)| *time_s)
    }

    /// The largest acceleration, m/s2.
    pub fn peak_m_per_s2(&self) -> f64 {
        self.samples.iter().fold(0.0, |peak, (_, acceleration)| peak.max(acceleration.abs()))
    }

    /// Whether duration and peak are those of the record of El Centro, 1940, of which the published
    /// table is.
    pub fn is_of_published_table(&self) -> bool {
        let (duration_s, peak_m_per_s2) = EL_CENTRO;
        (self.duration_s() - duration_s).abs() < 0.1
            && (self.peak_m_per_s2() / peak_m_per_s2 - 1.0).abs() < 0.01
    }

    /// The accelerations in equal steps, from the first sample to the last, times an intensity.
    pub(crate) fn in_steps(&self, step_s: f64, intensity: f64) -> Vec<f64> {
        let mut pairs = self.samples.windows(2).filter_map(|pair| match pair {
            [from, to] => Some((*from, *to)),
            _ => None,
        });
        let Some((mut from, mut to)) = pairs.next() else { return Vec::new() };
        let steps = (self.duration_s() / step_s) as usize;
        let value = |step: usize| {
            let time_s = step as f64 * step_s;
            while time_s > to.0
                && let Some(next) = pairs.next()
            {
                (from, to) = next;
            }
            let share = (time_s - from.0) / (to.0 - from.0);
            intensity * (from.1 + share * (to.1 - from.1))
        };
        (0..=steps).map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Record, RthsError> {
        Record::parse(Path::new("quake.csv"), text)
    }

    #[test]
    fn records_are_linear_between_their_samples() {
        let record = parse("t,a\n2.0,0\n\n2.5,1,x\n3.5,-1\n").unwrap();
        assert_eq!((record.duration_s(), record.peak_m_per_s2()), (1.5, 1.0));
        let steps = record.in_steps(0.25, 0.4);
        assert_eq!(steps, [0.0, 0.2, 0.4, 0.2, 0.0, -0.2, -0.4]);
        assert!(!record.is_of_published_table());
        // Without a head.
        assert_eq!(parse("2.0,0\n2.5,1\n3.5,-1\n").unwrap(), record);
    }

    #[test]
    fn a_record_that_cannot_be_one_is_refused_with_its_line() {
        let steps = |acceleration: &str| format!("t,a\n0,0\n1,{acceleration}\n2,0\n");
        for (text, expected) in [
            ("t\n0\n1\n".to_owned(), "quake.csv:1: found one column, expected time_s,"),
            ("t,a\n0,0\n1\n".to_owned(), "quake.csv:3: found one column, expected time_s,"),
            (steps("NaN"), "quake.csv:3: found \"NaN\", expected a finite number"),
            (steps("inf"), "quake.csv:3: found \"inf\", expected a finite number"),
            (steps("east"), "quake.csv:3: found \"east\", expected a finite number"),
            (steps("1e300"), "quake.csv:3: found 1e300 m/s2, expected at most 100 m/s2"),
            (steps("0"), "quake.csv: found a peak of 0 m/s2, expected at least 0.01 m/s2"),
            (
                "t,a\n5,0\n6,1\n6,1\n".to_owned(),
                "quake.csv:4: found time 6 s, expected more than 6 s",
            ),
            (
                "t,a\n0,0\n1,1\n1e300,1\n".to_owned(),
                "quake.csv:4: found 1e300 s since the first sample, expected at most 600 s",
            ),
            ("t,a\n0,0\n0.5,1\n".to_owned(), "quake.csv: found 0.5 s, expected at least 1 s"),
            (String::new(), "quake.csv: found 0 s, expected at least 1 s"),
        ] {
            let error = parse(&text).unwrap_err();
            let said = error.to_string();
            assert!(said.starts_with(expected), "{said}");
            assert!(error.is_bad_input() && said.lines().count() == 1, "{said}");
        }
        // The first time is far away: every difference is lost.
        assert!(parse("t,a\n-1e300,0\n1,1\n2,1\n").is_err());
    }

    #[test]
    fn a_synthetic_record_is_the_same_for_a_seed() {
        let record = Record::synthetic(1, 20.0);
        assert_eq!(record, Record::synthetic(1, 20.0));
        assert_ne!(record, Record::synthetic(2, 20.0));
        assert!((record.peak_m_per_s2() - 3.0).abs() < 1e-12);
        assert!((record.duration_s() - 20.0).abs() < 1e-9);
    }
}
