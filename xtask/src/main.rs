//! The project's own tasks, so that one command checks what CI checks.
//!
//! ```text
//! cargo xtask test       everything: format, lints, tests, docs, the firmware build, CAN
//! cargo xtask ci         the same
//! cargo xtask ci --full  that, tests of minutes, golden hashes of other builds, and hours of
//!                        faults, sound rigs and killed runs: under 85 minutes
//! cargo xtask firmware   the no_std crates for a Cortex-M7: that they cannot panic there, and in
//!                        QEMU that they have the host's bits; `--full` for 10,000 steps,
//!                        `--table` for the kinds of instructions in a step
//! cargo xtask vcan       the tests over SocketCAN; a round trip next to that of an echo pair in C
//! cargo xtask power-cut  kills an emulated machine that records, and reads what is on its disk
//! cargo xtask bench      the benchmarks; what follows goes to criterion. `--v3` first builds them
//!                        for x86-64-v3 (AVX2), in a target folder of its own
//! cargo xtask instructions   instructions of a cycle, against those that are committed
//! cargo xtask bits       the golden hashes in builds for AVX2 and in release
//! cargo xtask miri       unit tests of can-protocol and of the guard, in an interpreter
//! cargo xtask fuzz       decoders and loaders, guided by coverage; a target and `--seconds N`
//! ```
//!
//! A task installs what it needs where it may: a compiler target through rustup, Debian packages
//! as root, Python packages in a folder of their own. Whatever only has to be read is unpacked
//! under the target folder and leaves the machine as it was. What could not be had is said in one
//! line and skipped, unless the environment asks for it: `REQUIRE_VCAN`, `REQUIRE_THUMB`,
//! `REQUIRE_QEMU_ARM`, `REQUIRE_CANTOOLS`, `REQUIRE_BROWSER` and `REQUIRE_POWER_CUT`, each `=1`.

mod bits;
mod board;
mod callgrind;
mod debian;
mod equipment;
mod full;
mod fuzz;
mod hub;
mod instructions;
mod machine;
mod miri;
mod modules;
mod no_panic;
mod operations;
mod power_cut;
mod qemu;
mod release;
mod roles;
mod run;
mod stream;
mod thumb;
mod uml;
mod vcan;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use board::Length;
use run::{Outcome, Run};
use thumb::Compiler;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut run = Run::new();
    match words.as_slice() {
        ["test" | "ci"] => test(&mut run),
        ["ci", "--full"] => {
            test(&mut run);
            full::test(&mut run);
        }
        ["firmware"] => firmware(&mut run, Compiler::Any, Length::Short),
        ["firmware", "--full"] => firmware(&mut run, Compiler::Any, Length::Full),
        ["firmware", "--table"] => {
            firmware(&mut run, Compiler::Any, Length::Short);
            run.step("table", |run| board::table(run, thumb::TARGET));
        }
        ["firmware", "--debian"] => firmware(&mut run, Compiler::Debian, Length::Short),
        ["vcan", "--uml", rest @ ..] => {
            run.step("cantools", equipment::cantools);
            run.step("echo", equipment::c_echo);
            run.step("vcan", |run| vcan::test(run, vcan::Place::Uml, rest));
        }
        ["vcan", "--qemu", rest @ ..] => {
            run.step("cantools", equipment::cantools);
            run.step("echo", equipment::c_echo);
            run.step("vcan", |run| vcan::test(run, vcan::Place::Qemu, rest));
        }
        ["vcan", rest @ ..] => {
            run.step("cantools", equipment::cantools);
            run.step("echo", equipment::c_echo);
            run.step("vcan", |run| vcan::test(run, vcan::Place::Any, rest));
        }
        ["power-cut", rest @ ..] => {
            let Some(cuts) = power_cut::Cuts::parse(rest) else { return usage() };
            run.step("power-cut", |run| power_cut::test(run, cuts));
        }
        ["bench", "--v3", rest @ ..] => {
            run.step("bench", |run| bench(run, Some(bits::AVX2), rest));
        }
        ["bench", rest @ ..] => run.step("bench", |run| bench(run, None, rest)),
        ["bits"] => {
            run.step("bits", bits::with_avx2);
            run.step("bits in release", bits::in_release);
        }
        ["miri"] => run.step("miri", miri::test),
        ["instructions"] => run.step("instructions", instructions::count),
        ["fuzz", rest @ ..] => run.step("fuzz", |run| fuzz::fuzz(run, rest)),
        _ => return usage(),
    }
    run.finish()
}

fn usage() -> ExitCode {
    eprintln!(
        "usage: cargo xtask test | ci [--full] | firmware [--full | --table | --debian] \
         | vcan [--uml | --qemu] [TEST] | power-cut [--kills N] [--seed S] \
         | bench [--v3] [BENCHMARK] | instructions | bits | miri \
         | fuzz [TARGET] [--seconds N]"
    );
    ExitCode::from(2)
}

/// Every check, cheapest first; one that fails does not keep the others from running.
///
/// Lints and docs share their metadata, the tests share one build: with other `--package` choices
/// cargo would unify features anew and compile everything again.
fn test(run: &mut Run) {
    run.step("format", |run| {
        let mut all = Outcome::Passed;
        // The image is no member of the workspace.
        for manifest in ["Cargo.toml", "firmware/Cargo.toml"] {
            let mut cargo = run.cargo();
            cargo.args(["fmt", "--all", "--check", "--manifest-path", manifest]);
            all = all.and(run.checked(&mut cargo));
        }
        // A macro declares the effects' modules, which hides them from cargo fmt.
        let mut rustfmt = std::process::Command::new("rustfmt");
        rustfmt.args(["--check", "--edition", "2024"]).current_dir(&run.root);
        rustfmt.args(rust_files(&run.root.join("firmware-core/src/damper/effects")));
        all.and(run.checked(&mut rustfmt))
    });
    run.step("lints", |run| {
        let mut cargo = run.cargo();
        cargo.args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]);
        run.checked(&mut cargo)
    });
    run.step("docs", |run| {
        let mut cargo = run.cargo();
        cargo.args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings");
        run.checked(&mut cargo)
    });
    run.step("cantools", equipment::cantools);
    run.step("hyperqueue", equipment::hyperqueue);
    run.step("browser", equipment::browser);
    run.step("build", |run| {
        let mut cargo = run.cargo();
        run.checked(cargo.args(["test", "--workspace", "--no-run"]))
    });
    // The host's end of an image is part of that build.
    firmware(run, Compiler::Any, Length::Short);
    run.step("tests", tests);
    // It leaves one processor to the tests over SocketCAN, some of which run on the clock.
    let release = release::Build::begin(run);
    run.step("vcan", |run| vcan::test(run, vcan::Place::Any, &[]));
    run.step("release", |run| release::same_bits(run, release));
}

/// The tests of the workspace.
fn tests(run: &mut Run) -> Outcome {
    let folder = match run.temporary() {
        Ok(folder) => folder,
        Err(error) => return Outcome::Failed(format!("a folder for temporary files: {error}")),
    };
    let mut cargo = run.cargo();
    cargo.args(["test", "--workspace", "--no-fail-fast"]).envs(run.equipment.clone());
    cargo.env("TMPDIR", folder);
    // The step below runs these, on whatever has CAN; a skipped run here would look like a gap.
    run.checked(cargo.env("VCAN_ELSEWHERE", "1"))
}

/// The images for a Cortex-M7: linked, which proves them, and run.
fn firmware(run: &mut Run, compiler: Compiler, length: Length) {
    run.step("firmware", |run| match thumb::build(run, compiler) {
        Outcome::Passed => {
            let bits = board::test(run, thumb::TARGET, length);
            bits.and(roles::test(run, thumb::TARGET, length))
        }
        worse => worse,
    });
}

/// The Rust files of a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path());
    files.filter(|path| path.extension().is_some_and(|ending| ending == "rs")).collect()
}

/// Only the criterion benches: the test harness of the libraries would refuse their arguments.
fn bench(run: &mut Run, processor: Option<&str>, arguments: &[&str]) -> Outcome {
    let mut cargo = run.cargo();
    if let Some(processor) = processor {
        bits::for_processor(run, &mut cargo, processor);
    }
    cargo.args(["bench", "--bench", "*"]);
    if !arguments.is_empty() {
        cargo.arg("--").args(arguments);
    }
    run.checked(&mut cargo)
}
