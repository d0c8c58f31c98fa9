//! A critical speed from below: decay rates of ring-downs, extrapolated to zero.
//!
//! ```text
//! d(v) = c0 + c1 v              through the last four ring-downs, by least squares
//! d(v) = c0 + c1 v + c2 v^2     through the last eight
//! d(v*) = 0                     the critical speed of each
//! |d(v)| <= t s(v)              its interval of 95 %: where zero lies within the band of the curve
//! ```
//! `s(v)` is the standard error of a curve, with the variance of the residuals, and `t` Student's
//! quantile of their degrees of freedom. An interval is that of Fieller, and may be open above.
//! Which of both curves the decay rates go on to follow is not known from below, and the residuals
//! of one do not tell: the speed that is stated is the mean of both, the interval holds both.
//!
//! The climb goes on as long as the next speed stays a margin below what is extrapolated so far, so
//! that the ram never hunts. The speed is that at which a motion of the window's amplitudes neither
//! grows nor dies. With a clearance or a relief valve that is not the speed below which no hunting
//! stays, which is the lowest one over all amplitudes.

use super::ring_down::{Release, RingDown};
use crate::error::StudyError;
use crate::trip::Equipped;
use nalgebra::{DMatrix, DVector, RowDVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Coefficients of the curves, and the ring-downs that each goes through.
const LINE: (usize, usize) = (2, 4);
const PARABOLA: (usize, usize) = (3, 8);
/// Share of a two-sided interval.
const CONFIDENCE: f64 = 0.95;
/// Step in which the band is followed upward (km/h), and how far over the highest ring-down.
const FOLLOWED_KMH: [f64; 2] = [0.05, 100.0];

/// How a climb goes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Climb {
    /// The first speed (km/h).
    pub from_kmh: f64,
    /// Distance between speeds (km/h).
    pub step_kmh: f64,
    /// Share of the extrapolated speed that is kept as a distance from it.
    pub margin: f64,
    /// Every ring-down.
    pub release: Release,
}

/// A critical speed that was never reached.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FromBelow {
    /// How the climb went.
    pub climb: Climb,
    /// The ring-downs, from the lowest speed up.
    pub ring_downs: Vec<RingDown>,
    /// Where the curves are zero, in the mean (km/h); none where that is not within reach.
    pub critical_kmh: Option<f64>,
    /// Ends of the interval of 95 % (km/h); none for an end that is not within reach.
    pub interval_kmh: [Option<f64>; 2],
    /// The most that a ram moved from the middle (m).
    pub largest_stroke_m: f64,
}

impl FromBelow {
    /// Climbs and extrapolates.
    ///
    /// # Errors
    /// No steady running, or the work is stopped.
    pub fn of(equipped: &Equipped<'_>, climb: Climb) -> Result<Self, StudyError> {
        let mut ring_downs: Vec<RingDown> = Vec::new();
        let mut kmh = climb.from_kmh;
        let mut curves = Curves::default();
        while kmh < 2.0 * climb.from_kmh {
            let Some(found) = RingDown::of(equipped, &climb.release, kmh)? else {
                // Too well damped still; or a ram reached its limit, which ends the climb.
                if ring_downs.is_empty() {
                    kmh += climb.step_kmh;
                    continue;
                }
                break;
            };
            ring_downs.push(found);
            curves = Curves::through(&ring_downs);
            kmh += climb.step_kmh;
            let mut zeros = curves.each(Curve::zero_kmh).into_iter().flatten();
            if zeros.any(|zero_kmh| kmh > (1.0 - climb.margin) * zero_kmh) {
                break;
            }
        }
        let largest_stroke_m =
            ring_downs.iter().map(|one| one.largest_stroke_m).fold(0.0, f64::max);
        Ok(Self {
            climb,
            critical_kmh: curves.zero_kmh(),
            interval_kmh: curves.interval_kmh(),
            largest_stroke_m,
            ring_downs,
        })
    }
}

/// The line and the parabola, as far as there are ring-downs for them.
#[derive(Debug, Clone, PartialEq, Default)]
struct Curves([Option<Curve>; 2]);

impl Curves {
    fn through(all: &[RingDown]) -> Self {
        Self([LINE, PARABOLA].map(|kind| Curve::through(all, kind)))
    }

    /// A speed of each curve that there is (km/h).
    fn each(&self, of: fn(&Curve) -> Option<f64>) -> Vec<Option<f64>> {
        self.0.iter().flatten().map(of).collect()
    }

    /// The mean of both zeros; none where a curve has none.
    fn zero_kmh(&self) -> Option<f64> {
        let zeros: Option<Vec<f64>> = self.each(Curve::zero_kmh).into_iter().collect();
        zeros.filter(|zeros| !zeros.is_empty()).map(|zeros| signal::statistics::mean(&zeros))
    }

    /// What holds the intervals of both; open where one of them is.
    fn interval_kmh(&self) -> [Option<f64>; 2] {
        let all = |of| -> Option<Vec<f64>> { self.each(of).into_iter().collect() };
        let over = |values: Vec<f64>, fold: fn(f64, f64) -> f64| values.into_iter().reduce(fold);
        [
            all(Curve::lowest_kmh).and_then(|values| over(values, f64::min)),
            all(Curve::highest_kmh).and_then(|values| over(values, f64::max)),
        ]
    }
}

/// A polynomial of the decay rate over the speed, with its band.
#[derive(Debug, Clone, PartialEq)]
struct Curve {
    coefficients: DVector<f64>,
    /// `(X' X)^-1`.
    inverse: DMatrix<f64>,
    /// Standard deviation of a residual (1/s), times Student's quantile.
    band_per_s: f64,
    /// Highest speed of a ring-down (km/h), and the distance to the lowest.
    top_kmh: f64,
    span_kmh: f64,
}

impl Curve {
    /// Through the last ring-downs; none through so few that nothing is left for the band.
    fn through(all: &[RingDown], (coefficients, through): (usize, usize)) -> Option<Self> {
        let last = &all[all.len().saturating_sub(through)..];
        let freedom = last.len().checked_sub(coefficients + 1)? + 1;
        let (top_kmh, low_kmh) = (last.last()?.kmh, last.first()?.kmh);
        let span_kmh = top_kmh - low_kmh;
        let row = |kmh: f64| powers((kmh - top_kmh) / span_kmh, coefficients);
        let rows: Vec<RowDVector<f64>> = last.iter().map(|one| row(one.kmh)).collect();
        let matrix = DMatrix::from_rows(&rows);
        let rates = DVector::from_iterator(last.len(), last.iter().map(|one| one.decay_per_s));
        let inverse = (matrix.transpose() * &matrix).try_inverse()?;
        let coefficients = &inverse * matrix.transpose() * &rates;
        let residuals = rates - &matrix * &coefficients;
        let deviation_per_s = (residuals.norm_squared() / freedom as f64).sqrt();
        let student = StudentsT::new(0.0, 1.0, freedom as f64).ok()?;
        let quantile = student.inverse_cdf(0.5 * (1.0 + CONFIDENCE));
        Some(Self {
            coefficients,
            inverse,
            band_per_s: quantile * deviation_per_s,
            top_kmh,
            span_kmh,
        })
    }

    /// The decay rate, and half the width of its band (1/s).
    fn at(&self, kmh: f64) -> [f64; 2] {
        let row = powers((kmh - self.top_kmh) / self.span_kmh, self.coefficients.len());
        let rate = (&row * &self.coefficients)[0];
        let share = (&row * &self.inverse * row.transpose())[0];
        [rate, self.band_per_s * share.max(0.0).sqrt()]
    }

    /// The lowest speed at which a bound of the band is zero or less.
    fn first_kmh(&self, bound: impl Fn([f64; 2]) -> f64) -> Option<f64> {
        let [step_kmh, reach_kmh] = FOLLOWED_KMH;
        let steps = (reach_kmh / step_kmh) as u32;
        let speeds = (0..=steps).map(|step| self.top_kmh + f64::from(step) * step_kmh);
        let mut before: Option<(f64, f64)> = None;
        for kmh in speeds {
            let value = bound(self.at(kmh));
            if value <= 0.0 {
                let share = before.map_or(0.0, |(_, last)| value / (value - last));
                return Some(kmh - share * step_kmh);
            }
            before = Some((kmh, value));
        }
        None
    }

    fn zero_kmh(&self) -> Option<f64> {
        self.first_kmh(|[rate, _]| rate)
    }

    fn lowest_kmh(&self) -> Option<f64> {
        self.first_kmh(|[rate, half]| rate - half)
    }

    fn highest_kmh(&self) -> Option<f64> {
        self.first_kmh(|[rate, half]| rate + half)
    }
}

/// `1, u, u^2`, as many as there are coefficients.
fn powers(u: f64, coefficients: usize) -> RowDVector<f64> {
    RowDVector::from_fn(coefficients, |_, power| u.powi(power as i32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::random::Random;

    fn ring_downs(noise_per_s: f64, random: &mut Random) -> Vec<RingDown> {
        let at = |n: u32| {
            let kmh = 200.0 + 5.0 * f64::from(n);
            // Zero at 250 km/h, and bent.
            let rate = 0.05 * (250.0 - kmh) + 2e-4 * (250.0 - kmh) * (250.0 - kmh);
            let decay_per_s = rate + noise_per_s * random.gaussian();
            RingDown { kmh, decay_per_s, frequency_hz: 3.3, half_cycles: 9, largest_stroke_m: 0.0 }
        };
        (0..8).map(at).collect()
    }

    #[test]
    fn a_parabola_without_noise_is_extrapolated_to_its_zero() {
        let all = ring_downs(0.0, &mut Random::new(1, 0));
        let curve = Curve::through(&all, PARABOLA).unwrap();
        for kmh in [curve.zero_kmh(), curve.lowest_kmh(), curve.highest_kmh()] {
            assert!((kmh.unwrap() - 250.0).abs() < 1e-3, "{kmh:?}");
        }
        assert_eq!(Curve::through(&all[..3], PARABOLA), None);
        // The last four lie on a parabola: the line through them reaches zero elsewhere.
        let both = Curves::through(&all);
        let line_kmh = both.each(Curve::zero_kmh)[0].unwrap();
        assert!((line_kmh - 250.0).abs() > 0.1, "{line_kmh}");
        assert!((both.zero_kmh().unwrap() - 0.5 * (line_kmh + 250.0)).abs() < 1e-3);
        let [low, high] = both.interval_kmh().map(Option::unwrap);
        assert!(low <= line_kmh.min(250.0) && high >= line_kmh.max(250.0), "{low} {high}");
    }

    #[test]
    fn the_interval_covers_the_truth_as_often_as_it_says() {
        let mut random = Random::new(21, 0);
        let draws = 400;
        let covered = (0..draws).filter(|_| {
            let curve = Curve::through(&ring_downs(0.03, &mut random), PARABOLA).unwrap();
            let low = curve.lowest_kmh().is_none_or(|kmh| kmh <= 250.0);
            low && curve.highest_kmh().is_none_or(|kmh| kmh >= 250.0)
        });
        let share = covered.count() as f64 / f64::from(draws);
        // Three standard deviations of a binomial share.
        assert!((share - CONFIDENCE).abs() < 0.033, "{share}");
    }
}
