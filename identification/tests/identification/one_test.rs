//! An effect that only one of many tests excites.

use crate::support::{NOMINAL, investigate_with, names, sensors};
use firmware_core::damper::Damper;
use firmware_core::damper::effects::BumpStop;
use virtual_bench::bench_visit::Modelled;

/// Amplitude and frequency, mm and Hz: one sine in ten reaches a stop at 17 mm.
const SINES: [(f64, f64); 11] = [
    (1.0, 3.5),
    (3.46, 3.5),
    (7.0, 3.5),
    (1.5, 1.2),
    (25.0, 0.8),
    (1.0, 8.0),
    (10.0, 1.0),
    (5.0, 2.0),
    (2.0, 5.0),
    (12.0, 0.5),
    (2.5, 2.5),
];

#[test]
fn a_stop_that_one_test_of_ten_touches_was_refused() {
    let stop = BumpStop {
        extension_stop_m: 17e-3,
        compression_stop_m: 17e-3,
        stiffness_n_per_m: 2e6,
        damping_n_s_per_m: 2e4,
    };
    let damper = Damper::new(NOMINAL, &[stop.into()]).unwrap();
    let found = investigate_with(&SINES, &Modelled { damper }, &sensors());
    assert_eq!(names(&found), ["bump_stop"], "{}", found.result.sentence());
    let at_m = found.result.effects[0].parameters["extension_stop_m"].value;
    assert!((at_m / 17e-3 - 1.0).abs() < 0.02, "{at_m}");
}
