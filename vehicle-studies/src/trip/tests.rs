//! What the signals of a trip owe each other.

use super::leg::{self, Traveller};
use super::signals::{Places, Recorder, Signals, Wheels};
use super::{Equipped, Trip};
use firmware_core::vehicle::{GRAVITY_M_PER_S2, LATERAL};
use scenario::irregularity::{Band, aar6};
use scenario::run::{Overrides, Run};
use scenario::setting::Setting;
use scenario::track::OwnedTrack;
use std::path::Path;

fn locomotive(settings: &[Setting]) -> Run {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
    Run::load_with(&path, overrides, settings).unwrap()
}

fn rough(scale: f64) -> OwnedTrack {
    let band = Band { seed: 1, shortest: 1.0, longest: 100.0, scale };
    OwnedTrack { samples: aar6(&band, 0.0, 400.0), ..OwnedTrack::default() }
}

fn signals(run: &Run, track: &OwnedTrack, duration_s: f64) -> Signals {
    let equipped = Equipped::of(run).unwrap();
    let track = track.view();
    let trip = Trip::new(&equipped, &track, run.speed_m_per_s, run.substeps);
    let mut state = trip.begin(&[]).unwrap();
    Signals::of(&trip, &mut state, duration_s, &Places::of(run, 1.25), Wheels::Recorded).unwrap()
}

#[test]
fn wheels_carry_the_vehicle_and_lose_what_their_creepages_say() {
    let run = locomotive(&[]);
    let found = signals(&run, &rough(0.3), 6.0);
    assert!(!found.derailed && found.len() == 6000);
    let names: Vec<&str> = found.floor.iter().map(|place| place.name.as_str()).collect();
    assert_eq!(
        names,
        ["floor above bogie_front", "floor above bogie_rear", "floor above the middle"]
    );
    assert_eq!((found.bogies.len(), found.wheelsets.len(), found.dampers.len()), (2, 6, 4));
    let mass_kg: f64 = run.vehicle.bodies.iter().map(|body| body.mass_kg).sum();
    let wheels = || found.wheelsets.iter().flat_map(|wheelset| &wheelset.wheels);
    let mean = |values: &[f64]| signal::statistics::mean(values);
    let carried_n: f64 = wheels().map(|wheel| mean(&wheel.q_n)).sum();
    assert!((carried_n / (mass_kg * GRAVITY_M_PER_S2) - 1.0).abs() < 2e-3, "{carried_n}");
    for wheel in wheels() {
        for at in (0..found.len()).step_by(97) {
            // On gentle straight track the tread carries alone: one patch, so that sums and
            // creepages belong together.
            let t_gamma_n = -wheel.creep_longitudinal_n[at] * wheel.longitudinal_creepage[at]
                - wheel.creep_lateral_n[at] * wheel.lateral_creepage[at];
            assert!((t_gamma_n - wheel.t_gamma_n[at]).abs() < 1e-9, "{t_gamma_n}");
            let spin_w = -run.speed_m_per_s * wheel.spin_moment_n_m[at] * wheel.spin_per_m[at];
            let power_w = run.speed_m_per_s * t_gamma_n + spin_w;
            assert!((power_w - wheel.wear_w[at]).abs() < 1e-6, "{power_w}");
        }
    }
}

#[test]
fn the_middle_of_a_rigid_floor_moves_as_the_mean_of_its_ends() {
    let found = signals(&locomotive(&[]), &rough(1.0), 4.0);
    let [front, rear, middle] = &found.floor[..] else { panic!("{}", found.floor.len()) };
    let strongest = signal::statistics::rms(&front.lateral_m_per_s2[2500..]);
    assert!(strongest > 0.01, "{strongest}");
    let halfway = |[a, b, c]: [&[f64]; 3]| {
        (0..found.len()).all(|at| (0.5 * (a[at] + b[at]) - c[at]).abs() < 1e-12)
    };
    assert!(halfway([front, rear, middle].map(|place| place.lateral_m_per_s2.as_slice())));
    assert!(halfway([front, rear, middle].map(|place| place.vertical_m_per_s2.as_slice())));
}

#[test]
fn a_clearance_of_a_metre_takes_the_dampers_off() {
    let off = Setting::to("damper.clearance_2a_m", 1.0);
    let run = locomotive(&[off]);
    let found = signals(&run, &rough(1.0), 4.0);
    for damper in &found.dampers {
        assert!(damper.force_n.iter().all(|force_n| *force_n == 0.0));
        assert!(signal::statistics::rms(&damper.extension_m) > 1e-5);
    }
}

/// Trips of a batch: at their own speeds on their own tracks, one of which ends sooner, and one
/// vehicle that is thrown off the track.
#[test]
fn a_trip_in_a_batch_is_the_very_trip_that_runs_alone() {
    for wheels in [Wheels::LeftOut, Wheels::Recorded] {
        batch_and_alone(wheels);
    }
}

fn batch_and_alone(wheels: Wheels) {
    let clearances_m = [0.2e-3, 2e-3, 8e-3, 1e-3];
    let settings = clearances_m.map(|m| [Setting::to("damper.clearance_2a_m", m)]);
    let runs: Vec<Run> = settings.iter().map(|own| locomotive(own)).collect();
    let tracks = [1.0, 0.5, 0.0, 1.0].map(rough);
    let views = tracks.each_ref().map(OwnedTrack::view);
    let equipped: Vec<_> = runs.iter().map(|run| Equipped::of(run).unwrap()).collect();
    let cycles = [1500, 700, 1500, 1500];
    let (mut batch, mut alone) = (Vec::new(), Vec::new());
    for (n, kmh) in [200.0, 260.0, 320.0, 250.0].into_iter().enumerate() {
        let trip = Trip::new(&equipped[n], &views[n], kmh / 3.6, 2);
        let mut state = trip.begin(&[]).unwrap();
        if n == 3 {
            state.line.vehicle.half_velocity[0][LATERAL].0[0] = 40.0;
        }
        let contact = equipped[n].contact.as_ref().map(|contact| &contact.table);
        let recorder = Recorder::of(trip.vehicle(), Places::of(&runs[n], 1.25), wheels);
        let mut own = Some(recorder.clone());
        let traveller =
            Traveller::of(&trip.line, contact, &state.line, cycles[n], Some(recorder)).unwrap();
        batch.push(Box::new(traveller));
        let stays = trip.record(&mut state, 1e-3 * cycles[n] as f64, &mut own).unwrap();
        assert_eq!(stays, n != 3);
        alone.push((state.line, own.unwrap().signals));
    }
    assert!(batch.iter().all(|trip| batch[0].can_join(trip)));
    // The others go on in a batch of three, which repeats one of them, then two take turns.
    while !batch.iter().all(|trip| trip.has_ended()) {
        let (mut open, ended): (Vec<_>, Vec<_>) =
            batch.into_iter().partition(|trip| !trip.has_ended());
        leg::run(&mut open);
        batch = ended.into_iter().chain(open).collect();
    }
    for (line, signals) in alone {
        let own =
            batch.iter().find(|trip| trip.state.vehicle.distance_m == line.vehicle.distance_m);
        let own = own.unwrap();
        let mut state = own.state.clone();
        if state.is_safe() {
            // Nobody looks at the wheel forces of a vehicle that has left the track.
            state.vehicle.wheels = line.vehicle.wheels;
        }
        assert!(state == line, "{state:?} {line:?}");
        let recorded = &own.recorder.as_ref().unwrap().signals;
        assert!(*recorded == signals);
        assert_eq!(own.state.is_safe(), own.left > 0);
    }
}
