//! A flag ends trips, points and sets of points within a fraction of a second of simulated time.

use crate::support::{GO, bogie, linear};
use firmware_core::track::Track;
use scenario::run::{Overrides, Run};
use signal::shards::{self, Shard, Work};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use vehicle_studies::StudyError;
use vehicle_studies::critical_speed::Ascent;
use vehicle_studies::critical_speed::Fold;
use vehicle_studies::critical_speed::LinearSpeed;
use vehicle_studies::critical_speed::Procedure;
use vehicle_studies::trip::{Equipped, Trip};

/// Most cycles of 1 ms that a trip does after its flag is set.
const CYCLES_MAX: usize = 256;

fn bogie_run(place: &Path) -> Run {
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    Run::load(&place.join("bogie.toml"), overrides).unwrap()
}

#[test]
fn a_flag_ends_a_trip_of_an_hour_within_256_cycles() {
    let place = bogie("stopped-trip");
    let run = bogie_run(&place);
    let stop = AtomicBool::new(false);
    let equipped = Equipped::of(&run).unwrap().until(&stop);
    let track = Track::default();
    let trip = Trip::new(&equipped, &track, 60.0, 2);
    let mut state = trip.begin(&[]).unwrap();
    let mut cycles = 0;
    let ended = trip.go(&mut state, 3600.0, |_| {
        cycles += 1;
        stop.store(cycles >= 1000, Ordering::Relaxed);
    });
    assert!(matches!(ended, Err(StudyError::Stopped)), "{ended:?}");
    assert!((1000..=1000 + CYCLES_MAX).contains(&cycles), "{cycles}");
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn critical_speeds_end_without_an_answer_when_the_flag_is_set() {
    let place = bogie("stopped-speeds");
    let run = bogie_run(&place);
    let set = AtomicBool::new(true);
    let equipped = Equipped::of(&run).unwrap().until(&set);
    let procedure = Procedure::default();
    assert!(matches!(Ascent::of(&equipped, &procedure), Err(StudyError::Stopped)));
    assert!(matches!(Fold::of(&equipped, &procedure), Err(StudyError::Stopped)));
    assert!(matches!(LinearSpeed::of(&equipped, &procedure, 1e-3), Err(StudyError::Stopped)));
    assert_eq!(equipped.pace(), None);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_stopped_point_is_no_answer_and_is_computed_when_the_study_goes_on() {
    let place = bogie("stopped-point");
    let asked = linear(&place);
    let identity = asked.identity().unwrap();
    let stop = AtomicBool::new(false);
    let work = Work { items: 1, name: asked.name(&identity), identity: &identity };
    let (mut folder, _) = files::ResultFolder::for_identity(
        Some(&place.join("study")),
        "critical-speed",
        "critical-speed",
        &identity,
    )
    .unwrap();
    folder.create().unwrap();
    let begun = AtomicUsize::new(0);
    // The flag is set while the point is at work.
    let point = |index| {
        begun.fetch_add(1, Ordering::Relaxed);
        stop.store(true, Ordering::Relaxed);
        asked.point(&identity, index, &stop)
    };
    let stopped = shards::run(&work, Shard::WHOLE, &folder, &stop, &point, &|_, _, _| {}).unwrap();
    assert!(stopped.is_stopped() && stopped.done == 0, "{stopped:?}");
    assert_eq!(begun.load(Ordering::Relaxed), 1);
    let point = |index| asked.point(&identity, index, &GO);
    let whole = shards::run(&work, Shard::WHOLE, &folder, &GO, &point, &|_, _, _| {}).unwrap();
    assert_eq!((whole.done, whole.of), (1, 1));
    std::fs::remove_dir_all(&place).unwrap();
}
