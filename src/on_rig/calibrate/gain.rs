//! Gain and offset of the load cell: a known force, and the rig at rest.
//!
//! Each run adds a reading to those of `--calibration`; the line through all of them is the gain.

use super::Shown;
use super::sines::MEASURED_S;
use crate::calibration_file::CalibrationFile;
use crate::on_rig::Bench;
use firmware_core::command::Command;
use firmware_core::supervision::CommandLimits;
use hil_host::calibration::{GainFit, Reading};
use hil_host::run::{MeasuredTest, OpenLoopPlan, Origin, PlannedTest};
use scenario::run::{CYCLE_S, Readiness};

/// Four seconds at rest where the ram stands, with a force that a rig at rest has otherwise not.
pub(super) fn plan<'b>(bench: &'b Bench<'_>, known_n: f64) -> OpenLoopPlan<'b> {
    let cycles = (MEASURED_S / CYCLE_S) as usize;
    let rest = PlannedTest { name: "gain".to_owned(), commands: vec![Command::default(); cycles] };
    let plan = bench.plan(vec![rest]);
    let at_rest_n = Readiness::default().force_at_rest_n + 1.5 * known_n.abs();
    OpenLoopPlan {
        // Where the ram stands is not known before the rig is armed.
        limits: CommandLimits { stroke_m: 1.0, ..plan.limits },
        readiness: Readiness { force_at_rest_n: at_rest_n, ..plan.readiness },
        origin: Origin::WhereItStands,
        needs_its_limits: false,
        ..plan
    }
}

/// Gain and offset from all readings so far.
pub(super) fn evaluated(
    bench: &Bench<'_>,
    tests: &[MeasuredTest],
    file: CalibrationFile,
    known_n: f64,
) -> Shown {
    let reading = Reading::of(tests.first()?, known_n)?;
    let mut readings = file.readings();
    readings.push(reading);
    let fit = GainFit::of(&readings);
    let mut lines = vec![format!(
        "reading {:.2} +- {:.2} N under {:.2} N",
        reading.reading_n, reading.error_n, reading.reference_n
    )];
    // The zero alone is a reading, and no gain.
    let file = file.with_readings(fit, &readings, bench.args.calibrate.certificate.as_deref());
    lines.extend(file.lines().pop());
    Some((file, lines))
}
