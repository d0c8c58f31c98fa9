//! One 1 ms step of the whole locomotive, per creep law.

use criterion::{Criterion, criterion_group, criterion_main};
use firmware_core::damper::Damper;
use firmware_core::guard::{ForceInput, Guard};
use firmware_core::line::{Line, Slot};
use firmware_core::wheel_rail::creep::{CreepLaw, Fastsim};
use scenario::run::{CYCLE_S, Overrides, Run, SlotForce};
use std::hint::black_box;
use std::path::Path;

fn step(criterion: &mut Criterion) {
    let path = Path::new("scenarios/ss9-160kmh.toml");
    let run = match Run::load(path, Overrides { duration_s: Some(60.0), speed_kmh: None }) {
        Ok(run) => run,
        Err(error) => panic!("{error}"),
    };
    let mut laws =
        vec![("linear_saturated", CreepLaw::LinearSaturated), ("polach", CreepLaw::Polach)];
    if let Some(grid) = Fastsim::new(10, 10) {
        laws.push(("fastsim 10x10", CreepLaw::Fastsim(grid)));
    }
    let track = run.track.view();
    let substep_s = CYCLE_S / f64::from(run.substeps);
    let damper: Damper = run.rig.damper.clone().prepared(substep_s);
    for (name, law) in laws {
        let mut vehicle = run.vehicle.clone();
        for axle in &mut vehicle.axles {
            axle.wheel.creep = law;
        }
        let modelled = |place: &scenario::run::Slot| match &place.force {
            SlotForce::Modelled(damper) => Slot::Modelled(damper.clone().prepared(substep_s)),
            SlotForce::Rig { .. } => Slot::Modelled(damper.clone()),
        };
        let mut slots = [const { Slot::Empty }; 4];
        for (slot, place) in slots.iter_mut().zip(&run.slots) {
            *slot = modelled(place);
        }
        let line = Line {
            vehicle: &vehicle,
            track: &track,
            contact: run.contact.as_ref().map(|contact| &*contact.table),
            speed_m_per_s: run.speed_m_per_s,
            cycle_s: CYCLE_S,
            substeps: run.substeps,
            slots,
            guard: Guard::default(),
        };
        let start = line.start(run.start.state.clone());
        let mut state = start.clone();
        for _ in 0..3000 {
            line.step(&mut state, &[ForceInput::Missing; 4]);
        }
        criterion.bench_function(&format!("1 ms step, {name}"), |bencher| {
            bencher.iter(|| {
                line.step(black_box(&mut state), &[ForceInput::Missing; 4]);
                // Stay on the track that has irregularity.
                if state.cycle > 55_000 {
                    state = start.clone();
                }
            });
        });
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
