//! Motions without a test: a way that the ram rests behind, and warm oil.
//!
//! A way is a raised cosine in time, `x = (1 - cos(pi t / T)) / 2 d` with `T = pi d / (2 v)`, of at
//! most 5 mm/s. The limits of the rig rule; a way that leads beyond its stroke is refused when the
//! rig is armed, which is when it says where its ram stands.

use super::records::counted;
use super::{Bench, ended_early};
use crate::error::CommandError;
use crate::exit::FAILED;
use crate::output::{self, print};
use firmware_core::command::Command;
use firmware_core::supervision::CommandLimits;
use hil_host::run::{OpenLoopPlan, OpenLoopRecord, Origin, PlannedTest, on_the_way};
use scenario::run::CYCLE_S;
use std::f64::consts::PI;
use std::process::ExitCode;

/// Highest speed of a jog (m/s).
const JOG_M_PER_S: f64 = 5e-3;
/// Cycles of rest behind a jog.
const REST_CYCLES: usize = 200;
/// Stroke that is asked for where the rig's own rules (m).
const ANY_STROKE_M: f64 = 1.0;

/// Moves the ram, and leaves it where it is.
pub(super) fn jog(bench: &Bench<'_>, way_m: f64) -> Result<ExitCode, CommandError> {
    let name = "jog".to_owned();
    let plan = OpenLoopPlan {
        returns: false,
        ..task(bench, PlannedTest { name, commands: jog_commands(way_m) })
    };
    let found = conduct(bench, &plan)?;
    if let Some(code) = ended_early(&found) {
        return Ok(code);
    }
    let rests_mm = 1e3 * found.rests_at_m;
    print(&format!("the ram rests at {rests_mm:.2} mm\n{}", counted(&found)))?;
    Ok(ExitCode::SUCCESS)
}

/// Strokes the damper until its oil is warm.
pub(super) fn warm_up(bench: &Bench<'_>, degc: f64) -> Result<ExitCode, CommandError> {
    let nothing = PlannedTest { name: "warm-up".to_owned(), commands: Vec::new() };
    let window_degc = Some(degc..=f64::INFINITY);
    let plan = OpenLoopPlan { window_degc, ..task(bench, nothing) };
    let found = conduct(bench, &plan)?;
    if let Some(code) = ended_early(&found) {
        return Ok(code);
    }
    let (message, is_warm) = match found.temperature_degc {
        Some(found_degc) => {
            (format!("the oil is at {found_degc:.1} degrees Celsius"), found_degc >= degc)
        }
        None => ("the rig reports no temperature".to_owned(), false),
    };
    if !is_warm {
        output::complain(&format!("{message}, expected {}", files::number(degc)));
        return Ok(ExitCode::from(FAILED));
    }
    print(&format!("{message}\n{}", counted(&found)))?;
    Ok(ExitCode::SUCCESS)
}

/// A motion from where the ram stands, within the limits of the rig.
fn task<'b>(bench: &'b Bench<'_>, test: PlannedTest) -> OpenLoopPlan<'b> {
    let plan = bench.plan(vec![test]);
    let limits = CommandLimits { stroke_m: ANY_STROKE_M, ..plan.limits };
    OpenLoopPlan { limits, origin: Origin::WhereItStands, needs_its_limits: false, ..plan }
}

fn conduct(bench: &Bench<'_>, plan: &OpenLoopPlan<'_>) -> Result<OpenLoopRecord, CommandError> {
    let mut folder = bench.folder(None, &[])?;
    bench.conduct(plan, &mut folder)
}

/// A way from rest to rest, and a short rest behind it.
fn jog_commands(way_m: f64) -> Vec<Command> {
    let length_s = PI * way_m.abs() / (2.0 * JOG_M_PER_S);
    let cycles = libm::ceil(length_s / CYCLE_S).max(1.0) as usize;
    (0..=cycles + REST_CYCLES).map(|cycle| on_the_way(0.0, way_m, cycle, cycles)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jog_keeps_its_speed_and_ends_at_rest_where_it_was_sent() {
        for way_m in [20e-3, -0.1e-3, 0.0] {
            let commands = jog_commands(way_m);
            let fastest = commands.iter().map(|c| c.velocity_m_per_s.abs()).fold(0.0, f64::max);
            assert!(fastest <= JOG_M_PER_S, "{fastest} m/s");
            assert!(way_m.abs() < 1e-3 || fastest > 0.999 * JOG_M_PER_S, "{fastest} m/s");
            for pair in commands.windows(2) {
                let step_m = pair[1].displacement_m - pair[0].displacement_m;
                assert!(step_m.abs() <= 1.001 * JOG_M_PER_S * CYCLE_S, "{step_m} m");
            }
            let last = commands[commands.len() - 1];
            assert!((last.displacement_m - way_m).abs() < 1e-15, "{last:?}");
            assert_eq!(last.velocity_m_per_s, 0.0);
        }
    }
}
