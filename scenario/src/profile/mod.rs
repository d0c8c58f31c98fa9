//! Wheel and rail profiles as chains of arcs and straight lines.
//!
//! One profile is a curve `down(outward)` in axes fixed to the wheel or the rail: `outward` from
//! the track centre, `down`. A wheel has its tape circle at `outward = 0`, `down = 0` and its
//! flange at negative `outward`; a rail head has its crown at the origin and is not yet canted.
//!
//! Every arc obeys `sin(theta) = (outward - centre) / radius` with `tan(theta)` the slope, so the
//! sine of the slope angle is linear along an arc, and a chain whose neighbours share that sine is
//! tangent-continuous by construction. The radius carries the sign of the curvature: positive bends
//! down going outward (the head of a rail, the throat of a wheel), negative bends up (the tip of a
//! flange).
//!
//! The profiles and where they come from: [`lma`], [`s1002`], [`jm3_like`] for wheels, [`cn60`] and
//! [`uic60`] for rails, [`Profile::from_csv`] for a user's own. Single-valued in `outward`:
//! vertical or undercut parts (the back of a flange) are cut off and continue as steep straight
//! lines.

mod chain;
mod jm3_like;
mod points;
mod rails;
mod smoothing;
mod wheels;

pub use jm3_like::{Jm3Like, jm3_like};
pub use points::Part;
pub use rails::{cn60, uic60};
pub use wheels::{lma, s1002};

pub(crate) use chain::Chain;

use std::borrow::Cow;

/// Where the shape of a profile comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// Coordinates or radii of a published drawing or standard.
    Published,
    /// Radii and break points read off a published point cloud.
    Derived,
    /// Shaped here so that the vehicle reproduces published behaviour; no drawing behind it.
    Calibrated,
    /// Points that the user brought.
    Measured,
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Distance below the origin of the profile (m).
    pub down_m: f64,
    /// `d down / d outward`.
    pub slope: f64,
    /// Curvature, positive where the curve bends down going outward (1/m).
    pub curvature_per_m: f64,
}

/// A wheel tread with its flange, or a rail head.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    name: Cow<'static, str>,
    provenance: Provenance,
    source: Cow<'static, str>,
    sections: Vec<Section>,
    last_m: f64,
}

/// A piece of a profile, from its own start to the start of the next.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Section {
    pub(crate) first_m: f64,
    pub(crate) shape: Shape,
}

/// The curve of one section.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    /// Straight through `(first_m, down_m)`.
    Line { down_m: f64, slope: f64 },
    /// Circle; the sign of the radius is the sign of the curvature.
    Arc { centre_outward_m: f64, centre_down_m: f64, radius_m: f64 },
    /// Power series in `outward` (m), lowest power first.
    Series { coefficients: Vec<f64> },
}

impl Profile {
    pub(crate) fn new(
        name: impl Into<Cow<'static, str>>,
        provenance: Provenance,
        source: impl Into<Cow<'static, str>>,
        sections: Vec<Section>,
        last_m: f64,
    ) -> Self {
        Self { name: name.into(), provenance, source: source.into(), sections, last_m }
    }

    /// The point at `outward_m`; beyond the ends the end tangent continues.
    ///
    /// ```
    /// let wheel = scenario::profile::s1002();
    /// assert!(wheel.at(0.0).down_m.abs() < 1e-12);          // the tape circle
    /// assert!((wheel.at(-0.055).down_m - 0.028).abs() < 1e-9); // a flange 28 mm high
    /// ```
    pub fn at(&self, outward_m: f64) -> SurfacePoint {
        let first_m = self.first_m();
        let inside = outward_m.clamp(first_m, self.last_m);
        let index = self.sections.partition_point(|section| section.first_m <= inside);
        let mut point =
            self.sections.get(index.saturating_sub(1)).map_or(FLAT, |section| section.at(inside));
        if inside != outward_m {
            point.down_m += point.slope * (outward_m - inside);
            point.curvature_per_m = 0.0;
        }
        point
    }

    /// Name, as a scenario refers to it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What kind of source the shape has.
    pub fn provenance(&self) -> Provenance {
        self.provenance
    }

    /// The source in words.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Inner end of the drawn part (m).
    pub fn first_m(&self) -> f64 {
        self.sections.first().map_or(0.0, |section| section.first_m)
    }

    /// Outer end of the drawn part (m).
    pub fn last_m(&self) -> f64 {
        self.last_m
    }

    /// Where one arc or line ends and the next begins, with both ends (m).
    pub fn breakpoints_m(&self) -> Vec<f64> {
        self.sections.iter().map(|section| section.first_m).chain([self.last_m]).collect()
    }
}

const FLAT: SurfacePoint = SurfacePoint { down_m: 0.0, slope: 0.0, curvature_per_m: 0.0 };

impl Section {
    fn at(&self, outward_m: f64) -> SurfacePoint {
        match &self.shape {
            Shape::Line { down_m, slope } => SurfacePoint {
                down_m: down_m + slope * (outward_m - self.first_m),
                slope: *slope,
                curvature_per_m: 0.0,
            },
            Shape::Arc { centre_outward_m, centre_down_m, radius_m } => {
                let sine = (outward_m - centre_outward_m) / radius_m;
                let cosine = libm::sqrt((1.0 - sine * sine).max(1e-12));
                SurfacePoint {
                    down_m: centre_down_m - radius_m * cosine,
                    slope: sine / cosine,
                    curvature_per_m: 1.0 / radius_m,
                }
            }
            Shape::Series { coefficients } => {
                let (mut value, mut first, mut second) = (0.0, 0.0, 0.0);
                for coefficient in coefficients.iter().rev() {
                    second = second * outward_m + 2.0 * first;
                    first = first * outward_m + value;
                    value = value * outward_m + coefficient;
                }
                let stretch = 1.0 + first * first;
                SurfacePoint {
                    down_m: value,
                    slope: first,
                    curvature_per_m: second / (stretch * libm::sqrt(stretch)),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
