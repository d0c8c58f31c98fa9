//! Critical speeds over the delay as a table, with the conditions for which they hold.

use super::answer::{OnRigs, Point};
use super::procedure::Question;
use crate::over_seeds::seeds_in_words;
use crate::point_table::{self, key_cells, keyed};
use report::{Cell, Table};

/// The points as text for a terminal, and under which conditions they hold.
pub(super) fn text(points: &[Point], question: &Question) -> String {
    point_table::text(&[table(points)], points, &conditions(points, question))
}

/// The dampers behind rigs of a point, by what they are called.
pub(super) type Case = (String, fn(&Point) -> Option<&OnRigs>);

/// The cases that some point has an answer for.
pub(super) fn cases(points: &[Point]) -> Vec<Case> {
    let of: [fn(&Point) -> Option<&OnRigs>; 2] =
        [|point| point.answer.as_in_scenario.as_ref(), |point| point.answer.all_on_rigs.as_ref()];
    let named = of.into_iter().filter_map(|of| {
        let rigs = points.iter().find_map(of)?.rigs;
        Some((if rigs == 1 { "1 rig".to_owned() } else { format!("{rigs} rigs") }, of))
    });
    named.collect()
}

/// The points as a table, with the columns that some point has an entry for.
pub(super) fn table(points: &[Point]) -> Table {
    let cases = cases(points);
    let mut table =
        keyed("Critical speed", points).fixed("measured", "ms", 2).fixed("damping lost", "%", 1);
    table = table.written("modelled", "km/h");
    let hunts_from = hunts_from(points);
    for (name, _) in &cases {
        table = table
            .written(name, "km/h")
            .fixed("difference", "km/h", 1)
            .fixed("difference", "%", 1)
            .fixed("linear", "km/h", 1);
        if hunts_from {
            table = table.fixed("hunts from", "km/h", 1);
        }
    }
    table.rows(points.iter().map(|point| {
        let modelled = point.answer.modelled;
        let first = cases.iter().find_map(|(_, of)| of(point));
        let mut row = key_cells(point);
        row.push(first.and_then(|found| found.measured_delay_s).map(|s| 1e3 * s).into());
        row.push(first.and_then(|found| found.damping_lost_percent).into());
        row.push(modelled.map(|speeds| speeds.fold.to_string()).into());
        for (_, of) in &cases {
            let found = of(point);
            let off =
                found.and_then(|found| found.difference(modelled, |speeds| speeds.fold.kmh()));
            let linear =
                found.and_then(|found| found.difference(modelled, |speeds| speeds.linear.kmh()));
            row.push(found.map(|found| found.speeds.fold.to_string()).into());
            row.extend([off.map(|[kmh, _]| kmh), off.map(|[_, percent]| percent)].map(Cell::from));
            row.push(linear.map(|[kmh, _]| kmh).into());
            if hunts_from {
                let off = found
                    .and_then(|found| found.difference(modelled, |speeds| speeds.hunts_from_kmh));
                row.push(off.map(|[kmh, _]| kmh).into());
            }
        }
        row
    }))
}

/// Whether some point has the speed from which irregular track leads to hunting.
pub(super) fn hunts_from(points: &[Point]) -> bool {
    let mut modelled = points.iter().filter_map(|point| point.answer.modelled);
    modelled.any(|speeds| speeds.hunts_from_kmh.is_some())
}

/// What every speed holds for.
pub(super) fn conditions(points: &[Point], question: &Question) -> Vec<String> {
    let frequency = points.iter().find_map(|point| point.answer.hunting_hz);
    let frequency = frequency.map_or_else(String::new, |hz| format!(", {hz:.2} Hz"));
    let mut lines = vec![
        format!(
            "emulated rig: ideal, its force late by rig_delay_ms, early where that is negative by a \
             compensator that extrapolates too far; measured over {} s of class-6 track at the speed of \
             the scenario, as a run does",
            question.measured_s
        ),
        format!(
            "damping lost: by the formula, at the frequency of hunting with modelled dampers{frequency}; \
             more than 5 % is refused by a run on a real bus"
        ),
        format!(
            "critical speed: the largest motion that stays at {} km/h followed down until it dies, met \
             within {} km/h; linear: the same difference by eigenvalues, every damper as stiffness and \
             damping of a stroke of {} mm, turned by the delay",
            question.procedure.to_kmh,
            question.procedure.resolution_kmh,
            1e3 * question.stroke_m
        ),
    ];
    if hunts_from(points) {
        lines.push(format!(
            "hunts from: the same difference of the first speed at which class-6 track leads to a hunting \
             that stays, mean over seeds {}",
            seeds_in_words(&question.procedure.seeds)
        ));
    }
    lines
}
