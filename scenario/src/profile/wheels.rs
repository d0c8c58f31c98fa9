//! Wheel profiles that are documented: LMA and S1002.

use super::chain::Chain;
use super::{Profile, Provenance, Section, Shape};

/// LMA, the Chinese high-speed wheel: 1:40, R450, R90, R14, face at 70 degrees, tip R15/R12.
///
/// Radii and break points from a curvature analysis of a published point cloud whose author did not
/// name it; that it is LMA is our identification. The joint of R90 and R14 (28.25 mm inside the
/// tape circle) puts the root within 0.05 mm of that cloud; above the root the cloud is smoothed
/// and the nominal 70 degrees are used.
pub fn lma() -> Profile {
    const FACE: f64 = 2.747_477_419;
    const HEIGHT_M: f64 = 28.02e-3;
    let root = Chain::start(3.8e-3, -1.0 / 40.0)
        .arc_to(0.450, -11.1e-3)
        .arc_to(0.090, -28.25e-3)
        .arc_to_slope(0.014, -FACE);
    let wheel = with_flange(root, FACE, HEIGHT_M, &[(0.015, 0.13), (0.012, 0.9)])
        .turn()
        .line_to(29.0e-3)
        .blend_to(32.0e-3, -1.0 / 15.0)
        .line_to(64.0e-3)
        .blend_to(65.0e-3, -1.0)
        .line_to(70.0e-3);
    Profile::new(
        "lma",
        Provenance::Derived,
        "radii 450/90/14, 1:40, tip 15/12 and break points read off a published point cloud; \
         identified here as LMA",
        wheel.sections(0.0, 0.0),
        70.0e-3,
    )
}

/// Continues from the root over a straight face and the tip, down the back until it is steep.
///
/// `tip` lists the radii over the tip with the slope at which each ends; the face is as long as the
/// flange height needs.
pub(super) fn with_flange(root: Chain, face: f64, height_m: f64, tip: &[(f64, f64)]) -> Chain {
    let tip_radius_m = tip.first().map_or(0.0, |first| first.0);
    let face_cosine = 1.0 / libm::sqrt(1.0 + face * face);
    let rise_m = height_m - tip_radius_m * (1.0 - face_cosine) - root.depth_below(0.0);
    let face_end_m = root.end_m() - (rise_m / face).max(0.0);
    let over_the_tip = root.line_to(face_end_m);
    tip.iter().fold(over_the_tip, |chain, (radius_m, slope)| chain.arc_to_slope(-radius_m, *slope))
}

/// S1002 (EN 13715): the sections of the standard, polynomials on the tread, arcs on the flange.
///
/// The chamfer beyond 60 mm is left out; the vertical last part of the flange back is cut.
pub fn s1002() -> Profile {
    let arc = |first_mm: f64, outward_mm: f64, down_mm: f64, radius_mm: f64| Section {
        first_m: first_mm * 1e-3,
        shape: Shape::Arc {
            centre_outward_m: outward_mm * 1e-3,
            centre_down_m: down_mm * 1e-3,
            radius_m: radius_mm * 1e-3,
        },
    };
    let series = |first_mm: f64, coefficients: &[f64]| Section {
        first_m: first_mm * 1e-3,
        shape: Shape::Series { coefficients: in_metres(coefficients) },
    };
    let sections = vec![
        arc(-69.7, -49.5, 9.519_259_302, -20.5),
        arc(-62.764_705_882, -55.0, 16.0, -12.0),
        arc(-49.662_510_381, -58.558_326_413, 8.834_924_130, -20.0),
        series(-39.764_473_993, &[-93.576_667_419, -2.747_477_419]),
        arc(-38.426_669_071, -26.210_665, 16.446, 13.0),
        series(
            -35.0,
            &[
                -4.320_221_063e3,
                -1.038_384_026e3,
                -1.065_501_873e2,
                -6.051_367_875,
                -2.054_332_446e-1,
                -4.169_739_389e-3,
                -4.687_195_829e-5,
                -2.252_755_540e-7,
            ],
        ),
        series(
            -26.0,
            &[
                0.0,
                -3.358_537_058e-2,
                1.565_681_624e-3,
                -2.810_427_944e-5,
                5.844_240_864e-8,
                -1.562_379_023e-8,
                5.309_217_349e-15,
                -5.957_839_843e-12,
                2.646_656_573e-13,
            ],
        ),
        series(32.157_96, &[1.364_323_640, -0.066_666_667]),
    ];
    Profile::new(
        "s1002",
        Provenance::Published,
        "EN 13715, S1002: section polynomials and arcs of the standard",
        sections,
        60.0e-3,
    )
}

/// Coefficients of a series in millimetres as one in metres.
fn in_metres(millimetres: &[f64]) -> Vec<f64> {
    let mut scale = 1e-3;
    let mut scaled = Vec::with_capacity(millimetres.len());
    for coefficient in millimetres {
        scaled.push(coefficient * scale);
        scale *= 1e3;
    }
    scaled
}
