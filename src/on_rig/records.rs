//! Records, figures and tracking of the tests that were run: files, and what is printed.

use super::tracking::{self, TRACKING, TrackingFile};
use super::{Bench, ended_early};
use crate::calibration_file::{CALIBRATION, CalibrationFile};
use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::{self, print};
use files::ResultFolder;
use hil_host::run::{MeasuredTest, OpenLoopRecord, PlannedTest};
use measurement::mapping::{Companion, Extension};
use measurement::read_tests;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use virtual_bench::characterisation::LaboratoryFile;

/// The figures of a visit.
pub(crate) const LABORATORY: &str = "laboratory.json";

/// What the mappings of the records say beside their columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct About<'a> {
    pub(super) specimen: Option<&'a str>,
    pub(super) orientation: Option<&'a str>,
    pub(super) calibration: Option<&'a CalibrationFile>,
}

/// The files that the tests of a visit leave.
pub(super) fn names(tests: &[PlannedTest]) -> Vec<String> {
    let mut names = csv_names(tests);
    names.extend([LABORATORY, TRACKING, CALIBRATION].map(str::to_owned));
    names
}

/// The records of these tests, and their mappings.
pub(super) fn csv_names(tests: &[PlannedTest]) -> Vec<String> {
    let csv = || tests.iter().map(|test| csv_name(&test.name));
    csv().chain(csv().map(|name| Companion::name_for(&name))).collect()
}

fn csv_name(test: &str) -> String {
    format!("{test}.csv")
}

/// Writes records, mappings, figures and tracking of the tests that were asked for;
/// prints figures and tracking.
pub(super) fn write(
    bench: &Bench<'_>,
    folder: &ResultFolder,
    found: &OpenLoopRecord,
    planned: &[PlannedTest],
) -> Result<ExitCode, CommandError> {
    let common = bench.common;
    let paths = write_records(bench, folder, &found.tests)?;
    write_tracking(bench, folder, &found.tests)?;
    if let Some(calibration) = &bench.calibration {
        folder.write(CALIBRATION, &calibration.to_toml()?)?;
    }
    let mut lines = Vec::new();
    if paths.is_empty() {
        lines.push("no test was run to its end".to_owned());
    } else {
        let tests = read_tests(&paths, None)?;
        let file = LaboratoryFile::of_records(&paths, &tests, common.datasheet);
        let json = serde_json::to_string_pretty(&file)?;
        folder.write(LABORATORY, &format!("{json}\n"))?;
        if common.json {
            print(&json)?;
        } else {
            lines.extend(file.to_string().lines().map(str::to_owned));
        }
    }
    if !common.json {
        lines.push("\nTracking of the ram".to_owned());
        lines.extend(tracking::table(&found.tests).lines());
        lines.push(counted(found));
        lines.push(files_in(folder));
        print(&lines.join("\n"))?;
    }
    if let Some(code) = ended_early(found) {
        return Ok(code);
    }
    if found.tests.len() == planned.len() {
        return Ok(ExitCode::SUCCESS);
    }
    let is_run = |name: &&str| found.tests.iter().any(|test| test.name == *name);
    let names = planned.iter().map(|test| test.name.as_str());
    let left_out: Vec<&str> = names.filter(|name| !is_run(name)).collect();
    let left_out = left_out.join(", ");
    output::complain(&format!("the oil did not reach its temperatures: without {left_out}"));
    Ok(ExitCode::from(FAILED))
}

/// Writes the records of tests with their mappings; their paths.
pub(super) fn write_records(
    bench: &Bench<'_>,
    folder: &ResultFolder,
    tests: &[MeasuredTest],
) -> Result<Vec<PathBuf>, CommandError> {
    let about = bench.about();
    let specimen = about.specimen.unwrap_or("specimen");
    let orientation = about.orientation.map(|text| format!("orientation: {text}"));
    let calibration = about.calibration.map(CalibrationFile::lines).unwrap_or_default();
    let calibration = calibration.iter().map(|line| format!("calibration: {line}"));
    let notes: Vec<String> = orientation.into_iter().chain(calibration).collect();
    let mut paths = Vec::new();
    for test in tests {
        let name = csv_name(&test.name);
        folder.write(&name, &csv(test))?;
        let companion = Companion {
            specimen: Some(specimen.to_owned()),
            notes: notes.clone(),
            extension: Extension::Positive,
            temperature: test.temperature_degc.is_some(),
        };
        folder.write(&Companion::name_for(&name), &companion.to_toml(&name))?;
        paths.push(folder.file(&name));
    }
    Ok(paths)
}

/// Writes the tracking of tests into its file.
pub(super) fn write_tracking(
    bench: &Bench<'_>,
    folder: &ResultFolder,
    tests: &[MeasuredTest],
) -> Result<(), CommandError> {
    let file = TrackingFile::of(tests, bench.node(), bench.bus.to_string());
    folder.write(TRACKING, &format!("{}\n", serde_json::to_string_pretty(&file)?))?;
    Ok(())
}

/// Where the files are.
pub(super) fn files_in(folder: &ResultFolder) -> String {
    let place = folder.path().display().to_string();
    format!("files in {}", files::quoted(&place))
}

/// Frames and what went wrong with them, in one line.
pub(super) fn counted(found: &OpenLoopRecord) -> String {
    let mut line = format!("frames sent {} received {}", found.bus.sent, found.bus.received);
    let counters = [
        ("ticks skipped", found.skipped),
        ("commands limited", found.limited),
        ("rows and frames not recorded", found.unrecorded),
        ("frames dropped", found.bus.send_dropped + found.bus.receive_dropped),
    ];
    for (what, count) in counters.into_iter().filter(|(_, count)| *count > 0) {
        // Writing to a string cannot fail.
        let _ = write!(line, ", {count} {what}");
    }
    line
}

/// The record of a test.
fn csv(test: &MeasuredTest) -> String {
    let mut text = String::new();
    let degc = test.temperature_degc.as_deref();
    let temperature = if degc.is_some() { ",temperature_degc" } else { "" };
    let _ = writeln!(text, "time_s,displacement_m,force_n{temperature},cycle");
    for (row, cycle) in test.cycles.iter().enumerate() {
        let (time_s, x_m, force_n) =
            (test.time_s[row], test.displacement_m[row], test.force_n[row]);
        let _ = write!(text, "{time_s:.3},{x_m:.9},{force_n:.3}");
        if let Some(degc) = degc.and_then(|degc| degc.get(row)) {
            let _ = write!(text, ",{degc:.2}");
        }
        let _ = writeln!(text, ",{cycle}");
    }
    text
}
