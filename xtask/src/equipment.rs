//! What single tests need from outside: Python's cantools and hyperqueue, and a browser.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::run::{Outcome, Run};
use crate::stream::quiet;

/// A Python of its own with cantools, the independent reader of the message database.
///
/// The tests find it as `PYTHON`.
pub(crate) fn cantools(run: &mut Run) -> Outcome {
    match virtual_environment(&run.target.join("cantools")) {
        Ok(python) => {
            run.equipment.push(("PYTHON".into(), python.into()));
            run.equipment.push(("REQUIRE_CANTOOLS".into(), "1".into()));
            Outcome::Passed
        }
        Err(reason) => Outcome::skipped_unless_required("REQUIRE_CANTOOLS", reason),
    }
}

/// The interpreter of a virtual environment that has cantools.
fn virtual_environment(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("bin/python3");
    let has_cantools = || quiet(Command::new(&python).args(["-c", "import cantools"]));
    if has_cantools().is_err() {
        if quiet(Command::new("python3").args(["-c", "import ensurepip"])).is_err() {
            debian::install(&["python3", "python3-venv"])?;
        }
        quiet(Command::new("python3").args(["-m", "venv", "--clear"]).arg(folder))?;
        quiet(
            Command::new(&python)
                .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
                .arg("cantools>=40,<46"),
        )?;
        has_cantools()?;
    }
    let version = "import cantools; print('cantools', cantools.__version__)";
    println!("{}", quiet(Command::new(&python).args(["-c", version]))?.trim());
    Ok(python)
}

/// A plain C echo pair, which the round trip over a virtual interface is compared with.
///
/// The tests find it as `VCAN_C_ECHO`; without a compiler the comparison is left out.
pub(crate) fn c_echo(run: &mut Run) -> Outcome {
    let program = run.target.join("vcan/echo");
    let compiled = std::fs::create_dir_all(run.target.join("vcan"))
        .map_err(|error| error.to_string())
        .and_then(|()| {
            // Static: a throw-away machine needs nothing else.
            let mut compiler = Command::new("cc");
            compiler.args(["-O2", "-static", "-o"]).arg(&program);
            quiet(compiler.arg(run.root.join("xtask/src/echo.c")))
        });
    match compiled {
        Ok(_) => {
            run.equipment.push(("VCAN_C_ECHO".into(), program.into()));
            Outcome::Passed
        }
        Err(reason) => Outcome::Skipped(format!("no plain C echo pair to compare with: {reason}")),
    }
}

/// `HyperQueue` for that Python, for the test that spreads a sweep over a scheduler's workers.
pub(crate) fn hyperqueue(run: &mut Run) -> Outcome {
    let python = run.target.join("cantools/bin/python3");
    let there = || quiet(Command::new(&python).args(["-c", "import hyperqueue"]));
    let installed = there().or_else(|_| {
        let mut pip = Command::new(&python);
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        quiet(pip.arg("hyperqueue>=0.20,<1"))?;
        there()
    });
    match installed {
        Ok(_) => {
            run.equipment.push(("REQUIRE_HYPERQUEUE".into(), "1".into()));
            Outcome::Passed
        }
        Err(reason) => Outcome::skipped_unless_required("REQUIRE_HYPERQUEUE", reason),
    }
}

const BROWSERS: [&str; 4] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Chromium, for the test that opens a report as a reader does.
pub(crate) fn browser(run: &mut Run) -> Outcome {
    let mut found = BROWSERS.into_iter();
    let found = found.find_map(debian::program);
    match found.map_or_else(|| debian::ensure("chromium", &["chromium"]), Ok) {
        Ok(path) => {
            println!("{}", path.display());
            run.equipment.push(("REQUIRE_BROWSER".into(), "1".into()));
            Outcome::Passed
        }
        Err(reason) => Outcome::skipped_unless_required("REQUIRE_BROWSER", reason),
    }
}
