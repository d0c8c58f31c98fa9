//! Where the rail stands under the wheel: cant, gauge, back-to-back distance.

use crate::error::ScenarioError;
use crate::profile::{Profile, SurfacePoint};

/// Distances that place a rail under a wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Inclination of the rail towards the track centre (1/40, 1/20).
    pub rail_cant: f64,
    /// Gauge (m).
    pub gauge_m: f64,
    /// Depth below the top of the rail at which the gauge is measured (m).
    pub gauge_depth_m: f64,
    /// Distance between the inner faces of the wheels (m).
    pub back_to_back_m: f64,
    /// Distance of the tape circle from the inner face of the wheel (m).
    pub tape_circle_m: f64,
}

impl Placement {
    /// China: cant 1:40, gauge 1435 mm at 16 mm depth, back-to-back 1353 mm.
    pub const CHINA: Self = Self {
        rail_cant: 1.0 / 40.0,
        gauge_m: 1.435,
        gauge_depth_m: 0.016,
        back_to_back_m: 1.353,
        tape_circle_m: 0.070,
    };

    /// UIC: cant 1:40, gauge 1435 mm at 14 mm depth, back-to-back 1360 mm.
    pub const UIC: Self = Self { gauge_depth_m: 0.014, back_to_back_m: 1.360, ..Self::CHINA };

    /// Half the distance between the two tape circles (m).
    ///
    /// ```
    /// use scenario::contact_geometry::Placement;
    /// assert!((Placement::CHINA.half_spacing_m() - 0.7465).abs() < 1e-12);
    /// ```
    pub fn half_spacing_m(&self) -> f64 {
        self.back_to_back_m / 2.0 + self.tape_circle_m
    }
}

/// A rail head with its cant, in the axes of the wheel's tape circle at zero shift.
///
/// `down` is counted from the highest point of the canted head.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedRail {
    head: Profile,
    sine: f64,
    cosine: f64,
    /// Added to the canted coordinates.
    outward_m: f64,
    down_m: f64,
    /// Steep ends between which the head is followed.
    first_m: f64,
    last_m: f64,
    /// The same ends, placed.
    inner_m: f64,
    outer_m: f64,
}

/// Beyond this slope the head continues straight (81 degrees): steeper than any flange.
const STEEPEST: f64 = 6.0;

impl PlacedRail {
    /// Cants the head and places it by its gauge face.
    ///
    /// # Errors
    /// A distance that no standard-gauge track has, or a head that ends above the gauge depth.
    pub fn new(head: Profile, placement: &Placement) -> Result<Self, ScenarioError> {
        let check = ScenarioError::check_dimension;
        let cant = check("rail_cant", placement.rail_cant, -0.05, 0.10)?;
        check("gauge_depth_m", placement.gauge_depth_m, 0.001, 0.020)?;
        check("gauge_m", placement.gauge_m, 0.3, 2.0)?;
        let clearance_m = placement.gauge_m / 2.0 - placement.half_spacing_m();
        check("gauge_m / 2 - half_spacing_m", clearance_m, -0.060, 0.0)?;
        let cosine = 1.0 / libm::sqrt(1.0 + cant * cant);
        let mut rail = Self {
            head,
            sine: cant * cosine,
            cosine,
            outward_m: 0.0,
            down_m: 0.0,
            first_m: 0.0,
            last_m: 0.0,
            inner_m: 0.0,
            outer_m: 0.0,
        };
        let (inner_m, outer_m) = (rail.head.first_m(), rail.head.last_m());
        // The head's own slope grows outward, so all three places are found by bisection.
        let top_m = bisect(inner_m, outer_m, |y| rail.head.at(y).slope - cant);
        let steep = |canted: f64| (canted + cant) / (1.0 - canted * cant);
        rail.first_m = bisect(inner_m, outer_m, |y| rail.head.at(y).slope - steep(-STEEPEST));
        rail.last_m = bisect(inner_m, outer_m, |y| rail.head.at(y).slope - steep(STEEPEST));
        rail.down_m = -rail.canted(top_m).1;
        let gauge_depth_m = placement.gauge_depth_m;
        let deepest_m = rail.canted(inner_m).1;
        check("depth of the rail head below its top, m", deepest_m, gauge_depth_m, 0.1)?;
        let face_m = bisect(inner_m, top_m, |y| gauge_depth_m - rail.canted(y).1);
        rail.outward_m = clearance_m - rail.canted(face_m).0;
        rail.inner_m = rail.canted(rail.first_m).0;
        rail.outer_m = rail.canted(rail.last_m).0;
        Ok(rail)
    }

    /// The rail surface at `outward_m` from the wheel's tape circle at zero shift.
    pub fn at(&self, outward_m: f64) -> SurfacePoint {
        let inside = outward_m.clamp(self.inner_m, self.outer_m);
        // Newton for the head's own coordinate; the head is convex and the cant small.
        let mut y = inside - self.outward_m;
        for _ in 0..8 {
            let point = self.head.at(y);
            let miss = y * self.cosine + point.down_m * self.sine + self.outward_m - inside;
            let step = miss / (self.cosine + point.slope * self.sine);
            y = (y - step).clamp(self.first_m, self.last_m);
            if step.abs() < 1e-13 {
                break;
            }
        }
        let point = self.head.at(y);
        let slope =
            (point.slope * self.cosine - self.sine) / (self.cosine + point.slope * self.sine);
        let down_m = self.canted(y).1;
        if inside == outward_m {
            SurfacePoint { down_m, slope, curvature_per_m: point.curvature_per_m }
        } else {
            let down_m = down_m + slope * (outward_m - inside);
            SurfacePoint { down_m, slope, curvature_per_m: 0.0 }
        }
    }

    /// The head's point at its own coordinate `y`, canted and placed.
    fn canted(&self, y: f64) -> (f64, f64) {
        let down_m = self.head.at(y).down_m;
        (
            y * self.cosine + down_m * self.sine + self.outward_m,
            down_m * self.cosine - y * self.sine + self.down_m,
        )
    }
}

/// Where a function that grows from `low` to `high` passes zero.
fn bisect(mut low: f64, mut high: f64, growing: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if growing(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
