//! The `no_std` crates, compiled for a Cortex-M7: proof that nothing in them needs a system.
//! Then the image that calls them, which is linked only where they have no way to panic.
//!
//! Three ways, in this order: the target is installed; rustup installs it; or Debian's own
//! compiler and library source, unpacked below the target folder, build `core` from source.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::no_panic;
use crate::run::{Outcome, Run};
use crate::stream::quiet;

/// Double-precision hardware differs between the parts; this is the common denominator.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";
const CRATES: [&str; 6] =
    ["--package", "can-protocol", "--package", "firmware-core", "--package", "nodes"];

/// Which compiler may be used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compiler {
    Any,
    /// Debian's, although rustup's might do: to test this way itself.
    Debian,
}

/// Builds the `no_std` crates for the target, then the image that proves them.
pub(crate) fn build(run: &mut Run, compiler: Compiler) -> Outcome {
    let toolchain = match Toolchain::find(run, compiler) {
        Ok(toolchain) => toolchain,
        Err(reason) => {
            let reason = format!("no {TARGET}: {reason}");
            return Outcome::skipped_unless_required("REQUIRE_THUMB", reason);
        }
    };
    let mut cargo = run.cargo();
    cargo.args(["build", "--lib"]).args(CRATES);
    if let Toolchain::Debian { .. } = toolchain {
        // Another compiler's files in the same folder would make cargo build all anew.
        cargo.arg("--target-dir").arg(run.target.join("thumb").join("build"));
    }
    toolchain.prepare(&mut cargo);
    match run.checked(&mut cargo) {
        Outcome::Passed => no_panic::check(run, TARGET, |cargo| toolchain.prepare(cargo)),
        worse => worse,
    }
}

/// A compiler and a linker for the target.
enum Toolchain {
    /// Cargo's own.
    Rustup,
    /// Debian's, each unpacked in a folder of its own.
    Debian { compiler: PathBuf, linker: PathBuf },
}

impl Toolchain {
    fn find(run: &Run, compiler: Compiler) -> Result<Self, String> {
        let by_rustup = match compiler {
            Compiler::Any => rustup(),
            Compiler::Debian => Err("not asked".into()),
        };
        let Err(no_rustup) = by_rustup else { return Ok(Self::Rustup) };
        println!("no {TARGET} from rustup ({no_rustup}); trying Debian's compiler");
        let folder = run.target.join("thumb");
        let (compiler, linker) = (folder.join("toolchain"), folder.join("linker"));
        let found = unpacked(&compiler, "rustc", &["rustc-web", "rust-web-src"])
            .and_then(|()| unpacked(&linker, "ld.lld", &["lld"]));
        found.map_err(|reason| format!("rustup: {no_rustup}; Debian: {reason}"))?;
        Ok(Self::Debian { compiler, linker })
    }

    /// Adds the target and the tools to a cargo command.
    fn prepare(&self, cargo: &mut Command) {
        cargo.args(["--target", TARGET]);
        if let Self::Debian { compiler, linker } = self {
            let libraries = [libraries(compiler), libraries(linker)];
            cargo
                .args(["-Z", "build-std=core"])
                .env("RUSTC", compiler.join("usr/bin/rustc"))
                .env("LD_LIBRARY_PATH", std::env::join_paths(libraries).unwrap_or_default())
                .env("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER", linker.join("usr/bin/ld.lld"))
                // -Z options are for nightly compilers; this lets a released one take them.
                .env("RUSTC_BOOTSTRAP", "1");
        }
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

/// Debian's packages in a folder, unless a program from them runs there already. The compiler is
/// the newest rustc, for building browsers, with the source of its library: about 140 MB.
fn unpacked(folder: &Path, program: &str, packages: &[&str]) -> Result<(), String> {
    let works = || {
        let mut program = Command::new(folder.join("usr/bin").join(program));
        quiet(program.arg("--version").env("LD_LIBRARY_PATH", libraries(folder)))
    };
    if works().is_err() {
        // A half-unpacked one from an interrupted run would mix two versions.
        if folder.exists() {
            fs::remove_dir_all(folder).map_err(|error| error.to_string())?;
        }
        debian::unpack_with_dependencies(packages, folder)?;
    }
    println!("{}", works()?.trim());
    Ok(())
}

fn libraries(toolchain: &Path) -> PathBuf {
    toolchain.join(format!("usr/lib/{}-linux-gnu", std::env::consts::ARCH))
}
