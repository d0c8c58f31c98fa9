//! Smooth odd laws as piecewise-linear curves with few knots.
//!
//! The chords of a bent law lie on one side of it. Every inner knot is moved off the law by two
//! thirds of the sagitta of the flatter of its two chords,
//!
//! ```text
//! y_i = f(x_i) + 2/3 s        s = f(mid) - chord(mid)
//! ```
//!
//! so that the polygon winds about the law: the deviation has no mean, and 0.3 s in the root mean
//! square instead of 0.7 s. First and last knot stay on the law: zero stays zero, and beyond the
//! last the law goes on without a jump. How far a law is off is said, and tested, where it is
//! sampled.

use super::curve::{Curve, Knot};
use heapless::Vec;

/// Most knots on one side of zero.
pub(super) const SIDE_KNOTS: usize = 13;

/// Places of knots on the positive side, rising, zero left out.
pub(super) type Places = Vec<f64, SIDE_KNOTS>;

/// The places `place(i/n)` for i from 1 to n, then those beyond; at most [`SIDE_KNOTS`] in all.
pub(super) fn places(n: u8, place: impl Fn(f64) -> f64, beyond: &[f64]) -> Places {
    debug_assert!(usize::from(n) + beyond.len() <= SIDE_KNOTS, "more than {SIDE_KNOTS} places");
    let mut places = Places::new();
    for i in 1..=n {
        let _ = places.push(place(f64::from(i) / f64::from(n)));
    }
    for &x in beyond {
        let _ = places.push(x);
    }
    places
}

/// The odd law `law(x)` with knots at zero and at the given places on both sides, and `slope`
/// beyond the last.
pub(super) fn odd(places: &Places, slope: f64, law: impl Fn(f64) -> f64) -> Curve {
    debug_assert!(!places.is_empty(), "a law without places");
    let mut above: Vec<Knot, { SIDE_KNOTS + 1 }> = Vec::new();
    let mut left = None;
    let mut here = Knot { x: 0.0, y: 0.0 };
    for &x in places {
        let next = Knot { x, y: law(x) };
        let right = sagitta(here, next, &law);
        let moved = left.map_or(0.0, |left: f64| {
            let flatter = if left.abs() < right.abs() { left } else { right };
            2.0 / 3.0 * flatter
        });
        let _ = above.push(Knot { x: here.x, y: here.y + moved });
        left = Some(right);
        here = next;
    }
    let _ = above.push(here);
    Curve::odd(&above, slope)
}

/// How far the law lies above its chord in the middle.
fn sagitta(from: Knot, to: Knot, law: &impl Fn(f64) -> f64) -> f64 {
    law(0.5 * (from.x + to.x)) - 0.5 * (from.y + to.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_of_a_parabola_is_a_third_of_the_sagitta_of_its_chords() {
        let parabola = |x: f64| x * x.abs();
        let curve = odd(&places(8, |u| u, &[]), 2.0, parabola);
        assert_eq!(curve.knots().len(), 17);
        let sagitta = 1.0 / 64.0 / 4.0;
        let mut mean = 0.0;
        // The first and the last stretch have one end on the law.
        for i in 1000..7000 {
            let x = (f64::from(i) + 0.5) / 8000.0;
            let deviation = curve.at(x) - parabola(x);
            assert!(deviation.abs() <= (2.0 / 3.0 + 1e-9) * sagitta, "{x}: {deviation}");
            assert_eq!(curve.at(-x), -curve.at(x));
            mean += deviation / 6000.0;
        }
        assert!(mean.abs() < 1e-3 * sagitta, "{mean}");
        assert_eq!((curve.at(0.0), curve.at(1.0), curve.at(2.0)), (0.0, 1.0, 3.0));
    }

    #[test]
    fn straight_law_stays_straight() {
        let curve = odd(&places(5, |u| u * u, &[]), 3.0, |x| 3.0 * x);
        for x in [-2.0, -0.3, 0.01, 0.7, 5.0] {
            assert!((curve.at(x) - 3.0 * x).abs() < 1e-14);
        }
    }
}
