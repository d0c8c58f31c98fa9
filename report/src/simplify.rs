//! A loop with fewer points and the same shape (Ramer 1972; Douglas and Peucker 1973).
//!
//! Between two kept samples the one farthest from their chord is kept too, while it is farther than
//! the tolerance. Distances are in shares of the spans of x and y, so that one tolerance serves
//! both axes. Each sample is given once the tolerance at which it would go; then the tolerance is
//! below what a screen can show or, where that leaves too many points, the smallest that fits.
//! Stretches of bounded length keep the work linear in the record.

use std::ops::Range;

const SMALLEST_TOLERANCE: f64 = 1.0 / 4000.0;
const STRETCH: usize = 512;

/// The samples to keep of each run, at most about `budget` in all, and the tolerance that it took.
pub(crate) fn simplify(
    x: &[f64],
    y: &[f64],
    runs: &[Range<usize>],
    budget: usize,
) -> (Vec<Vec<usize>>, f64) {
    let shape = Shape { x, y, x_span: span(x), y_span: span(y) };
    let total: usize = runs.iter().map(Range::len).sum();
    let stretch = STRETCH.max(total.div_ceil(budget / 4));
    let goes_at: Vec<Vec<f64>> = runs.iter().map(|run| shape.goes_at(run, stretch)).collect();

    let mut sorted: Vec<f64> = goes_at.iter().flatten().copied().collect();
    sorted.sort_unstable_by(|a, b| b.total_cmp(a));
    // Ends and gaps never go, so the tolerance stays finite even where they fill the budget.
    let fitting = sorted.get(budget).copied().filter(|t| t.is_finite()).unwrap_or(0.0);
    let tolerance = fitting.max(SMALLEST_TOLERANCE);
    let keep = |(run, goes_at): (&Range<usize>, &Vec<f64>)| {
        run.clone().zip(goes_at).filter(|&(_, &t)| t > tolerance).map(|(k, _)| k).collect()
    };
    (runs.iter().zip(&goes_at).map(keep).collect(), tolerance)
}

fn span(values: &[f64]) -> f64 {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let span = finite().fold(f64::MIN, f64::max) - finite().fold(f64::MAX, f64::min);
    if span > 0.0 { span } else { 1.0 }
}

struct Shape<'a> {
    x: &'a [f64],
    y: &'a [f64],
    x_span: f64,
    y_span: f64,
}

impl Shape<'_> {
    /// For each sample of the run the tolerance at which it goes; infinite for those that stay.
    fn goes_at(&self, run: &Range<usize>, stretch: usize) -> Vec<f64> {
        let mut goes_at = vec![0.0; run.len()];
        let samples: Vec<usize> = run.clone().collect();
        for part in samples.chunk_by(|&a, &b| self.is_finite(a) == self.is_finite(b)) {
            if !self.is_finite(part[0]) {
                // One sample that is not finite breaks the line; more would break it no better.
                goes_at[part[0] - run.start] = f64::INFINITY;
                continue;
            }
            for chunk in part.chunks(stretch) {
                self.rank(chunk[0], chunk[chunk.len() - 1], run.start, &mut goes_at);
            }
        }
        goes_at
    }

    fn is_finite(&self, k: usize) -> bool {
        self.x[k].is_finite() && self.y[k].is_finite()
    }

    fn rank(&self, first: usize, last: usize, start: usize, goes_at: &mut [f64]) {
        goes_at[first - start] = f64::INFINITY;
        goes_at[last - start] = f64::INFINITY;
        let mut open = vec![(first, last, f64::INFINITY)];
        while let Some((a, b, parent)) = open.pop() {
            let farthest = (a + 1..b)
                .map(|k| (k, self.squared_distance_to_chord(k, a, b)))
                .max_by(|(_, i), (_, j)| i.total_cmp(j));
            if let Some((k, squared)) = farthest {
                // No sample stays longer than the one that split its chord.
                let tolerance = libm::sqrt(squared).min(parent);
                goes_at[k - start] = tolerance;
                open.extend([(a, k, tolerance), (k, b, tolerance)]);
            }
        }
    }

    /// Squared distance of sample `k` from the chord between `a` and `b`, in shares of the spans.
    fn squared_distance_to_chord(&self, k: usize, a: usize, b: usize) -> f64 {
        let from_a = |j: usize| {
            ((self.x[j] - self.x[a]) / self.x_span, (self.y[j] - self.y[a]) / self.y_span)
        };
        let ((px, py), (cx, cy)) = (from_a(k), from_a(b));
        let length_squared = cx * cx + cy * cy;
        let along = if length_squared > 0.0 {
            ((px * cx + py * cy) / length_squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let (dx, dy) = (px - along * cx, py - along * cy);
        dx * dx + dy * dy
    }
}

#[cfg(test)]
mod tests {
    use super::{SMALLEST_TOLERANCE, Shape, simplify, span};
    use proptest::prelude::*;

    fn one_run(x: &[f64], y: &[f64]) -> (Vec<Vec<usize>>, f64) {
        simplify(x, y, std::slice::from_ref(&(0..x.len())), 4000)
    }

    fn ellipse(samples: usize, turns: f64) -> (Vec<f64>, Vec<f64>) {
        let angle = |k: usize| std::f64::consts::TAU * turns * k as f64 / samples as f64;
        (0..samples).map(|k| (3.0 * libm::cos(angle(k)), 18e3 * libm::sin(angle(k)))).unzip()
    }

    #[test]
    fn an_ellipse_keeps_its_shape_with_few_points() {
        let (x, y) = ellipse(20_000, 10.0);
        let (kept, tolerance) = one_run(&x, &y);
        assert_eq!(tolerance, SMALLEST_TOLERANCE);
        let kept = &kept[0];
        assert!(kept.len() < 4000, "{}", kept.len());
        // A chord over an arc of angle phi is off by r (1 - cos(phi / 2)), here with r = 1/2 of
        // the span: the tolerance allows about 2 acos(1 - 2/4000) = 0.063 rad, 20 samples.
        let widest = kept.windows(2).map(|w| w[1] - w[0]).max();
        assert!(widest.is_some_and(|w| (2..=20).contains(&w)), "{widest:?}");
    }

    #[test]
    fn noise_raises_the_tolerance_until_the_points_fit() {
        let (x, mut y) = ellipse(40_000, 100.0);
        for (k, y) in y.iter_mut().enumerate() {
            *y += 900.0 * libm::sin(k as f64 * 2.4);
        }
        let (kept, tolerance) = one_run(&x, &y);
        assert!(kept[0].len() <= 4000 && tolerance > SMALLEST_TOLERANCE);
        assert!(tolerance < 0.1, "{tolerance}");
    }

    #[test]
    fn gaps_stay() {
        let (mut x, y) = ellipse(10_000, 3.0);
        x[5_000..5_010].fill(f64::NAN);
        let (kept, _) = one_run(&x, &y);
        assert!(kept[0].contains(&5_000) && kept[0].contains(&4_999) && kept[0].contains(&5_010));
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]
        #[test]
        fn no_sample_is_farther_from_the_line_than_the_tolerance(
            points in prop::collection::vec((-3.0..3.0, -18.0e3..18.0e3), 2..3000),
            budget in 100_usize..1000,
        ) {
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            let run = 0..x.len();
            let (kept, tolerance) = simplify(&x, &y, std::slice::from_ref(&run), budget);
            prop_assert!(kept[0].len() <= budget, "{} of {budget}", kept[0].len());
            prop_assert!(kept[0].first() == Some(&0) && kept[0].last() == Some(&(x.len() - 1)));
            let shape = Shape { x: &x, y: &y, x_span: span(&x), y_span: span(&y) };
            for ends in kept[0].windows(2) {
                for k in ends[0] + 1..ends[1] {
                    let distance = shape.squared_distance_to_chord(k, ends[0], ends[1]).sqrt();
                    prop_assert!(distance <= tolerance, "{k}: {distance} > {tolerance}");
                }
            }
        }
    }
}
