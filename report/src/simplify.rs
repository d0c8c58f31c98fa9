//! A loop with fewer points and the same shape (Ramer 1972; Douglas and Peucker 1973).
//!
//! Between two kept samples the one farthest from their chord is kept too, while it is farther than
//! the tolerance. Distances are in shares of the spans of x and y, so that one tolerance serves both
//! axes; it starts below what a screen can show and grows by halves until the points fit. Stretches of
//! bounded length keep the work linear in the record.

use std::ops::Range;

const FIRST_TOLERANCE: f64 = 1.0 / 4000.0;
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
    let mut tolerance = FIRST_TOLERANCE;
    loop {
        let kept: Vec<Vec<usize>> =
            runs.iter().map(|run| shape.keep(run.clone(), stretch, tolerance)).collect();
        // Past the whole span only ends and gaps are left, and they must stay.
        if kept.iter().map(Vec::len).sum::<usize>() <= budget || tolerance > 1.0 {
            return (kept, tolerance);
        }
        tolerance *= 1.5;
    }
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
    fn keep(&self, run: Range<usize>, stretch: usize, tolerance: f64) -> Vec<usize> {
        let mut kept = Vec::new();
        let run: Vec<usize> = run.collect();
        // Samples that are not finite stay: they break the line.
        for solid in run.chunk_by(|&a, &b| self.is_finite(a) == self.is_finite(b)) {
            if !self.is_finite(solid[0]) {
                kept.push(solid[0]);
                continue;
            }
            for chunk in solid.chunks(stretch) {
                self.keep_chunk(chunk[0], chunk[chunk.len() - 1], tolerance, &mut kept);
            }
        }
        kept
    }

    fn is_finite(&self, k: usize) -> bool {
        self.x[k].is_finite() && self.y[k].is_finite()
    }

    fn keep_chunk(&self, first: usize, last: usize, tolerance: f64, kept: &mut Vec<usize>) {
        let start = kept.len();
        kept.push(first);
        if last > first {
            kept.push(last);
        }
        let mut open = vec![(first, last)];
        while let Some((a, b)) = open.pop() {
            let distance = |k: usize| self.distance_to_chord(k, a, b);
            let farthest = (a + 1..b).max_by(|&i, &j| distance(i).total_cmp(&distance(j)));
            if let Some(k) = farthest.filter(|&k| distance(k) > tolerance) {
                kept.push(k);
                open.extend([(a, k), (k, b)]);
            }
        }
        kept[start..].sort_unstable();
    }

    /// Distance of sample `k` from the chord between `a` and `b`, in shares of the spans.
    fn distance_to_chord(&self, k: usize, a: usize, b: usize) -> f64 {
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
        libm::hypot(px - along * cx, py - along * cy)
    }
}

#[cfg(test)]
mod tests {
    use super::{FIRST_TOLERANCE, simplify};

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
        assert_eq!(tolerance, FIRST_TOLERANCE);
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
        assert!(kept[0].len() <= 4000 && tolerance > FIRST_TOLERANCE);
        assert!(tolerance < 0.1, "{tolerance}");
    }

    #[test]
    fn gaps_stay() {
        let (mut x, y) = ellipse(10_000, 3.0);
        x[5_000..5_010].fill(f64::NAN);
        let (kept, _) = one_run(&x, &y);
        assert!(kept[0].contains(&5_000) && kept[0].contains(&4_999) && kept[0].contains(&5_010));
    }
}
