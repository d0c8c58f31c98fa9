//! Rows of a contact table: Hertz and Kalker over slopes, radii and curvatures.

use firmware_core::fnv;
use firmware_core::wheel_rail::geometry::ContactGeometry;
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::row_at;

const ROLLING_RADIUS_M: f64 = 0.625;

/// Rows from an almost flat tread to a sharp flange.
#[inline(never)]
pub fn run(rows: u32) -> u64 {
    (0..rows).fold(fnv::START, |hash, number| {
        let share = f64::from(number) / f64::from(rows);
        let point = ContactGeometry {
            touch_m: -0.01 * share,
            slope: 3.0 * share * share,
            radius_deviation_m: 0.02 * share,
            lateral_m: -0.04 * share,
            curvature_lateral_per_m: 0.5 + 150.0 * share * share * share,
            rail_radius_m: 0.3 - 0.28 * share,
        };
        let row = row_at(&point, ROLLING_RADIUS_M, Material::STEEL);
        row.iter().fold(hash, |hash, value| fnv::add(hash, value.to_bits()))
    })
}
