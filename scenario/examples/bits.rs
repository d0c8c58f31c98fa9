//! Whether this build gives the bits of `tests/golden.toml`, as far as no bench is needed for them:
//! creep laws, effects of dampers, vehicles alone and side by side. `cargo xtask bits` runs it in a
//! build for processors with AVX2, `cargo xtask test` in a release build.

#![allow(clippy::unwrap_used, reason = "as loud as a test")]

#[path = "../../tests/support/bits.rs"]
mod bits;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let text = std::fs::read_to_string(root.join("tests/golden.toml")).unwrap();
    let golden: BTreeMap<String, BTreeMap<String, String>> = toml::from_str(&text).unwrap();
    let now = [
        ("creep_law", bits::creep_laws()),
        ("effect", bits::effects()),
        ("vehicle", bits::vehicles(root)),
    ];
    let (mut same, mut differs) = (0, 0);
    for (group, hashes) in now {
        for (name, hash) in hashes {
            let known = golden.get(group).and_then(|all| all.get(&name));
            if known == Some(&hash) {
                same += 1;
            } else {
                differs += 1;
                println!("{group} {name}: {hash}, in tests/golden.toml {known:?}");
            }
        }
    }
    let avx2 = if cfg!(target_feature = "avx2") { "with" } else { "without" };
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    println!("{profile} build {avx2} AVX2: {same} golden hashes are the same, {differs} differ");
    if differs == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
