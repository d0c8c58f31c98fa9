//! A signal through a filter that is given by its frequency response.
//!
//! ```text
//! y = F^-1 [ H(f) F[x] ]
//! ```
//! The transform takes a signal for one period of an endless one. It is therefore followed by zeros
//! as long as the filter takes to settle, so that its end does not ring into its beginning. A real
//! `H` delays nothing and rings before a blow as well as behind it.

use crate::error::SignalError;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// The signal through the filter; as long as the input.
///
/// # Errors
/// No sample, one that is not finite, or a rate that is not positive.
///
/// ```
/// use realfft::num_complex::Complex;
/// use signal::response::through;
/// let tone: Vec<f64> =
///     (0..8000).map(|n| libm::sin(std::f64::consts::TAU * 5e-3 * f64::from(n))).collect();
/// let band = |hz: f64| Complex::from(if (4.0..=6.0).contains(&hz) { 1.0 } else { 0.0 });
/// let kept = through(&tone, 1000.0, band, 2.0)?;
/// let stopped = through(&tone, 1000.0, |hz| 1.0 - band(hz), 2.0)?;
/// assert!((signal::statistics::rms(&kept[2000..6000]) - 0.7071).abs() < 0.01);
/// assert!(signal::statistics::rms(&stopped[2000..6000]) < 0.02);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn through(
    values: &[f64],
    rate_hz: f64,
    response: impl Fn(f64) -> Complex<f64>,
    settle_s: f64,
) -> Result<Vec<f64>, SignalError> {
    if !(rate_hz > 0.0 && rate_hz.is_finite()) {
        return Err(SignalError::Parameter("rate_hz", rate_hz, "a positive number"));
    }
    if values.is_empty() {
        return Err(SignalError::TooShort(0, 1));
    }
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        return Err(SignalError::NotFinite(index));
    }
    let settle = libm::ceil(settle_s.max(0.0) * rate_hz) as usize;
    let length = (values.len() + settle).next_power_of_two().max(2);
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let (mut signal, mut lines) = (forward.make_input_vec(), forward.make_output_vec());
    for (slot, value) in signal.iter_mut().zip(values) {
        *slot = *value;
    }
    // Transforms fail only for slices of other lengths than they made themselves.
    let failed = |_| SignalError::TooShort(values.len(), 1);
    forward.process(&mut signal, &mut lines).map_err(failed)?;
    let per_line_hz = rate_hz / length as f64;
    let last = lines.len() - 1;
    for (number, line) in lines.iter_mut().enumerate() {
        *line *= response(number as f64 * per_line_hz);
        if number == 0 || number == last {
            // These two have no mirror image: a real signal has real ones.
            line.im = 0.0;
        }
    }
    back.process(&mut lines, &mut signal).map_err(failed)?;
    signal.truncate(values.len());
    for value in &mut signal {
        *value /= length as f64;
    }
    Ok(signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_of_one_changes_nothing_and_a_delay_delays() {
        let values: Vec<f64> = (0..300).map(|n| libm::sin(0.1 * f64::from(n)) + 2.0).collect();
        let same = through(&values, 100.0, |_| Complex::from(1.0), 0.0).unwrap();
        assert!(values.iter().zip(&same).all(|(a, b)| (a - b).abs() < 1e-12));
        let delay = |hz: f64| {
            let (sin, cos) = libm::sincos(-std::f64::consts::TAU * hz * 0.05);
            Complex::new(cos, sin)
        };
        let late = through(&values, 100.0, delay, 1.0).unwrap();
        assert!(values.iter().zip(&late[5..]).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn what_cannot_be_filtered_is_named() {
        let one = |_| Complex::from(1.0);
        assert!(matches!(through(&[], 1.0, one, 0.0), Err(SignalError::TooShort(0, 1))));
        assert!(matches!(through(&[f64::NAN], 1.0, one, 0.0), Err(SignalError::NotFinite(0))));
        assert!(through(&[1.0], 0.0, one, 0.0).is_err());
    }
}
