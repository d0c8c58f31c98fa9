//! A wheel that runs like a JM3 wheel must have run, made backwards from its conicity.
//!
//! The arcs of the JM3 profile (TB/T 449) are in no public source. What is known is how the
//! locomotive behaved; a calibration against its published critical speeds asks for a conicity of
//! 0.22 to 0.25 at 1 to 3 mm that rises slowly to 0.30 to 0.33 at 8 mm, flange contact from 8 to
//! 8.5 mm, and contact angles whose half difference grows by 30 to 45 rad/m times half the rolling
//! radius difference. This profile has those and nothing else of JM3: **calibrated**, not measured.
//!
//! Method. Contact at the wheel place `w` under a shift `u` means equal slopes,
//! `s(w) = s_rail(w + u)`; the rolling radius changes by `dr = -s dw` (slopes counted positive
//! towards the flange). With `r'(u)` wanted and the rail known, `dw/du = -r'(u) / s_rail(w + u)`
//! gives the place, and the rail's slope there gives the wheel's. Contact-angle slope fixes the
//! starting point: near the centre `ds/dr = kappa_rail (1 / s - 1 / lambda)`, so 37 rad/m at 0.235
//! needs a slope of 0.139 on the 80 mm part of the head (on the 300 mm crown it would need the rail
//! to go on where it ends). Half the radius difference is `rho' = (r'(u) + r'(-u)) / 2`: the wheel
//! that moves away from its flange runs out onto a cone, the other makes up for it.
//! The curve is then replaced by arcs with common tangents through eleven of its places.

use super::wheels::with_flange;
use super::{Chain, Profile, Provenance, chain::sine_of, cn60};
use crate::contact_geometry::{PlacedRail, Placement};
use crate::error::ScenarioError;

/// What the JM3-like profile is calibrated by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jm3Like {
    /// `d rho / d u` up to [`rise_start_m`](Self::rise_start_m): the conicity of small motions.
    pub small_amplitude_conicity: f64,
    /// `d rho / d u` from [`rise_end_m`](Self::rise_end_m) to the flange.
    pub large_amplitude_conicity: f64,
    /// Shift at which the conicity begins to rise (m).
    pub rise_start_m: f64,
    /// Shift at which it has risen (m).
    pub rise_end_m: f64,
    /// Shift at which the contact enters the throat of the flange (m).
    pub flange_contact_shift_m: f64,
    /// Growth of the contact angle's half difference with `rho` near the centre (rad/m).
    pub contact_angle_slope_rad_per_m: f64,
}

impl Default for Jm3Like {
    fn default() -> Self {
        Self {
            small_amplitude_conicity: 0.235,
            large_amplitude_conicity: 0.40,
            rise_start_m: 2.0e-3,
            rise_end_m: 5.0e-3,
            flange_contact_shift_m: 8.0e-3,
            contact_angle_slope_rad_per_m: 37.0,
        }
    }
}

/// Curvature of the 80 mm part of the rail head (1/m).
const HEAD_CURVATURE_PER_M: f64 = 12.5;

/// Between these shifts away from the flange the contact settles onto the cone (m).
const CONE_SHIFTS_M: (f64, f64) = (2.0e-3, 6.0e-3);

/// Slope of the face of the flange: 70 degrees.
const FACE: f64 = 2.747_477_419;

/// Step of the integration over shift (m).
const STEP_M: f64 = 0.01e-3;

/// Places of the curve that become nodes of the chain, as shifts away from the flange (m).
const OUTER_NODES_M: [f64; 4] = [6.0e-3, 4.0e-3, 2.0e-3, 0.0];

/// Nodes on the flange side, as fractions of the way to the shoulder of the rail.
const INNER_NODES: [f64; 5] = [0.25, 0.5, 0.7, 0.85, 1.0];

/// Curvature of the rail that belongs to its shoulder and no longer to the head (1/m).
const SHOULDER_CURVATURE_PER_M: f64 = 40.0;

/// The JM3-like wheel, for CN60 rail canted 1:40 at 1435 mm gauge and 1353 mm back-to-back.
///
/// # Errors
/// A parameter outside the range in which the construction gives a convex contact.
pub fn jm3_like(shape: &Jm3Like) -> Result<Profile, ScenarioError> {
    let check = ScenarioError::check_dimension;
    let small = check("small_amplitude_conicity", shape.small_amplitude_conicity, 0.10, 0.40)?;
    check("large_amplitude_conicity", shape.large_amplitude_conicity, small, 0.60)?;
    check("rise_start_m", shape.rise_start_m, 0.0, shape.rise_end_m)?;
    check("rise_end_m", shape.rise_end_m, shape.rise_start_m + 0.1e-3, 0.010)?;
    check("flange_contact_shift_m", shape.flange_contact_shift_m, 5.0e-3, 9.5e-3)?;
    let angle_slope =
        check("contact_angle_slope_rad_per_m", shape.contact_angle_slope_rad_per_m, 20.0, 90.0)?;
    let rail = PlacedRail::new(cn60(), &Placement::CHINA)?;
    let start_slope = 1.0 / (angle_slope / HEAD_CURVATURE_PER_M + 1.0 / small);
    let start_m = place_of_slope(&rail, start_slope);

    let outer = Branch::outer(shape, &rail, start_m);
    let inner = Branch::inner(shape, &rail, start_m, &outer);
    let mut nodes: Vec<(f64, f64)> = OUTER_NODES_M.iter().map(|shift| outer.node(*shift)).collect();
    // The rail's curvature jumps where its shoulder begins; an arc across it would be too tight.
    let throat_m = shape.flange_contact_shift_m;
    let shoulder_m = inner.shoulder_shift_m(&rail).min(throat_m);
    nodes.extend(INNER_NODES.iter().map(|part| inner.node(part * shoulder_m)));
    if throat_m - shoulder_m > 0.2e-3 {
        nodes.push(inner.node(0.5 * (shoulder_m + throat_m)));
        nodes.push(inner.node(throat_m));
    }

    let root = Chain::through(nodes).arc_to_slope(0.014, -FACE);
    let cone = outer.node(OUTER_NODES_M[0]).1;
    let wheel = with_flange(root, FACE, 28.0e-3, &[(0.015, 0.13), (0.020, 0.9)])
        .turn()
        .line_to(30.0e-3)
        .blend_to(36.0e-3, cone.min(-1.0 / 8.0))
        .line_to(65.0e-3)
        .blend_to(66.0e-3, -1.0)
        .line_to(70.0e-3);
    Ok(Profile::new(
        "jm3_like",
        Provenance::Calibrated,
        "made from a conicity curve calibrated against published critical speeds; no JM3 drawing",
        wheel.sections(0.0, 0.0),
        70.0e-3,
    ))
}

impl Jm3Like {
    /// Half the growth of the rolling radius difference with shift, `d rho / d u`.
    pub fn conicity_at(&self, shift_m: f64) -> f64 {
        let way = (shift_m.abs() - self.rise_start_m) / (self.rise_end_m - self.rise_start_m);
        let rise = self.large_amplitude_conicity - self.small_amplitude_conicity;
        self.small_amplitude_conicity + rise * way.clamp(0.0, 1.0)
    }
}

/// The contact followed to one side from the centre, one entry per step of shift.
struct Branch {
    /// Wheel place (m), its slope towards the flange, and `d radius / d shift` there.
    places: Vec<(f64, f64, f64)>,
}

impl Branch {
    /// Away from the flange: the conicity of the centre, then onto a cone.
    fn outer(shape: &Jm3Like, rail: &PlacedRail, start_m: f64) -> Self {
        let growth = |shift_m: f64, slope: f64| {
            let (from_m, to_m) = CONE_SHIFTS_M;
            let way = ((shift_m - from_m) / (to_m - from_m)).clamp(0.0, 1.0);
            let blend = way * way * (3.0 - 2.0 * way);
            shape.conicity_at(shift_m).min(shape.small_amplitude_conicity) * (1.0 - blend)
                + slope * blend
        };
        Self::follow(rail, start_m, -1.0, growth)
    }

    /// Towards the flange: what the other wheel leaves to do.
    fn inner(shape: &Jm3Like, rail: &PlacedRail, start_m: f64, outer: &Self) -> Self {
        let growth =
            |shift_m: f64, _slope: f64| 2.0 * shape.conicity_at(shift_m) - outer.entry(shift_m).2;
        Self::follow(rail, start_m, 1.0, growth)
    }

    /// Integrates `dw/du = -r' / s` by the midpoint rule.
    fn follow(
        rail: &PlacedRail,
        start_m: f64,
        side: f64,
        growth: impl Fn(f64, f64) -> f64,
    ) -> Self {
        const STEPS: u32 = 1000;
        let slope_at = |place_m: f64, shift_m: f64| -rail.at(place_m + side * shift_m).slope;
        let mut place_m = start_m;
        let mut places = Vec::with_capacity(STEPS as usize + 1);
        for step in 0..=STEPS {
            let shift_m = f64::from(step) * STEP_M;
            let slope = slope_at(place_m, shift_m);
            let rate = growth(shift_m, slope);
            places.push((place_m, slope, rate));
            let half_m = shift_m + 0.5 * STEP_M;
            let middle_m = place_m - side * rate / slope * 0.5 * STEP_M;
            let middle_slope = slope_at(middle_m, half_m);
            place_m -= side * growth(half_m, middle_slope) / middle_slope * STEP_M;
        }
        Self { places }
    }

    /// Shift at which the contact reaches the shoulder of the rail (m).
    fn shoulder_shift_m(&self, rail: &PlacedRail) -> f64 {
        let on_shoulder = |(step, place): (usize, &(f64, f64, f64))| {
            let shift_m = step as f64 * STEP_M;
            let curvature = rail.at(place.0 + shift_m).curvature_per_m;
            (curvature > SHOULDER_CURVATURE_PER_M).then_some(shift_m)
        };
        self.places.iter().enumerate().find_map(on_shoulder).unwrap_or(f64::INFINITY)
    }

    fn entry(&self, shift_m: f64) -> (f64, f64, f64) {
        let index = libm::round(shift_m / STEP_M).max(0.0) as usize;
        let last = self.places.last().copied().unwrap_or((0.0, 0.0, 0.0));
        self.places.get(index).copied().unwrap_or(last)
    }

    /// Place and slope (in profile axes, falling outward) at a shift.
    fn node(&self, shift_m: f64) -> (f64, f64) {
        let (place_m, slope, _) = self.entry(shift_m);
        (place_m, -slope)
    }
}

/// Where the rail has this slope towards its gauge face (m from the tape circle).
fn place_of_slope(rail: &PlacedRail, slope: f64) -> f64 {
    let (mut low, mut high) = (-0.060, 0.040);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if sine_of(rail.at(middle).slope) > -sine_of(slope) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}
