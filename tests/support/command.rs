//! The `yawbench` command as a person types it, in a folder of its own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The repository.
pub(crate) fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The command; inside a throw-away machine its path comes from outside.
pub(crate) fn yawbench() -> Command {
    let path = std::env::var_os("YAWBENCH_BIN")
        .map_or_else(|| PathBuf::from(env!("CARGO_BIN_EXE_yawbench")), PathBuf::from);
    Command::new(path)
}

/// Runs it to its end.
pub(crate) fn output(command: &mut Command) -> Output {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"))
}

/// The text of a file.
pub(crate) fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// A fresh folder for a test.
pub(crate) fn folder(name: &str) -> PathBuf {
    // Tests of several topics run side by side and may choose the same name.
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(format!("yawbench-{process}-{count}-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    path
}
