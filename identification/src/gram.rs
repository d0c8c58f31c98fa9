//! Normal equations piece by piece: everything that least squares needs of a set of columns, so
//! that pieces can be left out without another pass over the samples.

use nalgebra::{DMatrix, DVector};

/// Products of columns with each other and with a residual, over one piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gram {
    /// Columns times columns.
    pub columns: DMatrix<f64>,
    /// Columns times residual.
    pub residual: DVector<f64>,
    /// Residual times residual.
    pub squares: f64,
}

impl Gram {
    /// Over equally long columns and residual.
    pub(crate) fn over(columns: &[&[f64]], residual: &[f64]) -> Self {
        let squares = dot(residual, residual);
        let none = Self { columns: DMatrix::zeros(0, 0), residual: DVector::zeros(0), squares };
        none.extended(columns, residual)
    }

    /// Over more columns and the same residual, of which the products of the first columns are
    /// known.
    #[must_use]
    pub(crate) fn extended(&self, columns: &[&[f64]], residual: &[f64]) -> Self {
        let (known, count) = (self.columns.nrows(), columns.len());
        debug_assert!(known <= count, "the known columns are the first of all columns");
        debug_assert!(
            columns.iter().all(|column| column.len() == residual.len()),
            "columns and residual cover the same samples"
        );
        let mut products = self.columns.clone().resize(count, count, 0.0);
        for row in known..count {
            for column in 0..=row {
                let value = dot(columns[row], columns[column]);
                products[(row, column)] = value;
                products[(column, row)] = value;
            }
        }
        let mut toward = self.residual.clone().resize_vertically(count, 0.0);
        toward.rows_mut(known, count - known).copy_from(&Self::toward(&columns[known..], residual));
        Self { columns: products, residual: toward, squares: self.squares }
    }

    /// Columns times a residual alone.
    pub(crate) fn toward(columns: &[&[f64]], residual: &[f64]) -> DVector<f64> {
        DVector::from_iterator(columns.len(), columns.iter().map(|column| dot(column, residual)))
    }

    /// The sum of several pieces, in their order.
    pub(crate) fn sum<'a>(pieces: impl Iterator<Item = &'a Self>) -> Option<Self> {
        pieces.fold(None, |sum: Option<Self>, piece| match sum {
            None => Some(piece.clone()),
            Some(sum) => Some(Self {
                columns: sum.columns + &piece.columns,
                residual: sum.residual + &piece.residual,
                squares: sum.squares + piece.squares,
            }),
        })
    }

    /// Coefficients of least squares; directions that the columns do not determine stay zero.
    pub(crate) fn solve(&self) -> DVector<f64> {
        let count = self.columns.nrows();
        let scale = DVector::from_fn(count, |i, _| {
            let length = self.columns[(i, i)].sqrt();
            if length > 0.0 { 1.0 / length } else { 0.0 }
        });
        let scaled =
            DMatrix::from_fn(count, count, |i, j| self.columns[(i, j)] * scale[i] * scale[j]);
        let right = self.residual.component_mul(&scale);
        let eigen = scaled.symmetric_eigen();
        let rotated = eigen.eigenvectors.tr_mul(&right);
        let largest = eigen.eigenvalues.max();
        let solved = DVector::from_fn(count, |i, _| {
            let value = eigen.eigenvalues[i];
            if value > SMALLEST_SHARE * largest { rotated[i] / value } else { 0.0 }
        });
        (eigen.eigenvectors * solved).component_mul(&scale)
    }

    /// A step of at most `longest` in every coefficient along which the sum of squares falls:
    /// a coefficient that would be longer is damped until it is not, the others stay free.
    ///
    /// `share` of every column's own weight is added to it, and `idle`, the squares that a change
    /// by 1 has to be worth: a column that hardly acts stays where it is.
    pub(crate) fn step_within(&self, share: f64, idle: f64, longest: f64) -> DVector<f64> {
        debug_assert!(share >= 0.0 && idle >= 0.0 && longest > 0.0, "{share} {idle} {longest}");
        let count = self.columns.nrows();
        let own = |i: usize| self.columns[(i, i)] + idle;
        let mut damping = vec![share; count];
        let mut step = DVector::zeros(count);
        for _ in 0..MOST_DAMPINGS {
            let mut damped = self.clone();
            for (i, damping) in damping.iter().enumerate() {
                damped.columns[(i, i)] = own(i) * (1.0 + damping);
            }
            step = damped.solve();
            let mut is_within = true;
            for i in (0..count).filter(|i| step[*i].abs() > longest) {
                damping[i] = (10.0 * damping[i]).max(LEAST_DAMPING);
                is_within = false;
            }
            if is_within {
                return step;
            }
        }
        let most = step.amax();
        step * (longest / most.max(longest))
    }

    /// How much the sum of squares falls when the given coefficients are used.
    pub(crate) fn fall(&self, coefficients: &DVector<f64>) -> f64 {
        2.0 * coefficients.dot(&self.residual) - coefficients.dot(&(&self.columns * coefficients))
    }

    /// The same without the parts of the other columns and of the residual that the first `count`
    /// columns explain.
    #[must_use]
    pub(crate) fn without_first(&self, count: usize) -> Self {
        debug_assert!(count <= self.columns.nrows());
        let rest = self.columns.nrows() - count;
        let first = Self {
            columns: self.columns.view((0, 0), (count, count)).into_owned(),
            residual: self.residual.rows(0, count).into_owned(),
            squares: self.squares,
        };
        let explain = |right: DVector<f64>| Self { residual: right, ..first.clone() }.solve();
        let cross = self.columns.view((0, count), (count, rest)).into_owned();
        let of_residual = explain(first.residual.clone());
        let mut columns = self.columns.view((count, count), (rest, rest)).into_owned();
        for j in 0..rest {
            let of_column = explain(cross.column(j).into_owned());
            for i in 0..rest {
                columns[(i, j)] -= cross.column(i).dot(&of_column);
            }
        }
        let residual = self.residual.rows(count, rest) - cross.tr_mul(&of_residual);
        Self { columns, residual, squares: self.squares - first.fall(&of_residual) }
    }
}

/// Sum of products of equally long columns.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len(), "columns cover the same samples");
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Least damping of a coefficient whose step is too long, and how often it is multiplied by ten.
const LEAST_DAMPING: f64 = 1e-6;
const MOST_DAMPINGS: usize = 16;
/// Directions with less than this share of the largest eigenvalue are ignored.
const SMALLEST_SHARE: f64 = 1e-11;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_that_hardly_acts_does_not_shorten_the_others() {
        // The second column would need 1e6 to explain its part.
        let (strong, weak, y) = ([1.0, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.5, 1.0, 0.0]);
        let gram = Gram::over(&[&strong, &weak], &y);
        let free = gram.solve();
        assert!((free[1] - 1e6).abs() < 1.0, "{free}");
        let step = gram.step_within(0.0, 0.0, 4.0);
        assert!((step[0] - 0.5).abs() < 1e-12 && (0.0..4.0).contains(&step[1]), "{step}");
        // Not worth moving.
        let step = gram.step_within(0.0, 1e-4, 4.0);
        assert!((step[0] - 0.5).abs() < 1e-4 && step[1] < 0.1, "{step}");
        // Where all are short, nothing changes.
        assert_eq!(gram.step_within(0.0, 0.0, 2e6), free);
    }

    #[test]
    fn along_a_step_the_sum_of_squares_falls_however_alike_the_columns_are() {
        // The difference of the columns would have to be 1e4 times as large.
        let (one, other) = ([1.0, 1.0, 1.0], [1.0, 1.0, 1.0 + 1e-4]);
        let gram = Gram::over(&[&one, &other], &[0.3, -0.2, 1.5]);
        assert!(gram.solve().amax() > 1e3);
        let step = gram.step_within(0.0, 0.0, 1.0);
        assert!(step.amax() <= 1.0, "{step}");
        assert!(gram.fall(&step) > 0.5, "{} of {}", gram.fall(&step), gram.fall(&gram.solve()));
    }

    #[test]
    fn least_squares_by_hand() {
        // y = 2 x + 1 through three points, with a residual that no line explains.
        let (ones, x, y) = ([1.0, 1.0, 1.0], [0.0, 1.0, 2.0], [1.5, 2.0, 5.5]);
        let gram = Gram::over(&[&ones, &x], &y);
        let line = gram.solve();
        assert!((line[0] - 1.0).abs() < 1e-12 && (line[1] - 2.0).abs() < 1e-12);
        assert!((gram.squares - gram.fall(&line) - 1.5).abs() < 1e-12);
        let slope_only = gram.without_first(1);
        assert!((slope_only.solve()[0] - 2.0).abs() < 1e-12);
        assert!((slope_only.squares - 9.5).abs() < 1e-12);
    }

    #[test]
    fn extended_by_a_column_is_over_all_of_them() {
        let (ones, x, y) = ([1.0, 1.0, 1.0], [0.1, 1.7, 2.3], [1.5, 2.0, 5.5]);
        let all = Gram::over(&[&ones, &x], &y);
        assert_eq!(Gram::over(&[&ones], &y).extended(&[&ones, &x], &y), all);
    }

    #[test]
    fn repeated_column_changes_nothing() {
        let (ones, y) = ([1.0, 1.0, 1.0], [1.0, 2.0, 6.0]);
        let gram = Gram::over(&[&ones, &ones], &y);
        let halves = gram.solve();
        assert!((halves[0] + halves[1] - 3.0).abs() < 1e-9, "{halves}");
    }
}
