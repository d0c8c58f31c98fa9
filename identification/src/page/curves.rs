//! Curves of one test: record and models over time, and over displacement.

use super::prefix::Prefixed;
use super::shown::Shown;
use crate::tables::{DATASHEET, REFITTED, WITH_EFFECTS};
use report::Plot;
use std::ops::Range;

/// The record.
pub(super) const MEASURED: &str = "measured";
/// Colours of the models, the same in every plot.
pub(super) const PALETTE: [&str; 3] = [WITH_EFFECTS, DATASHEET, REFITTED];

/// A whole record and its enlarged stretch fit on one sheet of A4, one below the other.
const TIME_HEIGHT_PX: u32 = 420;
const LOOP_HEIGHT_PX: u32 = 360;

/// Which models are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Which {
    /// The maker's.
    pub(super) datasheet: bool,
    /// The refitted one.
    pub(super) refitted: bool,
    /// The one with effects.
    pub(super) with_effects: bool,
}

impl Which {
    /// The chosen models that there are, with their names, the best one last and so on top.
    fn chosen<'a>(self, shown: &Shown<'a>) -> Vec<(&'static str, &'a [f64])> {
        let all = [
            (self.datasheet, DATASHEET, shown.force_n.datasheet),
            (self.refitted, REFITTED, shown.force_n.refitted),
            (self.with_effects, WITH_EFFECTS, shown.force_n.with_effects),
        ];
        all.into_iter()
            .filter_map(|(is, name, force)| Some((name, force.filter(|_| is)?)))
            .collect()
    }
}

/// Force over time with the stretch enlarged, and the residuals below.
pub(super) fn over_time(title: &str, shown: &Shown<'_>, which: Which) -> Plot {
    let record = &shown.test.record;
    let samples = record.force_n.len();
    let time_s: Vec<f64> =
        (0..samples).map(|i| record.start_s + i as f64 * record.step_s).collect();
    let force = Prefixed::for_all("N", &record.force_n);
    let mut plot = Plot::new(title)
        .palette(&PALETTE)
        .x("time", "s")
        .y("force", &force.unit)
        .height_px(TIME_HEIGHT_PX)
        .backdrop(MEASURED, &time_s, &force.values(&record.force_n));
    let models = which.chosen(shown);
    for (name, simulated) in &models {
        plot = plot.line(name, &time_s, &force.values(simulated));
    }
    if !models.is_empty() {
        let counted = shown.test.counted();
        let residuals: Vec<(&str, Vec<f64>)> = models
            .iter()
            .map(|(name, simulated)| {
                let pairs = record.force_n.iter().zip(simulated.iter());
                (*name, pairs.map(|(y, f)| y - f).collect())
            })
            .collect();
        // The run-in is drawn and not counted; it does not set the scale.
        let largest = residuals
            .iter()
            .flat_map(|(_, residual)| &residual[counted.clone()])
            .fold(0.0, |most: f64, r| most.max(r.abs()));
        let unit = Prefixed::for_size("N", largest);
        plot = plot.panel_below("residual", &unit.unit);
        if largest > 0.0 {
            let end = 1.08 * unit.value(largest);
            plot = plot.y_range(-end..=end);
        }
        for (name, residual) in residuals {
            plot = plot.line(name, &time_s, &unit.values(&residual));
        }
        if counted.start > 0 && counted.start < samples {
            plot = plot.span("run-in", time_s[0]..=time_s[counted.start]);
        }
    }
    let stretch = shown.stretch();
    if let (Some(from), Some(to)) = (time_s.get(stretch.start), time_s.get(stretch.end - 1))
        && 2 * stretch.len() < samples
        && from < to
    {
        plot = plot.zoom("Enlarged: where the error of the refitted model is largest", *from..=*to);
    }
    plot
}

/// What a loop is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Over {
    /// Displacement.
    Displacement,
    /// Velocity of the end.
    Velocity,
}

impl Over {
    /// Name and SI unit of the axis, and its values.
    fn axis<'a>(self, shown: &Shown<'a>) -> (&'static str, &'static str, &'a [f64]) {
        let record = &shown.test.record;
        match self {
            Self::Displacement => ("displacement", "m", &record.displacement_m),
            Self::Velocity => ("velocity", "m/s", &record.velocity_m_per_s),
        }
    }
}

/// Force in a stretch over displacement or velocity.
pub(super) fn loop_of(shown: &Shown<'_>, over: Over, stretch: &Range<usize>, which: Which) -> Plot {
    let (name, unit, values) = over.axis(shown);
    let (values, measured) =
        (&values[stretch.clone()], &shown.test.record.force_n[stretch.clone()]);
    let (x_unit, force) = (Prefixed::for_all(unit, values), Prefixed::for_all("N", measured));
    let x = x_unit.values(values);
    let mut plot = Plot::new(&format!("{}: force over {name}", shown.title()))
        .palette(&PALETTE)
        .x(name, &x_unit.unit)
        .y("force", &force.unit)
        .height_px(LOOP_HEIGHT_PX)
        .backdrop(MEASURED, &x, &force.values(measured));
    for (name, simulated) in which.chosen(shown) {
        plot = plot.line(name, &x, &force.values(&simulated[stretch.clone()]));
    }
    plot
}

/// Residual in a stretch over displacement.
pub(super) fn residual_of(shown: &Shown<'_>, stretch: &Range<usize>, which: Which) -> Plot {
    let (name, unit, values) = Over::Displacement.axis(shown);
    let values = &values[stretch.clone()];
    let x_unit = Prefixed::for_all(unit, values);
    let x = x_unit.values(values);
    let measured = &shown.test.record.force_n[stretch.clone()];
    let residuals: Vec<(&str, Vec<f64>)> = which
        .chosen(shown)
        .into_iter()
        .map(|(name, simulated)| {
            let pairs = measured.iter().zip(&simulated[stretch.clone()]);
            (name, pairs.map(|(y, f)| y - f).collect())
        })
        .collect();
    let force = Prefixed::for_all("N", residuals.iter().flat_map(|(_, residual)| residual));
    let mut plot = Plot::new(&format!("{}: residual over {name}", shown.title()))
        .palette(&PALETTE)
        .x(name, &x_unit.unit)
        .y("residual", &force.unit)
        .height_px(LOOP_HEIGHT_PX);
    for (name, residual) in residuals {
        plot = plot.line(name, &x, &force.values(&residual));
    }
    plot
}
