//! What one track does to one wheelset in one section.
//!
//! EN 14363: the sum of the guiding forces and Y/Q pass a low-pass of 20 Hz (four poles) and a
//! sliding mean over 2 m ([`signal::guiding_force`]), are read every 0.5 m, and their percentiles
//! 0.15 and 99.85 count; the median is the quasi-static value. Y/Q is the quotient of the
//! low-passed forces, the load not below 1 % of the static one.
//!
//! Stability: around the frequency `f0` of the highest line of the force between 1 and 10 Hz, 2 Hz
//! to either side, the rms over 100 m, every 10 m; the greatest counts.
//!
//! GB/T 5599-2019: Q/P, unloading `(Q0 - Q)/Q0` and lateral axle force after a low-pass of 40 Hz,
//! without a mean, by their percentile 99.85; the filter is this study's.
//!
//! Filters are causal; their delay (1 m, and 2.61/(2 pi f) of the low-pass) is taken off.

use crate::trip::signals::{RATE_HZ, WheelSignal, WheelsetSignal};
use realfft::num_complex::Complex;
use signal::SignalError;
use signal::guiding_force::{CORNER_HZ, MEAN_OVER_M, low_pass, sliding_mean};
use signal::response::through;
use signal::spectrum::Spectrum;
use signal::statistics::{mean, percentile, rms};
use std::ops::Range;

/// Distance between the values of a statistic (m).
const EVERY_M: f64 = 0.5;
/// Lower and upper percentile, as shares.
const SHARES: [f64; 2] = [0.0015, 0.9985];
/// Low-pass of GB/T 5599-2019's quantities (Hz).
const GB_CORNER_HZ: f64 = 40.0;
/// Delay of four Butterworth poles at low frequency, times the angular corner.
const DELAY: f64 = 2.613;
/// Least load in a quotient, over the static one.
const LEAST_LOAD: f64 = 0.01;
/// Segments of the spectrum (s).
pub(super) const SEGMENT_S: f64 = 4.096;
/// Where the frequency of an instability is looked for (Hz), and the band around it (Hz).
const UNSTABLE_HZ: ([f64; 2], f64) = ([1.0, 10.0], 2.0);
/// Length of the sliding rms and distance between its values (m).
const STABILITY_M: [f64; 2] = [100.0, 10.0];
/// A band of 4 Hz has forgotten a blow after this (s).
const SETTLE_S: f64 = 2.0;

/// Forces of a wheelset in a section; outward is away from the centre of the curve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxleForces {
    /// Sum of guiding forces, outward: 0.15 %, median, 99.85 % (N).
    pub sum_n: [f64; 3],
    /// Greatest rms of it over 100 m around the frequency of an instability (N); none in a shorter
    /// section.
    pub stability_rms_n: Option<f64>,
    /// Lateral axle force of GB/T 5599-2019 (N).
    pub gb_n: f64,
    /// Spectrum of the unfiltered sum (N2/Hz); none in a section too short for one.
    pub spectrum: Option<Spectrum>,
    /// Outer and inner wheel.
    pub wheels: [WheelForces; 2],
}

/// Forces of a wheel in a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WheelForces {
    /// Y/Q: median and 99.85 %.
    pub y_over_q: [f64; 2],
    /// Quasi-static guiding force, towards the outside of the track (N).
    pub y_quasi_static_n: f64,
    /// Wheel load: quasi-static and 99.85 % (N).
    pub q_n: [f64; 2],
    /// Q/P of GB/T 5599-2019.
    pub derailment_gb: f64,
    /// Wheel unloading.
    pub unloading: f64,
    /// Mean power lost in the patches (W).
    pub wear_w: f64,
    /// Mean wear number (N).
    pub t_gamma_n: f64,
}

/// A wheelset on its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage<'a> {
    /// Its signals.
    pub wheelset: &'a WheelsetSignal,
    /// Where it stood at the first sample (m).
    pub first_m: f64,
    /// Running speed (m/s).
    pub speed_m_per_s: f64,
    /// Static loads of its left and right wheel (N).
    pub static_n: [f64; 2],
    /// True in a right-hand curve: the left wheel is the outer one.
    pub right_hand: bool,
}

impl Passage<'_> {
    /// What happens in a section.
    ///
    /// # Errors
    /// A section that was not passed, or a signal that is not finite.
    pub(super) fn forces(&self, stretch_m: &Range<f64>) -> Result<AxleForces, SignalError> {
        let outward = if self.right_hand { -1.0 } else { 1.0 };
        let sum_n: Vec<f64> =
            self.wheelset.axle_force_n().into_iter().map(|n| outward * n).collect();
        let guided = self.guided(&sum_n)?;
        let read = self.every(&guided, stretch_m, EVERY_M)?;
        let [low, high] = SHARES;
        let at = |values: &[f64], share: f64| percentile(values, share).unwrap_or(f64::NAN);
        let gb = passed(&sum_n, GB_CORNER_HZ)?;
        let gb: Vec<f64> = self.all(&gb, stretch_m)?.iter().map(|n| n.abs()).collect();
        let [left, right] = &self.wheelset.wheels;
        let (pair, loads) = if self.right_hand {
            ([left, right], self.static_n)
        } else {
            ([right, left], [self.static_n[1], self.static_n[0]])
        };
        let spectrum = Spectrum::welch(self.all(&sum_n, stretch_m)?, RATE_HZ, SEGMENT_S).ok();
        Ok(AxleForces {
            sum_n: [at(&read, low), at(&read, 0.5), at(&read, high)],
            stability_rms_n: self.stability_rms_n(&sum_n, spectrum.as_ref(), stretch_m)?,
            gb_n: at(&gb, high),
            spectrum,
            wheels: [
                self.wheel(pair[0], loads[0], stretch_m)?,
                self.wheel(pair[1], loads[1], stretch_m)?,
            ],
        })
    }

    fn wheel(
        &self,
        wheel: &WheelSignal,
        static_n: f64,
        stretch_m: &Range<f64>,
    ) -> Result<WheelForces, SignalError> {
        let quotient = |corner_hz: f64| -> Result<Vec<f64>, SignalError> {
            let (y_n, q_n) = (passed(&wheel.y_n, corner_hz)?, passed(&wheel.q_n, corner_hz)?);
            let over = |(y, q): (&f64, &f64)| y / q.max(LEAST_LOAD * static_n);
            Ok(y_n.iter().zip(&q_n).map(over).collect())
        };
        let at = |values: &[f64], share: f64| percentile(values, share).unwrap_or(f64::NAN);
        let [_, high] = SHARES;
        let y_over_q = self.every(&self.meant(&quotient(CORNER_HZ)?), stretch_m, EVERY_M)?;
        let y_n = self.every(&self.guided(&wheel.y_n)?, stretch_m, EVERY_M)?;
        let q_n = self.every(&self.guided(&wheel.q_n)?, stretch_m, EVERY_M)?;
        let derailment = quotient(GB_CORNER_HZ)?;
        let load_n = passed(&wheel.q_n, GB_CORNER_HZ)?;
        let unloading: Vec<f64> =
            self.all(&load_n, stretch_m)?.iter().map(|q| 1.0 - q / static_n).collect();
        Ok(WheelForces {
            y_over_q: [at(&y_over_q, 0.5), at(&y_over_q, high)],
            y_quasi_static_n: at(&y_n, 0.5),
            q_n: [at(&q_n, 0.5), at(&q_n, high)],
            derailment_gb: at(self.all(&derailment, stretch_m)?, high),
            unloading: at(&unloading, high),
            wear_w: mean(self.all(&wheel.wear_w, stretch_m)?),
            t_gamma_n: mean(self.all(&wheel.t_gamma_n, stretch_m)?),
        })
    }

    /// The greatest rms over 100 m around the frequency of an instability.
    fn stability_rms_n(
        &self,
        sum_n: &[f64],
        spectrum: Option<&Spectrum>,
        stretch_m: &Range<f64>,
    ) -> Result<Option<f64>, SignalError> {
        let ([from_hz, to_hz], half_width_hz) = UNSTABLE_HZ;
        let [over_m, every_m] = STABILITY_M;
        let peak = spectrum
            .and_then(|spectrum| spectrum.peaks(from_hz, to_hz, 1).first().map(|(hz, _)| *hz));
        let Some(peak_hz) = peak.filter(|_| stretch_m.end - stretch_m.start >= over_m - 0.1) else {
            return Ok(None);
        };
        let inside = |hz: f64| (hz - peak_hz).abs() <= half_width_hz && hz >= 0.4;
        let band =
            through(sum_n, RATE_HZ, |hz| Complex::from(f64::from(u8::from(inside(hz)))), SETTLE_S)?;
        let mut greatest: f64 = 0.0;
        let windows =
            libm::floor((stretch_m.end - stretch_m.start - over_m + 0.1) / every_m) as usize;
        for window in 0..=windows {
            let from_m = stretch_m.start + window as f64 * every_m;
            let to_m = (from_m + over_m).min(stretch_m.end);
            greatest = greatest.max(rms(self.all(&band, &(from_m..to_m))?));
        }
        Ok(Some(greatest))
    }

    /// The sliding mean over 2 m around each place.
    fn meant(&self, values: &[f64]) -> Vec<f64> {
        let width = libm::round(MEAN_OVER_M / self.speed_m_per_s * RATE_HZ).max(1.0);
        earlier(sliding_mean(values, width as usize), 0.5 * (width - 1.0) / RATE_HZ)
    }

    /// Low-passed and meant, as EN 14363 reads guiding forces.
    fn guided(&self, values: &[f64]) -> Result<Vec<f64>, SignalError> {
        Ok(self.meant(&passed(values, CORNER_HZ)?))
    }

    /// The samples of a section.
    fn all<'b>(&self, values: &'b [f64], stretch_m: &Range<f64>) -> Result<&'b [f64], SignalError> {
        let (from, to) = (self.sample(stretch_m.start), self.sample(stretch_m.end));
        values.get(from..to.max(from + 1)).ok_or(SignalError::TooShort(values.len(), to))
    }

    /// Values at even distances in a section.
    fn every(
        &self,
        values: &[f64],
        stretch_m: &Range<f64>,
        every_m: f64,
    ) -> Result<Vec<f64>, SignalError> {
        let count = libm::floor((stretch_m.end - stretch_m.start) / every_m) as usize;
        let place = |number: usize| stretch_m.start + number as f64 * every_m;
        let value = |number: usize| {
            let sample = self.sample(place(number));
            values.get(sample).copied().ok_or(SignalError::TooShort(values.len(), sample))
        };
        (0..=count).map(value).collect()
    }

    /// The sample nearest to a place.
    fn sample(&self, place_m: f64) -> usize {
        libm::round((place_m - self.first_m) / self.speed_m_per_s * RATE_HZ).max(0.0) as usize
    }
}

/// Low-passed, without its delay.
fn passed(values: &[f64], corner_hz: f64) -> Result<Vec<f64>, SignalError> {
    let delay_s = DELAY / (std::f64::consts::TAU * corner_hz);
    Ok(earlier(low_pass(values, RATE_HZ, corner_hz)?, delay_s))
}

/// A signal moved to earlier times; its last value stays.
fn earlier(values: Vec<f64>, by_s: f64) -> Vec<f64> {
    let by = libm::round(by_s * RATE_HZ) as usize;
    let last = values.last().copied();
    let mut moved: Vec<f64> = values.into_iter().skip(by).collect();
    moved.extend(std::iter::repeat_n(last.unwrap_or_default(), by));
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const SPEED: f64 = 20.0;

    /// A wheelset under forces that depend on place alone, 600 m from zero on.
    fn wheelset(left_n: impl Fn(f64) -> f64, right_n: impl Fn(f64) -> f64) -> WheelsetSignal {
        let wheel = |y_n: &dyn Fn(f64) -> f64| WheelSignal {
            y_n: (0..30_000).map(|n| y_n(f64::from(n) * SPEED / RATE_HZ)).collect(),
            q_n: vec![100.0e3; 30_000],
            wear_w: vec![7.0; 30_000],
            t_gamma_n: vec![0.5; 30_000],
            ..WheelSignal::default()
        };
        WheelsetSignal { wheels: [wheel(&left_n), wheel(&right_n)], ..WheelsetSignal::default() }
    }

    fn forces(wheelset: &WheelsetSignal, right_hand: bool) -> AxleForces {
        let passage = Passage {
            wheelset,
            first_m: 0.0,
            speed_m_per_s: SPEED,
            static_n: [100.0e3; 2],
            right_hand,
        };
        passage.forces(&(200.0..500.0)).unwrap()
    }

    #[test]
    fn a_sine_has_its_amplitude_less_what_the_filters_take() {
        // 4 Hz at 20 m/s is 5 m: a mean over 2 m leaves sin(x)/x, x = 2 pi/5.
        let x = TAU / 5.0;
        let left = |m: f64| 30.0e3 + 10.0e3 * libm::sin(TAU * m / 5.0);
        let found = forces(&wheelset(left, |_| 5.0e3), true);
        let amplitude_n = 10.0e3 * libm::sin(x) / x;
        let [low, middle, high] = found.sum_n;
        assert!((middle - 25.0e3).abs() < 200.0, "{middle}");
        // Read every 0.5 m, ten times a period, the crest is met within cos(18 degrees).
        let met = |n: f64| (0.95..1.001).contains(&(n / amplitude_n));
        assert!(met(high - 25.0e3) && met(25.0e3 - low), "{low} {high}");
        // Its rms around 4 Hz, whatever the mean.
        let rms_n = found.stability_rms_n.unwrap();
        assert!((rms_n - 10.0e3 / f64::sqrt(2.0)).abs() < 60.0, "{rms_n}");
        let [outer, inner] = found.wheels;
        assert!((outer.y_over_q[0] - 0.3).abs() < 3e-3 && (inner.y_over_q[1] - 0.05).abs() < 1e-6);
        assert!((outer.derailment_gb - 0.4).abs() < 1e-3, "{}", outer.derailment_gb);
        assert!(outer.unloading.abs() < 1e-9 && outer.wear_w == 7.0 && outer.t_gamma_n == 0.5);
    }

    #[test]
    fn a_force_is_assigned_to_its_place_and_a_mirrored_wheelset_has_mirrored_forces() {
        // A step at 200 m, where the section begins: only the first 2 m know of what was before.
        let step = |m: f64| if m < 200.0 { -50.0e3 } else { 20.0e3 };
        let found = forces(&wheelset(step, |_| 0.0), true);
        assert!((found.sum_n[1] - 20.0e3).abs() < 1.0);
        let before = |m: f64| if m < 197.0 { -50.0e3 } else { 20.0e3 };
        let low_n = forces(&wheelset(before, |_| 0.0), true).sum_n[0];
        assert!((low_n - 20.0e3).abs() < 3.0e3, "{low_n}");
        assert_eq!(forces(&wheelset(|_| 0.0, step), false), found);
    }
}
