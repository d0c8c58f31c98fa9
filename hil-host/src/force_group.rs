//! One measured force that acts in several slots, for the check of stability.
//!
//! ```text
//! x = (I - G K)^-1 G f           without the dampers K of these slots; G has all dampers in it
//! f_j = -s_j K R exp(-s tau) x_r        s_j: sign in slot j, r: slot of the rig
//!
//! L = K R h_r exp(-s tau),  (I - G K) h = G s
//! ```
//! For two dampers that are opposite on one bogie, by symmetry `h_r = G_a / (1 - G_a K)` with
//! `G_a = G_rr - G_rp`: of motions in which both move oppositely the vehicle gives about twice as
//! much to the pair as to one of them, so the gain of the loop is about twice as large.

use crate::linear_vehicle::LinearMode;
use firmware_core::vehicle::DAMPER_SLOTS;
use num_complex::Complex64;

type Column = [Complex64; DAMPER_SLOTS];
type Matrix = [Column; DAMPER_SLOTS];

/// The slots in which the force of one rig acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceGroup {
    /// The slot of the rig.
    pub rig: usize,
    /// Sign of its force by slot: 1 or -1, and 0 where it does not act.
    pub signs: [f64; DAMPER_SLOTS],
}

impl ForceGroup {
    /// A rig that stands for its own damper alone.
    pub const fn alone(rig: usize) -> Self {
        debug_assert!(rig < DAMPER_SLOTS, "a slot that no vehicle has");
        let mut signs = [0.0; DAMPER_SLOTS];
        signs[rig] = 1.0;
        Self { rig, signs }
    }

    /// Whether the force acts in one slot.
    pub fn is_alone(&self) -> bool {
        self.signs.iter().filter(|sign| **sign != 0.0).count() == 1
    }

    /// `h_r`: the extension at the rig over its force, without the dampers of the group.
    pub(crate) fn receptance(
        &self,
        modes: &[LinearMode],
        s: Complex64,
        damper: Complex64,
    ) -> Complex64 {
        let with = receptances(modes, s);
        let (extension, _) = solved(self.without_dampers(&with, damper), self.moved(&with));
        extension[self.rig]
    }

    /// `det(I - G K + G s K R exp(-s tau)) / (G s)_r`, which vanishes at the poles of the coupled
    /// vehicle; `late` is `R exp(-s tau)`.
    pub(crate) fn characteristic(
        &self,
        modes: &[LinearMode],
        s: Complex64,
        damper: Complex64,
        late: Complex64,
    ) -> Complex64 {
        let with = receptances(modes, s);
        let (mut matrix, moved) = (self.without_dampers(&with, damper), self.moved(&with));
        for (row, moved) in matrix.iter_mut().zip(&moved) {
            row[self.rig] += moved * damper * late;
        }
        solved(matrix, moved).1 / moved[self.rig]
    }

    /// `I - G K` with the dampers of the group.
    fn without_dampers(&self, with: &Matrix, damper: Complex64) -> Matrix {
        std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                let unit = if row == column { Complex64::ONE } else { Complex64::ZERO };
                let is_member = self.signs[column] != 0.0;
                if is_member { unit - with[row][column] * damper } else { unit }
            })
        })
    }

    /// `G s`.
    fn moved(&self, with: &Matrix) -> Column {
        let of = |row: &Column| row.iter().zip(&self.signs).map(|(g, sign)| g * *sign).sum();
        std::array::from_fn(|row| of(&with[row]))
    }
}

/// The vehicle with all its dampers, between all slots.
fn receptances(modes: &[LinearMode], s: Complex64) -> Matrix {
    let between =
        |to: usize, from: usize| modes.iter().map(|mode| mode.of(mode.cross[to][from], s)).sum();
    std::array::from_fn(|to| std::array::from_fn(|from| between(to, from)))
}

/// The solution of `matrix x = right` by elimination with pivots, and the determinant.
fn solved(mut matrix: Matrix, mut right: Column) -> (Column, Complex64) {
    let mut determinant = Complex64::ONE;
    for step in 0..DAMPER_SLOTS {
        let size = |row: &usize| matrix[*row][step].norm();
        let pivot = (step..DAMPER_SLOTS).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(step);
        if pivot != step {
            matrix.swap(pivot, step);
            right.swap(pivot, step);
            determinant = -determinant;
        }
        let lead = matrix[step];
        determinant *= lead[step];
        for row in step + 1..DAMPER_SLOTS {
            let factor = matrix[row][step] / lead[step];
            for (value, above) in matrix[row].iter_mut().zip(&lead).skip(step) {
                *value -= factor * above;
            }
            let above = right[step];
            right[row] -= factor * above;
        }
    }
    for row in (0..DAMPER_SLOTS).rev() {
        let known: Complex64 =
            (row + 1..DAMPER_SLOTS).map(|column| matrix[row][column] * right[column]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    (right, determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complex(re: f64, im: f64) -> Complex64 {
        Complex64::new(re, im)
    }

    #[test]
    fn an_elimination_solves_and_has_the_determinant_of_a_known_matrix() {
        // A permutation of a triangle with 2, 3, i and 1 on its diagonal: two exchanges of rows.
        let z = Complex64::ZERO;
        let matrix = [
            [z, complex(3.0, 0.0), complex(1.0, 0.0), z],
            [complex(2.0, 0.0), complex(1.0, 1.0), z, z],
            [z, z, z, complex(1.0, 0.0)],
            [z, z, complex(0.0, 1.0), complex(4.0, 0.0)],
        ];
        let x = [complex(1.0, 2.0), complex(-1.0, 0.5), complex(0.0, 3.0), complex(2.0, 0.0)];
        let right = std::array::from_fn(|row| {
            matrix[row].iter().zip(&x).map(|(entry, value)| entry * value).sum()
        });
        let (found, determinant) = solved(matrix, right);
        for (found, expected) in found.iter().zip(&x) {
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
        assert!((determinant - complex(0.0, 6.0)).norm() < 1e-12, "{determinant}");
    }

    /// Two masses, left and right of a beam that yaws and shifts: symmetric and opposite motion
    /// have a pole each.
    fn pair() -> Vec<LinearMode> {
        let mode = |pole: Complex64, residue: Complex64, sign: f64| {
            let mut cross = [[Complex64::ZERO; DAMPER_SLOTS]; DAMPER_SLOTS];
            cross[0][..2].copy_from_slice(&[residue, residue * sign]);
            cross[1][..2].copy_from_slice(&[residue * sign, residue]);
            let residues = std::array::from_fn(|slot| cross[slot][slot]);
            LinearMode { pole, residues, cross }
        };
        vec![
            mode(complex(-3.0, 20.0), complex(0.0, -2e-6), -1.0),
            mode(complex(-8.0, 55.0), complex(1e-7, -1e-6), 1.0),
        ]
    }

    #[test]
    fn a_pair_sees_the_opposite_motion_alone_and_twice_as_much_of_it() {
        let (modes, damper) = (pair(), complex(4e4, 2e5));
        let both = ForceGroup { rig: 0, signs: [1.0, -1.0, 0.0, 0.0] };
        for omega in [5.0, 20.0, 100.0] {
            let s = complex(0.0, omega);
            let opposite = modes[0].of(modes[0].residues[0], s) * 2.0;
            let expected = opposite / (Complex64::ONE - opposite * damper);
            let found = both.receptance(&modes, s, damper);
            assert!((found - expected).norm() < 1e-9 * expected.norm(), "{found} {expected}");
            // 1 + L vanishes where the characteristic does.
            let late = complex(0.3, -0.2);
            let closed = Complex64::ONE + expected * damper * late;
            let expected = closed * (Complex64::ONE - opposite * damper) / opposite;
            // The other motion has a factor of its own: the damper pair without the rig.
            let same = modes[1].of(modes[1].residues[0], s) * 2.0;
            let expected = expected * (Complex64::ONE - same * damper);
            let found = both.characteristic(&modes, s, damper, late);
            assert!((found - expected).norm() < 1e-9 * expected.norm(), "{found} {expected}");
        }
    }

    #[test]
    fn a_rig_alone_has_the_scalar_formula() {
        let (modes, damper, s) = (pair(), complex(4e4, 2e5), complex(0.0, 21.0));
        let with: Complex64 = modes.iter().map(|mode| mode.of(mode.residues[0], s)).sum();
        let alone = ForceGroup::alone(0);
        let expected = with / (Complex64::ONE - with * damper);
        let found = alone.receptance(&modes, s, damper);
        assert!((found - expected).norm() < 1e-12 * expected.norm(), "{found} {expected}");
        let late = complex(0.9, -0.1);
        let expected = Complex64::ONE / with - damper * (Complex64::ONE - late);
        let found = alone.characteristic(&modes, s, damper, late);
        assert!((found - expected).norm() < 1e-12 * expected.norm(), "{found} {expected}");
        assert!(alone.is_alone());
    }
}
