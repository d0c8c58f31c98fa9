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
mod figures;
mod pairs;
mod second_run;
mod section;

pub(crate) use difference::readable;
pub use difference::{ComparedDamper, ComparedEffect, Comparison, Quantity};
pub(crate) use figures::{Figure, figures};
pub(crate) use second_run::{Cycles, SecondRun};
pub(crate) use section::section;

use crate::statistics::Statistics;
use crate::summary::Summary;
use scenario::compare::CompareSetup;
use scenario::run::{Run, SlotForce};

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
    let quantities = before.into_iter().zip(after).map(|(before, after)| {
        let Figure { quantity, unit, value: after } = after;
        let before = before.value;
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
        duration_s: second.counts.run_cycles as f64 * run.cycle_s(),
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
