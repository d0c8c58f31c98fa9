//! Beyond its stroke a clearance is no damper at all: the critical speed tends to that without yaw dampers.

use firmware_core::damper::{Damper, Nominal};
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use std::path::Path;
use studies::critical_speed::fold::Fold;
use studies::critical_speed::linear::LinearSpeed;
use studies::critical_speed::{Critical, Procedure};
use studies::ride::{self, Ride};
use studies::study::Busy;
use studies::trip::Equipped;

fn locomotive(nominal: Nominal) -> Equipped {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    let run = Run::load(&path, overrides).unwrap();
    let damper = Damper::new(nominal, &[]).unwrap();
    let equipped = Equipped::of(&run).unwrap();
    Equipped { dampers: vec![damper; equipped.dampers.len()], ..equipped }
}

fn at(critical: Critical) -> f64 {
    critical.kmh().unwrap_or_else(|| panic!("{critical}"))
}

#[test]
fn a_clearance_of_8_mm_leaves_the_locomotive_without_yaw_dampers() {
    let procedure = Procedure { from_kmh: 150.0, to_kmh: 250.0, ..Procedure::default() };
    let worn = locomotive(Nominal { clearance_2a_m: 8e-3, ..Nominal::NEW });
    let mut none = worn.clone();
    none.dampers.clear();
    let speeds = [
        at(Fold::of(&worn, &procedure).unwrap().dies),
        at(Fold::of(&none, &procedure).unwrap().dies),
        // At a stroke inside the clearance the describing function is zero.
        at(LinearSpeed::of(&worn, &procedure, 3.5e-3).critical),
        at(LinearSpeed::of(&none, &procedure, 3.5e-3).critical),
    ];
    println!("worn, without; linear worn, without: {speeds:?} km/h");
    assert!((speeds[0] - speeds[1]).abs() < 2.0, "{speeds:?}");
    assert!((speeds[2] - speeds[3]).abs() < 1e-9, "{speeds:?}");
    // The small motion that grows is the one that dies last: no relief, no clearance in its way.
    assert!((speeds[1] - speeds[3]).abs() < 2.0, "{speeds:?}");
}

#[test]
fn a_stiffer_damper_hunts_later_and_half_the_step_changes_nothing() {
    let procedure = Procedure { to_kmh: 320.0, ..Procedure::default() };
    let finer = Procedure { substeps: 4, ..procedure.clone() };
    let dies = |ke_n_per_m: f64, procedure: &Procedure| {
        let equipped = locomotive(Nominal { ke_n_per_m, ..Nominal::NEW });
        at(Fold::of(&equipped, procedure).unwrap().dies)
    };
    let soft = dies(3e6, &procedure);
    let stiff = dies(12.5e6, &procedure);
    let stiff_finer = dies(12.5e6, &finer);
    println!("3 MN/m {soft}, 12.5 MN/m {stiff}, at half the step {stiff_finer} km/h");
    assert!(stiff > soft + 30.0, "{soft} {stiff}");
    assert!((stiff - stiff_finer).abs() < 1.0, "{stiff} {stiff_finer}");
}

/// Ride has no critical point in between: what a wider clearance does, it does towards having no dampers.
#[test]
fn ride_tends_to_that_without_yaw_dampers() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    let procedure =
        ride::Procedure { seeds: vec![1, 2], section_s: 20.0, ..ride::Procedure::default() };
    let lateral = |clearance_2a_m: f64| {
        let wear = Setting { key: "damper.clearance_2a_m".to_owned(), value: clearance_2a_m };
        let run = Run::load_with(&path, overrides, &[wear]).unwrap();
        let ride = Ride::of(&run, &procedure, &Busy::default()).unwrap();
        ride.worst(|place| Some(place.lateral.sperling_1985?.mean)).unwrap()
    };
    // A clearance of a metre is never crossed.
    let without = lateral(1.0);
    let left = [0.2e-3, 4e-3, 8e-3, 16e-3].map(|clearance| (lateral(clearance) - without).abs());
    println!("without {without}, left at 0.2, 4, 8, 16 mm: {left:?}");
    assert!(left[0] > left[1] && left[1] > left[2] && left[2] > left[3], "{left:?}");
    assert!(left[3] < 0.02 * without, "{left:?}");
}
