//! A dry run: sines of equal speed with nothing mounted, for the mass behind the load cell.

use super::Shown;
use super::sines::{pairs, sine};
use crate::calibration_file::CalibrationFile;
use crate::on_rig::Bench;
use hil_host::calibration::EndMassFit;
use hil_host::run::{MeasuredTest, OpenLoopPlan};
use std::f64::consts::TAU;

/// Frequencies of the sines (Hz), and their highest speed (m/s).
const HZ: [f64; 5] = [4.0, 6.0, 8.0, 10.0, 12.0];
const SPEED_M_PER_S: f64 = 0.1;

/// Sines of equal speed about mid-stroke.
pub(super) fn plan<'b>(bench: &'b Bench<'_>) -> OpenLoopPlan<'b> {
    bench.plan(HZ.map(|hz| sine("dry", hz, SPEED_M_PER_S / (TAU * hz))).into())
}

/// The end mass from the sines of a dry run.
pub(super) fn evaluated(bench: &Bench<'_>, tests: &[MeasuredTest], file: CalibrationFile) -> Shown {
    let fit = EndMassFit::of(&pairs(tests, &HZ)?)?;
    let line = format!(
        "end mass {:.3} +- {:.3} kg, residual {:.2} %",
        fit.mass_kg,
        fit.mass_error_kg,
        1e2 * fit.residual
    );
    Some((file.with_end_mass(fit, bench.args.calibrate.certificate.as_deref()), vec![line]))
}
