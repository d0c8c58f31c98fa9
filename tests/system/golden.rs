//! The bits of every scenario, creep law, damper effect and vehicle, against `tests/golden.toml`.
//!
//! A hash changes with the physics and with nothing else: not with the layout of the code, the
//! build profile, the processor or the load of the machine. `cargo xtask bits` compares those that
//! need no bench in builds for other processors, a release build the rest. After a change of the
//! physics, print the new table with
//! `YAWBENCH_PRINT_GOLDEN=1 cargo test --test system golden -- --nocapture`, put it into the file,
//! and say in the commit what changed.

use crate::support::bits;
use crate::support::session::scenario;
use crate::support::whole_run::run_through;
use hil_host::control::End;
use scenario::run::Run;
use std::collections::BTreeMap;
use std::path::Path;

/// Groups of named hashes, as the file has them.
type Golden = BTreeMap<String, BTreeMap<String, String>>;

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

#[test]
fn every_scenario_creep_law_and_effect_gives_its_known_bits() {
    let now: Golden = [
        ("creep_law".to_owned(), bits::creep_laws()),
        ("effect".to_owned(), bits::effects()),
        ("scenario".to_owned(), scenarios(|_| {})),
        // From a ram at its start, without ramps and limits: the bits from before there were any.
        ("scenario_without_ramps".to_owned(), scenarios(without_ramps)),
        ("vehicle".to_owned(), bits::vehicles(Path::new(env!("CARGO_MANIFEST_DIR")))),
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
