//! Playback: the ram follows the displacement of a record.
//!
//! ```text
//! record -> uniform clock, noise removed -> 1 kHz, cubic between samples -> commands
//! ```
//! The velocity is that of the interpolant of `measurement`. The whole motion is checked before
//! anything moves: the speed and the acceleration of every cycle, from displacements as from
//! velocities, and a begin at rest. The displacement counts from mid-stroke, as it was recorded.

use super::{Bench, visit};
use crate::error::CommandError;
use crate::value::number;
use clap::Args;
use firmware_core::command::Command;
use hil_host::bus::BusChoice;
use hil_host::run::PlannedTest;
use measurement::{Measurement, read_motions, read_tests_with};
use scenario::run::CYCLE_S;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Options of a playback.
#[derive(Debug, Args)]
pub(crate) struct PlayArgs {
    /// No tests: follow the displacement of this record, a CSV file, or record.npy or bus.log of a
    /// run. --mapping says what its columns mean.
    #[arg(id = "play", long = "play", value_name = "FILE", requires = "bus", conflicts_with_all = ["tests", "calibrate"])]
    pub(super) file: Option<PathBuf>,
    /// The highest speed of a record that is played (m/s).
    #[arg(long, value_name = "M_PER_S", default_value_t = 0.5, requires = "play",
        value_parser = number("a speed over 0 and up to 2 m/s", |v| v > 0.0 && v <= 2.0))]
    play_speed: f64,
    /// The highest acceleration of a record that is played (m/s2).
    #[arg(long, value_name = "M_PER_S2", default_value_t = 20.0, requires = "play",
        value_parser = number("an acceleration from 1 to 200 m/s2", |a| (1.0..=200.0).contains(&a)))]
    play_acceleration: f64,
}

/// Follows the motion of a record.
pub(super) fn play(bench: &Bench<'_>) -> Result<ExitCode, CommandError> {
    let args = &bench.args.play;
    let Some(file) = &args.file else {
        return Err(CommandError::option("no record", "--play FILE"));
    };
    let tests = read(bench, file)?
        .iter()
        .map(|record| planned(record, args))
        .collect::<Result<Vec<_>, _>>()?;
    if *bench.bus == BusChoice::Memory {
        check_stroke(&tests, bench.rig.stroke_m).map_err(|(found, expected)| {
            CommandError::Input { file: file.clone(), found, expected }
        })?;
    }
    let frequencies_hz = vec![0.0; tests.len()];
    visit::run(bench, Some(file), tests, &frequencies_hz)
}

/// The motions of a record, with or without a force.
fn read(bench: &Bench<'_>, file: &Path) -> Result<Vec<Measurement>, CommandError> {
    let (mapping, reader) = (bench.common.mapping, bench.common.reader);
    if !reader.reads(file)
        && let Some(motions) = read_motions(file, mapping)?
    {
        return Ok(motions);
    }
    Ok(read_tests_with(&[file.to_owned()], mapping, Some(reader))?)
}

/// A record as commands.
fn planned(record: &Measurement, args: &PlayArgs) -> Result<PlannedTest, CommandError> {
    let commands = resampled(record);
    check(&commands, args).map_err(|misfit| CommandError::Input {
        file: record.file.clone(),
        found: format!(
            "{} at {:.3} s",
            misfit.found,
            record.start_s + misfit.cycle as f64 * CYCLE_S
        ),
        expected: misfit.expected,
    })?;
    Ok(PlannedTest { name: format!("played-{}", record.name), commands })
}

/// A motion at the rate of the control cycle.
fn resampled(record: &Measurement) -> Vec<Command> {
    let last = record.len().saturating_sub(1);
    let cycles = libm::floor(last as f64 * record.step_s / CYCLE_S + 1e-6) as usize;
    let command = |cycle: usize| {
        let place = cycle as f64 * CYCLE_S / record.step_s;
        let sample = (place as usize).min(last.saturating_sub(1));
        let share = (place - sample as f64).clamp(0.0, 1.0);
        let (displacement_m, velocity_m_per_s) = record.motion_between(sample, share);
        Command { displacement_m, velocity_m_per_s }
    };
    (0..=cycles).map(command).collect()
}

/// Checks that motions stay within a stroke; what was found and what was expected. A real rig
/// states its stroke when it is armed.
fn check_stroke(tests: &[PlannedTest], stroke_m: f64) -> Result<(), (String, String)> {
    for test in tests {
        let is_beyond = |command: &Command| command.displacement_m.abs() > stroke_m;
        if let Some(cycle) = test.commands.iter().position(is_beyond) {
            let (x_mm, most_mm) = (1e3 * test.commands[cycle].displacement_m, 1e3 * stroke_m);
            let time_s = cycle as f64 * CYCLE_S;
            return Err((
                format!("a displacement of {x_mm:.1} mm {time_s:.3} s after its begin"),
                format!("at most {most_mm:.1} mm, the stroke of the rig"),
            ));
        }
    }
    Ok(())
}

/// What the ram cannot follow, and in which cycle.
#[derive(Debug, PartialEq)]
struct Misfit {
    cycle: usize,
    found: String,
    expected: String,
}

/// Checks that a motion begins at rest, and the speed and the acceleration of every cycle.
fn check(commands: &[Command], args: &PlayArgs) -> Result<(), Misfit> {
    let (most_m_per_s, most_m_per_s2) = (args.play_speed, args.play_acceleration);
    let Some(first) = commands.first() else { return Ok(()) };
    let at_once_m_per_s = most_m_per_s2 * CYCLE_S;
    if first.velocity_m_per_s.abs() > at_once_m_per_s {
        return Err(Misfit {
            cycle: 0,
            found: format!("a speed of {:.1} mm/s", 1e3 * first.velocity_m_per_s.abs()),
            expected: "a motion that begins at rest".to_owned(),
        });
    }
    for (cycle, pair) in commands.windows(2).enumerate() {
        let [before, now] = pair else { continue };
        let step_m_per_s = (now.displacement_m - before.displacement_m) / CYCLE_S;
        let speed_m_per_s = step_m_per_s.abs().max(now.velocity_m_per_s.abs());
        // As the limits of the commands count it.
        let changes = [now.velocity_m_per_s, step_m_per_s].map(|v| v - before.velocity_m_per_s);
        let acceleration_m_per_s2 = changes.map(f64::abs).into_iter().fold(0.0, f64::max) / CYCLE_S;
        let cycle = cycle + 1;
        if speed_m_per_s > most_m_per_s {
            let found = format!("a speed of {speed_m_per_s:.4} m/s");
            let expected = format!("at most {} m/s (--play-speed)", files::number(most_m_per_s));
            return Err(Misfit { cycle, found, expected });
        }
        if acceleration_m_per_s2 > most_m_per_s2 {
            let found = format!("an acceleration of {acceleration_m_per_s2:.2} m/s2");
            let most = files::number(most_m_per_s2);
            let expected = format!("at most {most} m/s2 (--play-acceleration)");
            return Err(Misfit { cycle, found, expected });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::Series;
    use std::f64::consts::TAU;

    fn args() -> PlayArgs {
        PlayArgs { file: None, play_speed: 0.5, play_acceleration: 20.0 }
    }

    /// A record of this displacement, sampled at 200 Hz for four seconds.
    fn record(x_m: impl Fn(f64) -> f64) -> Measurement {
        let x_m: Vec<f64> = (0..800).map(|n| x_m(5e-3 * f64::from(n))).collect();
        Measurement::from_series(Series::sampled("record", 200.0, x_m.clone(), x_m)).unwrap()
    }

    /// 3.46 mm at 3.5 Hz that rises in half a second.
    fn sine(time_s: f64) -> f64 {
        let risen = (time_s / 0.5).min(1.0);
        risen * risen * (3.0 - 2.0 * risen) * 3.46e-3 * libm::sin(TAU * 3.5 * time_s)
    }

    #[test]
    fn a_record_at_200_hz_is_followed_at_1_khz() {
        let commands = resampled(&record(sine));
        assert_eq!(commands.len(), 3996);
        for (cycle, command) in commands.iter().enumerate().skip(600).take(3000) {
            let time_s = cycle as f64 * CYCLE_S;
            assert!((command.displacement_m - sine(time_s)).abs() < 1e-6, "{time_s} s");
            let v_m_per_s = 3.46e-3 * TAU * 3.5 * libm::cos(TAU * 3.5 * time_s);
            assert!((command.velocity_m_per_s - v_m_per_s).abs() < 1e-3, "{time_s} s");
        }
        assert_eq!(check(&commands, &args()), Ok(()));
    }

    #[test]
    fn steps_and_what_is_too_fast_are_refused_with_their_cycle() {
        let begun = |time_s: f64| 3.46e-3 * libm::sin(TAU * 3.5 * time_s);
        let misfit = check(&resampled(&record(begun)), &args()).unwrap_err();
        assert_eq!((misfit.cycle, misfit.found.as_str()), (0, "a speed of 76.1 mm/s"));
        // A step of 5 mm after two seconds.
        let step = |time_s: f64| sine(time_s) + if time_s < 2.0 { 0.0 } else { 5e-3 };
        let misfit = check(&resampled(&record(step)), &args()).unwrap_err();
        assert!((1985..=2000).contains(&misfit.cycle), "{misfit:?}");
        let slow = PlayArgs { play_speed: 0.07, ..args() };
        let misfit = check(&resampled(&record(sine)), &slow).unwrap_err();
        assert!(misfit.found.starts_with("a speed of 0.07"), "{misfit:?}");
        let soft = PlayArgs { play_acceleration: 1.5, ..args() };
        let misfit = check(&resampled(&record(sine)), &soft).unwrap_err();
        assert!(misfit.found.starts_with("an acceleration of 1."), "{misfit:?}");
    }
}
