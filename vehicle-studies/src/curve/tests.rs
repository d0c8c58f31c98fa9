//! A smooth curve in closed form, and its mirror image.

use super::assessment::Curve;
use super::procedure::Procedure;
use super::sections::Part;
use crate::trip::Equipped;
use firmware_core::vehicle::GRAVITY_M_PER_S2;
use scenario::run::{Overrides, Run};
use scenario::source::Source;
use std::path::Path;

/// The SS9 through a smooth curve of 500 m.
fn smooth(direction: &str, speed_kmh: f64, cant_m: f64) -> Curve {
    let text = format!(
        "title = \"smooth\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = {speed_kmh:?}\nduration_s = 1.0\n\
         substeps = 8\n[track.curve]\nradius_m = 500.0\ndirection = \"{direction}\"\n\
         cant_m = {cant_m:?}\nlead_in_m = 60.0\ntransition_m = 80.0\nlength_m = 240.0\n"
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/test.toml");
    let source = Source::from_text(&path, &text);
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    let run = Run::from_source(&source, overrides).unwrap();
    Curve::of(&run, &Equipped::of(&run).unwrap(), &Procedure::default()).unwrap()
}

#[test]
fn guiding_forces_carry_the_unbalanced_acceleration() {
    let mass_kg = 126.0e3;
    for (speed_kmh, cant_m) in [(80.0, 0.04), (100.0, 0.1)] {
        let found = smooth("right", speed_kmh, cant_m);
        let speed = speed_kmh / 3.6;
        let unbalanced = speed * speed / 500.0 - GRAVITY_M_PER_S2 * cant_m / 1.5;
        assert!((found.unbalanced_m_per_s2 - unbalanced).abs() < 1e-12);
        let full = found.full().unwrap();
        let carried_n: f64 = full.wheelsets.iter().map(|axle| axle.sum_quasi_static_n.mean).sum();
        assert!((carried_n / (mass_kg * unbalanced) - 1.0).abs() < 0.02, "{carried_n}");
        let load_n: f64 = full
            .wheelsets
            .iter()
            .flat_map(|axle| [&axle.outer, &axle.inner])
            .map(|wheel| wheel.q_quasi_static_n.mean)
            .sum();
        assert!((load_n / (mass_kg * GRAVITY_M_PER_S2) - 1.0).abs() < 0.02, "{load_n}");
        // The outer wheels carry more; the leading outer wheel guides.
        let first = &full.wheelsets[0];
        assert!(first.outer.q_quasi_static_n.mean > first.inner.q_quasi_static_n.mean);
        assert!(first.outer.y_quasi_static_n.mean > 10.0e3);
        // One track without seeds; without irregularity percentiles are close to the median.
        assert_eq!(found.track.irregularity, "none");
        assert!(first.sum_high_n.mean - first.sum_low_n.mean < 6.0e3);
        assert!(first.stability_rms_n.unwrap().mean < 1.0e3);
        let parts: Vec<Part> = found.sections.iter().map(|section| section.section.part).collect();
        assert_eq!(parts, [Part::Entry, Part::Curve, Part::Exit]);
    }
}

#[test]
fn a_left_curve_is_a_right_curve_mirrored() {
    let right = smooth("right", 90.0, 0.08);
    let left = smooth("left", 90.0, 0.08);
    assert_eq!((right.direction.as_str(), left.direction.as_str()), ("right", "left"));
    assert_eq!(right.unbalanced_m_per_s2, left.unbalanced_m_per_s2);
    let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-6 * a.abs().max(1.0), "{a} {b}");
    for (right, left) in right.sections.iter().zip(&left.sections) {
        assert_eq!(right.section, left.section);
        close(right.wear_w.mean, left.wear_w.mean);
        for (right, left) in right.wheelsets.iter().zip(&left.wheelsets) {
            close(right.sum_quasi_static_n.mean, left.sum_quasi_static_n.mean);
            close(right.sum_n.mean, left.sum_n.mean);
            close(right.outer.y_over_q.mean, left.outer.y_over_q.mean);
            close(right.inner.unloading.mean, left.inner.unloading.mean);
        }
    }
}
