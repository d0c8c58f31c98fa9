//! FASTSIM: Kalker's simplified theory (Vehicle System Dynamics 11, 1982) on a grid.
//!
//! The surface is a bed of springs with flexibilities `L1 = 8a/(3 G C11)`, `L2 = 8a/(3 G C22)`,
//! `L3 = pi a sqrt(a/b) / (4 G C23)`. Each strip is followed from its leading edge; the traction
//! grows by slip over flexibility and is cut at `mu p` with the parabolic pressure
//! `p = 2N/(pi a b) (1 - x^2/a^2 - y^2/b^2)`. Cost grows with the number of cells and nothing else.
//! It is compared with the closed form and with CONTACT in `evidence/src/validation/fastsim.rs`.

use super::{CreepForce, Creepage, Patch};
use crate::number::Number;

const PI: f64 = core::f64::consts::PI;

/// Grid of the simplified theory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fastsim {
    along: u16,
    across: u16,
}

/// Largest number of cells along one axis.
const FASTSIM_CELLS_MAX: u16 = 256;

impl Fastsim {
    /// Cells along and across; `None` when a number is zero or above 256.
    pub fn new(along: u16, across: u16) -> Option<Self> {
        let fits = |cells| (1..=FASTSIM_CELLS_MAX).contains(&cells);
        (fits(along) && fits(across)).then_some(Self { along, across })
    }

    #[inline(always)]
    pub(super) fn force<N: Number>(self, patch: &Patch<N>, creepage: Creepage<N>) -> CreepForce<N> {
        let of = N::splat;
        let (a, b) = (patch.along_m, patch.across_m);
        let is_empty = |size: N| size.is_at_most(of(0.0));
        let none = N::or(N::or(is_empty(a), is_empty(b)), is_empty(patch.normal_n));
        if N::all(none) {
            return CreepForce::default();
        }
        let g = patch.shear_modulus_pa;
        let slip_x = creepage.longitudinal * (of(3.0) * g * patch.c11 / (of(8.0) * a));
        let slip_y = creepage.lateral * (of(3.0) * g * patch.c22 / (of(8.0) * a));
        let spin = creepage.spin_per_m * (of(4.0) * g * patch.c23 / (of(PI) * a * (a / b).sqrt()));
        let peak = patch.friction * of(2.0) * patch.normal_n / (of(PI) * a * b);
        let strip_m = of(2.0) * b / of(f64::from(self.across));

        let bed = Bed { slip_x, slip_y, spin, peak, along_m: a, cells: self.along };
        let mut sum = CreepForce::default();
        // Both strips at one distance from the middle together, so that mirrored creepages give
        // mirrored forces to the last bit.
        for pair in 0..self.across / 2 {
            let place = f64::from(2 * pair + 1 + self.across % 2) / f64::from(self.across);
            sum = sum + (bed.strip(place, of(place) * b) + bed.strip(place, of(-place) * b));
        }
        if self.across % 2 == 1 {
            sum = sum + bed.strip(0.0, of(0.0));
        }
        (sum * strip_m).unless(none)
    }
}

/// Slip over flexibility and the friction bound: what every strip shares.
struct Bed<N> {
    slip_x: N,
    slip_y: N,
    spin: N,
    peak: N,
    along_m: N,
    cells: u16,
}

impl<N: Number> Bed<N> {
    /// Traction of one strip, integrated over its length; `place` is its distance from the middle
    /// over the semi-axis.
    #[inline(always)]
    fn strip(&self, place: f64, y: N) -> CreepForce<N> {
        let of = N::splat;
        let height = (1.0 - place * place).max(0.0);
        let half_length = self.along_m * of(crate::sqrt::sqrt(height));
        let step = of(2.0) * half_length / of(f64::from(self.cells));
        let mut x = half_length - of(0.5) * step;
        // The traction grows from zero at the leading edge: half a cell to the first centre.
        let mut grown = of(0.5) * step;
        let (mut px, mut py) = (of(0.0), of(0.0));
        let mut sum = CreepForce::default();
        for _ in 0..self.cells {
            px -= (self.slip_x - self.spin * y) * grown;
            py -= (self.slip_y + self.spin * (x + of(0.5) * grown)) * grown;
            grown = step;
            let parabola = of(height) - x * x / (self.along_m * self.along_m);
            let limit = (self.peak * parabola).at_least(0.0);
            let square = px * px + py * py;
            let slips = square.is_above(limit * limit);
            if N::any(slips) {
                let cut = limit / square.sqrt();
                px = N::choose(slips, px * cut, px);
                py = N::choose(slips, py * cut, py);
            }
            sum.longitudinal_n += px;
            sum.lateral_n += py;
            sum.spin_moment_n_m += x * py - y * px;
            x -= step;
        }
        sum * step
    }
}

impl<N: Number> core::ops::Add for CreepForce<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            longitudinal_n: self.longitudinal_n + other.longitudinal_n,
            lateral_n: self.lateral_n + other.lateral_n,
            spin_moment_n_m: self.spin_moment_n_m + other.spin_moment_n_m,
        }
    }
}

impl<N: Number> core::ops::Mul<N> for CreepForce<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, width: N) -> Self {
        Self {
            longitudinal_n: self.longitudinal_n * width,
            lateral_n: self.lateral_n * width,
            spin_moment_n_m: self.spin_moment_n_m * width,
        }
    }
}
