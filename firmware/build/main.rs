//! What the host knows goes into flash: the set-up of a scenario as constants, and the hashes that
//! the same runs have here.

mod expected;
mod literal;
mod setup;

use scenario::run::{Overrides, Run};
use std::fs;
use std::path::{Path, PathBuf};

/// The scenario of the images.
const SCENARIO: &str = "../scenarios/ss9-160kmh.toml";

/// Track in flash, as run time (s): 10,000 steps and some reserve.
const TRACK_S: f64 = 10.5;

fn main() {
    let root = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    let out = PathBuf::from(variable("OUT_DIR"));
    for input in ["memory.x", "build", "../scenarios"] {
        println!("cargo::rerun-if-changed={input}");
    }
    println!("cargo::rustc-link-search={}", root.display());
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // The start is rounded up to pages otherwise, which flash has none of.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    let overrides = Overrides { duration_s: Some(TRACK_S), ..Overrides::default() };
    let run = Run::load(&root.join(SCENARIO), overrides).unwrap_or_else(|e| panic!("{e}"));
    write(&out.join("setup.rs"), &setup::source(&run));
    write(&out.join("expected.rs"), &expected::source(&run));
}

fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn write(path: &Path, text: &str) {
    fs::write(path, text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
