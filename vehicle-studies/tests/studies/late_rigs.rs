//! A vehicle whose dampers are behind emulated rigs.

use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::{CYCLE_S, Overrides, Run};
use std::path::Path;
use vehicle_studies::critical_speed::{Fold, Procedure, set_off};
use vehicle_studies::trip::track::rough_start;
use vehicle_studies::trip::{Equipped, Rigs};

fn locomotive() -> Run {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    Run::load(&path, Overrides { duration_s: Some(1.0), ..Overrides::default() }).unwrap()
}

fn behind(run: &Run, delay_s: f64, slots: [bool; DAMPER_SLOTS]) -> Equipped<'static> {
    let rigs = Rigs::late_by(&run.rig, delay_s, slots).unwrap();
    Equipped::of(run).unwrap().behind(rigs)
}

#[test]
fn the_delay_that_is_set_is_the_one_that_a_run_measures() {
    let run = locomotive();
    let procedure = Procedure::default();
    let track = rough_start(&procedure.band(1), 300.0);
    let track = track.view();
    for delay_ms in [-2.0, -0.3, 0.0, 1.0, 5.0] {
        let equipped = behind(&run, 1e-3 * delay_ms, [true, false, false, true]);
        let (trip, mut state, _) = set_off(&equipped, &procedure, &track, 160.0).unwrap();
        assert!(trip.go(&mut state, 6.0, |_| {}).unwrap());
        let measured: Vec<f64> =
            state.delays().map(|blocks| 1e3 * blocks.residual(CYCLE_S).unwrap().mean_s).collect();
        assert_eq!(measured.len(), 2);
        for found in measured {
            assert!((found - delay_ms).abs() < 0.05, "{found} ms of {delay_ms}");
        }
    }
}

#[test]
fn rigs_without_delay_hunt_from_the_speed_of_modelled_dampers_and_late_ones_do_not() {
    let run = locomotive();
    let procedure = Procedure { from_kmh: 200.0, to_kmh: 270.0, ..Procedure::default() };
    let dies = |equipped: &Equipped<'_>| {
        Fold::of(equipped, &procedure).unwrap().dies.kmh().expect("a speed in the range")
    };
    let modelled = dies(&Equipped::of(&run).unwrap());
    let ideal = dies(&behind(&run, 0.0, [true; DAMPER_SLOTS]));
    let late = dies(&behind(&run, 5e-3, [true; DAMPER_SLOTS]));
    println!("modelled {modelled}, ideal rigs {ideal}, 5 ms late {late} km/h");
    assert!((ideal - modelled).abs() <= 2.0 * procedure.resolution_kmh, "{ideal} {modelled}");
    assert!((late - modelled).abs() > 4.0 * procedure.resolution_kmh, "{late} {modelled}");
}
