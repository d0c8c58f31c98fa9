//! The comparison of a run: what another damper would have made of the vehicle.
//!
//! ```text
//! change = 100 % (after / before - 1)        before: the other damper, after: the scenario's own
//! ```
//! A scenario with `[compare]` is run once more with the other damper, on the memory bus and in virtual
//! time, when its own run is over and its files are written ([`SecondRun`]). Vehicle, track, speed, rig and
//! seeds are the same, so that a damper compared with itself changes nothing, to the last bit. The
//! figures are those of the summary, and how far the leading wheelset moves on the track.
//!
//! Limits: a rig on a real bus cannot be run again, its slot is modelled before and measured after. A
//! negative figure (a force in compression) that grows in size has a positive change.

mod second_run;
mod section;

pub use second_run::SecondRun;
pub use section::section;

use crate::columns::Columns;
use crate::summary::{Accelerations, DamperSummary, Summary};
use firmware_core::damper::Damper;
use scenario::compare::CompareSetup;
use scenario::run::{CYCLE_S, Run, SlotForce};
use serde::Serialize;
use signal::statistics;
use std::collections::BTreeMap;

/// A comparison as it stands in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What the other damper is called.
    pub name: String,
    /// The other damper.
    pub damper: ComparedDamper,
    /// How its run ended: `completed` or `safe`.
    pub state: &'static str,
    /// Model time of it (s).
    pub duration_s: f64,
    /// Its trajectory hash: that of a plain run with this damper.
    pub trajectory_hash: String,
    /// Slots that are on a rig of a real bus in the run, and modelled in the one compared with.
    pub modelled_instead: Vec<String>,
    /// What changes.
    pub quantities: Vec<Quantity>,
}

/// A damper in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ComparedDamper {
    pub ce_n_s_per_m: f64,
    pub ke_n_per_m: f64,
    pub clearance_2a_m: f64,
    /// Null without relief.
    pub f_relief_n: Option<f64>,
    pub c2_n_s_per_m: f64,
    pub effects: Vec<ComparedEffect>,
}

/// An effect of a damper.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct ComparedEffect {
    pub name: &'static str,
    pub parameters: BTreeMap<&'static str, f64>,
}

/// One figure, before and after.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// What it is.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// With the other damper; null when its run ended before statistics began.
    pub before: Option<f64>,
    /// As the scenario says.
    pub after: Option<f64>,
    /// The change (%); null from zero.
    pub change_percent: Option<f64>,
}

impl From<&Damper> for ComparedDamper {
    fn from(damper: &Damper) -> Self {
        let nominal = damper.nominal();
        let effects = damper.effects().iter().map(|effect| ComparedEffect {
            name: effect.name(),
            parameters: effect
                .parameters()
                .iter()
                .map(|row| row.name)
                .zip(effect.values())
                .collect(),
        });
        Self {
            ce_n_s_per_m: nominal.ce_n_s_per_m,
            ke_n_per_m: nominal.ke_n_per_m,
            clearance_2a_m: nominal.clearance_2a_m,
            f_relief_n: Some(nominal.f_relief_n).filter(|force| force.is_finite()),
            c2_n_s_per_m: nominal.c2_n_s_per_m,
            effects: effects.collect(),
        }
    }
}

impl Comparison {
    /// Sets a run beside its second one.
    pub fn of(
        setup: &CompareSetup,
        (run, summary, columns): (&Run, &Summary, &Columns),
        (other, second): (&Run, &SecondRun),
    ) -> Self {
        let first = second.columns.first_after(run.run_in_s);
        let dampers = crate::summary::dampers(other, &second.columns, first);
        let accelerations = crate::summary::accelerations(second.watched, &second.columns, first);
        let before = figures(other, &dampers, &accelerations, &second.columns);
        let after = figures(run, &summary.damper, &summary.accelerations, columns);
        let known = |value: f64, columns: &Columns| {
            let any = columns.first_after(run.run_in_s) < columns.time_s.len();
            Some(value).filter(|value| any && value.is_finite())
        };
        let quantities = before.into_iter().zip(after).map(|(before, (quantity, unit, after))| {
            let (before, after) = (known(before.2, &second.columns), known(after, columns));
            let change_percent = before.zip(after).and_then(|(b, a)| change_percent(b, a));
            Quantity { quantity, unit, before, after, change_percent }
        });
        let on_a_rig = |force: &SlotForce| matches!(force, SlotForce::Rig { .. });
        let pairs = run.slots.iter().zip(&other.slots);
        let instead = pairs.filter(|(one, two)| on_a_rig(&one.force) && !on_a_rig(&two.force));
        Self {
            name: setup.name.clone(),
            damper: ComparedDamper::from(&setup.damper),
            state: if second.safe { "safe" } else { "completed" },
            duration_s: second.cycles as f64 * CYCLE_S,
            trajectory_hash: format!("{:016x}", second.hash),
            modelled_instead: instead.map(|(slot, _)| slot.place.clone()).collect(),
            quantities: quantities.collect(),
        }
    }

    /// What makes the two runs unlike beside their dampers, one sentence each.
    pub fn warnings(&self, run_state: &str) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.state == "safe" {
            warnings.push(format!(
                "with {} the model left its track after {:.1} s: before covers only what came until then",
                self.name, self.duration_s
            ));
        }
        if run_state == "safe" {
            warnings.push(
                "the run ended in the safe state: after covers only what came until then"
                    .to_owned(),
            );
        }
        if !self.modelled_instead.is_empty() {
            warnings.push(format!(
                "{}: on a rig after, modelled before, without the rig's lag and noise",
                self.modelled_instead.join(", ")
            ));
        }
        warnings
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "what the difference does to the vehicle: {} before, the scenario's own damper after",
            self.name
        )?;
        writeln!(
            f,
            "{:<42} {:<5} {:>10} {:>10} {:>10}",
            "quantity", "unit", "before", "after", "change %"
        )?;
        for quantity in &self.quantities {
            let (scale, unit) = quantity.readable();
            let number = |value: Option<f64>| {
                value.map_or("-".to_owned(), |value| report::significant(value * scale, 4))
            };
            let change = quantity.change_percent;
            writeln!(
                f,
                "{:<42} {:<5} {:>10} {:>10} {:>10}",
                quantity.quantity,
                unit,
                number(quantity.before),
                number(quantity.after),
                change.map_or("-".to_owned(), |percent| format!("{percent:+.1}")),
            )?;
        }
        Ok(())
    }
}

impl Quantity {
    /// Factor and unit for readers: forces in kN, strokes in mm.
    fn readable(&self) -> (f64, &'static str) {
        match self.unit {
            "N" => (1e-3, "kN"),
            "m" => (1e3, "mm"),
            "m/s2" => (1.0, "m/s²"),
            unit => (1.0, unit),
        }
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
    columns: &Columns,
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
        let moved = &columns.wheelset_lateral_m[columns.first_after(run.run_in_s)..];
        let most = moved.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        add("wheelset 1", "lateral displacement rms", "m", statistics::rms(moved));
        add("wheelset 1", "lateral displacement max", "m", most);
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
