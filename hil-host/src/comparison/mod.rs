//! The comparison of a run: the same vehicle with another damper.
//!
//! ```text
//! change = 100 % (after / before - 1)        before: the other damper, after: the scenario's own
//! ```
//! A scenario with `[compare]` is run once more with the other damper, on the memory bus and in
//! virtual time, when its own run is over and its files are written ([`SecondRun`]). Vehicle,
//! track, speed, rig and seeds are the same, so that a damper compared with itself changes nothing,
//! to the last bit. The figures are those of the summary, and how far the leading wheelset moves on
//! the track.
//!
//! Limits: a rig on a real bus cannot be run again, its slot is modelled before and measured after.
//! A negative figure (a force in compression) that grows in size has a positive change.

mod difference;
mod pairs;
mod second_run;
mod section;

pub use difference::{ComparedDamper, ComparedEffect, Comparison, Quantity};
pub(crate) use second_run::{Cycles, SecondRun};
pub(crate) use section::section;

use crate::statistics::{Statistics, Sums};
use crate::summary::{Accelerations, DamperSummary, Summary};
use scenario::compare::CompareSetup;
use scenario::run::{CYCLE_S, Run, SlotForce};

/// Compares a run with its second one.
pub(crate) fn compare(
    setup: &CompareSetup,
    (run, summary, statistics): (&Run, &Summary, &Statistics),
    (other, second): (&Run, &SecondRun),
) -> Comparison {
    let (sums, sums_before) = (statistics.after_run_in(), second.statistics.after_run_in());
    let dampers = crate::summary::dampers(other, &second.counts, sums_before, None);
    let accelerations = crate::summary::accelerations(second.watched, sums_before);
    let before = figures(other, &dampers, &accelerations, sums_before);
    let after = figures(run, &summary.damper, &summary.accelerations, sums);
    let known =
        |value: f64, sums: &Sums| Some(value).filter(|value| sums.rows > 0 && value.is_finite());
    let quantities = before.into_iter().zip(after).map(|(before, (quantity, unit, after))| {
        let (before, after) = (known(before.2, sums_before), known(after, sums));
        let change_percent = before.zip(after).and_then(|(b, a)| change_percent(b, a));
        Quantity { quantity, unit, before, after, change_percent }
    });
    let on_a_rig =
        |force: &SlotForce| matches!(force, SlotForce::Rig { .. } | SlotForce::StandIn { .. });
    let pairs = run.slots.iter().zip(&other.slots);
    let instead = pairs.filter(|(one, two)| on_a_rig(&one.force) && !on_a_rig(&two.force));
    Comparison {
        name: setup.name.clone(),
        damper: ComparedDamper::from(&setup.damper),
        state: second.end,
        duration_s: second.counts.run_cycles as f64 * CYCLE_S,
        trajectory_hash: format!("{:016x}", second.hash),
        modelled_instead: instead.map(|(slot, _)| slot.place.clone()).collect(),
        quantities: quantities.collect(),
    }
}

/// Change of a figure (%); none from zero to something.
fn change_percent(before: f64, after: f64) -> Option<f64> {
    match () {
        () if before == after => Some(0.0),
        () if before == 0.0 => None,
        () => Some(100.0 * (after - before) / before),
    }
}

/// The figures of one run by name and unit, in the same order for every run of a vehicle.
fn figures(
    run: &Run,
    dampers: &[DamperSummary],
    accelerations: &Accelerations,
    sums: &Sums,
) -> Vec<(String, &'static str, f64)> {
    let mut figures = Vec::new();
    let mut add = |of: &str, what: &str, unit, value| {
        figures.push((format!("{of}, {what}"), unit, value));
    };
    let bodies = [
        ("wheelset 1", accelerations.wheelset_1),
        ("bogie front", accelerations.bogie_front),
        ("carbody", accelerations.carbody),
    ];
    for (name, body) in bodies {
        if let Some(body) = body {
            add(name, "lateral acceleration rms", "m/s2", body.lateral_rms_m_per_s2);
        }
    }
    if let Some(body) = accelerations.carbody {
        add("carbody", "vertical acceleration rms", "m/s2", body.vertical_rms_m_per_s2);
    }
    if !run.vehicle.axles.is_empty() {
        add("wheelset 1", "lateral displacement rms", "m", sums.wheelset_lateral.rms());
        add("wheelset 1", "lateral displacement max", "m", sums.wheelset_lateral_max_m);
    }
    for damper in dampers {
        let name = format!("damper {}", damper.name);
        add(&name, "force rms", "N", damper.force_n.rms);
        add(&name, "force min", "N", damper.force_n.min);
        add(&name, "force max", "N", damper.force_n.max);
        add(&name, "stroke rms", "m", damper.stroke_m.rms);
        add(&name, "stroke max", "m", damper.stroke_m.max);
        add(&name, "work", "J/s", damper.work_per_s_j);
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_relative_to_before_and_positive_for_what_grows_in_size() {
        assert_eq!(change_percent(2.0, 3.0), Some(50.0));
        assert_eq!(change_percent(-20.0, -25.0), Some(25.0));
        assert_eq!(change_percent(0.0, 0.0), Some(0.0));
        assert_eq!(change_percent(0.0, 1.0), None);
    }
}
