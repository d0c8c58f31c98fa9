//! Calibration of a rig: a rigid bar, a dry run, or the gain of the load cell.
//!
//! | mounted | motion | found |
//! | --- | --- | --- |
//! | [`bar`] | sines of 1 to 10 Hz, 20 um about where the ram stands | stiffness, skew |
//! | [`dry`]: nothing | sines of 4 to 12 Hz with 0.1 m/s at most | mass behind the load cell |
//! | [`gain`]: a known force | none, four seconds at rest | gain and offset of the load cell |
//!
//! There is no other motion while one of them is declared: the options of other tasks are refused.

mod bar;
mod dry;
mod gain;
mod sines;

use super::records::{counted, csv_names, files_in, write_records, write_tracking};
use super::tracking::TRACKING;
use super::{Bench, ended_early};
use crate::calibration_file::{CALIBRATION, CalibrationFile};
use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::{self, print};
use crate::value::number;
use clap::{Args, ValueEnum};
use hil_host::bus::BusChoice;
use hil_host::run::{MeasuredTest, OpenLoopPlan};
use scenario::rig::{BAR_N_PER_M, Mounted, RigSetup};
use std::process::ExitCode;

/// Standard gravity (m/s2).
const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// What is calibrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Task {
    /// A rigid bar in the place of the damper: stiffness from the displacement sensor to the ground
    /// and skew of the force.
    Bar,
    /// Nothing mounted: the mass behind the load cell.
    Dry,
    /// A known force at rest: gain and offset of the load cell.
    Gain,
}

/// Options of a calibration.
#[derive(Debug, Args)]
#[command(next_help_heading = "Calibration of a rig")]
pub(crate) struct CalibrateArgs {
    /// No tests: calibrate the rig, and write calibration.toml. Parts of --calibration that are not
    /// measured anew are kept.
    #[arg(long, value_enum, requires = "bus", conflicts_with_all = ["tests", "oil_degc", "datasheet"])]
    calibrate: Option<Task>,
    /// With a bar: the range of the load cell, of which a fifth is not exceeded (kN).
    #[arg(long, value_name = "KN", requires = "calibrate",
        value_parser = number("a range from 1 to 500 kN", |kn| (1.0..=500.0).contains(&kn)))]
    cell_kn: Option<f64>,
    /// With a bar: amplitude of the sines [default: 20] (um).
    #[arg(long, value_name = "UM", requires = "calibrate",
        value_parser = number("an amplitude from 1 to 90 um", |um| (1.0..=90.0).contains(&um)))]
    bar_um: Option<f64>,
    /// With a bar: where the ram stands, by its displacement sensor [default: 0] (mm).
    #[arg(long, value_name = "MM", requires = "calibrate",
        value_parser = number("a place from -500 to 500 mm", |mm| mm.abs() <= 500.0))]
    at_mm: Option<f64>,
    /// With gain: the dead weight that hangs on the load cell; zero for none (kg).
    #[arg(long, value_name = "KG", requires = "calibrate", conflicts_with_all = ["shunt_n", "reference_n"],
        value_parser = number("a mass from 0 to 10000 kg", |kg| (0.0..=1e4).contains(&kg)))]
    dead_weight_kg: Option<f64>,
    /// With gain: the force that the shunt stands for (N).
    #[arg(long, value_name = "N", requires = "calibrate", conflicts_with = "reference_n",
        value_parser = number("a force from -100000 to 100000 N", |n| n.abs() <= 1e5))]
    shunt_n: Option<f64>,
    /// With gain: the force that a reference cell in series shows (N).
    #[arg(long, value_name = "N", requires = "calibrate",
        value_parser = number("a force from -100000 to 100000 N", |n| n.abs() <= 1e5))]
    reference_n: Option<f64>,
    /// Number of the certificate, for calibration.toml.
    #[arg(long, value_name = "NUMBER", requires = "calibrate")]
    certificate: Option<String>,
}

impl CalibrateArgs {
    /// Whether the rig is calibrated.
    pub(super) const fn is_given(&self) -> bool {
        self.calibrate.is_some()
    }

    /// Refuses options of another task than this one.
    fn refuse_foreign(&self, task: Task) -> Result<(), CommandError> {
        let options = [
            ("--cell-kn", self.cell_kn.is_some(), Task::Bar, "bar"),
            ("--bar-um", self.bar_um.is_some(), Task::Bar, "bar"),
            ("--at-mm", self.at_mm.is_some(), Task::Bar, "bar"),
            ("--dead-weight-kg", self.dead_weight_kg.is_some(), Task::Gain, "gain"),
            ("--shunt-n", self.shunt_n.is_some(), Task::Gain, "gain"),
            ("--reference-n", self.reference_n.is_some(), Task::Gain, "gain"),
        ];
        match options.iter().find(|(_, is_given, of, _)| *is_given && *of != task) {
            Some((option, _, _, of)) => {
                Err(CommandError::option(*option, format!("--calibrate {of} with it")))
            }
            None => Ok(()),
        }
    }

    /// The force that is known (N).
    fn known_n(&self) -> Option<f64> {
        let weight_n = self.dead_weight_kg.map(|kg| kg * GRAVITY_M_PER_S2);
        weight_n.or(self.shunt_n).or(self.reference_n)
    }
}

/// Calibrates the rig.
pub(super) fn calibrate(bench: Bench<'_>) -> Result<ExitCode, CommandError> {
    let args = &bench.args.calibrate;
    let task = args.calibrate.unwrap_or(Task::Dry);
    args.refuse_foreign(task)?;
    match task {
        Task::Bar => {
            let Some(cell_kn) = args.cell_kn else {
                let expected = "--cell-kn, the range of the load cell";
                return Err(CommandError::option("--calibrate bar", expected));
            };
            let bench = bench.with_mounted(Mounted::Bar { stiffness_n_per_m: BAR_N_PER_M });
            run(&bench, &bar::plan(&bench, cell_kn), bar::evaluated)
        }
        Task::Gain => {
            let Some(force_n) = args.known_n() else {
                let expected = "--dead-weight-kg, --shunt-n or --reference-n";
                return Err(CommandError::option("--calibrate gain", expected));
            };
            let bench = bench.with_mounted(Mounted::Load { force_n });
            run(&bench, &gain::plan(&bench, force_n), |bench, tests, file| {
                gain::evaluated(bench, tests, file, force_n)
            })
        }
        Task::Dry => {
            let bench = bench.with_mounted(Mounted::Load { force_n: 0.0 });
            run(&bench, &dry::plan(&bench), dry::evaluated)
        }
    }
}

impl Bench<'_> {
    /// On the memory bus, a rig with what a calibration needs in the place of its damper. A file
    /// that states what is mounted is left alone: it is mounted there as on a real rig.
    fn with_mounted(self, mounted: Mounted) -> Self {
        let is_emulated = *self.bus == BusChoice::Memory && self.rig.mounted == Mounted::Damper;
        let mounted = if is_emulated { mounted } else { self.rig.mounted };
        Self { rig: RigSetup { mounted, ..self.rig }, ..self }
    }
}

/// What tests have shown: the calibration with it, and lines to print; none where they show
/// nothing.
type Shown = Option<(CalibrationFile, Vec<String>)>;

/// Runs a plan, writes what it has shown and prints it.
fn run(
    bench: &Bench<'_>,
    plan: &OpenLoopPlan<'_>,
    evaluate: impl Fn(&Bench<'_>, &[MeasuredTest], CalibrationFile) -> Shown,
) -> Result<ExitCode, CommandError> {
    let mut names = csv_names(&plan.tests);
    names.extend([CALIBRATION, TRACKING].map(str::to_owned));
    let mut folder = bench.folder(None, &names)?;
    let found = bench.conduct(plan, &mut folder)?;
    write_records(bench, &folder, &found.tests)?;
    if let Some(code) = ended_early(&found) {
        return Ok(code);
    }
    let before = bench.calibration.clone().unwrap_or_else(|| CalibrationFile::empty(bench.node()));
    let Some((file, mut lines)) = evaluate(bench, &found.tests, before) else {
        output::complain("the measurements do not determine a calibration");
        return Ok(ExitCode::from(FAILED));
    };
    folder.write(CALIBRATION, &file.to_toml()?)?;
    write_tracking(bench, &folder, &found.tests)?;
    if bench.common.json {
        print(&serde_json::to_string_pretty(&file)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    lines.extend([counted(&found), files_in(&folder)]);
    print(&lines.join("\n"))?;
    Ok(ExitCode::SUCCESS)
}
