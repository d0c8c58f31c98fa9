//! What changes from one run to the other, as `summary.json` and a terminal have it.

use crate::control::End;
use firmware_core::damper::Damper;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// A comparison, as `summary.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What the other damper is called.
    pub name: String,
    /// The other damper.
    pub damper: ComparedDamper,
    /// How its run ended: `completed` or `safe`.
    pub state: End,
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
    /// What makes the two runs differ in addition to their dampers, one sentence each.
    pub fn warnings(&self, run_state: End) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.state == End::Safe {
            warnings.push(format!(
                "with {} the model left its track after {:.1} s: before covers only the time \
                 until then",
                self.name, self.duration_s
            ));
        }
        if run_state == End::Safe {
            warnings.push(
                "the run ended in the safe state: after covers only the time until then".to_owned(),
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

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
    /// Factor and unit for readers.
    pub(super) fn readable(&self) -> (f64, &'static str) {
        readable(self.unit)
    }
}

/// Factor and unit of a figure for readers: forces in kN, strokes in mm.
pub(crate) fn readable(unit: &'static str) -> (f64, &'static str) {
    match unit {
        "N" => (1e-3, "kN"),
        "m" => (1e3, "mm"),
        "m/s2" => (1.0, "m/s²"),
        unit => (1.0, unit),
    }
}
