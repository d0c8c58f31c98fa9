//! The same scenario gives the same bits: twice, in debug and in release, and after a snapshot.

use crate::support::session::{cycles, ready, scenario, session};
use crate::support::whole_run::run_through;
use hil_host::control::End;
use hil_host::record::Queues;
use scenario::irregularity::Stretches;
use scenario::run::Run;

/// Hash of 3 s of `ss9-160kmh.toml` and their ramps. It changes with the physics and with nothing
/// else: not with the build profile, the processor or the load of the machine. After a change of
/// the physics put the number of the failure message here, and say in the commit what changed.
const GOLDEN_160_KMH: u64 = 0xe890_4e96_e608_e82c;

#[test]
fn a_scenario_gives_its_known_hash_twice() {
    let run = scenario("ss9-160kmh.toml", 3.0);
    let first = run_through(&run);
    assert_eq!(first, run_through(&run));
    assert_eq!(first.0, End::Completed);
    assert_eq!(first.1, GOLDEN_160_KMH, "trajectory hash {:#018x}", first.1);
}

#[test]
fn a_track_in_stretches_gives_the_hash_of_a_track_in_one_piece() {
    let whole = scenario("ss9-160kmh.toml", 3.0);
    let cut = whole.clone().in_stretches_of(1024);
    let count = |run: &Run| run.stretches.as_ref().map(Stretches::count);
    assert_eq!((count(&whole), count(&cut)), (Some(1), Some(10)));
    assert_eq!(run_through(&cut), run_through(&whole));
}

#[test]
fn a_snapshot_in_the_middle_continues_to_the_same_bits() {
    let run = scenario("ss9-one-worn-of-four.toml", 1.0);
    let track = run.track.view();
    let session = session(&run, &track);
    let (mut state, mut buses) = ready(&run, &session);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    cycles(&session, &mut state, &mut buses, &mut recorder, 400);
    let snapshot = (state.clone(), buses.clone());
    cycles(&session, &mut state, &mut buses, &mut recorder, 300);
    let (mut again, mut buses_again) = snapshot;
    assert_ne!(again, state);
    cycles(&session, &mut again, &mut buses_again, &mut recorder, 300);
    assert_eq!(again.hash, state.hash);
    assert_eq!(again, state);
    assert_eq!(buses_again, buses);
}

#[test]
fn another_seed_of_the_track_is_another_trajectory() {
    let run = scenario("ss9-160kmh.toml", 0.5);
    let mut other = run.clone();
    for sample in &mut other.track.samples.samples {
        sample.alignment_m = -sample.alignment_m;
    }
    assert_ne!(run_through(&run).1, run_through(&other).1);
}
