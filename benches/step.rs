//! One 1 ms step of the whole locomotive, per creep law.

use criterion::{Criterion, criterion_group, criterion_main};
use firmware_core::damper::Damper;
use firmware_core::guard::ForceInput;
use firmware_core::line::Slot;
use firmware_core::wheel_rail::creep::{CreepLaw, Fastsim};
use scenario::run::{CYCLE_S, Overrides, Run};
use std::hint::black_box;
use std::path::Path;

fn step(criterion: &mut Criterion) {
    let path = Path::new("scenarios/ss9-160kmh.toml");
    let run = match Run::load(path, Overrides { duration_s: Some(60.0), ..Overrides::default() }) {
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
        let mut line = hil_host::run::line(&run, &track);
        line.vehicle = &vehicle;
        // All four modelled: the rig's slot gets the rig's damper.
        for slot in &mut line.slots {
            if let Slot::Rig(_) = slot {
                *slot = Slot::Modelled(damper.clone());
            }
        }
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
