//! Least squares in three unknowns with forgetting, and a ridge towards given values.

/// Exponentially forgotten sums of the normal equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Regression {
    /// Upper triangle of the normal matrix, by rows.
    normal: [f64; 6],
    right: [f64; 3],
}

impl Regression {
    /// No equations yet.
    pub(super) const EMPTY: Self = Self { normal: [0.0; 6], right: [0.0; 3] };

    /// Adds an equation `inputs . unknowns = output` with a weight, after the sums are multiplied
    /// by `kept`.
    pub(super) fn add(&mut self, inputs: [f64; 3], output: f64, weight: f64, kept: f64) {
        let [x, y, z] = inputs;
        let products = [x * x, x * y, x * z, y * y, y * z, z * z];
        for (sum, product) in self.normal.iter_mut().zip(products) {
            *sum = kept * *sum + weight * product;
        }
        for (sum, input) in self.right.iter_mut().zip(inputs) {
            *sum = kept * *sum + weight * input * output;
        }
    }

    /// The diagonal of the normal matrix: what each input has of its square.
    pub(super) const fn squares(&self) -> [f64; 3] {
        let [xx, _, _, yy, _, zz] = self.normal;
        [xx, yy, zz]
    }

    /// The unknowns; `ridge` pulls each towards its `prior`. Not finite if the equations are not.
    pub(super) fn solve(&self, prior: [f64; 3], ridge: [f64; 3]) -> [f64; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.normal;
        let [p, q, r] = prior;
        let [right_x, right_y, right_z] = self.right;
        // The deviation from the prior solves the same equations with another right-hand side.
        let right_x = right_x - xx * p - xy * q - xz * r;
        let right_y = right_y - xy * p - yy * q - yz * r;
        let right_z = right_z - xz * p - yz * q - zz * r;
        // The ridge makes the matrix positive definite: elimination needs no pivots.
        let [ridge_x, ridge_y, ridge_z] = ridge;
        let (xx, yy, zz) = (xx + ridge_x, yy + ridge_y, zz + ridge_z);
        let (by, bz) = (xy / xx, xz / xx);
        let (yy, yz, zz) = (yy - by * xy, yz - by * xz, zz - bz * xz);
        let (right_y, right_z) = (right_y - by * right_x, right_z - bz * right_x);
        let cz = yz / yy;
        let z = (right_z - cz * right_y) / (zz - cz * yz);
        let y = (right_y - yz * z) / yy;
        let x = (right_x - xy * y - xz * z) / xx;
        [p + x, q + y, r + z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_without_error_give_their_unknowns_and_none_the_prior() {
        let (truth, prior) = ([1.0, -2.0, 0.5], [0.9, 0.0, 0.0]);
        let mut sums = Regression::EMPTY;
        assert_eq!(sums.solve(prior, [1e-9; 3]), prior);
        for k in 0..50 {
            let t = f64::from(k);
            let inputs = [libm::sin(t), libm::cos(2.0 * t), libm::sin(3.0 * t)];
            let output: f64 = inputs.iter().zip(truth).map(|(input, a)| input * a).sum();
            sums.add(inputs, output, 1.0, 0.99);
        }
        for (found, expected) in sums.solve(prior, [1e-9; 3]).iter().zip(truth) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
        // One of them held.
        let [.., third] = sums.solve([0.9, 0.0, 0.25], [1e-9, 1e-9, 1e12]);
        assert!((third - 0.25).abs() < 1e-9, "{third}");
    }
}
