//! The figures by which runs are compared: what the vehicle does, and what its dampers do.

use crate::statistics::Sums;
use crate::summary::{Accelerations, DamperSummary};
use scenario::run::Run;

/// One figure of a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Figure {
    /// What it is: of what, and which figure.
    pub(crate) quantity: String,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// None where the run ended before statistics began.
    pub(crate) value: Option<f64>,
}

/// The figures of one run, in the same order for every run of a vehicle.
pub(crate) fn figures(
    run: &Run,
    dampers: &[DamperSummary],
    accelerations: &Accelerations,
    sums: &Sums,
) -> Vec<Figure> {
    let mut figures = Vec::new();
    let mut add = |of: &str, what: &str, unit, value: f64| {
        let value = Some(value).filter(|value| sums.rows > 0 && value.is_finite());
        figures.push(Figure { quantity: format!("{of}, {what}"), unit, value });
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
