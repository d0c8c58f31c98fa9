//! Hertz's elliptical contact of two bodies of the same material.
//!
//! With `A` and `B` the relative curvatures along and across the rolling direction (each
//! `1/(2 R')`), the approach `delta`, the force `N` and the semi-axes `a` (along) and `b` (across)
//! obey `N = k delta^1.5`, `a = a1 sqrt(delta)`, `b = b1 sqrt(delta)` (Johnson, Contact Mechanics,
//! section 4.2). The elliptic integrals come from the arithmetic-geometric mean. Used off-line to
//! fill the contact tables, so that a step needs one square root per patch.

/// Steel on steel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Shear modulus (Pa).
    pub shear_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Material {
    /// Wheel and rail steel: shear modulus 82e9 Pa, Poisson's ratio 0.28.
    pub const STEEL: Self = Self { shear_modulus_pa: 82.0e9, poisson: 0.28 };
}

/// A contact ellipse for unit approach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzEllipse {
    /// `N / delta^1.5` (N/m^1.5).
    pub stiffness_n_per_m15: f64,
    /// Semi-axis in rolling direction over `sqrt(delta)` (m^0.5).
    pub along_per_sqrt_m: f64,
    /// Semi-axis across over `sqrt(delta)` (m^0.5).
    pub across_per_sqrt_m: f64,
}

/// The ellipse for relative curvatures (sum of both bodies, convex positive, 1/m), both positive.
///
/// ```
/// use firmware_core::wheel_rail::hertz::{ellipse, Material};
/// // Two equal curvatures give a circle with a = sqrt(R delta). The axis ratio is held below
/// // 1 - 1e-7, so a circle is met to 5e-8.
/// let e = ellipse(2.0, 2.0, Material::STEEL);
/// assert!((e.along_per_sqrt_m / 0.5f64.sqrt() - 1.0).abs() < 1e-7);
/// ```
pub fn ellipse(along_per_m: f64, across_per_m: f64, material: Material) -> HertzEllipse {
    let modulus = material.shear_modulus_pa / (1.0 - material.poisson);
    // The longer semi-axis lies where the curvature is smaller.
    let (flat, sharp) = if along_per_m <= across_per_m {
        (along_per_m, across_per_m)
    } else {
        (across_per_m, along_per_m)
    };
    let ratio = axis_ratio(flat / sharp);
    let (k, e) = elliptic_integrals(ratio);
    // sqrt(R'R'') of the relative curvatures.
    let radius = 1.0 / crate::sqrt::sqrt(flat * sharp);
    // Shape factor of a circle is pi/4 * 1/2 ...; `shape` -> (pi/4)^2 / 4 as the ratio -> 1.
    let eccentric = (1.0 - ratio * ratio).max(1e-14);
    let moment_long = (e / (ratio * ratio) - k) / eccentric;
    let moment_short = (k - e) / eccentric;
    let shape = 4.0 / core::f64::consts::PI
        * ratio
        * crate::sqrt::sqrt(ratio)
        * crate::sqrt::sqrt(moment_long * moment_short);
    // c^3 = (a b)^1.5 = 3 N R / (4 E*) shape; delta = 3 N K / (2 pi E* long).
    // With long = c / sqrt(ratio): eliminate N for delta = 1.
    let cube = 0.75 * radius / modulus * shape; // c^3 per N
    // delta = 3 N K sqrt(ratio) / (2 pi E* c), c = (cube N)^(1/3)  =>  N^(2/3) = delta * ...
    let factor = 3.0 * k * crate::sqrt::sqrt(ratio) / (2.0 * core::f64::consts::PI * modulus);
    let n_two_thirds = libm::cbrt(cube) / factor;
    let stiffness_n_per_m15 = n_two_thirds * crate::sqrt::sqrt(n_two_thirds);
    let mean_axis = libm::cbrt(cube * stiffness_n_per_m15);
    let long = mean_axis / crate::sqrt::sqrt(ratio);
    let short = mean_axis * crate::sqrt::sqrt(ratio);
    let (along_per_sqrt_m, across_per_sqrt_m) =
        if along_per_m <= across_per_m { (long, short) } else { (short, long) };
    HertzEllipse { stiffness_n_per_m15, along_per_sqrt_m, across_per_sqrt_m }
}

/// Short over long semi-axis for the ratio of the small to the large relative curvature:
/// `A/B = (K - E) / (E/r^2 - K)`, monotone in `r`, by bisection.
fn axis_ratio(curvature_ratio: f64) -> f64 {
    let (mut low, mut high) = (1e-4, 1.0 - 1e-7);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let (k, e) = elliptic_integrals(middle);
        if (k - e) / (e / (middle * middle) - k) < curvature_ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Complete elliptic integrals K and E with complementary modulus `r` (short over long axis).
fn elliptic_integrals(r: f64) -> (f64, f64) {
    let (mut mean, mut root) = (1.0, r);
    let mut excess = 0.5 * (1.0 - r * r);
    let mut weight = 0.5;
    for _ in 0..8 {
        let half_difference = 0.5 * (mean - root);
        let next = 0.5 * (mean + root);
        root = crate::sqrt::sqrt(mean * root);
        mean = next;
        weight *= 2.0;
        excess += weight * half_difference * half_difference;
    }
    let k = core::f64::consts::PI / (2.0 * mean);
    (k, k * (1.0 - excess))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elliptic_integrals_match_published_values() {
        // Abramowitz and Stegun, m = 0.5: K = 1.8540746773, E = 1.3506438810.
        let (k, e) = elliptic_integrals(crate::sqrt::sqrt(0.5));
        assert!((k - 1.854_074_677_301_372).abs() < 1e-12, "{k}");
        assert!((e - 1.350_643_881_047_675).abs() < 1e-12, "{e}");
    }

    #[test]
    fn a_sphere_on_a_plane_follows_the_closed_form() {
        // N = 4/3 E* sqrt(R) delta^1.5, a = sqrt(R delta).
        let steel = Material::STEEL;
        let e = ellipse(1.0 / 0.5, 1.0 / 0.5, steel);
        let modulus = steel.shear_modulus_pa / (1.0 - steel.poisson);
        let expected = 4.0 / 3.0 * modulus * crate::sqrt::sqrt(0.5);
        assert!((e.stiffness_n_per_m15 / expected - 1.0).abs() < 1e-5, "{e:?}");
        assert!((e.across_per_sqrt_m / crate::sqrt::sqrt(0.5) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_traction_curve_patch_matches_contact() {
        // CONTACT, Eurosprinter case: N = 106.7 kN, A = 0.0008 1/mm, a/b = 0.5 -> a = 6.304 mm.
        let steel = Material::STEEL;
        let along = 2.0 * 0.8;
        // Find the lateral curvature that gives a/b = 0.5.
        let (mut low, mut high) = (0.01, along);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let e = ellipse(along, middle, steel);
            if e.along_per_sqrt_m / e.across_per_sqrt_m < 0.5 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let e = ellipse(along, low, steel);
        let delta =
            libm::cbrt((106.7e3f64 / e.stiffness_n_per_m15) * (106.7e3 / e.stiffness_n_per_m15));
        let a = e.along_per_sqrt_m * crate::sqrt::sqrt(delta);
        assert!((a - 6.304e-3).abs() < 5e-6, "{a}");
    }
}
