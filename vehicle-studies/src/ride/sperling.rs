//! The Sperling index, as GB 5599-85 and GB/T 5599-2019 have it.
//!
//! ```text
//! W_i = 3.57 (A_i^3 F(f_i) / f_i)^(1/10)        W = (sum W_i^10)^(1/10)        0.5 to 40 Hz
//! ```
//! with the amplitude `A_i` (m/s2) of each line of the signal's Fourier series over one window, and
//! ```text
//! vertical   F = 0.325 f^2 (0.5 to 5.9 Hz)   400/f^2 (5.9 to 20 Hz)   1 above
//! lateral    F = 0.8 f^2   (0.5 to 5.4 Hz)   650/f^2 (5.4 to 26 Hz)   1 above
//! ```
//! (GB/T 5599-2019, annex E). The older 7.08 with `A` in g is the same number, 7.08/9.81^0.3. The
//! two editions differ in the window: 18 to 20 s then, 5 s now. A line's amplitude falls as windows
//! grow, so the index of random vibration falls as `T^(-1/20)`: 20 s give 7 % less than 5 s. No
//! taper is applied, as the standards name none; a tone between two lines reads up to 6 % low.

use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};
use signal::SignalError;

/// Window of GB 5599-85 (s).
pub const WINDOW_1985_S: f64 = 20.0;
/// Window of GB/T 5599-2019 (s).
pub const WINDOW_2019_S: f64 = 5.0;

/// Direction of an acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Direction {
    Lateral,
    Vertical,
}

impl Direction {
    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lateral => "lateral",
            Self::Vertical => "vertical",
        }
    }
}

/// The factor `F` of a frequency; zero where a line does not count.
///
/// ```
/// use vehicle_studies::ride::sperling::{Direction, factor};
/// assert_eq!(factor(2.0, Direction::Lateral), 3.2);
/// assert_eq!(factor(10.0, Direction::Vertical), 4.0);
/// assert_eq!(factor(0.2, Direction::Vertical), 0.0);
/// ```
pub fn factor(frequency_hz: f64, direction: Direction) -> f64 {
    let square = frequency_hz * frequency_hz;
    let (rising, falling, [turn_hz, end_hz]) = match direction {
        Direction::Vertical => (0.325, 400.0, [5.9, 20.0]),
        Direction::Lateral => (0.8, 650.0, [5.4, 26.0]),
    };
    match frequency_hz {
        f if !(0.5..=40.0).contains(&f) => 0.0,
        f if f < turn_hz => rising * square,
        f if f < end_hz => falling / square,
        _ => 1.0,
    }
}

/// The index of one window of acceleration (m/s2).
///
/// # Errors
/// Fewer than two samples, one that is not finite, or a rate that is not positive.
///
/// ```
/// use vehicle_studies::ride::sperling::{Direction, index};
/// // 0.3 m/s2 at 2 Hz, lateral: 3.57 (0.027 x 3.2 / 2)^0.1 = 2.607.
/// let sine: Vec<f64> =
///     (0..5000).map(|n| 0.3 * libm::sin(std::f64::consts::TAU * 2e-3 * f64::from(n))).collect();
/// assert!((index(&sine, 1000.0, Direction::Lateral)? - 2.607).abs() < 1e-3);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn index(values: &[f64], rate_hz: f64, direction: Direction) -> Result<f64, SignalError> {
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(SignalError::Parameter("rate_hz", rate_hz, "a positive number"));
    }
    if values.len() < 2 {
        return Err(SignalError::TooShort(values.len(), 2));
    }
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        return Err(SignalError::NotFinite(index));
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(values.len());
    let (mut input, mut lines) = (values.to_vec(), transform.make_output_vec());
    // Fails only for slices of other lengths than it made itself.
    transform
        .process(&mut input, &mut lines)
        .map_err(|_| SignalError::TooShort(values.len(), 2))?;
    let (scale, per_line_hz) = (2.0 / values.len() as f64, rate_hz / values.len() as f64);
    let tenth_power: f64 = lines
        .iter()
        .enumerate()
        .skip(1)
        .map(|(number, line)| {
            let (amplitude, hz) = (scale * line.norm(), number as f64 * per_line_hz);
            amplitude * amplitude * amplitude * factor(hz, direction) / hz
        })
        .sum();
    Ok(3.57 * libm::pow(tenth_power, 0.1))
}

/// The index of every whole window of a signal, one after the other.
///
/// # Errors
/// A signal shorter than one window, or as for [`index`].
pub fn windows(
    values: &[f64],
    rate_hz: f64,
    window_s: f64,
    direction: Direction,
) -> Result<Vec<f64>, SignalError> {
    let length = libm::round(window_s * rate_hz).max(2.0) as usize;
    if values.len() < length {
        return Err(SignalError::TooShort(values.len(), length));
    }
    values.chunks_exact(length).map(|window| index(window, rate_hz, direction)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sine(count: usize, hz: f64, amplitude: f64) -> Vec<f64> {
        (0..count).map(|n| amplitude * libm::sin(TAU * hz * n as f64 * 1e-3)).collect()
    }

    #[test]
    fn a_sine_on_a_line_has_the_index_of_the_formula() {
        for (hz, direction, factor) in [
            (1.4, Direction::Lateral, 0.8 * 1.4 * 1.4),
            (10.0, Direction::Lateral, 6.5),
            (30.0, Direction::Lateral, 1.0),
            (1.2, Direction::Vertical, 0.325 * 1.2 * 1.2),
            (8.0, Direction::Vertical, 6.25),
            (25.0, Direction::Vertical, 1.0),
        ] {
            let expected = 3.57 * libm::pow(0.2 * 0.2 * 0.2 * factor / hz, 0.1);
            for count in [5_000, 20_000] {
                let found = index(&sine(count, hz, 0.2), 1000.0, direction).unwrap();
                assert!((found - expected).abs() < 1e-9, "{hz} Hz: {found}, {expected}");
            }
        }
    }

    #[test]
    fn two_sines_add_in_their_tenth_power_and_a_constant_does_not_count() {
        let one = |hz| index(&sine(5000, hz, 0.3), 1000.0, Direction::Lateral).unwrap();
        let sum: Vec<f64> = sine(5000, 2.0, 0.3)
            .iter()
            .zip(sine(5000, 7.0, 0.3))
            .map(|(a, b)| a + b + 5.0)
            .collect();
        let found = index(&sum, 1000.0, Direction::Lateral).unwrap();
        let expected = libm::pow(libm::pow(one(2.0), 10.0) + libm::pow(one(7.0), 10.0), 0.1);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn a_tone_between_lines_reads_at_most_6_per_cent_low() {
        for hundredth in 0..20 {
            let hz = 2.0 + 0.01 * f64::from(hundredth);
            let found = index(&sine(5000, hz, 0.3), 1000.0, Direction::Lateral).unwrap();
            let expected = 3.57 * libm::pow(0.027 * 0.8 * hz, 0.1);
            assert!((0.935..1.01).contains(&(found / expected)), "{hz}: {}", found / expected);
        }
    }

    #[test]
    fn windows_stand_one_after_the_other() {
        let found = windows(&sine(12_000, 2.0, 0.3), 1000.0, 5.0, Direction::Vertical).unwrap();
        assert_eq!(found.len(), 2);
        assert!((found[0] - found[1]).abs() < 1e-12);
        let short = windows(&[0.0; 100], 1000.0, 5.0, Direction::Vertical);
        assert!(matches!(short, Err(SignalError::TooShort(100, 5000))));
    }
}
