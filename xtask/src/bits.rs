//! The golden hashes in builds other than that of the tests: for processors with AVX2, where four
//! wheels share one register, and in release. The example `bits` of `scenario` compares them.

use std::process::Command;

use crate::run::{Outcome, Run};

/// The processors that builds for AVX2 are for.
pub(crate) const AVX2: &str = "x86-64-v3";

/// Has cargo build for a kind of processor.
pub(crate) fn for_processor(run: &Run, cargo: &mut Command, processor: &str) {
    cargo.env("RUSTFLAGS", format!("-C target-cpu={processor}"));
    // Other flags in the same folder would make cargo build all anew, each time.
    cargo.env("CARGO_TARGET_DIR", run.target.join(processor));
}

/// Compares them in a build for AVX2, on a processor that has it.
pub(crate) fn with_avx2(run: &mut Run) -> Outcome {
    if !has_avx2() {
        return Outcome::Skipped(format!("this processor does not run builds for {AVX2}"));
    }
    let mut cargo = run.cargo();
    cargo.args(["run", "--quiet", "-p", "scenario", "--example", "bits"]);
    for_processor(run, &mut cargo, AVX2);
    run.checked(&mut cargo)
}

/// Compares them in a release build.
pub(crate) fn in_release(run: &mut Run) -> Outcome {
    let mut cargo = run.cargo();
    cargo.args(["run", "--quiet", "--release", "-p", "scenario", "--example", "bits"]);
    run.checked(&mut cargo)
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    // What x86-64-v3 asks for, as far as a compiler makes use of it.
    std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("lzcnt")
        && std::arch::is_x86_feature_detected!("movbe")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx2() -> bool {
    false
}
