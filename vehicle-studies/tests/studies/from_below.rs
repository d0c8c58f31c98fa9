//! Critical speeds from below, on a damper for which eigenvalues are exact.

use firmware_core::damper::{Damper, Nominal};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::rig::RigSetup;
use scenario::run::{Overrides, Run};
use std::path::Path;
use vehicle_studies::critical_speed::{LinearSpeed, Procedure};
use vehicle_studies::trip::{Equipped, Rigs};
use vehicle_studies::yaw_damper_problem::{Climb, DataSheet, FromBelow, Ours, Release};

/// Dead time of the rigs (cycles of 1 ms).
const DEAD_TIME: u16 = 5;

#[test]
fn the_interval_holds_the_speed_of_eigenvalues_and_the_ram_never_hunts() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    let run = Run::load(&path, overrides).unwrap();
    let equipped = Equipped::of(&run).unwrap();
    // No clearance, and a relief valve that stays shut.
    let nominal = Nominal {
        clearance_2a_m: 0.0,
        f_relief_n: 1e9,
        ..*equipped.dampers.first().unwrap().nominal()
    };
    let maxwell = Damper::new(nominal, &[]).unwrap();
    let equipped = equipped.with(&maxwell);
    let procedure = Procedure { from_kmh: 340.0, to_kmh: 420.0, ..Procedure::default() };
    let linear = LinearSpeed::of(&equipped, &procedure, 1e-3).unwrap();
    let linear_kmh = linear.critical.kmh().unwrap();
    let release = Release {
        burst_m: 0.4e-3,
        burst_hz: 3.8,
        window_m: [0.02e-3, 0.2e-3],
        watched_s: 8.0,
        stroke_limit_m: 2e-3,
    };
    let climb = Climb { from_kmh: 320.0, step_kmh: 5.0, margin: 0.03, release };
    let modelled = FromBelow::of(&equipped, climb).unwrap();
    let rig = RigSetup { delay_cycles: DEAD_TIME, damper: maxwell, ..run.rig.clone() };
    let sheet = DataSheet::of(&rig);
    let dead_time_s = 1e-3 * f64::from(DEAD_TIME);
    let compensator = Ours::Inverse.compensator(&sheet, dead_time_s, 3.8);
    let rigs = Rigs::compensated(&rig, compensator, [true; DAMPER_SLOTS]);
    let on_rigs = FromBelow::of(&equipped.behind(rigs), climb).unwrap();
    println!("eigenvalues {linear_kmh} km/h\nmodelled {modelled:?}\non rigs {on_rigs:?}");
    for found in [modelled, on_rigs] {
        let [low, high] = found.interval_kmh;
        assert!(low.unwrap() <= linear_kmh, "{low:?} {linear_kmh}");
        assert!(high.is_none_or(|high| high >= linear_kmh), "{high:?} {linear_kmh}");
        let critical_kmh = found.critical_kmh.unwrap();
        assert!((critical_kmh / linear_kmh - 1.0).abs() < 0.06, "{critical_kmh} {linear_kmh}");
        assert!(found.largest_stroke_m < release.stroke_limit_m, "{found:?}");
        assert!(found.ring_downs.iter().all(|one| one.decay_per_s > 0.0), "{found:?}");
        // The highest speed stays below what is extrapolated.
        let top_kmh = found.ring_downs.last().unwrap().kmh;
        assert!(top_kmh < critical_kmh, "{top_kmh} {critical_kmh}");
    }
}
