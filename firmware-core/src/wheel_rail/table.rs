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

/// Shape of one contact at unit approach, ready for a creep law.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactShape {
    /// Downward displacement of the wheel at which the zone just touches (m).
    pub touch_m: f64,
    /// Tangent of the contact angle.
    pub slope: f64,
    /// Rolling radius less nominal (m).
    pub radius_deviation_m: f64,
    /// Outward distance from the tape circle (m).
    pub lateral_m: f64,
    /// Depth of the rail's centre of curvature below the tape circle (m).
    pub rail_radius_m: f64,
    /// Outward distance of the rail's centre of curvature from the tape circle (m).
    pub rail_centre_m: f64,
    /// `N / delta^1.5` (N/m^1.5).
    pub hertz_n_per_m15: f64,
    /// Semi-axis along over `sqrt(delta)` (m^0.5).
    pub along_per_sqrt_m: f64,
    /// Semi-axis across over `sqrt(delta)` (m^0.5).
    pub across_per_sqrt_m: f64,
    /// Kalker's C11.
    pub c11: f64,
    /// Kalker's C22.
    pub c22: f64,
    /// Kalker's C23.
    pub c23: f64,
}

const COLUMNS: usize = 12;

/// One row, as an array so that mixing two rows is one short vector loop.
type Row = [f64; COLUMNS];

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
    #[expect(clippy::large_stack_arrays, reason = "25 kB, off-line, and there is no heap")]
    fn new(geometry: &[ContactGeometry; TABLE_ROWS], radius_m: f64, material: Material) -> Self {
        let mut rows = [[0.0; COLUMNS]; TABLE_ROWS];
        for (row, point) in rows.iter_mut().zip(geometry) {
            let cosine = 1.0 / crate::sqrt::sqrt(1.0 + point.slope * point.slope);
            let along_per_m = cosine / (radius_m + point.radius_deviation_m);
            let patch = ellipse(along_per_m, point.curvature_lateral_per_m, material);
            let kalker =
                coefficients(patch.along_per_sqrt_m, patch.across_per_sqrt_m, material.poisson);
            *row = [
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
            ];
        }
        Self { rows }
    }

    /// The two rows around a shift and the fraction between them; the shift is held inside the
    /// table.
    #[inline(always)]
    fn bracket(&self, shift_m: f64) -> (&Row, &Row, f64) {
        let last = (TABLE_ROWS - 2) as f64;
        let place = (shift_m - TABLE_FIRST_SHIFT_M) * (1.0 / TABLE_STEP_M);
        let index = (place.clamp(0.0, last) as usize).min(TABLE_ROWS - 2);
        let fraction = (place - index as f64).clamp(0.0, 1.0);
        debug_assert!(index + 1 < self.rows.len(), "row {index} of {TABLE_ROWS}");
        debug_assert!(
            fraction.is_nan() || (0.0..=1.0).contains(&fraction),
            "{fraction} between two rows"
        );
        match self.rows.get(index..index + 2) {
            Some([low, high]) => (low, high, fraction),
            _ => (&EMPTY, &EMPTY, 0.0),
        }
    }

    /// Touching height alone (m): whether the zone is in contact at all.
    #[inline(always)]
    pub fn touch_m(&self, shift_m: f64) -> f64 {
        let (low, high, fraction) = self.bracket(shift_m);
        touch_between(low, high, fraction)
    }

    /// Depth of the rail's centre of curvature at a shift (m).
    #[inline(always)]
    pub fn rail_radius_m(&self, shift_m: f64) -> f64 {
        let (low, high, fraction) = self.bracket(shift_m);
        low[4] + (high[4] - low[4]) * fraction
    }

    /// Everything at a shift.
    #[inline(always)]
    pub fn at(&self, shift_m: f64) -> ContactShape {
        let (low, high, fraction) = self.bracket(shift_m);
        let mut mixed = [0.0; COLUMNS];
        for (value, (low, high)) in mixed.iter_mut().zip(low.iter().zip(high)) {
            *value = low + (high - low) * fraction;
        }
        // In the order in which `new` lists them.
        ContactShape {
            touch_m: touch_between(low, high, fraction),
            slope: mixed[1],
            radius_deviation_m: mixed[2],
            lateral_m: mixed[3],
            rail_radius_m: mixed[4],
            rail_centre_m: mixed[5],
            hertz_n_per_m15: mixed[6],
            along_per_sqrt_m: mixed[7],
            across_per_sqrt_m: mixed[8],
            c11: mixed[9],
            c22: mixed[10],
            c23: mixed[11],
        }
    }
}

static EMPTY: Row = [0.0; COLUMNS];

/// Cubic through both touching heights with both slopes.
#[inline(always)]
fn touch_between(low: &Row, high: &Row, t: f64) -> f64 {
    let (m0, m1) = (-low[1] * TABLE_STEP_M, -high[1] * TABLE_STEP_M);
    let rise = high[0] - low[0];
    // Hermite form around the straight line.
    low[0] + t * (rise + (1.0 - t) * ((1.0 - t) * (m0 - rise) - t * (m1 - rise)))
}

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
