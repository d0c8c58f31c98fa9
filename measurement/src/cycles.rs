//! Whole cycles of a periodic test, and the run-in.
//!
//! A cycle begins where the displacement comes up through the middle of its range (between the 2nd
//! and 98th percentile); it counts once the displacement has left a dead band of 20 % of the half
//! range to either side, so that noise makes none. A test is periodic where at least two cycles in
//! a row, over at least half of the record, have lengths within 5 % (or two samples) of their
//! median and ranges within 10 %: sines and triangles are, sweeps and service records are not. Only
//! those equal cycles are marked.
//!
//! The run-in is the first period of the record where at least three cycles are marked; else a
//! tenth of the record, at most one second. It is the same for every model.

use signal::statistics::percentile;

/// Dead band, as a share of half the range.
const DEAD_BAND: f64 = 0.2;
/// Length of a cycle against the median.
const LENGTH_SHARE: f64 = 0.05;
/// Range of a cycle against the median.
const RANGE_SHARE: f64 = 0.1;

/// First sample of every whole cycle and the end of the last; empty where there are none.
pub(crate) fn find(displacement_m: &[f64]) -> Vec<usize> {
    let (Some(low), Some(high)) =
        (percentile(displacement_m, 0.02), percentile(displacement_m, 0.98))
    else {
        return Vec::new();
    };
    let crossings = upward(displacement_m, 0.5 * (low + high), DEAD_BAND * 0.5 * (high - low));
    let cycles: Vec<Cycle> =
        crossings.windows(2).map(|pair| Cycle::between(displacement_m, pair[0], pair[1])).collect();
    let length = median(cycles.iter().map(|cycle| cycle.length));
    let range = median(cycles.iter().map(|cycle| cycle.range));
    let equal = |cycle: &Cycle| {
        (cycle.length - length).abs() <= (LENGTH_SHARE * length).max(2.0)
            && (cycle.range - range).abs() <= RANGE_SHARE * range
    };
    let (mut best, mut from) = (0..0, 0);
    for (index, cycle) in cycles.iter().enumerate() {
        if !equal(cycle) {
            from = index + 1;
        } else if index + 1 - from > best.len() {
            best = from..index + 1;
        }
    }
    debug_assert!(best.is_empty() || best.end < crossings.len(), "every cycle ends in a crossing");
    let marks: Vec<usize> = crossings
        .get(best.start..=best.end)
        .unwrap_or_default()
        .iter()
        .map(|crossing| libm::ceil(*crossing) as usize)
        .collect();
    let covered = marks.last().zip(marks.first()).map_or(0, |(end, start)| end - start);
    if marks.len() < 3 || 2 * covered < displacement_m.len() {
        return Vec::new();
    }
    marks
}

/// Samples that no error counts.
pub(crate) fn run_in(cycles: &[usize], samples: usize, step_s: f64) -> usize {
    if let [first, _, _, .., last] = cycles {
        return (last - first).div_ceil(cycles.len() - 1);
    }
    let second = libm::round(1.0 / step_s) as usize;
    (samples / 10).min(second)
}

struct Cycle {
    length: f64,
    range: f64,
}

impl Cycle {
    fn between(values: &[f64], start: f64, end: f64) -> Self {
        let inside = values.get(start as usize..=end as usize).unwrap_or_default();
        let (low, high) = signal::statistics::min_max(inside).unwrap_or((0.0, 0.0));
        Self { length: end - start, range: high - low }
    }
}

/// Where the values come up through the middle, in samples, interpolated. A record that begins or
/// ends in the middle has a crossing there.
fn upward(values: &[f64], middle: f64, band: f64) -> Vec<f64> {
    let near = |value: Option<&f64>| value.is_some_and(|x| (x - middle).abs() <= 0.1 * band);
    let (mut below, mut crossing) = (near(values.first()), 0.0);
    let mut found = Vec::new();
    for (index, pair) in values.windows(2).enumerate() {
        let (before, now) = (pair[0] - middle, pair[1] - middle);
        below |= before < -band;
        if before < 0.0 && now >= 0.0 {
            crossing = index as f64 - before / (now - before);
        }
        if below && now > band {
            found.push(crossing);
            below = false;
        }
    }
    if below && !found.is_empty() && near(values.last()) {
        let last = values.len() as f64 - 1.0;
        found.push(if crossing > last - 5.0 { crossing } else { last });
    }
    found
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    percentile(&values, 0.5).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(count: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..count).map(|n| of(n as f64 * 1e-3)).collect()
    }

    fn triangle(phase: f64) -> f64 {
        1.0 - 4.0 * ((phase - libm::floor(phase)) - 0.5).abs()
    }

    #[test]
    fn sines_and_triangles_have_cycles_with_noise_and_offset() {
        for period in [0.137, 0.2857, 1.0] {
            let noise = |t: f64| 0.02 * libm::sin(TAU * 171.3 * t);
            let sine = wave(5000, |t| 40.0 + 3.0 * (libm::sin(TAU * t / period - 1.0) + noise(t)));
            let zigzag = wave(5000, |t| -7.0 + triangle(t / period) + noise(t));
            for marks in [find(&sine), find(&zigzag)] {
                let covered = (marks[marks.len() - 1] - marks[0]) as f64 * 1e-3;
                assert!(covered > 5.0 - 2.0 * period && covered <= 5.0, "{marks:?}");
                for pair in marks.windows(2) {
                    assert!(((pair[1] - pair[0]) as f64 * 1e-3 / period - 1.0).abs() < 0.02);
                }
            }
        }
    }

    #[test]
    fn a_record_that_begins_at_a_crest_has_its_first_cycle_at_the_rise() {
        // Three periods of 100 samples, of which two are whole from the rise at 75.
        let x: Vec<f64> = (0..300).map(|n| libm::cos(TAU * f64::from(n) * 0.01)).collect();
        assert_eq!(find(&x), [75, 175, 275]);
    }

    #[test]
    fn sweeps_noise_ramps_and_growing_amplitudes_have_none() {
        let sweep = wave(10_000, |t| libm::sin(TAU * (0.5 + 0.5 * t) * t));
        let growing = wave(10_000, |t| t * libm::sin(TAU * t));
        let service = wave(10_000, |t| {
            libm::sin(TAU * 0.7 * t)
                + libm::sin(TAU * 1.13 * t + 1.0)
                + 0.8 * libm::sin(TAU * 1.9 * t)
        });
        let ramp = wave(10_000, |t| t);
        for signal in [sweep, growing, service, ramp, vec![1.0; 500], vec![]] {
            assert_eq!(find(&signal), [0; 0]);
        }
    }

    #[test]
    fn a_fade_in_is_no_cycle() {
        let faded = wave(10_000, |t| (t / 2.0).min(1.0) * libm::sin(TAU * t));
        let marks = find(&faded);
        assert_eq!((marks[0], *marks.last().unwrap()), (2000, 9999));
        assert_eq!(run_in(&marks, 10_000, 1e-3), 1000);
    }

    #[test]
    fn the_run_in_without_enough_cycles_is_a_tenth_at_most_a_second() {
        assert_eq!(run_in(&[], 5000, 1e-3), 500);
        assert_eq!(run_in(&[], 50_000, 1e-3), 1000);
        assert_eq!(run_in(&[0, 1000, 2000], 2500, 1e-3), 250);
        assert_eq!(run_in(&[40, 1040, 2040, 3041], 3100, 1e-3), 1001);
    }
}
