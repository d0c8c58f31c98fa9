//! A rig whose node stands before a servo controller: the line closes before anything moves, and
//! opens for good where the ram is not seen any more.

use crate::locomotive_node::{Found, specimen, terms, together};
use crate::support::locomotive::{NODE, scenario};
use can_protocol::{Pace, Profile, RunState};
use firmware_core::damper::Damper;
use hil_host::Draw;
use nodes::locomotive::End;
use nodes::rig::{BLIND_CYCLES, Plant, RigNode, ServoBench, ServoRig, ServoSetup, Target};
use scenario::run::{CYCLE_S, Run};

/// Where the ram stands at the start (m): 3 mm out of the middle.
const START_M: f64 = 3e-3;

fn bench<'a>(run: &Run, damper: &'a Damper) -> ServoBench<'a> {
    let drive = [run.rig.stroke_m, run.rig.rate_m_per_s, run.rig.lag_s];
    ServoBench::new(damper, drive, START_M, CYCLE_S)
}

fn setup<'a>(run: &Run, servo: ServoBench<'a>) -> ServoSetup<ServoBench<'a>> {
    let (stroke_m, rate_m_per_s) = (run.rig.stroke_m, run.rig.rate_m_per_s);
    ServoSetup { servo, stroke_m, rate_m_per_s, seed: 1 }
}

type Rig<'a> = RigNode<ServoRig<ServoBench<'a>>, Draw>;

/// A session of a locomotive and a rig before this bench, to its end.
fn session<'a>(run: &Run, servo: ServoBench<'a>, pace: Pace) -> Found<ServoRig<ServoBench<'a>>> {
    let track = run.track.view();
    let line = hil_host::run::line(run, &track);
    let rig = Rig::new(&setup(run, servo), NODE, Profile::Classical);
    let state = line.start(run.start.state.clone());
    together(&line, state, terms(run, pace), rig, |_, _, _| true)
}

#[test]
fn a_locomotive_runs_with_a_rig_behind_a_servo_controller() {
    let run = scenario();
    let damper = specimen(&run);
    for pace in [Pace::LockStep, Pace::Clock] {
        let found = session(&run, bench(&run, &damper), pace);
        assert_eq!((found.end, found.stop), (End::Completed, None), "{pace:?}");
        assert_eq!(found.rig, RunState::Standby);
        // The session is over, so the drive has no power, and the ram stays where it stands.
        assert!(!found.physics.servo().is_closed());
    }
}

#[test]
fn a_rig_that_does_not_see_its_ram_any_more_loses_its_power_for_good() {
    let run = scenario();
    let damper = specimen(&run);
    let found = session(&run, bench(&run, &damper).blind_from(3000), Pace::LockStep);
    assert_eq!(found.end, End::Safe);
    assert_eq!(found.rig, RunState::Fault);
    assert!(!found.physics.servo().is_closed());
}

#[test]
fn a_drive_without_power_stands_and_one_that_goes_blind_is_known() {
    let run = scenario();
    let damper = specimen(&run);
    let setup = setup(&run, bench(&run, &damper).blind_from(200));
    let plant = ServoRig::new(&setup, CYCLE_S, 1);
    let mut state = plant.start_at(0.0);
    // A board moves no ram to begin with: where it is asked to start does not matter.
    for _ in 0..50 {
        plant.cycle(&mut state, Target::Centre);
    }
    assert_eq!(state.servo().ram_m(), START_M);
    assert!(plant.is_at_rest(&state));
    let mut lost_in = Vec::new();
    for cycle in 50..300 {
        plant.power(&mut state, true);
        plant.cycle(&mut state, Target::Centre);
        assert_eq!(plant.is_measured(&state), cycle < 199, "{cycle}");
        if plant.has_lost_power(&state) {
            lost_in.push(cycle);
        }
    }
    assert!(state.servo().ram_m() < START_M, "it went towards the middle");
    assert_eq!(lost_in, [199 + u64::from(BLIND_CYCLES) - 1]);
}
