//! Guiding forces as acceptance tests read them: low-pass, then a sliding mean over distance.
//!
//! A raw wheel force is full of blows of a few milliseconds that neither shift a track nor lift a
//! wheel over the rail, and whose height depends on how finely one samples. EN 14363 therefore
//! judges the sum of the guiding forces of a wheelset and the quotient Y/Q after a low-pass of 20
//! Hz (four poles, Butterworth) and as a sliding mean over 2 m of track. Here the result is given
//! at every sample (the standard takes one each 0.5 m) and causal: it lags by 1 m plus about 21 ms.

use crate::error::SignalError;

/// Corner of the low-pass (Hz).
pub const CORNER_HZ: f64 = 20.0;

/// Length of the sliding mean (m).
pub const MEAN_OVER_M: f64 = 2.0;

/// The filtered force (or quotient) at a running speed; as long as the input.
///
/// # Errors
/// A rate of less than 80 Hz, or a speed that is not positive.
///
/// ```
/// use signal::guiding_force::filtered;
/// // A blow of 2 ms and 100 kN at 160 km/h: its impulse over 2 m would be 4.4 kN; the low-pass
/// // rings a little, and 4.9 kN remain.
/// let mut force_n = vec![0.0; 1000];
/// force_n[500] = 100.0e3;
/// force_n[501] = 100.0e3;
/// let peak = filtered(&force_n, 1000.0, 160.0 / 3.6)?.into_iter().fold(0.0, f64::max);
/// assert!((peak - 4.9e3).abs() < 0.05e3, "{peak}");
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn filtered(values: &[f64], rate_hz: f64, speed_m_per_s: f64) -> Result<Vec<f64>, SignalError> {
    let passed = low_pass(values, rate_hz, CORNER_HZ)?;
    if !(speed_m_per_s > 0.0 && speed_m_per_s.is_finite()) {
        return Err(SignalError::Parameter("speed_m_per_s", speed_m_per_s, "a positive number"));
    }
    let width = libm::round(MEAN_OVER_M / speed_m_per_s * rate_hz).max(1.0);
    Ok(sliding_mean(&passed, width as usize))
}

/// Butterworth low-pass of four poles, starting in the steady state of the first sample.
///
/// # Errors
/// A corner that is not above zero and below a quarter of the rate.
pub fn low_pass(values: &[f64], rate_hz: f64, corner_hz: f64) -> Result<Vec<f64>, SignalError> {
    if !(corner_hz > 0.0 && corner_hz.is_finite()) {
        return Err(SignalError::Parameter("corner_hz", corner_hz, "a positive number"));
    }
    if !(rate_hz >= 4.0 * corner_hz && rate_hz.is_finite()) {
        return Err(SignalError::Parameter("rate_hz", rate_hz, "at least four times the corner"));
    }
    let mut passed = values.to_vec();
    for pole_angle in [1.0, 3.0] {
        let damping = 2.0 * libm::cos(pole_angle * std::f64::consts::PI / 8.0);
        let mut section = Section::new(rate_hz, corner_hz, damping);
        if let Some(first) = passed.first() {
            section.settle(*first);
        }
        for value in &mut passed {
            *value = section.next(*value);
        }
    }
    Ok(passed)
}

/// Mean of the last `width` samples; at the beginning of those that there are.
pub fn sliding_mean(values: &[f64], width: usize) -> Vec<f64> {
    let width = width.max(1);
    let mut sum = 0.0;
    let mut means = Vec::with_capacity(values.len());
    for (index, value) in values.iter().enumerate() {
        sum += value;
        if let Some(left) = index.checked_sub(width).and_then(|left| values.get(left)) {
            sum -= left;
        }
        means.push(sum / (index + 1).min(width) as f64);
    }
    means
}

/// Two poles by the bilinear transform, transposed direct form.
struct Section {
    forward: f64,
    back: [f64; 2],
    memory: [f64; 2],
}

impl Section {
    fn new(rate_hz: f64, corner_hz: f64, damping: f64) -> Self {
        let k = libm::tan(std::f64::consts::PI * corner_hz / rate_hz);
        let scale = 1.0 / (1.0 + damping * k + k * k);
        Self {
            forward: k * k * scale,
            back: [2.0 * (k * k - 1.0) * scale, (1.0 - damping * k + k * k) * scale],
            memory: [0.0; 2],
        }
    }

    /// Sets the memory as if the value had been there for ever.
    fn settle(&mut self, value: f64) {
        let second = (self.forward - self.back[1]) * value;
        self.memory = [(1.0 - self.forward) * value, second];
    }

    fn next(&mut self, value: f64) -> f64 {
        let out = self.forward * value + self.memory[0];
        self.memory[0] = 2.0 * self.forward * value - self.back[0] * out + self.memory[1];
        self.memory[1] = self.forward * value - self.back[1] * out;
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_low_pass_halves_the_power_at_its_corner_and_falls_by_24_db_per_octave() {
        for (hz, gain) in [(2.0, 1.0), (20.0, 0.5f64.sqrt()), (40.0, 1.0 / 257.0f64.sqrt())] {
            let tone: Vec<f64> =
                (0..4000).map(|n| libm::sin(TAU * hz * f64::from(n) * 1e-3)).collect();
            let passed = low_pass(&tone, 1000.0, CORNER_HZ).unwrap();
            let power: f64 = passed[2000..].iter().map(|v| v * v).sum::<f64>() / 2000.0;
            let found = (2.0 * power).sqrt();
            assert!((found / gain - 1.0).abs() < 0.04, "{hz} Hz: {found} {gain}");
        }
    }

    #[test]
    fn a_constant_passes_from_the_first_sample_on() {
        for value in filtered(&[7.5; 300], 1000.0, 40.0).unwrap() {
            assert!((value - 7.5).abs() < 1e-12, "{value}");
        }
    }

    #[test]
    fn the_sliding_mean_is_the_mean() {
        assert_eq!(sliding_mean(&[1.0, 2.0, 3.0, 6.0], 2), [1.0, 1.5, 2.5, 4.5]);
        assert_eq!(sliding_mean(&[], 3), [0.0; 0]);
    }

    #[test]
    fn impossible_parameters_are_named() {
        assert!(matches!(filtered(&[1.0], 50.0, 1.0), Err(SignalError::Parameter("rate_hz", ..))));
        assert!(matches!(
            filtered(&[1.0], 1000.0, 0.0),
            Err(SignalError::Parameter("speed_m_per_s", ..))
        ));
    }
}
