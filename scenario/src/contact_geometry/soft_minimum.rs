//! The soft minimum of the gap over one zone, and its weighted means.

use crate::profile::SurfacePoint;
use firmware_core::wheel_rail::geometry::ContactGeometry;

/// Gap over the smallest one at which a place still counts by 1/e (m).
pub(super) const SOFTNESS_M: f64 = 5e-6;

/// Smallest relative lateral curvature handed on (1/m): a patch no flatter than a radius of 5 m.
pub(super) const LEAST_CURVATURE_PER_M: f64 = 0.2;

/// Weights below `exp(-REACH)` are left out.
const REACH: f64 = 40.0;

/// A rail that is flatter than this is a straight one (1/m).
const STRAIGHT_PER_M: f64 = 0.1;

/// The rail radius is kept within these bounds (m).
const RAIL_RADIUS_M: (f64, f64) = (0.0, 0.5);

/// One place on a wheel, as drawn and as ground back near the divide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WheelPlace {
    pub(super) outward_m: f64,
    pub(super) drawn: SurfacePoint,
    /// `drawn.down_m` less the relief.
    pub(super) relieved_m: f64,
}

/// A wheel place in track axes with the rail under it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facing<'a> {
    pub(super) wheel: &'a WheelPlace,
    pub(super) rail: SurfacePoint,
    pub(super) gap_m: f64,
}

/// Contact of one zone whose places are `step_m` apart; `datum_m` is taken off the touch.
pub(super) fn contact<'a>(
    places: impl Iterator<Item = Facing<'a>> + Clone,
    step_m: f64,
    datum_m: f64,
) -> ContactGeometry {
    let least_m = places.clone().fold(f64::INFINITY, |least, place| least.min(place.gap_m));
    let mut sums = Sums::default();
    for place in places {
        let above = (place.gap_m - least_m) / SOFTNESS_M;
        if above < REACH {
            sums.add(&place, libm::exp(-above));
        }
    }
    let mean = |sum: f64| sum / sums.weight;
    let rail_slope = mean(sums.rail_slope);
    let covariance = |product: f64, factor: f64| mean(product) - mean(factor) * rail_slope;
    // How the mean position answers to a shift and to a roll: their ratio is the rail radius. A
    // straight rail does not answer to a shift at all; the ratio fades out before.
    let by_shift = covariance(sums.position_slope, sums.position);
    let by_roll = mean(sums.position_roll) - mean(sums.position) * mean(sums.roll);
    let straight = STRAIGHT_PER_M * (mean(sums.position_square) - square(mean(sums.position)));
    let radius_m = by_roll * by_shift / (square(by_shift) + square(straight)).max(1e-60);
    ContactGeometry {
        touch_m: least_m - SOFTNESS_M * libm::log(sums.weight * step_m) - datum_m,
        slope: -rail_slope,
        radius_deviation_m: mean(sums.radius),
        lateral_m: mean(sums.position) + sums.origin_m,
        curvature_lateral_per_m: mean(sums.curvature).max(LEAST_CURVATURE_PER_M),
        rail_radius_m: radius_m.clamp(RAIL_RADIUS_M.0, RAIL_RADIUS_M.1),
    }
}

fn square(value: f64) -> f64 {
    value * value
}

/// Weighted sums; positions count from the first place met, so that squares do not cancel.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    origin_m: f64,
    weight: f64,
    position: f64,
    position_square: f64,
    rail_slope: f64,
    radius: f64,
    curvature: f64,
    roll: f64,
    position_slope: f64,
    position_roll: f64,
}

impl Sums {
    fn add(&mut self, place: &Facing<'_>, weight: f64) {
        if self.weight == 0.0 {
            self.origin_m = place.wheel.outward_m;
        }
        let wheel = place.wheel;
        let position = wheel.outward_m - self.origin_m;
        // A roll lowers the place by its position and moves it sideways by its depth.
        let roll = position + place.rail.slope * wheel.relieved_m;
        self.weight += weight;
        self.position += weight * position;
        self.position_square += weight * position * position;
        self.rail_slope += weight * place.rail.slope;
        self.radius += weight * wheel.drawn.down_m;
        self.curvature += weight * (place.rail.curvature_per_m - wheel.drawn.curvature_per_m);
        self.roll += weight * roll;
        self.position_slope += weight * position * place.rail.slope;
        self.position_roll += weight * position * roll;
    }
}
