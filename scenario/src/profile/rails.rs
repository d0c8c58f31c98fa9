//! Rail heads: three radii, symmetric, sides inclined 1:20.

use super::{Chain, Profile, Provenance};

/// CHN 60 kg/m rail: radii 80, 300, 80 with 13 mm shoulders.
///
/// Break points 10.0 and 25.3 mm fitted to a published point cloud of the head; the 13 mm arc ends
/// where it is parallel to the 1:20 side.
pub fn cn60() -> Profile {
    head(
        "cn60",
        Provenance::Derived,
        "radii 13/80/300 of the 60 kg/m rail of China; break points 10.0 and 25.3 mm fitted to a \
         published point cloud of the head",
        10.0e-3,
        25.3e-3,
    )
}

/// UIC 60 (60E1) rail: radii 80, 300, 80 with 13 mm shoulders, break points as drawn.
pub fn uic60() -> Profile {
    head(
        "uic60",
        Provenance::Published,
        "UIC 60 (60E1) drawing: radii 300/80/13, widths 20.456, 52.053 and 72 mm",
        20.456e-3 / 2.0,
        52.053e-3 / 2.0,
    )
}

/// A symmetric head of three radii; the 13 mm shoulder ends where it meets the 1:20 side.
pub(super) fn head(
    name: &'static str,
    provenance: Provenance,
    source: &'static str,
    crown_m: f64,
    shoulder_m: f64,
) -> Profile {
    const SIDE_SLOPE: f64 = 20.0;
    const SIDE_LENGTH_M: f64 = 0.6e-3;
    let half = Chain::start(0.0, 0.0)
        .arc_to(0.300, crown_m)
        .arc_to(0.080, shoulder_m)
        .arc_to_slope(0.013, SIDE_SLOPE);
    let side_m = half.end_m();
    let whole = half
        .line_to(side_m + SIDE_LENGTH_M)
        .turn()
        .arc_to(0.300, -crown_m)
        .arc_to(0.080, -shoulder_m)
        .arc_to_slope(0.013, -SIDE_SLOPE)
        .line_to(-side_m - SIDE_LENGTH_M);
    Profile::new(name, provenance, source, whole.sections(0.0, 0.0), side_m + SIDE_LENGTH_M)
}
