//! The two `no_std` crates, compiled for a Cortex-M7: proof that nothing in them needs a system.
//!
//! Three ways, in this order: the target is installed; rustup installs it; or Debian's own
//! compiler and library source, unpacked below the target folder, build `core` from source.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::run::{Outcome, Run};
use crate::stream::quiet;

/// Double-precision hardware differs between the parts; this is the common denominator.
const TARGET: &str = "thumbv7em-none-eabihf";
const CRATES: [&str; 4] = ["--package", "can-protocol", "--package", "firmware-core"];

/// Which compiler may be used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compiler {
    Any,
    /// Debian's, although rustup's might do: to test this way itself.
    Debian,
}

/// Builds `can-protocol` and `firmware-core` for the target.
pub(crate) fn build(run: &mut Run, compiler: Compiler) -> Outcome {
    let by_rustup = match compiler {
        Compiler::Any => rustup(),
        Compiler::Debian => Err("not asked".into()),
    };
    let no_rustup = match by_rustup {
        Ok(()) => {
            let mut cargo = run.cargo();
            return run.checked(cargo.args(["build", "--lib", "--target", TARGET]).args(CRATES));
        }
        Err(reason) => reason,
    };
    println!("no {TARGET} from rustup ({no_rustup}); trying Debian's compiler");
    match from_debian(&run.target.join("thumb")) {
        Ok(toolchain) => {
            let mut cargo = run.cargo();
            cargo
                .args(["build", "--lib", "-Z", "build-std=core", "--target", TARGET])
                .args(CRATES)
                // Another compiler's files in the same folder would make cargo build all anew.
                .arg("--target-dir")
                .arg(run.target.join("thumb").join("build"))
                .env("RUSTC", toolchain.join("usr/bin/rustc"))
                .env("LD_LIBRARY_PATH", libraries(&toolchain))
                // -Z options are for nightly compilers; this lets a released one take them.
                .env("RUSTC_BOOTSTRAP", "1");
            run.checked(&mut cargo)
        }
        Err(reason) => Outcome::skipped_unless_required(
            "REQUIRE_THUMB",
            format!("no {TARGET}: rustup: {no_rustup}; Debian: {reason}"),
        ),
    }
}

fn rustup() -> Result<(), String> {
    let installed =
        quiet(Command::new("rustc").args(["--print", "target-libdir"]).args(["--target", TARGET]));
    let library =
        |folder: String| fs::read_dir(folder.trim()).is_ok_and(|mut f| f.next().is_some());
    if installed.is_ok_and(library) {
        return Ok(());
    }
    quiet(Command::new("rustup").args(["target", "add", TARGET])).map(drop)
}

/// Debian's newest rustc for building browsers, with the source of its library: about 140 MB.
fn from_debian(folder: &Path) -> Result<PathBuf, String> {
    let toolchain = folder.join("toolchain");
    let works = || {
        quiet(
            Command::new(toolchain.join("usr/bin/rustc"))
                .arg("--version")
                .env("LD_LIBRARY_PATH", libraries(&toolchain)),
        )
    };
    if works().is_err() {
        // A half-unpacked one from an interrupted run would mix two versions.
        if toolchain.exists() {
            fs::remove_dir_all(&toolchain).map_err(|error| error.to_string())?;
        }
        debian::unpack_with_dependencies(&["rustc-web", "rust-web-src"], &toolchain)?;
    }
    println!("{}", works()?.trim());
    Ok(toolchain)
}

fn libraries(toolchain: &Path) -> PathBuf {
    toolchain.join(format!("usr/lib/{}-linux-gnu", std::env::consts::ARCH))
}
