//! The tests of a visit on a rig.
//!
//! Before the rig is armed, the heat of every test and the temperature that the oil will reach are
//! printed.

use super::Bench;
use super::records::{names, write};
use crate::error::CommandError;
use firmware_core::command::Command;
use firmware_core::damper::{Damper, DamperState, HeatBalance, Motion};
use hil_host::run::PlannedTest;
use measurement::SAMPLES_LEAST;
use report::{Cell, Table};
use scenario::damper::DamperFile;
use scenario::run::CYCLE_S;
use scenario::source::Source;
use std::path::Path;
use std::process::ExitCode;
use virtual_bench::bench_visit::LABORATORY_DEGC;
use virtual_bench::bench_visit::protocol::Test;
use virtual_bench::excitation::Excitation;

/// Runs the tests of a list.
pub(super) fn visit(bench: &Bench<'_>) -> Result<ExitCode, CommandError> {
    let planned: Vec<PlannedTest> = bench.common.tests.iter().map(planned).collect();
    // Its record would be refused when the ram has moved.
    if let Some(test) = planned.iter().find(|test| test.commands.len() < SAMPLES_LEAST) {
        let found =
            format!("test {} of {} samples", files::quoted(&test.name), test.commands.len());
        return Err(CommandError::option(found, format!("at least {SAMPLES_LEAST}, at 1 kHz")));
    }
    let frequencies = bench.common.tests.iter().map(|test| test.excitation.frequency_hz());
    let frequencies: Vec<f64> = frequencies.collect();
    run(bench, None, planned, &frequencies)
}

/// Runs motions, of `record` where they were read from one, and writes what was measured; a motion
/// without a frequency has one of zero.
pub(super) fn run(
    bench: &Bench<'_>,
    record: Option<&Path>,
    motions: Vec<PlannedTest>,
    frequencies_hz: &[f64],
) -> Result<ExitCode, CommandError> {
    let mut folder = bench.folder(record, &names(&motions))?;
    print_heat(bench, &motions, frequencies_hz)?;
    let plan = bench.plan(motions);
    let found = bench.conduct(&plan, &mut folder)?;
    write(bench, &folder, &found, &plan.tests)
}

/// A test as commands.
fn planned(test: &Test) -> PlannedTest {
    let cycles = libm::floor(test.duration_s / CYCLE_S + 1e-9) as usize;
    let commands = commands(&test.excitation, test.mean_m, cycles);
    PlannedTest { name: test.name.clone(), commands }
}

/// A motion about a place, over so many cycles.
pub(super) fn commands(motion: &Excitation, mean_m: f64, cycles: usize) -> Vec<Command> {
    let command = |cycle: usize| {
        let (x_m, velocity_m_per_s) = motion.at(cycle as f64 * CYCLE_S);
        Command { displacement_m: mean_m + x_m, velocity_m_per_s }
    };
    (0..=cycles).map(command).collect()
}

/// Prints the heat of every test with the damper that is expected.
fn print_heat(
    bench: &Bench<'_>,
    tests: &[PlannedTest],
    frequencies_hz: &[f64],
) -> Result<(), CommandError> {
    let damper = match bench.common.model {
        Some(path) => DamperFile::load_model(path)?.build(&Source::read(path)?)?,
        None => bench.rig.damper.clone(),
    };
    files::say!("expected heat, from {LABORATORY_DEGC} degrees Celsius on:");
    for line in heat(&damper, tests, frequencies_hz).lines() {
        files::say!("{line}");
    }
    Ok(())
}

/// The heat of every test, and where it leads the oil.
fn heat(damper: &Damper, tests: &[PlannedTest], frequencies_hz: &[f64]) -> Table {
    let table = Table::new("")
        .text("test")
        .fixed("length", "s", 1)
        .fixed("work", "J", 0)
        .fixed("per cycle", "J", 1)
        .fixed("heat", "W", 0)
        .fixed("oil behind it", "degC", 1);
    let (damper, balance) = (damper.clone().prepared(CYCLE_S), HeatBalance::of(damper));
    let mut degc = LABORATORY_DEGC;
    let rows: Vec<[Cell; 6]> = tests
        .iter()
        .zip(frequencies_hz)
        .map(|(test, frequency_hz)| {
            let works_j = works_j(&damper, &test.commands);
            let work_j = works_j.last().copied().unwrap_or(0.0);
            let length_s = test.commands.len().saturating_sub(1).max(1) as f64 * CYCLE_S;
            degc = balance.after(degc, work_j / length_s, LABORATORY_DEGC, length_s);
            let per_cycle = largest_in(&works_j, 1.0 / (frequency_hz * CYCLE_S));
            [
                test.name.as_str().into(),
                length_s.into(),
                work_j.into(),
                per_cycle.into(),
                (work_j / length_s).into(),
                degc.into(),
            ]
        })
        .collect();
    table.rows(rows)
}

/// The largest work within so many cycles (J), of the work so far; tests begin and end softly.
fn largest_in(works_j: &[f64], cycles: f64) -> Option<f64> {
    let whole = (1.0..=works_j.len() as f64).contains(&cycles).then(|| cycles.round() as usize)?;
    works_j.windows(whole + 1).map(|works_j| works_j[whole] - works_j[0]).reduce(f64::max)
}

/// The work of a damper along a motion, so far (J).
fn works_j(damper: &Damper, commands: &[Command]) -> Vec<f64> {
    let Some(first) = commands.first() else { return Vec::new() };
    let mut state = DamperState::starting(Motion::new(first.displacement_m, 0.0));
    let steps = commands.windows(2).map(|pair| {
        let motion = Motion::new(pair[1].displacement_m, pair[1].velocity_m_per_s);
        let force_n = damper.advance(&mut state, motion, CYCLE_S);
        force_n * (pair[1].displacement_m - pair[0].displacement_m)
    });
    let so_far = steps.scan(0.0, |sum_j, work_j| {
        *sum_j += work_j;
        Some(*sum_j)
    });
    std::iter::once(0.0).chain(so_far).collect()
}
