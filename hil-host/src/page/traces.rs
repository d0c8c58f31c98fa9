//! Traces in the units that a report shows, and what is worth showing of them.

use crate::statistics::Trace;
use report::Plot;
use signal::spectrum::Welch;

pub(crate) fn kilo(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e-3).collect()
}

pub(crate) fn milli(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e3).collect()
}

/// Draws a trace over time, in a unit of which one of the trace has so many.
pub(super) fn line(plot: Plot, name: &str, trace: &Trace, scale: f64) -> Plot {
    let values: Vec<f64> = trace.value.iter().map(|value| value * scale).collect();
    plot.line_of(name, &trace.time_s, &values, trace.samples())
}

/// Highest frequency that spectra show (Hz).
const SPECTRUM_TO_HZ: f64 = 50.0;

/// Frequencies (Hz) and densities of a spectrum, up to what a plot shows.
pub(crate) fn spectrum(welch: &Welch) -> (Vec<f64>, Vec<f64>) {
    match welch.spectrum() {
        Ok(spectrum) => spectrum
            .lines()
            .filter(|(frequency, density)| {
                *frequency > 0.0 && *frequency <= SPECTRUM_TO_HZ && *density > 0.0
            })
            .unzip(),
        Err(_) => (Vec::new(), Vec::new()),
    }
}
