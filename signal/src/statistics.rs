//! Figures of a sampled signal: rms, extremes, percentiles, half cycles.
//!
//! A **half cycle** is what lies between two crossings of the mean. A crossing counts once the
//! signal has left a dead band of `dead_band` to either side of its mean, so that noise around zero
//! makes no cycles; its time is that of the last crossing of the mean itself, interpolated
//! between samples. The incomplete half cycles at both ends are left out.

/// Root of the mean square; zero for no samples. The mean is not taken off.
///
/// ```
/// assert_eq!(signal::statistics::rms(&[3.0, -4.0, 3.0, -4.0]), 12.5f64.sqrt());
/// ```
pub fn rms(values: &[f64]) -> f64 {
    let square: f64 = values.iter().map(|value| value * value).sum();
    (square / values.len().max(1) as f64).sqrt()
}

/// Arithmetic mean; zero for no samples.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean over `half` values to either side, over fewer at the ends.
///
/// ```
/// assert_eq!(signal::statistics::moving_mean(&[0.0, 3.0, 6.0, 0.0], 1), [1.5, 3.0, 3.0, 3.0]);
/// ```
pub fn moving_mean(values: &[f64], half: usize) -> Vec<f64> {
    (0..values.len())
        .map(|i| {
            let range = i.saturating_sub(half)..(i + half + 1).min(values.len());
            let length = range.len() as f64;
            values[range].iter().sum::<f64>() / length
        })
        .collect()
}

/// Least and greatest value; `None` for no samples. Values that are not numbers are passed over.
///
/// ```
/// assert_eq!(signal::statistics::min_max(&[1.0, f64::NAN, -2.0]), Some((-2.0, 1.0)));
/// ```
pub fn min_max(values: &[f64]) -> Option<(f64, f64)> {
    values.iter().filter(|value| !value.is_nan()).fold(None, |found, value| match found {
        None => Some((*value, *value)),
        Some((least, greatest)) => Some((least.min(*value), greatest.max(*value))),
    })
}

/// The value that a `share` (0 to 1) of the samples does not exceed, linear between ranks (the rule
/// of `NumPy` and of most spreadsheets); `None` for no samples or a share outside 0 to 1.
///
/// ```
/// use signal::statistics::percentile;
/// assert_eq!(percentile(&[4.0, 1.0, 3.0, 2.0], 0.5), Some(2.5));
/// assert_eq!(percentile(&[4.0, 1.0, 3.0, 2.0], 1.0), Some(4.0));
/// ```
pub fn percentile(values: &[f64], share: f64) -> Option<f64> {
    if !(0.0..=1.0).contains(&share) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = share * sorted.len().checked_sub(1)? as f64;
    let (below, fraction) = (place as usize, place - libm::floor(place));
    let low = *sorted.get(below)?;
    let high = sorted.get(below + 1).copied().unwrap_or(low);
    Some(low + (high - low) * fraction)
}

/// Standard deviations of a normal distribution in its median absolute value.
const NORMAL_MEDIAN: f64 = 0.6745;

/// Root mean square of normally distributed values from the median of their sizes, which a few
/// outliers hardly change; `None` for no samples and where the median is zero.
///
/// ```
/// use signal::statistics::robust_rms;
/// assert_eq!(robust_rms(&[0.6745, -0.6745, 1000.0]), Some(1.0));
/// ```
pub fn robust_rms(values: &[f64]) -> Option<f64> {
    let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    let median = percentile(&sizes, 0.5)?;
    (median > 0.0).then_some(median / NORMAL_MEDIAN)
}

/// The smallest change from one value to the next that is larger than `above`: the last digit of a
/// record. `f64::MAX` where nothing changes.
///
/// ```
/// use signal::statistics::smallest_change;
/// assert_eq!(smallest_change(&[1.0, 1.0, 1.25, 0.0], 0.0), 0.25);
/// ```
pub fn smallest_change(values: &[f64], above: f64) -> f64 {
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    changes.filter(|change| *change > above).fold(f64::MAX, f64::min)
}

/// One half cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfCycle {
    /// Where the mean is crossed at its beginning, in samples from the first.
    pub start: f64,
    /// Where it is crossed at its end.
    pub end: f64,
    /// Greatest distance from the mean in between, signed.
    pub extreme: f64,
}

/// All complete half cycles of a signal around its mean.
pub fn half_cycles(values: &[f64], dead_band: f64) -> Vec<HalfCycle> {
    let mut found = HalfCycles::new(mean(values), dead_band);
    values.iter().filter_map(|value| found.push(*value)).collect()
}

/// Finds the half cycles of a signal that comes sample by sample, around a mean that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfCycles {
    middle: f64,
    dead_band: f64,
    /// Samples so far.
    samples: usize,
    /// Side of the present half cycle, its start, its extreme so far.
    side: f64,
    start: Option<f64>,
    extreme: f64,
    /// Where the mean was crossed last.
    crossing: f64,
    before: f64,
    /// What has been seen since the last crossing of the mean belongs to the next half cycle.
    since: f64,
}

impl HalfCycles {
    /// No samples yet.
    pub const fn new(middle: f64, dead_band: f64) -> Self {
        Self {
            middle,
            dead_band,
            samples: 0,
            side: 0.0,
            start: None,
            extreme: 0.0,
            crossing: 0.0,
            before: 0.0,
            since: 0.0,
        }
    }

    /// Takes in the next sample; gives the half cycle that it completes.
    pub fn push(&mut self, value: f64) -> Option<HalfCycle> {
        let (value, mut found) = (value - self.middle, None);
        if self.samples > 0 && (self.before < 0.0) != (value < 0.0) {
            self.crossing = self.samples as f64 - value / (value - self.before);
            self.since = 0.0;
        }
        if value.abs() > self.since.abs() {
            self.since = value;
        }
        if value.abs() > self.dead_band && value * self.side <= 0.0 {
            let (end, extreme) = (self.crossing, self.extreme);
            found = self.start.map(|start| HalfCycle { start, end, extreme });
            // The first half cycle began before the record.
            self.start = (self.side != 0.0).then_some(self.crossing);
            self.side = libm::copysign(1.0, value);
            self.extreme = self.since;
        }
        if value * self.side > self.extreme * self.side {
            self.extreme = value;
        }
        self.before = value;
        self.samples += 1;
        found
    }
}

/// Mean of the greatest distances from the mean, one per half cycle: the amplitude that a reader
/// sees in a plot. `None` without a complete half cycle.
///
/// ```
/// use signal::statistics::mean_peak;
/// // 3.46 mm at 3.5 Hz.
/// let stroke: Vec<f64> = (0..4000)
///     .map(|n| 3.46e-3 * libm::sin(std::f64::consts::TAU * 3.5e-3 * f64::from(n)))
///     .collect();
/// assert!((mean_peak(&stroke, 0.1e-3).unwrap() - 3.46e-3).abs() < 1e-6);
/// ```
pub fn mean_peak(values: &[f64], dead_band: f64) -> Option<f64> {
    let cycles = half_cycles(values, dead_band);
    let sum: f64 = cycles.iter().map(|cycle| cycle.extreme.abs()).sum();
    (!cycles.is_empty()).then(|| sum / cycles.len() as f64)
}

/// Frequency by zero crossings (Hz): complete half cycles over twice the time they take. `None`
/// without a complete half cycle.
///
/// ```
/// use signal::statistics::zero_crossing_hz;
/// let tone: Vec<f64> =
///     (0..5000).map(|n| libm::cos(std::f64::consts::TAU * 3.7e-3 * f64::from(n))).collect();
/// assert!((zero_crossing_hz(&tone, 1000.0, 0.01).unwrap() - 3.7).abs() < 0.01);
/// ```
pub fn zero_crossing_hz(values: &[f64], rate_hz: f64, dead_band: f64) -> Option<f64> {
    let cycles = half_cycles(values, dead_band);
    let span = cycles.last()?.end - cycles.first()?.start;
    (span > 0.0).then(|| 0.5 * cycles.len() as f64 / span * rate_hz)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(count: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..count).map(|n| of(n as f64 * 1e-3)).collect()
    }

    #[test]
    fn a_dead_band_keeps_noise_from_making_cycles() {
        // 2 Hz with a ripple that crosses zero many times.
        let noisy = wave(10_000, |t| libm::sin(TAU * 2.0 * t) + 0.1 * libm::sin(TAU * 170.0 * t));
        let clean = zero_crossing_hz(&noisy, 1000.0, 0.2).unwrap();
        assert!((clean - 2.0).abs() < 0.01, "{clean}");
        let naive = zero_crossing_hz(&noisy, 1000.0, 0.0).unwrap();
        assert!(naive > 2.5, "{naive}");
        // The ripple adds to the highest sample of each half cycle, at most by its own size.
        let peak = mean_peak(&noisy, 0.2).unwrap();
        assert!((1.0..1.101).contains(&peak), "{peak}");
    }

    #[test]
    fn peaks_of_unequal_halves_are_averaged_around_the_mean() {
        // Halves of one second at +3 and -1 (mean 1): both are 2 away from the mean.
        let square = wave(8000, |t| if t.rem_euclid(2.0) < 1.0 { 3.0 } else { -1.0 });
        let cycles = half_cycles(&square, 0.5);
        assert_eq!(cycles.len(), 6);
        assert!(cycles.iter().all(|cycle| cycle.extreme.abs() == 2.0), "{cycles:?}");
        assert_eq!(mean_peak(&square, 0.5), Some(2.0));
        assert!((zero_crossing_hz(&square, 1000.0, 0.5).unwrap() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn the_extreme_is_kept_although_it_comes_before_the_dead_band_is_left_for_good() {
        let triangle = [0.0, -1.0, 0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0, 1.0];
        let cycles = half_cycles(&triangle, 0.5);
        assert_eq!(cycles.iter().map(|c| c.extreme).collect::<Vec<_>>(), vec![2.0, -2.0]);
    }

    #[test]
    fn a_signal_without_cycles_has_no_frequency() {
        for flat in [&[][..], &[1.0][..], &[2.0; 50][..]] {
            assert_eq!(mean_peak(flat, 0.0), None);
            assert_eq!(zero_crossing_hz(flat, 1.0, 0.0), None);
        }
        assert_eq!(mean_peak(&wave(3000, libm::sin), 2.0), None);
    }

    #[test]
    fn nothing_in_nothing_out() {
        assert_eq!(
            (rms(&[]), mean(&[]), min_max(&[]), percentile(&[], 0.5)),
            (0.0, 0.0, None, None)
        );
        assert_eq!(percentile(&[1.0], 1.5), None);
        assert_eq!(percentile(&[7.0], 0.3), Some(7.0));
    }
}
