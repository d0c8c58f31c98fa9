//! From readings to a test on a uniform clock: checked, repaired, with velocity and acceleration.

use crate::cycles;
use crate::error::MeasurementError;
use crate::layout::Extension;
use crate::measurement::Measurement;
use crate::series::Series;
use crate::sign::{self, Agreement};
use crate::{clock, force_faults, integral, interpolant, plausibility, smoothing};
use std::collections::BTreeMap;

impl Measurement {
    /// A measurement from readings: checked, on a uniform clock, signs as agreed.
    ///
    /// # Errors
    /// The first thing that does not fit.
    ///
    /// ```
    /// use measurement::{Measurement, Series};
    /// // A dashpot of 10 kN s/m at 2 Hz and 5 mm.
    /// let w = std::f64::consts::TAU * 2.0;
    /// let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 1e-3);
    /// let f = |n: usize| 10e3 * 5e-3 * w * libm::cos(w * n as f64 * 1e-3);
    /// let (x, f) = ((0..3000).map(x).collect(), (0..3000).map(f).collect());
    /// let series = Series::sampled("a", 1e3, x, f);
    /// let test = Measurement::from_series(series)?;
    /// assert!((test.frequency_hz().unwrap() - 2.0).abs() < 1e-3);
    /// assert!((test.amplitude_m() - 5e-3).abs() < 1e-6);
    /// assert_eq!(test.run_in, 500);
    /// # Ok::<(), measurement::MeasurementError>(())
    /// ```
    pub fn from_series(series: Series) -> Result<Self, MeasurementError> {
        let mut alone = as_recorded(series)?;
        settle_signs(&mut [&mut alone]);
        Ok(alone)
    }

    /// The tests of one visit, wired alike: all of them together decide about their signs.
    ///
    /// # Errors
    /// The first thing that does not fit.
    pub fn from_visit(
        visit: impl IntoIterator<Item = Series>,
    ) -> Result<Vec<Self>, MeasurementError> {
        let mut tests = visit.into_iter().map(as_recorded).collect::<Result<Vec<_>, _>>()?;
        settle_signs(&mut tests.iter_mut().collect::<Vec<_>>());
        Ok(tests)
    }
}

/// A test whose force has the sign that was recorded.
///
/// # Errors
/// The first thing that does not fit.
pub(crate) fn as_recorded(mut series: Series) -> Result<Measurement, MeasurementError> {
    debug_assert!(series.is_complete(), "{}: channels of different length", series.name);
    plausibility::check_size(&series)?;
    series.turn_to_extension();
    force_faults::refuse_clipped(&mut series)?;
    force_faults::refuse_frozen(&series)?;
    force_faults::mend_spikes(&mut series);
    let start_s = series.time_s.first().copied().unwrap_or(0.0);
    let step_s = clock::make_uniform(&mut series)?;
    let mut destroyed = BTreeMap::new();
    if series.is_integrated {
        integrate(&mut series, step_s, &mut destroyed);
    }
    plausibility::check_length(&series, step_s)?;
    destroyed.extend(plausibility::report_rate(&mut series, step_s));
    let runs = cycles::runs(&series.displacement_m);
    let cycles = cycles::longest(&runs);
    let agreement = Agreement::of(&series, &cycles, step_s)?;
    let drive_m = smoothing::smoothed(&series.displacement_m);
    let (velocity_m_per_s, acceleration_m_per_s2) = interpolant::derivatives(&drive_m, step_s);
    plausibility::report_velocity(&mut series, &velocity_m_per_s);
    let run_in = cycles::run_in(&cycles, series.force_n.len(), step_s);
    debug_assert!(series.is_complete() && drive_m.len() == series.force_n.len());
    debug_assert!(cycles.is_sorted() && cycles.iter().all(|at| *at < series.force_n.len()));
    Ok(Measurement {
        name: series.name,
        file: series.file,
        start_s,
        step_s,
        displacement_m: series.displacement_m,
        drive_m,
        velocity_m_per_s,
        acceleration_m_per_s2,
        force_n: series.force_n,
        temperature_degc: series.temperature_degc,
        cycles,
        runs,
        run_in,
        direction_declared: series.extension != Extension::Unknown,
        force_turned: false,
        repairs: series.repairs,
        destroyed,
        specimen: None,
        agreement,
    })
}

/// Effects that depend on where the damper stands on its stroke.
const OF_POSITION: [&str; 3] =
    ["position_dependent_damping", "bump_stop", "stroke_dependent_stiffness"];

/// Replaces the first integral of the velocity by that over the uniform clock.
fn integrate(series: &mut Series, step_s: f64, destroyed: &mut BTreeMap<&'static str, String>) {
    let Some(velocity_m_per_s) = &series.velocity_m_per_s else { return };
    let (displacement_m, drift_m_per_s) = integral::displacement(velocity_m_per_s, step_s);
    series.displacement_m = displacement_m;
    series.repairs.push(format!(
        "{}: no displacement was recorded: the velocity is integrated, a drift of {:.4} mm/s is \
         removed; the position on the stroke is not known",
        series.columns[1],
        1e3 * drift_m_per_s
    ));
    for effect in OF_POSITION {
        let why = "the displacement is an integrated velocity: the position is not known";
        destroyed.insert(effect, why.to_owned());
    }
}

/// Turns the force where it disagrees with the displacement.
pub(crate) fn settle_signs(visit: &mut [&mut Measurement]) {
    let disagree = sign::disagree(visit.iter().map(|test| &test.agreement));
    for test in visit {
        test.force_turned = test.agreement.turned(disagree);
        if test.force_turned {
            test.force_n.iter_mut().for_each(|force| *force = -*force);
        }
        test.repairs.extend(test.agreement.report(disagree));
    }
}
