//! Whole cycles of a periodic test, and the run-in.
//!
//! A cycle begins where the displacement comes up through the middle of its range (between the 2nd
//! and 98th percentile); it counts once the displacement has left a dead band of 20 % of the half
//! range to either side, so that noise makes none.
//!
//! - **A periodic record**: at least two cycles in a row, over at least half of the record, have
//!   lengths within 5 % (or two samples) of their median and ranges within 10 %, and neighbours
//!   that differ by at most 30 % of their rms, one over the other: sines and triangles do, sweeps
//!   and service records do not.
//! - **A short test**, with rests, growing and fading: at least two cycles in a row whose lengths
//!   agree within 2 % (or two samples), whose ranges agree within 3 %, and whose displacements, one
//!   over the other, differ by at most 3 % of their rms. They have to be a tenth of the
//!   record's cycles and not a piece of a steady growth: cycles of a random motion that happen to
//!   be alike are none.
//!
//! Marked are the cycles of one run, the longest: a mark for the first sample of each and one for
//! the end of the last, so that two marks that follow each other always enclose one cycle and three
//! enclose two cycles of equal motion. A record of several runs, such as one for each speed, has
//! them all in [`runs`], the longest among them.
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

/// Difference of neighbouring cycles, rms over rms, in the median.
const PERIODIC_SHAPE_SHARE: f64 = 0.3;

/// Length of a cycle of a short test against another of its run.
const SHORT_LENGTH_SHARE: f64 = 0.02;
/// Range of a cycle of a short test against another of its run.
const SHORT_RANGE_SHARE: f64 = 0.03;
/// Difference of two cycles of a short test, rms over rms.
const SHAPE_SHARE: f64 = 0.03;
/// Share of a record's cycles that a run of equal ones needs.
const SHARE_OF_CYCLES: f64 = 0.1;
/// Growth from cycle to cycle within a run, as a share of that just outside it.
const GROWTH_SHARE: f64 = 0.34;

/// First sample of every whole cycle and the end of the last, of the longest run; empty where there
/// are none.
pub(crate) fn find(displacement_m: &[f64]) -> Vec<usize> {
    longest(&runs(displacement_m))
}

/// The marks of all runs of equal cycles, in the order of the record: of one run where the whole
/// record is periodic.
pub(crate) fn runs(displacement_m: &[f64]) -> Vec<Vec<usize>> {
    let periodic = of_periodic(displacement_m);
    if periodic.is_empty() { of_short(displacement_m) } else { vec![periodic] }
}

/// The marks of the run with the most cycles, the first of several.
pub(crate) fn longest(runs: &[Vec<usize>]) -> Vec<usize> {
    let mut longest: &[usize] = &[];
    for marks in runs.iter().filter(|marks| !marks.is_empty()) {
        if marks.len() > longest.len() {
            longest = marks;
        }
    }
    longest.to_vec()
}

/// The marks of a record that is periodic over at least half of its length.
fn of_periodic(displacement_m: &[f64]) -> Vec<usize> {
    let (Some(low), Some(high)) =
        (percentile(displacement_m, 0.02), percentile(displacement_m, 0.98))
    else {
        return Vec::new();
    };
    let middle = 0.5 * (low + high);
    let crossings = upward(displacement_m, middle, DEAD_BAND * 0.5 * (high - low));
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
    let run = crossings.get(best.start..=best.end).unwrap_or_default();
    let marks: Vec<usize> = run.iter().map(|crossing| libm::ceil(*crossing) as usize).collect();
    let covered = marks.last().zip(marks.first()).map_or(0, |(end, start)| end - start);
    if marks.len() < 3 || 2 * covered < displacement_m.len() {
        return Vec::new();
    }
    let unlike = median(run.windows(3).map(|three| {
        let cycle = |start, end| Whole { start, end, range };
        let [first, next] = [cycle(three[0], three[1]), cycle(three[1], three[2])];
        difference(displacement_m, middle, first, next)
    }));
    if unlike > PERIODIC_SHAPE_SHARE { Vec::new() } else { marks }
}

/// A cycle between two rises through the middle.
#[derive(Debug, Clone, Copy)]
struct Whole {
    /// Where it leaves the middle, in samples.
    start: f64,
    /// Where it is back at the middle.
    end: f64,
    /// Greatest displacement less the least.
    range: f64,
}

impl Whole {
    fn length(self) -> f64 {
        self.end - self.start
    }

    /// Equal in length and range.
    fn is_like(self, other: Self) -> bool {
        let (length, range) = (self.length().max(other.length()), self.range.max(other.range));
        (self.length() - other.length()).abs() <= (SHORT_LENGTH_SHARE * length).max(2.0)
            && (self.range - other.range).abs() <= SHORT_RANGE_SHARE * range
    }

    /// The next one begins where this one ends, without a rest.
    fn goes_on_in(self, next: Self) -> bool {
        next.start - self.end <= (SHORT_LENGTH_SHARE * self.length()).max(2.0)
    }
}

/// The marks of every run of equal cycles of a record that is not periodic as a whole.
fn of_short(displacement_m: &[f64]) -> Vec<Vec<usize>> {
    let (Some(low), Some(high)) =
        (percentile(displacement_m, 0.02), percentile(displacement_m, 0.98))
    else {
        return Vec::new();
    };
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut all: Vec<Whole> = Vec::new();
    for (start, end) in rises(displacement_m, middle, DEAD_BAND * half) {
        let inside = displacement_m.get(start as usize..=end as usize).unwrap_or_default();
        let (low, high) = signal::statistics::min_max(inside).unwrap_or((0.0, 0.0));
        all.push(Whole { start, end, range: high - low });
    }
    let alike = |first: &Whole, next: &Whole| {
        first.goes_on_in(*next)
            && first.is_like(*next)
            && difference(displacement_m, middle, *first, *next) <= SHAPE_SHARE
    };
    let (mut found, mut from) = (Vec::new(), 0);
    for index in 1..=all.len() {
        let (Some(first), next) = (all.get(from), all.get(index)) else { break };
        let before = all.get(index - 1);
        if next
            .zip(before)
            .is_some_and(|(next, before)| alike(before, next) && next.is_like(*first))
        {
            continue;
        }
        let run = from..index;
        from = index;
        let enough = run.len() >= 2 && run.len() as f64 >= SHARE_OF_CYCLES * all.len() as f64;
        if enough && is_plateau(&all, run.clone()) {
            found.push(marks(all.get(run).unwrap_or_default()));
        }
    }
    found
}

fn marks(run: &[Whole]) -> Vec<usize> {
    let starts = run.iter().map(|cycle| cycle.start);
    let end = run.last().map(|cycle| cycle.end);
    starts.chain(end).map(|at| libm::ceil(at) as usize).collect()
}

/// A run that grows from cycle to cycle as it does just outside is a piece of a growing motion.
fn is_plateau(all: &[Whole], run: std::ops::Range<usize>) -> bool {
    let range = |at: usize| all.get(at).map(|cycle| cycle.range);
    let growth = |from: usize, to: usize| {
        // A rest between two cycles ends what grows.
        let goes_on = all.get(from)?.goes_on_in(*all.get(to)?);
        Some(range(to)? - range(from)?).filter(|_| goes_on)
    };
    let Some(inside) = growth_per_cycle(all, run.clone()) else { return false };
    let before = run.start.checked_sub(1).and_then(|before| growth(before, run.start));
    let after = growth(run.end - 1, run.end);
    // A rest, the end of the record or a change of size on either side ends a plateau.
    let outside = [before, after];
    !outside.iter().flatten().any(|step| {
        step * inside > 0.0
            && inside.abs() > GROWTH_SHARE * step.abs()
            && inside.abs() > 1e-3 * range(run.start).unwrap_or(0.0)
    })
}

fn growth_per_cycle(all: &[Whole], run: std::ops::Range<usize>) -> Option<f64> {
    let (first, last) = (all.get(run.start)?, all.get(run.end.checked_sub(1)?)?);
    Some((last.range - first.range) / (run.len() - 1).max(1) as f64)
}

/// Difference of two cycles, one over the other from their starts on, rms over rms.
fn difference(values: &[f64], middle: f64, first: Whole, next: Whole) -> f64 {
    let at = |place: f64| {
        let n = libm::floor(place) as usize;
        let (a, b) = (values.get(n), values.get(n + 1).or(values.get(n)));
        let share = place - libm::floor(place);
        a.zip(b).map_or(middle, |(a, b)| a + share * (b - a))
    };
    let length = first.length().min(next.length());
    let (mut off, mut size) = (0.0, 0.0);
    for n in 0..=(length as usize) {
        let (a, b) = (at(first.start + n as f64), at(next.start + n as f64));
        off += (a - b) * (a - b);
        size += (a - middle) * (a - middle);
    }
    if size > 0.0 { (off / size).sqrt() } else { f64::INFINITY }
}

/// Where cycles begin and end, in samples: each from the rise through the middle before a crest to
/// the return to the middle after the trough that follows. A rest at the middle lies between an end
/// and a beginning.
fn rises(values: &[f64], middle: f64, band: f64) -> Vec<(f64, f64)> {
    // A return counts this far below the middle: a motion that ends at rest may not reach it.
    let near = 0.05 * band;
    let mut found = Vec::new();
    // The last rise through the middle; the beginning of the cycle that has passed its crest; the
    // return that ends it.
    let mut rise = values.first().filter(|x| (**x - middle).abs() <= near).map(|_| 0.0);
    let (mut begun, mut returned): (Option<f64>, Option<f64>) = (None, None);
    let (mut crest, mut trough) = (false, false);
    for (index, pair) in values.windows(2).enumerate() {
        let (before, now) = (pair[0] - middle, pair[1] - middle);
        if before <= near && now > near {
            // Straight back to the middle, from which a motion that begins at rest rises.
            rise = Some((index as f64 - before / (now - before)).max(0.0));
        }
        if trough && returned.is_none() && now >= -near {
            // Straight on to the middle, which a motion that ends at rest may not reach.
            let place = index as f64 - before / (now - before).max(f64::MIN_POSITIVE);
            let most = index as f64 + 1.0 + 0.02 * (index as f64 - begun.unwrap_or(0.0));
            returned = Some(place.clamp(index as f64, most));
        }
        if now < -band {
            if crest {
                trough = true;
            }
            returned = None;
        }
        if now > band {
            if trough {
                if let (Some(start), Some(end)) = (begun, returned) {
                    found.push((start, end));
                }
                (crest, trough, returned) = (false, false, None);
            }
            if !crest {
                begun = rise;
                crest = true;
            }
        }
    }
    if let (true, Some(start), Some(end)) = (trough, begun, returned) {
        found.push((start, end));
    }
    found
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

    /// A rest, `cycles` of 10 mm at 1 Hz, a rest; 1 kHz, noise of 1 um.
    fn between_rests(rest_s: f64, cycles: f64) -> Vec<f64> {
        let noise = |n: usize| ((n * 7919 + n * n * 104_729) % 997) as f64 / 997.0 - 0.5;
        let count = (1e3 * (2.0 * rest_s + cycles)) as usize;
        let of = |n: usize| {
            let t = n as f64 * 1e-3 - rest_s;
            if (0.0..cycles).contains(&t) { 10e-3 * libm::sin(TAU * t) } else { 0.0 }
        };
        (0..count).map(|n| of(n) + 2e-6 * noise(n)).collect()
    }

    #[test]
    fn cycles_between_rests_were_none() {
        for rest_s in [0.3, 1.0, 2.0, 10.0] {
            for cycles in [2.0, 3.0, 5.0] {
                let marks = find(&between_rests(rest_s, cycles));
                let whole = marks.len().saturating_sub(1);
                assert!(whole >= 2 && whole <= cycles as usize, "{rest_s} {cycles}: {marks:?}");
                for pair in marks.windows(2) {
                    assert!((pair[1] - pair[0]).abs_diff(1000) <= 20, "{marks:?}");
                }
            }
        }
        // Without noise, from an exact rest.
        let exact: Vec<f64> =
            between_rests(2.0, 3.0).iter().map(|x| (x * 1e5).round() * 1e-5).collect();
        assert_eq!(find(&exact).len(), 4);
    }

    #[test]
    fn whole_cycles_between_a_soft_start_and_a_soft_end_were_none() {
        let soft = wave(12_000, |t| (t / 4.0).min(3.0 - t / 4.0).min(1.0) * libm::sin(TAU * t));
        let marks = find(&soft);
        assert!(marks.len() >= 4 && marks.len() <= 6, "{marks:?}");
        assert!(marks[0] >= 3900 && *marks.last().unwrap() <= 8100, "{marks:?}");
    }

    #[test]
    fn every_run_of_a_record_of_several_is_found() {
        let mut x = between_rests(1.0, 3.0);
        x.extend(between_rests(1.0, 4.0).iter().map(|x| 0.5 * x));
        x.extend(between_rests(1.0, 3.0).iter().map(|x| 0.8 * x));
        let found: Vec<usize> = runs(&x).iter().map(|marks| marks.len() - 1).collect();
        assert!(
            found.len() == 3 && found.iter().zip([3, 4, 3]).all(|(a, b)| (b - 1..=b).contains(a)),
            "{found:?}"
        );
        assert!(find(&x).len() >= 4);
    }

    #[test]
    fn alike_cycles_of_a_random_or_slowly_growing_motion_are_chance() {
        let growing = wave(100_000, |t| t * libm::sin(TAU * t));
        assert_eq!(find(&growing), [0; 0]);
        let dying = wave(60_000, |t| libm::exp(-0.02 * t) * libm::sin(TAU * t));
        assert_eq!(find(&dying), [0; 0]);
        // A band of a third of an octave about 2 Hz.
        for seed in 0..6 {
            let narrow = wave(60_000, |t| {
                let tones = (0..60).map(|k| {
                    let k = f64::from(k);
                    let phase = 1e4 * libm::sin(k * k + f64::from(seed));
                    libm::sin(TAU * (1.8 + 0.0077 * k) * t + phase)
                });
                tones.sum()
            });
            assert_eq!(find(&narrow), [0; 0], "{seed}");
        }
    }

    #[test]
    fn two_swings_of_a_random_motion_were_cycles() {
        // Two periods of one length and range, the second with its crest late.
        let late = |phase: f64| phase - 0.6 * (1.0 - libm::cos(phase));
        let x = wave(2100, |t| {
            let phase = TAU * t;
            if t < 1.0 { libm::sin(phase) } else { libm::sin(late(late(phase))) }
        });
        assert_eq!(find(&x), [0; 0]);
        // The same swing twice is a cycle.
        let x = wave(2100, |t| libm::sin(late(late(TAU * t))));
        assert_eq!(find(&x), [1, 1001, 2001]);
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
