//! Thinning: which samples of a long record are drawn.
//!
//! - A record, where x only rises: of every step of the axis (in decades when it is logarithmic)
//!   the smallest and the largest sample, at their true places. No peak is lost and none is
//!   invented; an average or every n-th sample would lower them.
//! - A loop, where x goes back and forth: samples are left out where the line stays within a
//!   tolerance without them (Ramer, Douglas, Peucker), in shares of the spans of x and y.
//! - A cloud of marks: the outermost samples of every stretch of the record.

use std::iter;
use std::ops::{Range, RangeInclusive};

use crate::simplify::simplify;

/// The most points of one trace that are drawn as they are; above, the trace is thinned to about
/// this many.
pub const MAX_DRAWN: usize = 4000;

/// What to draw, in order: `Some(index)` of a sample, or `None` where the line is to break.
pub(crate) type Drawn = Vec<Option<usize>>;

/// The samples to draw of a trace.
pub(crate) struct Chosen {
    pub(crate) drawn: Drawn,
    /// For a thinned loop: how far the drawn line may be from the samples, as a share of the spans.
    pub(crate) off_by: Option<f64>,
}

/// Chooses the samples to draw of a trace, within a window of x if one is given.
pub(crate) fn choose(
    x: &[f64],
    y: &[f64],
    scatter: bool,
    log_x: bool,
    window: Option<&RangeInclusive<f64>>,
) -> Chosen {
    let runs = runs_inside(x, window);
    let total: usize = runs.iter().map(Range::len).sum();
    let (runs, off_by): (Vec<Vec<usize>>, _) = if total <= MAX_DRAWN {
        (runs.into_iter().map(Iterator::collect).collect(), None)
    } else if scatter {
        let stretch = total.div_ceil(MAX_DRAWN / 4);
        (runs.into_iter().map(|run| outermost(x, y, run, stretch)).collect(), None)
    } else if rises(x) {
        let by_steps = |run| extremes_of_axis_steps(x, y, run, MAX_DRAWN / 2, log_x);
        (runs.into_iter().map(by_steps).collect(), None)
    } else {
        let (runs, tolerance) = simplify(x, y, &runs, MAX_DRAWN);
        (runs, Some(tolerance))
    };
    let mut drawn = Drawn::new();
    for run in runs {
        if !drawn.is_empty() {
            drawn.push(None);
        }
        drawn.extend(run.into_iter().map(Some));
    }
    Chosen { drawn, off_by }
}

/// True when x never falls and has no gap.
pub(crate) fn rises(x: &[f64]) -> bool {
    x.iter().all(|v| v.is_finite()) && x.is_sorted()
}

/// Stretches of samples inside the window, each with one neighbour more so that lines run up to
/// the edge of the picture.
fn runs_inside(x: &[f64], window: Option<&RangeInclusive<f64>>) -> Vec<Range<usize>> {
    let Some(window) = window else { return iter::once(0..x.len()).collect() };
    let mut runs: Vec<Range<usize>> = Vec::new();
    for k in (0..x.len()).filter(|&k| window.contains(&x[k])) {
        let (from, to) = (k.saturating_sub(1), (k + 2).min(x.len()));
        match runs.last_mut() {
            Some(last) if from <= last.end => last.end = to,
            _ => runs.push(from..to),
        }
    }
    runs
}

fn extremes_of_axis_steps(
    x: &[f64],
    y: &[f64],
    run: Range<usize>,
    steps: usize,
    log_x: bool,
) -> Vec<usize> {
    let place = |k: usize| if log_x { libm::log10(x[k]) } else { x[k] };
    // On a log axis what is not positive has no place; it is counted as a gap elsewhere.
    let run: Vec<usize> = run.filter(|&k| place(k).is_finite()).collect();
    let (Some(&first), Some(&last)) = (run.first(), run.last()) else { return Vec::new() };
    let (from, width) = (place(first), (place(last) - place(first)) / steps as f64);
    let step_of = |k: usize| ((place(k) - from) / width) as usize;
    let mut kept = vec![first];
    for chunk in run.chunk_by(|&a, &b| step_of(a) == step_of(b)) {
        keep_extremes(chunk, |k| y[k], &mut kept);
    }
    kept.push(last);
    in_order(kept)
}

fn outermost(x: &[f64], y: &[f64], run: Range<usize>, stretch: usize) -> Vec<usize> {
    let run: Vec<usize> = run.collect();
    let mut kept = Vec::new();
    for chunk in run.chunks(stretch) {
        keep_extremes(chunk, |k| x[k], &mut kept);
        keep_extremes(chunk, |k| y[k], &mut kept);
    }
    in_order(kept)
}

/// Keeps the places of the smallest and the largest value, and of the first gap.
fn keep_extremes(chunk: &[usize], value: impl Fn(usize) -> f64, kept: &mut Vec<usize>) {
    let finite = || chunk.iter().copied().filter(|&k| value(k).is_finite());
    kept.extend(finite().min_by(|&a, &b| value(a).total_cmp(&value(b))));
    kept.extend(finite().max_by(|&a, &b| value(a).total_cmp(&value(b))));
    kept.extend(chunk.iter().copied().find(|&k| !value(k).is_finite()));
}

fn in_order(mut kept: Vec<usize>) -> Vec<usize> {
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::{MAX_DRAWN, choose};
    use proptest::prelude::*;

    fn indices(x: &[f64], y: &[f64], log_x: bool) -> Vec<usize> {
        choose(x, y, false, log_x, None).drawn.into_iter().flatten().collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(32) })]
        #[test]
        fn peaks_stay_and_the_size_is_bounded(
            y in prop::collection::vec(-1.0e3..1.0e3, 1..30_000),
            scatter in any::<bool>(),
        ) {
            let n = y.len();
            // A record rises; a cloud runs back and forth.
            let back_and_forth = |k: usize| ((k % 1000) as f64 - 500.0).abs();
            let x: Vec<f64> = (0..n)
                .map(|k| if scatter { back_and_forth(k) } else { k as f64 * 1e-3 })
                .collect();
            let chosen = choose(&x, &y, scatter, false, None).drawn;
            let kept: Vec<usize> = chosen.into_iter().flatten().collect();
            prop_assert!(kept.len() <= n.min(MAX_DRAWN + 4), "{} of {n}", kept.len());
            prop_assert!(kept.is_sorted() && kept.iter().all(|&k| k < n));
            for values in [&x, &y] {
                for pick in [f64::min as fn(f64, f64) -> f64, f64::max] {
                    let all = values.iter().copied().reduce(pick);
                    prop_assert_eq!(all, kept.iter().map(|&k| values[k]).reduce(pick));
                }
            }
        }
    }

    #[test]
    fn a_short_spike_between_drawn_columns_survives() {
        let x: Vec<f64> = (0..200_000).map(f64::from).collect();
        let mut y = vec![0.0; x.len()];
        y[123_457] = 1.0;
        assert!(indices(&x, &y, false).contains(&123_457));
    }

    #[test]
    fn a_log_axis_keeps_its_first_decade_whole() {
        let frequency: Vec<f64> = (1..=50_000).map(|k| f64::from(k) * 0.01).collect();
        let kept = indices(&frequency, &vec![1.0; frequency.len()], true);
        let first_decade = kept.iter().filter(|&&k| frequency[k] < 0.1).count();
        assert_eq!(first_decade, 9);
        assert!(kept.len() < MAX_DRAWN + 6);
    }

    #[test]
    fn gaps_stay_gaps() {
        let x: Vec<f64> = (0..20_000).map(f64::from).collect();
        let mut y = vec![1.0; x.len()];
        y[7_000..7_020].fill(f64::NAN);
        let kept = indices(&x, &y, false);
        assert!(kept.iter().any(|&k| y[k].is_nan()));
    }

    #[test]
    fn a_window_keeps_every_sample_inside_and_breaks_between_passes() {
        let x = [0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0, -1.0, 0.0, 1.0];
        let drawn = choose(&x, &x, false, false, Some(&(-0.5..=1.5))).drawn;
        let expected: Vec<Option<usize>> =
            [0, 1, 2].map(Some).into_iter().chain([None]).chain((4..10).map(Some)).collect();
        assert_eq!(drawn, expected);
    }
}
