//! White noise of the samples, where it is white.
//!
//! Third differences suppress a smooth signal, and a median ignores the few places where the signal
//! is not smooth:
//!
//! ```text
//! d_i = y_i - 3 y_(i-1) + 3 y_(i-2) - y_(i-3)        sigma = median |d| / (0.6745 sqrt(20))
//! ```
//!
//! That is the noise only if the noise is white. Then the autocorrelation of the differences,
//! clipped at four sigmas, is -0.75 at lag one and +0.30 at lag two, and differences over twice the
//! stride give the same sigma. A filter, a moving average, an autoregression and a signal in the
//! differences each fail at least one of these, and nothing is returned.
//!
//! Limits: slow noise (drift) under the white one is not seen, so the result is a lower bound.

use signal::statistics::robust_rms;

/// Differences are clipped at so many standard deviations.
const CLIP: f64 = 4.0;
/// Autocorrelation of third differences of white noise at lags one and two, and how far off a
/// record may be.
const AUTOCORRELATION: [(f64, f64); 2] = [(-0.75, 0.08), (0.30, 0.10)];
/// Range of sigma at twice the stride over sigma.
const OTHER_STRIDE: std::ops::RangeInclusive<f64> = 0.75..=1.3;
/// Fewer samples decide nothing.
const FEWEST: usize = 200;

/// rms of white noise in samples; none where the noise is not white or there is none.
///
/// ```
/// use measurement::noise::white;
/// // Pseudo-random numbers, uniform over +-1, on a slow sine of 100.
/// let mut state = 1_u64;
/// let noisy: Vec<f64> = (0..4000)
///     .map(|n| {
///         state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
///         let uniform = (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
///         100.0 * libm::sin(0.01 * f64::from(n)) + uniform
///     })
///     .collect();
/// let rms = white::rms(&noisy).unwrap();
/// assert!((rms * 3.0_f64.sqrt() - 1.0).abs() < 0.3);
/// // The mean of four neighbours is no white noise any more.
/// let averaged: Vec<f64> = noisy.windows(4).map(|w| w.iter().sum::<f64>() / 4.0).collect();
/// assert_eq!(white::rms(&averaged), None);
/// ```
pub fn rms(values: &[f64]) -> Option<f64> {
    if values.len() < FEWEST {
        return None;
    }
    let differences = third_differences(values, 1);
    let sigma = robust_rms(&differences)?;
    let clipped: Vec<f64> =
        differences.iter().map(|d| d.clamp(-CLIP * sigma, CLIP * sigma)).collect();
    let is_white = AUTOCORRELATION.iter().enumerate().all(|(index, (expected, off))| {
        let found = autocorrelation(&clipped, index + 1);
        (found - expected).abs() <= *off
    });
    let other = robust_rms(&third_differences(values, 2))?;
    let found = sigma / 20.0_f64.sqrt();
    (is_white && OTHER_STRIDE.contains(&(other / sigma))).then_some(found)
}

/// Size of the third differences as if they came from white noise: the noise where it is white,
/// less than the noise where it was filtered, and more where the signal is not smooth.
pub fn third_difference_rms(values: &[f64]) -> Option<f64> {
    robust_rms(&third_differences(values, 1)).map(|sigma| sigma / 20.0_f64.sqrt())
}

fn third_differences(values: &[f64], stride: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(3 * stride);
    (0..last)
        .map(|i| {
            values[i + 3 * stride] - 3.0 * values[i + 2 * stride] + 3.0 * values[i + stride]
                - values[i]
        })
        .collect()
}

fn autocorrelation(values: &[f64], lag: usize) -> f64 {
    let square: f64 = values.iter().map(|v| v * v).sum();
    let pairs = values.iter().zip(values.iter().skip(lag));
    if square > 0.0 { pairs.map(|(a, b)| a * b).sum::<f64>() / square } else { 0.0 }
}
