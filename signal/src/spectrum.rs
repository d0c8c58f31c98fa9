//! Power spectral density by Welch's method.
//!
//! The signal is cut into segments that overlap by half; each loses its mean and is weighted by a
//! Hann window `w`; the squared spectra are averaged and scaled to one side:
//! ```text
//! S(f_k) = 2 / (f_s sum w^2) |sum (x - mean) w exp(-2 pi i k n / N)|^2        unit^2/Hz
//! ```
//! (Welch 1967; without the 2 at zero and at half the rate). The integral over frequency is the
//! variance. A segment of `T` seconds gives lines `1/T` apart; a Hann window blurs a tone over four
//! of them, and its leakage falls by 18 dB per octave. What is slower than one segment is lost with
//! the mean or smeared into the first lines.

use crate::error::SignalError;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};
use std::fmt;
use std::sync::Arc;

/// Fewest samples in a segment.
const SEGMENT_MIN: usize = 8;

/// A one-sided power spectral density.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Distance between two lines (Hz): one over the segment's length.
    pub resolution_hz: f64,
    /// Density at `0, 1, 2 ...` times the resolution (unit^2/Hz).
    pub density: Vec<f64>,
    /// Number of segments in the average; below about five a density scatters by half its value.
    pub segments: usize,
}

impl Spectrum {
    /// The density of `values`, sampled at `rate_hz`, from segments of `segment_s` that overlap by
    /// half. A signal shorter than a segment is one segment; [`Spectrum::resolution_hz`] says so.
    ///
    /// # Errors
    /// Fewer than eight samples, a rate or length that is not positive, a sample that is not
    /// finite.
    ///
    /// ```
    /// use signal::spectrum::Spectrum;
    /// // 3 mm at 3.46 Hz: the peak is found between two lines, the power is half the square.
    /// let tone: Vec<f64> = (0..20_000)
    ///     .map(|n| 3e-3 * libm::sin(std::f64::consts::TAU * 3.46 * f64::from(n) * 1e-3))
    ///     .collect();
    /// let spectrum = Spectrum::welch(&tone, 1000.0, 4.0)?;
    /// assert!((spectrum.peak_hz().unwrap() - 3.46).abs() < 0.005);
    /// let power = spectrum.power(0.0, 500.0);
    /// assert!((power / (0.5 * 3e-3 * 3e-3) - 1.0).abs() < 0.01);
    /// # Ok::<(), signal::SignalError>(())
    /// ```
    pub fn welch(values: &[f64], rate_hz: f64, segment_s: f64) -> Result<Self, SignalError> {
        for (name, value) in [("rate_hz", rate_hz), ("segment_s", segment_s)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SignalError::Parameter(name, value, "a positive number"));
            }
        }
        if values.len() < SEGMENT_MIN {
            return Err(SignalError::TooShort(values.len(), SEGMENT_MIN));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(SignalError::NotFinite(index));
        }
        let wanted = libm::round(segment_s * rate_hz) as usize;
        let length = wanted.clamp(SEGMENT_MIN, values.len());
        let mut segments = Segments::new(length);
        for segment in values.windows(length).step_by((length / 2).max(1)) {
            segments.add(segment);
        }
        Ok(segments.spectrum(rate_hz))
    }

    /// Frequency of the highest density above zero (Hz), refined by a parabola through the
    /// logarithms of three lines; `None` for a signal without any.
    pub fn peak_hz(&self) -> Option<f64> {
        let (line, highest) = self
            .density
            .iter()
            .enumerate()
            .skip(1)
            .max_by(|(_, a), (_, b)| a.total_cmp(b))
            .filter(|(_, density)| **density > 0.0)?;
        let next_to = |index: usize| self.density.get(index).copied().filter(|d| *d > 0.0);
        let shift = match (next_to(line - 1).filter(|_| line > 1), next_to(line + 1)) {
            (Some(before), Some(after)) => {
                let (l, m, r) = (libm::log(before), libm::log(*highest), libm::log(after));
                let bend = l - 2.0 * m + r;
                if bend < 0.0 { 0.5 * (l - r) / bend } else { 0.0 }
            }
            _ => 0.0,
        };
        Some((line as f64 + shift) * self.resolution_hz)
    }

    /// The mean of spectra with the same lines; none of none. Lines that some do not have are left
    /// out.
    pub fn mean(spectra: &[Self]) -> Option<Self> {
        let first = spectra.first()?;
        let lines = spectra.iter().map(|spectrum| spectrum.density.len()).min()?;
        let mean = |line: usize| {
            let sum: f64 = spectra.iter().map(|spectrum| spectrum.density[line]).sum();
            sum / spectra.len() as f64
        };
        Some(Self {
            resolution_hz: first.resolution_hz,
            density: (0..lines).map(mean).collect(),
            segments: spectra.iter().map(|spectrum| spectrum.segments).sum(),
        })
    }

    /// The highest lines that stand above both neighbours between two frequencies, the highest
    /// first: frequency and density (Hz, unit^2/Hz).
    pub fn peaks(&self, from_hz: f64, to_hz: f64, most: usize) -> Vec<(f64, f64)> {
        let inside = |hz: f64| (from_hz..=to_hz).contains(&hz);
        let lines: Vec<(f64, f64)> = self.lines().collect();
        let mut peaks: Vec<(f64, f64)> = lines
            .windows(3)
            .filter(|three| three[1].1 > three[0].1 && three[1].1 >= three[2].1)
            .map(|three| three[1])
            .filter(|(hz, _)| inside(*hz))
            .collect();
        peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
        peaks.truncate(most);
        peaks
    }

    /// Power between two frequencies (unit^2): the sum of the lines with `from_hz <= f <= to_hz`.
    pub fn power(&self, from_hz: f64, to_hz: f64) -> f64 {
        let inside = |line: usize| (from_hz..=to_hz).contains(&(line as f64 * self.resolution_hz));
        let lines = self.density.iter().enumerate().filter(|(line, _)| inside(*line));
        lines.map(|(_, density)| density * self.resolution_hz).sum()
    }

    /// Frequency and density of every line (Hz, unit^2/Hz).
    pub fn lines(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.density.iter().enumerate().map(|(line, d)| (line as f64 * self.resolution_hz, *d))
    }
}

/// The spectrum of a signal that comes sample by sample: the same as [`Spectrum::welch`] of all of
/// them, to the last bit, with the memory of one segment.
///
/// ```
/// use signal::spectrum::{Spectrum, Welch};
/// let tone: Vec<f64> = (0..9_999).map(|n| libm::sin(0.02 * f64::from(n))).collect();
/// let mut welch = Welch::new(1000.0, 2.0);
/// for value in &tone {
///     welch.push(*value);
/// }
/// assert_eq!(welch.spectrum()?, Spectrum::welch(&tone, 1000.0, 2.0)?);
/// # Ok::<(), signal::SignalError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Welch {
    rate_hz: f64,
    segment_s: f64,
    length: usize,
    /// Samples that are not yet, or not only, in a segment that was added.
    recent: Vec<f64>,
    samples: usize,
    segments: Segments,
    /// The first sample that is not finite.
    not_finite: Option<usize>,
}

impl Welch {
    /// No samples yet, taken at `rate_hz`, for segments of `segment_s` that overlap by half.
    pub fn new(rate_hz: f64, segment_s: f64) -> Self {
        let length = (libm::round(segment_s * rate_hz) as usize).max(SEGMENT_MIN);
        Self {
            rate_hz,
            segment_s,
            length,
            recent: Vec::new(),
            samples: 0,
            segments: Segments::new(length),
            not_finite: None,
        }
    }

    /// Takes in the next sample.
    pub fn push(&mut self, value: f64) {
        if !value.is_finite() {
            self.not_finite.get_or_insert(self.samples);
        }
        self.samples += 1;
        if self.not_finite.is_some() {
            return;
        }
        self.recent.push(value);
        if self.recent.len() == self.length {
            self.segments.add(&self.recent);
            self.recent.drain(..(self.length / 2).max(1));
        }
    }

    /// The density of all samples so far.
    ///
    /// # Errors
    /// As [`Spectrum::welch`].
    pub fn spectrum(&self) -> Result<Spectrum, SignalError> {
        match self.not_finite {
            Some(index) => Err(SignalError::NotFinite(index)),
            None if self.segments.count > 0 => Ok(self.segments.clone().spectrum(self.rate_hz)),
            None => Spectrum::welch(&self.recent, self.rate_hz, self.segment_s),
        }
    }
}

/// The segments of a signal, summed up.
#[derive(Clone)]
struct Segments {
    transform: Arc<dyn RealToComplex<f64>>,
    window: Vec<f64>,
    input: Vec<f64>,
    output: Vec<Complex<f64>>,
    density: Vec<f64>,
    count: usize,
}

impl Segments {
    /// None yet, of so many samples each.
    fn new(length: usize) -> Self {
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let (input, output) = (transform.make_input_vec(), transform.make_output_vec());
        let density = vec![0.0; output.len()];
        Self { transform, window: hann(length), input, output, density, count: 0 }
    }

    fn add(&mut self, segment: &[f64]) {
        let length = self.window.len();
        let mean = segment.iter().sum::<f64>() / length as f64;
        for ((slot, value), weight) in self.input.iter_mut().zip(segment).zip(&self.window) {
            *slot = (value - mean) * weight;
        }
        // Fails only for slices of other lengths than it made itself.
        let done = self.transform.process(&mut self.input, &mut self.output);
        debug_assert!(done.is_ok(), "{done:?}");
        for (sum, line) in self.density.iter_mut().zip(&self.output) {
            *sum += line.norm_sqr();
        }
        self.count += 1;
    }

    fn spectrum(self, rate_hz: f64) -> Spectrum {
        let Self { window, mut density, count: segments, .. } = self;
        let length = window.len();
        let weight: f64 = window.iter().map(|w| w * w).sum();
        let scale = 2.0 / (rate_hz * weight * segments as f64);
        for value in &mut density {
            *value *= scale;
        }
        // Zero and half the rate have no mirror image.
        if let Some(first) = density.first_mut() {
            *first *= 0.5;
        }
        if length.is_multiple_of(2)
            && let Some(last) = density.last_mut()
        {
            *last *= 0.5;
        }
        Spectrum { resolution_hz: rate_hz / length as f64, density, segments }
    }
}

impl fmt::Debug for Segments {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (length, count) = (self.window.len(), self.count);
        let mut shown = f.debug_struct("Segments");
        shown.field("length", &length).field("count", &count).finish_non_exhaustive()
    }
}

/// Periodic Hann window.
fn hann(length: usize) -> Vec<f64> {
    let turn = std::f64::consts::TAU / length as f64;
    (0..length).map(|n| 0.5 - 0.5 * libm::cos(turn * n as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn tone(hz: f64, amplitude: f64, rate_hz: f64, count: usize) -> Vec<f64> {
        (0..count).map(|n| amplitude * libm::sin(TAU * hz * n as f64 / rate_hz)).collect()
    }

    #[test]
    fn a_tone_on_a_line_has_the_closed_form_height() {
        // On line k the windowed sum is A N/4 and sum w^2 = 3 N/8: S = A^2 N / (3 f_s).
        let spectrum = Spectrum::welch(&tone(5.0, 2.0, 100.0, 4000), 100.0, 4.0).unwrap();
        assert_eq!(spectrum.resolution_hz, 0.25);
        let expected = 4.0 * 400.0 / (3.0 * 100.0);
        assert!((spectrum.density[20] / expected - 1.0).abs() < 1e-12, "{}", spectrum.density[20]);
        assert!((spectrum.density[19] / expected - 0.25).abs() < 1e-9);
        assert_eq!(spectrum.segments, 19);
    }

    #[test]
    fn a_signal_in_samples_has_the_spectrum_of_the_whole() {
        for count in [0, 7, 8, 1999, 2000, 2001, 3000, 10_001] {
            let values = tone(3.3, 1.0, 1000.0, count);
            let mut welch = Welch::new(1000.0, 2.0);
            for value in &values {
                welch.push(*value);
            }
            let whole = Spectrum::welch(&values, 1000.0, 2.0);
            assert_eq!(welch.spectrum().ok(), whole.ok(), "{count}");
            assert!(welch.recent.len() < 2000);
        }
        let mut welch = Welch::new(1000.0, 2.0);
        for value in [1.0, f64::NAN, 2.0] {
            welch.push(value);
        }
        assert!(matches!(welch.spectrum(), Err(SignalError::NotFinite(1))));
    }

    #[test]
    fn peaks_between_lines_are_refined_to_a_twentieth_of_a_line() {
        for tenth in 0..10 {
            let hz = 3.0 + 0.025 * f64::from(tenth);
            let spectrum = Spectrum::welch(&tone(hz, 1.0, 200.0, 8000), 200.0, 4.0).unwrap();
            let found = spectrum.peak_hz().unwrap();
            assert!((found - hz).abs() < 0.05 * 0.25, "{hz}: {found}");
        }
    }

    #[test]
    fn white_noise_is_flat_and_its_integral_is_the_variance() {
        // A fixed linear congruential sequence (Numerical Recipes): uniform, variance 1/12.
        let mut seed = 1u32;
        let noise: Vec<f64> = (0..200_000)
            .map(|_| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(seed) / 4_294_967_296.0
            })
            .collect();
        let spectrum = Spectrum::welch(&noise, 1000.0, 0.256).unwrap();
        let total = spectrum.power(0.0, 500.0);
        assert!((total * 12.0 - 1.0).abs() < 0.01, "{total}");
        let low = spectrum.power(50.0, 150.0) / 101.6;
        assert!((low / (1.0 / 12.0 / 500.0) - 1.0).abs() < 0.05, "{low}");
    }

    #[test]
    fn a_step_in_level_does_not_hide_a_small_tone_behind_the_mean() {
        let lifted: Vec<f64> = tone(7.0, 1e-3, 100.0, 2000).iter().map(|v| v + 50.0).collect();
        let peak = Spectrum::welch(&lifted, 100.0, 5.0).unwrap().peak_hz().unwrap();
        assert!((peak - 7.0).abs() < 0.01, "{peak}");
    }

    #[test]
    fn two_tones_are_two_peaks_and_the_mean_of_equals_is_the_same() {
        let both: Vec<f64> = tone(3.0, 1.0, 100.0, 6000)
            .iter()
            .zip(tone(7.5, 2.0, 100.0, 6000))
            .map(|(a, b)| a + b)
            .collect();
        let spectrum = Spectrum::welch(&both, 100.0, 4.0).unwrap();
        let peaks = spectrum.peaks(0.5, 20.0, 2);
        assert_eq!(peaks.iter().map(|(hz, _)| *hz).collect::<Vec<_>>(), [7.5, 3.0]);
        assert!(spectrum.peaks(10.0, 20.0, 5).iter().all(|(_, density)| *density < 1e-6));
        let mean = Spectrum::mean(&[spectrum.clone(), spectrum.clone()]).unwrap();
        assert_eq!(mean.density, spectrum.density);
        assert_eq!(Spectrum::mean(&[]), None);
    }

    #[test]
    fn what_cannot_be_analysed_is_named() {
        assert!(matches!(Spectrum::welch(&[0.0; 3], 1.0, 1.0), Err(SignalError::TooShort(3, 8))));
        assert!(matches!(
            Spectrum::welch(&[0.0; 9], 0.0, 1.0),
            Err(SignalError::Parameter("rate_hz", ..))
        ));
        let mut hole = [0.0; 20];
        hole[11] = f64::NAN;
        assert!(matches!(Spectrum::welch(&hole, 1.0, 10.0), Err(SignalError::NotFinite(11))));
        assert_eq!(Spectrum::welch(&[3.0; 40], 1.0, 10.0).unwrap().peak_hz(), None);
    }
}
