//! The bits of every scenario, creep law and damper effect, against `tests/golden.toml`.
//!
//! A hash changes with the physics and with nothing else: not with the layout of the code, the
//! build profile, the processor or the load of the machine. After a change of the physics, print
//! the new table with `YAWBENCH_PRINT_GOLDEN=1 cargo test --test system golden -- --nocapture`, put
//! it into the file, and say in the commit what changed.

use crate::support::session::scenario;
use crate::support::whole_run::run_through;
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};
use firmware_core::fnv;
use firmware_core::wheel_rail::creep::{ConicalPrescribed, CreepLaw, Creepage, Fastsim, Patch};
use hil_host::control::End;
use scenario::run::Run;
use std::collections::BTreeMap;
use std::path::Path;

/// Groups of named hashes, as the file has them.
type Golden = BTreeMap<String, BTreeMap<String, String>>;

fn hash(values: impl IntoIterator<Item = f64>) -> String {
    let hash = values.into_iter().fold(fnv::START, |hash, value| fnv::add(hash, value.to_bits()));
    format!("{hash:016x}")
}

/// The trajectory of every scenario, over its whole duration; `change` may change it first.
fn scenarios(change: impl Fn(&mut Run)) -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    files
        .map(|path| {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            let mut run = scenario(&name, None);
            change(&mut run);
            let (end, hash) = run_through(&run);
            assert_eq!(end, End::Completed, "{name}");
            (path.file_stem().unwrap().to_str().unwrap().to_owned(), format!("{hash:016x}"))
        })
        .collect()
}

fn without_ramps(run: &mut Run) {
    run.motion.ramp_cycles = 0;
    run.motion.velocity_m_per_s = f64::INFINITY;
    run.motion.acceleration_m_per_s2 = f64::INFINITY;
}

/// Each creep law over a grid of creepages that reaches from pure creep into full sliding.
fn creep_laws() -> BTreeMap<String, String> {
    let patch = Patch {
        normal_n: 110e3,
        along_m: 7e-3,
        across_m: 5e-3,
        c11: 4.6,
        c22: 4.2,
        c23: 2.1,
        shear_modulus_pa: 8.0e10,
        friction: 0.3,
    };
    let prescribed = ConicalPrescribed { shear_force_n: 8.8e6, psi: 0.54, phi: 0.6 };
    let laws = [
        ("linear_saturated", CreepLaw::LinearSaturated),
        ("polach", CreepLaw::Polach),
        ("fastsim", CreepLaw::Fastsim(Fastsim::new(10, 10).unwrap())),
        ("conical_prescribed", CreepLaw::ConicalPrescribed(prescribed)),
    ];
    let steps = [-1e-2, -2e-3, -3e-4, 0.0, 1e-4, 1e-3, 2e-2];
    laws.into_iter()
        .map(|(name, law)| {
            let mut forces = Vec::new();
            for longitudinal in steps {
                for lateral in steps {
                    for spin_per_m in [-0.5, 0.0, 0.1] {
                        let force =
                            law.force(&patch, Creepage { longitudinal, lateral, spin_per_m });
                        forces.extend([
                            force.longitudinal_n,
                            force.lateral_n,
                            force.spin_moment_n_m,
                        ]);
                    }
                }
            }
            (name.to_owned(), hash(forces))
        })
        .collect()
}

/// Each effect alone at its usual size, for two seconds of two sines of 1.5 and 7 Hz.
fn effects() -> BTreeMap<String, String> {
    let force = |effects: &[Effect]| {
        let step_s = 1e-3;
        let damper = Damper::new(Nominal::NEW, effects).unwrap().prepared(step_s);
        let motion = |step: u32| {
            let at_s = f64::from(step) * step_s;
            let sine = |size_m: f64, hz: f64| {
                let omega = 2.0 * core::f64::consts::PI * hz;
                let (sin, cos) = libm::sincos(omega * at_s);
                (size_m * sin, size_m * omega * cos)
            };
            let (slow, fast) = (sine(8e-3, 1.5), sine(0.8e-3, 7.0));
            Motion::new(slow.0 + fast.0, slow.1 + fast.1)
        };
        let mut state = DamperState::starting(motion(0));
        let forces = (1..=2000).map(|step| damper.advance(&mut state, motion(step), step_s));
        hash(forces.collect::<Vec<_>>())
    };
    let scale = Nominal::NEW.scale();
    let mut table: BTreeMap<String, String> = CATALOGUE
        .iter()
        .map(|info| {
            let usual: Vec<f64> = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            (info.name.to_owned(), force(&[Effect::from_values(info.name, &usual).unwrap()]))
        })
        .collect();
    table.insert("none".into(), force(&[]));
    table
}

#[test]
fn every_scenario_creep_law_and_effect_gives_its_known_bits() {
    let now: Golden = [
        ("creep_law".to_owned(), creep_laws()),
        ("effect".to_owned(), effects()),
        ("scenario".to_owned(), scenarios(|_| {})),
        // From a ram at its start, without ramps and limits: the bits from before there were any.
        ("scenario_without_ramps".to_owned(), scenarios(without_ramps)),
    ]
    .into();
    let text = toml::to_string(&now).unwrap();
    if std::env::var_os("YAWBENCH_PRINT_GOLDEN").is_some() {
        println!("{text}");
    }
    let known: Golden = toml::from_str(include_str!("../golden.toml")).unwrap();
    for (group, hashes) in &now {
        for (name, hash) in hashes {
            assert_eq!(
                Some(hash),
                known.get(group).and_then(|all| all.get(name)),
                "{group} {name}"
            );
        }
    }
    assert_eq!(now, known, "tests/golden.toml names what is not there");
    let effects = &now["effect"];
    for (name, hash) in effects {
        let same = effects.iter().filter(|(_, other)| *other == hash).count();
        assert_eq!(same, 1, "{name} has the bits of another: it does nothing here");
    }
}
