//! Traces in the units that a report shows, and what is worth showing of them.

use crate::summary::SEGMENT_S;
use scenario::run::CYCLE_S;
use signal::spectrum::Spectrum;

/// Where the window with the greatest sum of squares begins; none in a trace hardly longer than it.
pub(crate) fn most_in(values: &[f64], window: usize) -> Option<usize> {
    let (mut sum, mut best, mut at) = (0.0, -1.0, 0);
    for (index, value) in values.iter().enumerate() {
        sum += value * value;
        if index >= window {
            sum -= values[index - window] * values[index - window];
        }
        if index + 1 >= window && sum > best {
            (best, at) = (sum, index + 1 - window);
        }
    }
    (values.len() > 2 * window).then_some(at)
}

pub(crate) fn kilo(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e-3).collect()
}

pub(crate) fn milli(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e3).collect()
}

/// Highest frequency that spectra show (Hz).
const SPECTRUM_TO_HZ: f64 = 50.0;

/// Frequencies (Hz) and densities of a trace, up to what a plot shows.
pub(crate) fn spectrum(values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    match Spectrum::welch(values, 1.0 / CYCLE_S, SEGMENT_S) {
        Ok(spectrum) => spectrum
            .lines()
            .filter(|(frequency, density)| {
                *frequency > 0.0 && *frequency <= SPECTRUM_TO_HZ && *density > 0.0
            })
            .unzip(),
        Err(_) => (Vec::new(), Vec::new()),
    }
}
