//! Beyond its stroke a clearance is no damper at all: the critical speed tends to that without yaw
//! dampers.

use firmware_core::damper::{Damper, Nominal};
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use std::path::Path;
use vehicle_studies::critical_speed::Fold;
use vehicle_studies::critical_speed::LinearSpeed;
use vehicle_studies::critical_speed::{Critical, Procedure};
use vehicle_studies::ride::{self, Ride};
use vehicle_studies::trip::Equipped;

fn locomotive(nominal: Nominal) -> Equipped<'static> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    let run = Run::load(&path, overrides).unwrap();
    let damper = Damper::new(nominal, &[]).unwrap();
    Equipped::of(&run).unwrap().with(&damper)
}

fn at(critical: Critical) -> f64 {
    critical.kmh().unwrap_or_else(|| panic!("{critical}"))
}

#[test]
fn a_wide_clearance_leaves_the_locomotive_without_yaw_dampers() {
    let procedure = Procedure { from_kmh: 150.0, to_kmh: 250.0, ..Procedure::default() };
    let worn = |clearance_2a_m: f64| locomotive(Nominal { clearance_2a_m, ..Nominal::NEW });
    let mut none = worn(8e-3);
    none.dampers.clear();
    let dies = |equipped: &Equipped<'_>| at(Fold::of(equipped, &procedure).unwrap().dies);
    let grows = |equipped: &Equipped<'_>| {
        at(LinearSpeed::of(equipped, &procedure, 3.5e-3).unwrap().critical)
    };
    let without = dies(&none);
    // The cycle at its end has more than 4 mm of stroke: at 8 mm a damper is still touched a
    // little.
    let above = [4e-3, 8e-3, 16e-3].map(|clearance| dies(&worn(clearance)) - without);
    // At a stroke inside the clearance the describing function is zero.
    let linear = [grows(&worn(8e-3)), grows(&none)];
    println!("without {without}, above it at 4, 8, 16 mm {above:?}; linear {linear:?} km/h");
    assert!(above[0] > above[1] && above[1] >= above[2], "{above:?}");
    assert!((0.0..4.0).contains(&above[1]) && above[2].abs() < 0.7, "{above:?}");
    assert!((linear[0] - linear[1]).abs() < 1e-9, "{linear:?}");
    // The wheel's conicity rises with amplitude: the large cycle lives below the speed at which
    // small motions grow.
    assert!((0.0..15.0).contains(&(linear[1] - without)), "{linear:?} {without}");
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

/// Ride has no critical point in between: what a wider clearance does, it does towards having no
/// dampers.
#[test]
fn ride_tends_to_that_without_yaw_dampers() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    let procedure =
        ride::Procedure { seeds: vec![1, 2], section_s: 20.0, ..ride::Procedure::default() };
    let lateral = |clearance_2a_m: f64| {
        let wear = Setting::to("damper.clearance_2a_m", clearance_2a_m);
        let run = Run::load_with(&path, overrides, &[wear]).unwrap();
        let ride = Ride::of(&run, &Equipped::of(&run).unwrap(), &procedure).unwrap();
        ride.worst(|place| Some(place.lateral.sperling_1985?.mean)).unwrap()
    };
    // A clearance of a metre is never crossed.
    let without = lateral(1.0);
    let left = [0.2e-3, 4e-3, 8e-3, 16e-3].map(|clearance| (lateral(clearance) - without).abs());
    println!("without {without}, left at 0.2, 4, 8, 16 mm: {left:?}");
    assert!(left[0] > left[1] && left[1] > left[2] && left[2] > left[3], "{left:?}");
    assert!(left[3] < 0.02 * without, "{left:?}");
}
