//! Every effect, and every pair, at 1 ms against an independent integration at 1 microsecond.

mod damper_reference;

use damper_reference::{EXCITATIONS, Reference, effects_at, relative_error, simulate};
use firmware_core::damper::{Damper, Effect, Nominal};

/// The promise of the design: 0.05 % of rms force at 1 ms.
const PROMISE: f64 = 5e-4;

fn combinations(effects: &[Effect]) -> Vec<Vec<Effect>> {
    let mut all = vec![vec![]];
    for (i, &a) in effects.iter().enumerate() {
        all.push(vec![a]);
        all.extend(effects[i + 1..].iter().map(|&b| vec![a, b]));
    }
    all.push(effects.to_vec());
    all
}

fn check(label: &str, nominal: Nominal, effects: &[Effect]) {
    for effects in combinations(effects) {
        let names: Vec<_> = effects.iter().map(Effect::name).collect();
        let damper = Damper::new(nominal, &effects).unwrap().prepared(1e-3);
        for excitation in &EXCITATIONS {
            let reference = Reference::new(nominal, &effects).forces(excitation, 1000);
            let error = relative_error(&simulate(&damper, excitation, 1000), &reference);
            println!("{label:12} {:16} {:.5} %  {names:?}", excitation.name, 100.0 * error);
            assert!(error < PROMISE, "{label}, {}, {names:?}: {error}", excitation.name);
        }
    }
}

#[test]
fn new_damper() {
    check("new", Nominal::NEW, &effects_at(&Nominal::NEW, 1.0));
}

#[test]
fn worn_damper_with_large_effects() {
    let nominal = Nominal { clearance_2a_m: 0.6e-3, ke_n_per_m: 9e6, ..Nominal::NEW };
    check("worn, x3", nominal, &effects_at(&nominal, 3.0));
}

#[test]
fn nearly_capped_relief() {
    let nominal =
        Nominal { f_relief_n: 15e3, c2_n_s_per_m: 5e3, clearance_2a_m: 0.5e-3, ..Nominal::NEW };
    check("C2 = 5 kN s/m", nominal, &effects_at(&nominal, 1.0));
}
