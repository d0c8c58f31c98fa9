//! The damper element at the step of a vehicle.

use criterion::{Criterion, criterion_group, criterion_main};
use firmware_core::damper::effects::{CATALOGUE, Effect};
use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
use std::hint::black_box;

const STEP_S: f64 = 0.25e-3;

fn advance(criterion: &mut Criterion) {
    let scale = Nominal::NEW.scale();
    let effects: Vec<Effect> = CATALOGUE
        .iter()
        .filter_map(|info| {
            let usual: Vec<f64> = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            Effect::from_values(info.name, &usual).ok()
        })
        .collect();
    let mut cases = vec![("nominal".to_owned(), Vec::new())];
    for effect in &effects {
        cases.push((effect.name().to_owned(), vec![*effect]));
    }
    // The longest laws, joined anew in every step.
    let long = ["quadratic_orifice", "orifice_leakage", "stiffening_attachment", "entrained_air"];
    let slow = "stroke_dependent_stiffness";
    let chosen = |effect: &&Effect| long.contains(&effect.name()) || effect.name() == slow;
    cases.push(("longest laws".to_owned(), effects.iter().filter(chosen).copied().collect()));
    for (name, effects) in cases {
        let damper = match Damper::new(Nominal::NEW, &effects) {
            Ok(damper) => damper.prepared(STEP_S),
            Err(error) => panic!("{name}: {error}"),
        };
        let omega = core::f64::consts::TAU * 3.5;
        let motion: Vec<Motion> = (0..8000)
            .map(|k| {
                let (sin, cos) = libm::sincos(omega * f64::from(k) * STEP_S);
                Motion::new(3.46e-3 * sin, 3.46e-3 * omega * cos)
            })
            .collect();
        let mut state = DamperState::rest();
        let mut next = motion.iter().cycle();
        criterion.bench_function(&format!("damper advance, {name}"), |bencher| {
            bencher.iter(|| {
                let motion = next.next().copied().unwrap_or_default();
                damper.advance(black_box(&mut state), motion, STEP_S)
            });
        });
    }
}

criterion_group!(benches, advance);
criterion_main!(benches);
