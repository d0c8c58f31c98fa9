//! The event-exact update of the series chain.
//!
//! Within a step the ends of the damper move as a parabola, x' = V + A t, through the displacements
//! at both ends with the mean acceleration between the velocities there. On one segment of the
//! [law](super::law) the deflection then is
//!
//! ```text
//! e(t) = e0 + t f1(-s t) (V - v(e0)) + t^2 f2(-s t) A
//! f1(z) = (exp(z) - 1)/z           f2(z) = (f1(z) - 1)/z
//! ```
//!
//! with the rate s = dv/de. The time at which it leaves the segment is the root of this equation,
//! found by a bracketed Newton iteration; then the next segment goes on for the rest of the step.
//! A step rarely meets more than two segments. After [`MAX_VISITS`] the rest of the step is closed
//! by one backward Euler step, which always succeeds, and counted.
//!
//! Limit: an excursion into a neighbouring segment that begins and ends within one step is left
//! out; it is smaller than A h^2 / 8.

use super::chain::{Arrival, Drive, Gains, Stand};
use super::implicit::backward_euler;
use super::law::Law;
use super::segment::Segment;

/// Most pieces of one step before the fallback: a quick stroke of a stiff damper runs through all
/// the knots of a sampled law.
pub(super) const MAX_VISITS: u32 = 64;

/// Most iterations for one crossing time.
const MAX_CROSSING_ITERATIONS: u32 = 24;

/// Moves the chain through one step.
#[inline]
pub(super) fn advance(law: &Law, stand: Stand, drive: Drive, step_s: f64) -> Arrival {
    debug_assert!(!law.sliding.is_empty(), "a chain without a law");
    debug_assert!(step_s >= 0.0, "step of {step_s} s");
    let resting = stands_at_rest(law, stand);
    let segments: &[Segment] = if resting { &law.resting } else { &law.sliding };
    let e = stand.deflection_m;
    // Nearly every step begins and ends inside one segment.
    if let Some(segment) = segments.iter().find(|segment| e < segment.to_m)
        && e > segment.from_m
        && let Some(arrival) =
            within(law.step_s, segment, Stand { deflection_m: e, resting }, drive, step_s)
    {
        return arrival;
    }
    across(law, Stand { deflection_m: e, resting }, drive, step_s)
}

/// The whole step on one segment, or nothing if it leaves the segment. The gains of the segment
/// hold for `prepared_s`.
#[inline]
pub(super) fn within(
    prepared_s: f64,
    on: &Segment,
    stand: Stand,
    drive: Drive,
    time_s: f64,
) -> Option<Arrival> {
    let e = stand.deflection_m;
    let gains = gains_over(prepared_s, on, time_s);
    let excess = drive.velocity_m_per_s - on.velocity(e);
    let end = e + gains.velocity_s * excess + gains.acceleration_s2 * drive.acceleration_m_per_s2;
    if !(end < on.to_m && end > on.from_m) {
        return None;
    }
    Some(Arrival {
        stand: Stand { deflection_m: end, ..stand },
        force_n: on.force(end),
        piston_velocity_m_per_s: on.velocity(end),
        sensitivity_n_s_per_m: on.stiffness_n_per_m * gains.velocity_s,
        fell_back: false,
    })
}

/// The instant within a step, from its beginning, at which a slow influence on the piston has the
/// same effect on the deflection at the end as over the whole step:
///
/// ```text
/// h f2(-s h) / f1(-s h)        h/2 for a slow chain, h for a fast one or at a hard cap
/// ```
pub(super) fn weight_of_step(law: &Law, stand: Stand, step_s: f64) -> f64 {
    let e = stand.deflection_m;
    let Some(on) = law.sliding.iter().find(|segment| e < segment.to_m && e > segment.from_m) else {
        return step_s;
    };
    let gains = gains_over(law.step_s, on, step_s);
    gains.acceleration_s2 / gains.velocity_s
}

#[inline]
fn gains_over(prepared_s: f64, segment: &Segment, time_s: f64) -> Gains {
    if time_s == prepared_s { segment.gains } else { Gains::over(segment.rate_per_s, time_s) }
}

#[inline]
fn stands_at_rest(law: &Law, stand: Stand) -> bool {
    if !law.breaks_away() {
        return false;
    }
    let e = stand.deflection_m;
    if stand.resting {
        let from = law.resting.first().map_or(0.0, |first| first.from_m);
        let to = law.resting.last().map_or(0.0, |last| last.to_m);
        e >= from && e <= to
    } else {
        comes_to_rest(law, e)
    }
}

/// Whether a sliding piston has come to rest. Where the force is capped at the sliding force (dry
/// friction in a void) the edge itself still slides.
#[inline]
fn comes_to_rest(law: &Law, e: f64) -> bool {
    let capped_below = law.sliding.first().is_some_and(|first| first.from_m >= law.rest_from_m);
    let capped_above = law.sliding.last().is_some_and(|last| last.to_m <= law.rest_to_m);
    let above = e > law.rest_from_m || (e == law.rest_from_m && !capped_below);
    let below = e < law.rest_to_m || (e == law.rest_to_m && !capped_above);
    above && below
}

/// Which way a chain leaves a knot.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Below,
    Above,
}

/// The step over several segments.
fn across(law: &Law, stand: Stand, drive: Drive, step_s: f64) -> Arrival {
    let mut resting = stand.resting;
    let mut e = stand.deflection_m;
    let mut velocity = drive.velocity_m_per_s;
    let acceleration = drive.acceleration_m_per_s2;
    let mut left_s = step_s;
    // Set when the segment on the other side of a knot has turned the chain back.
    let mut turned: Option<Way> = None;
    for _ in 0..MAX_VISITS {
        let segments: &[Segment] = if resting { &law.resting } else { &law.sliding };
        e = clamp_to(segments, e);
        let stand = Stand { deflection_m: e, resting };
        let drive = Drive { velocity_m_per_s: velocity, acceleration_m_per_s2: acceleration };
        let (below, above) = around(segments, e);
        let on = match (below, above) {
            (Some(a), Some(b)) if core::ptr::eq(a, b) => a,
            _ => {
                // Beyond the last segment the force is capped, or the piston at rest breaks away.
                let cap = if resting { 0.0 } else { f64::INFINITY };
                let low = below.map_or(-cap, |segment| segment.velocity_to);
                let high = above.map_or(cap, |segment| segment.velocity_from);
                let way = turned.or_else(|| leave(velocity, acceleration, low, high));
                match (way, below, above) {
                    (Some(Way::Below), Some(segment), _) | (Some(Way::Above), _, Some(segment)) => {
                        segment
                    }
                    (Some(_), ..) if resting => {
                        // Breakaway: from here on the law of the sliding piston.
                        resting = false;
                        turned = None;
                        continue;
                    }
                    (Some(_), ..) => {
                        return held(segments, stand, velocity + acceleration * left_s);
                    }
                    (None, ..) => {
                        let bound = if acceleration > 0.0 { high } else { low };
                        let wait_s = (bound - velocity) / acceleration;
                        if acceleration == 0.0 || wait_s >= left_s {
                            return held(segments, stand, velocity + acceleration * left_s);
                        }
                        left_s -= wait_s;
                        velocity = bound;
                        continue;
                    }
                }
            }
        };
        if let Some(arrival) = within(law.step_s, on, stand, drive, left_s) {
            return arrival;
        }
        let gains = gains_over(law.step_s, on, left_s);
        let excess = velocity - on.velocity(e);
        let end = e + gains.velocity_s * excess + gains.acceleration_s2 * acceleration;
        let target = if end >= on.to_m { on.to_m } else { on.from_m };
        if target == e {
            // Out again where it came in: the excursion is too small to matter.
            if turned.is_some() {
                return held(segments, stand, velocity + acceleration * left_s);
            }
            turned = Some(if target == on.to_m { Way::Above } else { Way::Below });
        } else {
            let time_s = crossing_time(on, excess, acceleration, target - e, end - e, left_s);
            e = target;
            velocity += acceleration * time_s;
            left_s -= time_s;
            turned = None;
        }
        if !resting && law.breaks_away() && comes_to_rest(law, e) {
            resting = true;
            turned = None;
        }
    }
    let mean = velocity + 0.5 * acceleration * left_s;
    let segments = &law.sliding;
    let end = backward_euler(segments, e, mean, left_s);
    let stand = Stand { deflection_m: end, resting: false };
    Arrival { fell_back: true, ..held(segments, stand, velocity + acceleration * left_s) }
}

/// The segments below and above a deflection: the same one inside it, two at a knot, one at a cap.
fn around(segments: &[Segment], e: f64) -> (Option<&Segment>, Option<&Segment>) {
    let Some(index) = segments.iter().position(|segment| e <= segment.to_m) else {
        return (segments.last(), None);
    };
    let here = segments.get(index);
    match here {
        Some(segment) if e == segment.to_m => (here, segments.get(index + 1)),
        Some(segment) if e == segment.from_m => {
            (index.checked_sub(1).and_then(|i| segments.get(i)), here)
        }
        _ => (here, here),
    }
}

/// Which way the chain leaves a knot where the law jumps from `low` to `high`, if it leaves it.
fn leave(velocity: f64, acceleration: f64, low: f64, high: f64) -> Option<Way> {
    if velocity > high || (velocity == high && acceleration > 0.0) {
        Some(Way::Above)
    } else if velocity < low || (velocity == low && acceleration < 0.0) {
        Some(Way::Below)
    } else {
        None
    }
}

/// The end of a step at a knot, the piston taking all of the motion that the law leaves it.
fn held(segments: &[Segment], stand: Stand, velocity: f64) -> Arrival {
    let e = stand.deflection_m;
    let (below, above) = around(segments, e);
    let low = below.map_or(f64::NEG_INFINITY, |s| s.velocity(e).min(s.velocity_to));
    let high = above.map_or(f64::INFINITY, |s| s.velocity(e).max(s.velocity_from));
    debug_assert!(below.is_some() || above.is_some(), "a chain that is held on no segment");
    // The inner segment of the two, so that mirrored motion gives mirrored bits.
    let inner = if e > 0.0 { below.or(above) } else { above.or(below) };
    Arrival {
        stand,
        force_n: inner.map_or(0.0, |segment| segment.force(e)),
        piston_velocity_m_per_s: velocity.max(low).min(high),
        sensitivity_n_s_per_m: 0.0,
        fell_back: false,
    }
}

fn clamp_to(segments: &[Segment], e: f64) -> f64 {
    let from = segments.first().map_or(e, |first| first.from_m);
    let to = segments.last().map_or(e, |last| last.to_m);
    e.max(from).min(to)
}

/// The time at which the deflection has changed by `target`, knowing that it would change by
/// `change`, beyond the target, within `left_s`.
fn crossing_time(
    on: &Segment,
    excess: f64,
    acceleration: f64,
    target: f64,
    change: f64,
    left_s: f64,
) -> f64 {
    // No number where forces have overflowed.
    debug_assert!(left_s >= 0.0 || left_s.is_nan(), "{left_s} s left");
    let (mut early, mut late) = (0.0, left_s);
    let mut time = left_s * (target / change);
    for _ in 0..MAX_CROSSING_ITERATIONS {
        let gains = Gains::over(on.rate_per_s, time);
        let miss = gains.velocity_s * excess + gains.acceleration_s2 * acceleration - target;
        if miss * target >= 0.0 {
            late = time;
        } else {
            early = time;
        }
        let decay = 1.0 - on.rate_per_s * gains.velocity_s;
        let speed = excess * decay + acceleration * gains.velocity_s;
        let newton = time - miss / speed;
        if (newton - time).abs() <= 1e-13 * left_s {
            break;
        }
        time = if newton > early && newton < late { newton } else { 0.5 * (early + late) };
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::curve::Curve;
    use crate::damper::nominal::Nominal;
    use crate::damper::parts::{Body, Factors, Parts};

    fn law_of(nominal: &Nominal) -> Law {
        let (hydraulic, attachment) = (nominal.hydraulic(), nominal.attachment());
        let mut law = Law::empty();
        let parts = Parts { hydraulic, dry: Curve::ZERO, attachment };
        law.join(&parts, &Body::nominal(&parts), &Factors::NONE);
        law
    }

    #[test]
    fn one_long_step_is_many_short_ones() {
        // The same parabola in one step and in 64: clearance, Ce and C2 crossed either way.
        for c2_n_s_per_m in [0.0, 5e3, 80e3] {
            let law = law_of(&Nominal { c2_n_s_per_m, ..Nominal::NEW });
            for (velocity, acceleration) in [(0.1, 3.0), (0.3, -8.0), (-0.2, 5.0), (-0.05, -4.0)] {
                let step_s = 0.02;
                let begin = Stand { deflection_m: -0.3e-3, resting: false };
                let drive =
                    Drive { velocity_m_per_s: velocity, acceleration_m_per_s2: acceleration };
                let once = advance(&law, begin, drive, step_s);
                let (mut stand, short) = (begin, step_s / 64.0);
                let mut force_n = 0.0;
                for i in 0..64 {
                    let then = velocity + acceleration * short * f64::from(i);
                    let arrival =
                        advance(&law, stand, Drive { velocity_m_per_s: then, ..drive }, short);
                    stand = arrival.stand;
                    force_n = arrival.force_n;
                }
                assert!(!once.fell_back);
                let miss = (once.force_n - force_n).abs();
                assert!(miss < 1e-6, "{c2_n_s_per_m} {velocity} {acceleration}: {miss} N");
            }
        }
    }

    #[test]
    fn hard_cap_passes_all_motion_to_the_piston() {
        let nominal = Nominal { c2_n_s_per_m: 0.0, ..Nominal::NEW };
        let law = law_of(&nominal);
        let stand = Stand { deflection_m: 0.0, resting: false };
        let drive = Drive { velocity_m_per_s: 1.0, acceleration_m_per_s2: 0.0 };
        let arrival = advance(&law, stand, drive, 10e-3);
        assert!((arrival.force_n - nominal.f_relief_n).abs() < 1e-9);
        assert_eq!(arrival.piston_velocity_m_per_s, 1.0);
        // Turned round, the spring lets go at once.
        let back = Drive { velocity_m_per_s: -0.1, acceleration_m_per_s2: 0.0 };
        let arrival = advance(&law, arrival.stand, back, 1e-3);
        // -0.1 m/s and the dashpot's 18 mm/s against 12.5 MN/m, almost straight within 1 ms.
        let expected = 18e3 - 12.5e6 * 0.118e-3;
        assert!((arrival.force_n - expected).abs() < 15.0, "{}", arrival.force_n);
    }
}
