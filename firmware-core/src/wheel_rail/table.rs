//! The run-time contact table of one wheel on one rail: geometry, Hertz and Kalker, per zone, over
//! lateral shift.
//!
//! Everything that depends on shape alone is worked out once, off-line; a step finds two rows and
//! mixes them. The touching height is interpolated by a cubic through values and slopes, so that
//! the contact force is continuous and belongs to one potential.

use super::geometry::{
    ContactGeometry, ContactZones, TABLE_FIRST_SHIFT_M, TABLE_ROWS, TABLE_STEP_M,
};
use super::hertz::{Material, ellipse};
use super::kalker::coefficients;
use crate::number::Number;

/// Shape of one contact at unit approach, ready for a creep law.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactShape<N = f64> {
    /// Downward displacement of the wheel at which the zone just touches (m).
    pub touch_m: N,
    /// Tangent of the contact angle.
    pub slope: N,
    /// Rolling radius less nominal (m).
    pub radius_deviation_m: N,
    /// Outward distance from the tape circle (m).
    pub lateral_m: N,
    /// Depth of the rail's centre of curvature below the tape circle (m).
    pub rail_radius_m: N,
    /// Outward distance of the rail's centre of curvature from the tape circle (m).
    pub rail_centre_m: N,
    /// `N / delta^1.5` (N/m^1.5).
    pub hertz_n_per_m15: N,
    /// Semi-axis along over `sqrt(delta)` (m^0.5).
    pub along_per_sqrt_m: N,
    /// Semi-axis across over `sqrt(delta)` (m^0.5).
    pub across_per_sqrt_m: N,
    /// Kalker's C11.
    pub c11: N,
    /// Kalker's C22.
    pub c22: N,
    /// Kalker's C23.
    pub c23: N,
}

const COLUMNS: usize = 12;

/// One row, as an array so that mixing two rows is one short vector loop: the fields of
/// [`ContactShape`] in their order.
pub type Row = [f64; COLUMNS];

/// One zone of a wheel: rows over lateral shift.
#[derive(Debug, Clone, PartialEq)]
pub struct ZoneTable {
    rows: [Row; TABLE_ROWS],
}

/// Both zones of one wheel on one rail.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTable {
    /// The running tread.
    pub tread: ZoneTable,
    /// The flange.
    pub flange: ZoneTable,
}

impl ContactTable {
    /// Adds Hertz and Kalker to the geometry, for one nominal rolling radius.
    pub fn new(zones: &ContactZones, rolling_radius_m: f64, material: Material) -> Self {
        Self {
            tread: ZoneTable::new(&zones.tread, rolling_radius_m, material),
            flange: ZoneTable::new(&zones.flange, rolling_radius_m, material),
        }
    }
}

impl ZoneTable {
    /// Rows that were worked out before, such as the constants of an image.
    pub const fn from_rows(rows: [Row; TABLE_ROWS]) -> Self {
        Self { rows }
    }

    /// The rows, from [`TABLE_FIRST_SHIFT_M`] on.
    pub fn rows(&self) -> &[Row; TABLE_ROWS] {
        &self.rows
    }

    #[expect(clippy::large_stack_arrays, reason = "25 kB, off-line, and there is no heap")]
    fn new(geometry: &[ContactGeometry; TABLE_ROWS], radius_m: f64, material: Material) -> Self {
        let mut rows = [[0.0; COLUMNS]; TABLE_ROWS];
        for (row, point) in rows.iter_mut().zip(geometry) {
            *row = row_at(point, radius_m, material);
        }
        Self::from_rows(rows)
    }

    /// The two rows around a shift and the fraction between them; the shift is held inside the
    /// table.
    #[inline(always)]
    pub(super) fn between<N: Number>(&self, shift_m: N) -> Between<'_, N> {
        let place = (shift_m - N::splat(TABLE_FIRST_SHIFT_M)) * N::splat(1.0 / TABLE_STEP_M);
        // What is below zero or no number becomes zero.
        let indices = place.to_each(|place| (place as u32).min(TABLE_ROWS as u32 - 2));
        let from = N::gather(&indices, |index| f64::from(*index));
        let rows = place.with_each(&indices, |index, _| self.pair(*index as usize));
        Between { rows, fraction: (place - from).within_unit() }
    }

    /// A row and the next one.
    #[inline(always)]
    fn pair(&self, index: usize) -> &[Row; 2] {
        debug_assert!(index + 1 < self.rows.len(), "row {index} of {TABLE_ROWS}");
        self.rows.get(index..).and_then(|rows| rows.first_chunk()).unwrap_or(&EMPTY)
    }

    /// Touching height alone (m): whether the zone is in contact at all.
    pub fn touch_m(&self, shift_m: f64) -> f64 {
        self.between(shift_m).touch_m()
    }

    /// Depth of the rail's centre of curvature at a shift (m).
    #[inline(always)]
    pub fn rail_radius_m<N: Number>(&self, shift_m: N) -> N {
        self.between(shift_m).column(4)
    }

    /// Everything at a shift.
    pub fn at(&self, shift_m: f64) -> ContactShape {
        self.between(shift_m).shape()
    }
}

/// The row of one contact: its geometry, with the stiffness and the patch after Hertz and the creep
/// coefficients after Kalker.
pub fn row_at(point: &ContactGeometry, rolling_radius_m: f64, material: Material) -> Row {
    let cosine = 1.0 / crate::sqrt::sqrt(1.0 + point.slope * point.slope);
    let along_per_m = cosine / (rolling_radius_m + point.radius_deviation_m);
    let patch = ellipse(along_per_m, point.curvature_lateral_per_m, material);
    let kalker = coefficients(patch.along_per_sqrt_m, patch.across_per_sqrt_m, material.poisson);
    [
        point.touch_m,
        point.slope,
        point.radius_deviation_m,
        point.lateral_m,
        point.rail_radius_m,
        point.lateral_m + (point.rail_radius_m - point.radius_deviation_m) * point.slope,
        patch.stiffness_n_per_m15,
        patch.along_per_sqrt_m,
        patch.across_per_sqrt_m,
        kalker.c11,
        kalker.c22,
        kalker.c23,
    ]
}

/// Two rows of a zone and the fraction of the way from one to the other.
#[derive(Clone, Copy)]
pub(super) struct Between<'a, N: Number> {
    rows: N::Each<&'a [Row; 2]>,
    fraction: N,
}

impl<N: Number> Between<'_, N> {
    /// One column, on the straight line between the rows.
    #[inline(always)]
    fn column(&self, column: usize) -> N {
        let low = N::gather(&self.rows, |[low, _]| low.get(column).copied().unwrap_or(0.0));
        let high = N::gather(&self.rows, |[_, high]| high.get(column).copied().unwrap_or(0.0));
        low + (high - low) * self.fraction
    }

    /// Touching height (m): the cubic through both heights with both slopes.
    #[inline(always)]
    pub(super) fn touch_m(&self) -> N {
        let (one, step, t) = (N::splat(1.0), N::splat(TABLE_STEP_M), self.fraction);
        let low = N::gather(&self.rows, |[low, _]| low[0]);
        let high = N::gather(&self.rows, |[_, high]| high[0]);
        let m0 = -N::gather(&self.rows, |[low, _]| low[1]) * step;
        let m1 = -N::gather(&self.rows, |[_, high]| high[1]) * step;
        let rise = high - low;
        // Hermite form around the straight line.
        low + t * (rise + (one - t) * ((one - t) * (m0 - rise) - t * (m1 - rise)))
    }

    /// Everything.
    #[inline(always)]
    pub(super) fn shape(&self) -> ContactShape<N> {
        let mixed = self.fraction.with_each(&self.rows, |[low, high], fraction| {
            let mut mixed = [0.0; COLUMNS];
            for (value, (low, high)) in mixed.iter_mut().zip(low.iter().zip(high)) {
                *value = low + (high - low) * fraction;
            }
            mixed
        });
        // In the order in which `new` lists them.
        ContactShape {
            touch_m: self.touch_m(),
            slope: N::gather(&mixed, |row| row[1]),
            radius_deviation_m: N::gather(&mixed, |row| row[2]),
            lateral_m: N::gather(&mixed, |row| row[3]),
            rail_radius_m: N::gather(&mixed, |row| row[4]),
            rail_centre_m: N::gather(&mixed, |row| row[5]),
            hertz_n_per_m15: N::gather(&mixed, |row| row[6]),
            along_per_sqrt_m: N::gather(&mixed, |row| row[7]),
            across_per_sqrt_m: N::gather(&mixed, |row| row[8]),
            c11: N::gather(&mixed, |row| row[9]),
            c22: N::gather(&mixed, |row| row[10]),
            c23: N::gather(&mixed, |row| row[11]),
        }
    }
}

static EMPTY: [Row; 2] = [[0.0; COLUMNS]; 2];

#[cfg(test)]
mod tests {
    use super::*;

    /// A cone of angle 0.05 with a slope that rises by 10 mrad per mm.
    fn zones() -> ContactZones {
        let mut tread = [ContactGeometry {
            touch_m: 0.0,
            slope: 0.05,
            radius_deviation_m: 0.0,
            lateral_m: 0.0,
            curvature_lateral_per_m: 2.0,
            rail_radius_m: 0.3,
        }; TABLE_ROWS];
        for (index, row) in tread.iter_mut().enumerate() {
            let shift = TABLE_FIRST_SHIFT_M + index as f64 * TABLE_STEP_M;
            row.slope = 0.05 + 10.0 * shift;
            row.touch_m = -0.05 * shift - 5.0 * shift * shift;
        }
        ContactZones { flange: tread, tread }
    }

    #[test]
    fn the_touching_height_between_rows_is_the_integral_of_the_slope() {
        let table = ContactTable::new(&zones(), 0.625, Material::STEEL);
        for shift in [-0.012_34, -1e-5, 0.003_21, 0.007_77] {
            let expected = -0.05 * shift - 5.0 * shift * shift;
            let shape = table.tread.at(shift);
            assert!((shape.touch_m - expected).abs() < 1e-15, "{shift}: {}", shape.touch_m);
            assert!((shape.slope - 0.05 - 10.0 * shift).abs() < 1e-12);
            assert_eq!(shape.touch_m, table.tread.touch_m(shift));
        }
    }

    #[test]
    fn shifts_beyond_the_table_are_held_at_its_ends() {
        let table = ContactTable::new(&zones(), 0.625, Material::STEEL);
        assert_eq!(table.tread.at(1.0), table.tread.at(0.016));
        assert_eq!(table.tread.at(-1.0), table.tread.at(-0.016));
    }
}
