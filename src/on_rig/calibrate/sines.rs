//! Sines that rise from rest, and force over displacement in what was measured of them.

use crate::on_rig::visit::commands;
use hil_host::calibration::SinePair;
use hil_host::run::{MeasuredTest, PlannedTest};
use scenario::run::CYCLE_S;
use virtual_bench::excitation::Excitation;

/// Time for which a sine, or a rig at rest, is measured (s).
pub(super) const MEASURED_S: f64 = 4.0;
/// Periods in which a sine rises.
const RISE_PERIODS: f64 = 1.5;

/// A sine that rises from rest and is measured for some seconds.
pub(super) fn sine(name: &str, frequency_hz: f64, amplitude_m: f64) -> PlannedTest {
    let periods = libm::ceil(MEASURED_S * frequency_hz);
    let motion = Excitation::sine(amplitude_m, frequency_hz);
    let cycles = ((periods + RISE_PERIODS) / frequency_hz / CYCLE_S) as usize;
    let name = format!("{name}-{frequency_hz}hz");
    PlannedTest { name, commands: commands(&motion, 0.0, cycles) }
}

/// Force and displacement of every sine, once it has risen.
pub(super) fn pairs(tests: &[MeasuredTest], frequencies_hz: &[f64]) -> Option<Vec<SinePair>> {
    let risen = |hz: &f64| (RISE_PERIODS + 0.5) / hz;
    let pairs = tests.iter().zip(frequencies_hz);
    pairs.map(|(test, hz)| SinePair::of(test, *hz, risen(hz))).collect()
}
