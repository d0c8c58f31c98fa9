//! `cargo xtask miri`: unit tests of the protocol and of the guard in an interpreter that finds
//! undefined behaviour: reads out of bounds, overflow of pointers, values that no type has.
//!
//! It needs a nightly toolchain with the component miri, which nobody has to have.

use std::process::Command;

use crate::run::{Outcome, Run};

/// What is interpreted: package, and the tests of it by what their names hold.
const TESTS: [[&str; 2]; 2] = [["can-protocol", ""], ["firmware-core", "guard"]];

/// Runs them; skipped without the interpreter.
pub(crate) fn test(run: &mut Run) -> Outcome {
    let mut version = Command::new("cargo");
    version.args(["+nightly", "miri", "--version"]).current_dir(&run.root);
    let has_miri = version.output().is_ok_and(|output| output.status.success());
    if !has_miri {
        let how = "rustup component add miri rust-src --toolchain nightly";
        return Outcome::Skipped(format!("no nightly toolchain with miri here ({how})"));
    }
    let mut all = Outcome::Passed;
    for [package, filter] in TESTS {
        let mut cargo = Command::new("cargo");
        cargo.args(["+nightly", "miri", "test", "-p", package, "--lib", filter]);
        cargo.current_dir(&run.root).env("CARGO_TARGET_DIR", run.target.join("miri"));
        // Property tests draw fewer cases: each takes a thousand times as long.
        cargo.env("PROPTEST_CASES", "8").env("MIRIFLAGS", "-Zmiri-disable-isolation");
        all = all.and(run.checked(&mut cargo));
    }
    all
}
