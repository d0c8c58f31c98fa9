//! A rigid bar: small sines about where the ram stands, for stiffness and skew.
//!
//! A bar breaks what moves it. The limits that the rig is asked for are those of the bar: 0.1 mm
//! beyond where the ram stands, and a fifth of the load cell's range. The protocol knows no range:
//! `--cell-kn` states it.

use super::Shown;
use super::sines::{pairs, sine};
use crate::calibration_file::CalibrationFile;
use crate::on_rig::Bench;
use firmware_core::supervision::CommandLimits;
use hil_host::calibration::BarFit;
use hil_host::run::{MeasuredTest, OpenLoopPlan, Origin};
use report::{Cell, Table};

/// Frequencies of the sines (Hz), and their amplitude without `--bar-um` (um).
const HZ: [f64; 6] = [1.0, 2.0, 4.0, 6.0, 8.0, 10.0];
const AMPLITUDE_UM: f64 = 20.0;
/// Way that a bar leaves to either side (m), and the highest speed with it (m/s).
const STROKE_M: f64 = 0.1e-3;
const SPEED_M_PER_S: f64 = 10e-3;
/// Share of the load cell's range that a bar may take.
const SHARE: f64 = 0.2;
/// Residual above which something else than a bar is mounted, such as a damper.
const RESIDUAL_MOST: f64 = 0.1;

/// Small sines about where the ram stands, within the limits of a bar.
pub(super) fn plan<'b>(bench: &'b Bench<'_>, cell_kn: f64) -> OpenLoopPlan<'b> {
    let args = &bench.args.calibrate;
    let sines = HZ.map(|hz| sine("bar", hz, 1e-6 * args.bar_um.unwrap_or(AMPLITUDE_UM)));
    let plan = bench.plan(sines.into());
    OpenLoopPlan {
        limits: CommandLimits {
            stroke_m: 1e-3 * args.at_mm.unwrap_or(0.0).abs() + STROKE_M,
            velocity_m_per_s: SPEED_M_PER_S,
            ..plan.limits
        },
        force_n: SHARE * 1e3 * cell_kn,
        origin: Origin::WhereItStands,
        ..plan
    }
}

/// Stiffness and skew from the sines on a bar.
pub(super) fn evaluated(bench: &Bench<'_>, tests: &[MeasuredTest], file: CalibrationFile) -> Shown {
    let fit = BarFit::of(&pairs(tests, &HZ)?)?;
    let table = Table::new("")
        .fixed("frequency", "Hz", 1)
        .fixed("stiffness", "MN/m", 3)
        .fixed("phase", "deg", 3)
        .fixed("no sine", "%", 2);
    let rows = fit.points.iter().map(|point| -> [Cell; 4] {
        [
            point.frequency_hz.into(),
            (1e-6 * point.stiffness_n_per_m).into(),
            point.phase_rad.to_degrees().into(),
            (1e2 * point.force_rest).into(),
        ]
    });
    let mut lines = table.rows(rows).lines();
    lines.push(format!(
        "stiffness {:.3} +- {:.3} MN/m from the displacement sensor to the ground, force {:.4} +- \
         {:.4} ms late, residual {:.2} %",
        1e-6 * fit.stiffness_n_per_m,
        1e-6 * fit.stiffness_error_n_per_m,
        1e3 * fit.skew_s,
        1e3 * fit.skew_error_s,
        1e2 * fit.residual
    ));
    if fit.residual > RESIDUAL_MOST {
        lines.push("warning: a residual above 10 %, expected less of a rigid bar".to_owned());
    }
    Some((file.with_bar(&fit, bench.args.calibrate.certificate.as_deref()), lines))
}
