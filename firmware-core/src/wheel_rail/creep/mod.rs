//! Creep laws: from creepages and normal force to the tangential force of one patch.
//!
//! Axes of a patch: along the rolling direction, across it outward, and the normal into the rail.
//! Creepage is the velocity of the wheel against the rail over the running speed; the force acts on
//! the wheel and opposes it. A new law is a new file here and one line in [`CreepLaw`].

mod conical_prescribed;
mod fastsim;
mod linear_saturated;
mod polach;

pub use conical_prescribed::ConicalPrescribed;
pub use fastsim::Fastsim;

use crate::number::Number;

/// One contact patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch<N = f64> {
    /// Normal force (N).
    pub normal_n: N,
    /// Semi-axis in rolling direction (m).
    pub along_m: N,
    /// Semi-axis across (m).
    pub across_m: N,
    /// Kalker's C11.
    pub c11: N,
    /// Kalker's C22.
    pub c22: N,
    /// Kalker's C23.
    pub c23: N,
    /// Shear modulus (Pa).
    pub shear_modulus_pa: N,
    /// Coefficient of friction.
    pub friction: N,
}

/// Relative motion in a patch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Creepage<N = f64> {
    /// Along the rolling direction.
    pub longitudinal: N,
    /// Across it, outward.
    pub lateral: N,
    /// Spin about the normal (1/m).
    pub spin_per_m: N,
}

/// Force on the wheel in a patch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CreepForce<N = f64> {
    /// Along the rolling direction (N).
    pub longitudinal_n: N,
    /// Across it, outward (N).
    pub lateral_n: N,
    /// Moment about the normal into the rail (N m).
    pub spin_moment_n_m: N,
}

/// The creep laws, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CreepLaw {
    /// `linear_saturated`: Kalker's linear theory with cubic saturation.
    LinearSaturated,
    /// `polach`: Polach's closed form with spin.
    Polach,
    /// `fastsim`: Kalker's simplified theory on a grid.
    Fastsim(Fastsim),
    /// `conical_prescribed`: given coefficients, for classical bogie models.
    ConicalPrescribed(ConicalPrescribed),
}

impl CreepLaw {
    /// Force on the wheel.
    #[inline(always)]
    pub fn force<N: Number>(&self, patch: &Patch<N>, creepage: Creepage<N>) -> CreepForce<N> {
        match self {
            Self::LinearSaturated => linear_saturated::force(patch, creepage),
            Self::Polach => polach::force(patch, creepage),
            Self::Fastsim(law) => law.force(patch, creepage),
            Self::ConicalPrescribed(law) => law.force(patch, creepage),
        }
    }
}

/// Shen, Hedrick and Elkins's saturation: share of the linear force that remains when the linear
/// force is `u` times the friction limit.
#[inline(always)]
fn cubic_saturation<N: Number>(u: N) -> N {
    let one = N::splat(1.0);
    let share = one - u * N::splat(1.0 / 3.0) + u * u * N::splat(1.0 / 27.0);
    N::choose(u.is_at_most(N::splat(3.0)), share, one / u)
}

impl<N: Number> CreepForce<N> {
    /// The force, but none where that is said.
    #[inline(always)]
    fn unless(self, none: N::Truth) -> Self {
        let zero = N::splat(0.0);
        Self {
            longitudinal_n: N::choose(none, zero, self.longitudinal_n),
            lateral_n: N::choose(none, zero, self.lateral_n),
            spin_moment_n_m: N::choose(none, zero, self.spin_moment_n_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wheel_rail::kalker::coefficients;

    /// The Eurosprinter patch of CONTACT's traction curve.
    pub(super) fn eurosprinter() -> Patch {
        let (a, b) = (6.304e-3, 12.61e-3);
        let c = coefficients(a, b, 0.28);
        Patch {
            normal_n: 106.7e3,
            along_m: a,
            across_m: b,
            c11: c.c11,
            c22: c.c22,
            c23: c.c23,
            shear_modulus_pa: 82.0e9,
            friction: 0.33,
        }
    }

    pub(super) fn laws() -> [CreepLaw; 3] {
        [
            CreepLaw::LinearSaturated,
            CreepLaw::Polach,
            CreepLaw::Fastsim(Fastsim::new(40, 40).unwrap()),
        ]
    }

    #[test]
    fn every_law_starts_with_kalkers_slope() {
        let patch = eurosprinter();
        let area = patch.along_m * patch.across_m;
        let gab = patch.shear_modulus_pa * area;
        for law in laws() {
            let force = law
                .force(&patch, Creepage { longitudinal: 1e-7, ..Creepage::default() })
                .longitudinal_n;
            assert!((force / (-gab * patch.c11 * 1e-7) - 1.0).abs() < 0.02, "{law:?} {force}");
            let force =
                law.force(&patch, Creepage { lateral: 1e-7, ..Creepage::default() }).lateral_n;
            assert!((force / (-gab * patch.c22 * 1e-7) - 1.0).abs() < 0.02, "{law:?} {force}");
            let spin = 1e-5;
            let force =
                law.force(&patch, Creepage { spin_per_m: spin, ..Creepage::default() }).lateral_n;
            let expected =
                -patch.shear_modulus_pa * area * crate::sqrt::sqrt(area) * patch.c23 * spin;
            assert!((force / expected - 1.0).abs() < 0.03, "{law:?} {force} {expected}");
        }
    }

    #[test]
    fn every_law_ends_at_the_friction_limit() {
        let patch = eurosprinter();
        for law in laws() {
            let force =
                law.force(&patch, Creepage { longitudinal: -0.03, lateral: 0.04, spin_per_m: 0.0 });
            let total = libm::hypot(force.longitudinal_n, force.lateral_n);
            assert!(total <= patch.friction * patch.normal_n * (1.0 + 2e-3), "{law:?} {total}");
            assert!(total > 0.97 * patch.friction * patch.normal_n, "{law:?} {total}");
            assert!(force.longitudinal_n > 0.0 && force.lateral_n < 0.0);
        }
    }

    #[test]
    fn no_law_gives_a_force_without_friction_or_load() {
        let creepage = Creepage { longitudinal: 3e-4, lateral: -7e-4, spin_per_m: 0.13 };
        for law in laws() {
            for patch in [
                Patch { friction: 0.0, ..eurosprinter() },
                Patch { normal_n: 0.0, along_m: 0.0, across_m: 0.0, ..eurosprinter() },
            ] {
                let force = law.force(&patch, creepage);
                for value in [force.longitudinal_n, force.lateral_n, force.spin_moment_n_m] {
                    assert!(value.abs() < 1e-9, "{law:?} {patch:?} {force:?}");
                }
            }
        }
    }

    #[test]
    fn every_law_is_mirror_symmetric_to_the_bit() {
        let patch = eurosprinter();
        for law in laws() {
            let creepage = Creepage { longitudinal: 3e-4, lateral: -7e-4, spin_per_m: 0.13 };
            let mirrored = Creepage { lateral: 7e-4, spin_per_m: -0.13, ..creepage };
            let (force, image) = (law.force(&patch, creepage), law.force(&patch, mirrored));
            assert_eq!(force.longitudinal_n, image.longitudinal_n, "{law:?}");
            assert_eq!(force.lateral_n, -image.lateral_n, "{law:?}");
            assert_eq!(force.spin_moment_n_m, -image.spin_moment_n_m, "{law:?}");
        }
    }
}
