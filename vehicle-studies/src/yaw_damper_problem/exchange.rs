//! What goes out to others and comes back: motions, commands and filters as CSV.
//!
//! ```text
//! wanted-*.csv    time_s,displacement_m,velocity_m_per_s     at 1 kHz, from the all-model run
//! command.csv     the same columns; the velocity may be left out
//! filter.csv      b,a                                        one coefficient per row
//! ```
//! A command has a row for every row of the wanted motion, at the same times. Its velocity is the
//! rate at which the ram runs on until the next command. Without one it is that from the command
//! before, which costs half a cycle. Numbers are written so that they are read back bit for bit.

use super::columns::Columns;
use super::regime::Regime;
use crate::error::StudyError;
use crate::trip::{COEFFICIENTS_MAX, DiscreteFilter};
use files::number;
use firmware_core::command::Command;
use scenario::run::CYCLE_S;
use std::fmt::Write as _;
use std::path::Path;

/// Columns of a motion; the velocity may be left out.
const MOTION: [&str; 3] = ["time_s", "displacement_m", "velocity_m_per_s"];
/// Columns of a filter.
const FILTER: [&str; 2] = ["b", "a"];
/// Stroke of the rig to either side (m).
const STROKE_M: f64 = 0.1;
/// How far a time may be off its cycle (s).
const CLOSE_S: f64 = 1e-6;

/// A motion as CSV.
pub fn motion_csv(motion: &[Command]) -> String {
    let mut text = format!("{}\n", MOTION.join(","));
    for (cycle, at) in motion.iter().enumerate() {
        let time_s = time_s(cycle);
        // Writing to a string does not fail.
        let _ = writeln!(text, "{time_s},{},{}", at.displacement_m, at.velocity_m_per_s);
    }
    text
}

/// Time of a row (s), as it is written.
fn time_s(cycle: usize) -> f64 {
    // Whole milliseconds print in few digits.
    cycle as f64 / (1.0 / CYCLE_S).round()
}

/// Reads a command for a motion in a regime.
///
/// # Errors
/// What is no such command, with its line.
pub fn read_command(path: &Path, regime: Regime) -> Result<Vec<Command>, StudyError> {
    command_of(&Columns::read(path, &MOTION, 2)?, regime.cycles())
}

fn command_of(columns: &Columns, rows: usize) -> Result<Vec<Command>, StudyError> {
    let times_s = columns.full(0)?.unwrap_or_default();
    for (row, found_s) in times_s.iter().enumerate() {
        let expected_s = time_s(row);
        if (found_s - expected_s).abs() > CLOSE_S {
            let expected = format!("{} s, steps of 1 ms from 0 s", number(expected_s));
            return Err(columns.wrong(row, format!("time {} s", number(*found_s)), &expected));
        }
    }
    let displacements_m = columns.full(1)?.unwrap_or_default();
    if columns.rows() != rows {
        let expected = format!("{rows}, one for each of the wanted motion");
        return Err(columns.wrong_whole(format!("{} rows", columns.rows()), expected));
    }
    if let Some(row) = displacements_m.iter().position(|x| x.abs() > STROKE_M) {
        let found = format!("a displacement of {} m", number(displacements_m[row]));
        let expected = format!("at most {} m, the stroke of the rig", number(STROKE_M));
        return Err(columns.wrong(row, found, &expected));
    }
    let rates = columns.full(2)?.unwrap_or_else(|| {
        let before = std::iter::once(0.0).chain(displacements_m.iter().copied());
        displacements_m.iter().zip(before).map(|(now, last)| (now - last) / CYCLE_S).collect()
    });
    let command = |(displacement_m, velocity_m_per_s)| Command { displacement_m, velocity_m_per_s };
    Ok(displacements_m.into_iter().zip(rates).map(command).collect())
}

/// Reads a linear filter of the wanted displacement.
///
/// # Errors
/// What is no filter that fades.
pub fn read_filter(path: &Path) -> Result<DiscreteFilter, StudyError> {
    filter_of(&Columns::read(path, &FILTER, 2)?)
}

fn filter_of(columns: &Columns) -> Result<DiscreteFilter, StudyError> {
    let (b, a) = (columns.leading(0)?, columns.leading(1)?);
    DiscreteFilter::new(&b, &a).ok_or_else(|| {
        let found = format!("{} coefficients b and {} a", b.len(), a.len());
        let expected = format!(
            "1 to {COEFFICIENTS_MAX} of each, a0 not zero, of a filter whose answer to an impulse \
             fades"
        );
        columns.wrong_whole(found, expected)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(text: &str) -> Result<Vec<Command>, StudyError> {
        command_of(&Columns::parse(Path::new("command.csv"), text, &MOTION, 2)?, 3)
    }

    #[test]
    fn a_motion_comes_back_bit_for_bit() {
        let at = |k: usize| Command {
            displacement_m: 1e-3 / (3.0 + k as f64),
            velocity_m_per_s: -1.0 / 7.0 * k as f64,
        };
        let motion: Vec<Command> = (0..3).map(at).collect();
        assert_eq!(command(&motion_csv(&motion)).unwrap(), motion);
    }

    #[test]
    fn without_a_velocity_it_is_that_from_the_command_before() {
        let found = command("displacement_m,time_s\n0,0\n1e-3,0.001\n1e-3,0.002\n").unwrap();
        let rates: Vec<f64> = found.iter().map(|at| at.velocity_m_per_s).collect();
        assert_eq!(rates, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn what_is_no_command_is_one_line() {
        for (text, expected) in [
            ("", "command.csv:1: found no column time_s, expected time_s,displacement_m"),
            ("time_s\n0\n", "command.csv:1: found no column displacement_m, expected"),
            ("time_s,displacement_m,time_s\n", "command.csv:1: found column time_s twice"),
            (
                "time_s,displacement_m\n0,0\n0.001,NaN\n",
                "command.csv:3: found \"NaN\" in column displacement_m, expected a finite number",
            ),
            (
                "time_s,displacement_m\n0,0\n0.001,\n",
                "command.csv:3: found an empty cell, expected a finite number",
            ),
            (
                "time_s,displacement_m\n0,0\n0.002,0\n",
                "command.csv:3: found time 0.002 s, expected 0.001 s, steps of 1 ms from 0 s",
            ),
            (
                "time_s,displacement_m\n0,0\n0.001,0\n",
                "command.csv: found 2 rows, expected 3, one for each of the wanted motion",
            ),
            (
                "time_s,displacement_m\n0,0\n0.001,0.3\n0.002,0\n",
                "command.csv:3: found a displacement of 0.3 m, expected at most 0.1 m",
            ),
            ("time_s,displacement_m\n0,0\n0.001\n", "command.csv:3: found "),
        ] {
            let error = command(text).unwrap_err();
            let said = error.to_string();
            assert!(said.starts_with(expected), "{said}");
            assert!(error.is_bad_input() && said.lines().count() == 1, "{said}");
        }
    }

    #[test]
    fn a_filter_may_have_columns_of_different_lengths() {
        let filter = |text: &str| {
            let columns = Columns::parse(Path::new("filter.csv"), text, &FILTER, 2);
            filter_of(&columns.unwrap())
        };
        let expected = DiscreteFilter::new(&[6.0, -5.0], &[1.0]).unwrap();
        assert_eq!(filter("b,a\n6,1\n-5,\n").unwrap(), expected);
        for (text, expected) in [
            ("b,a\n1,1\n,2\n", "filter.csv: found 1 coefficients b and 2 a, expected 1 to 512"),
            ("b,a\n1,1\n,\n1,\n", "filter.csv:4: found a number below an empty cell"),
        ] {
            let said = filter(text).unwrap_err().to_string();
            assert!(said.starts_with(expected), "{said}");
        }
    }
}
