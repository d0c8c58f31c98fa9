//! A folder for a test, and a good record.

use std::fmt::Write as _;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A folder that is removed when the test ends.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let name = format!("yawbench-measurement-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a file and returns its path.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.join(name);
        std::fs::write(&path, content).unwrap();
        path
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A record at 500 Hz: 5 mm at 2 Hz, a force of 1 kN ahead by 50 degrees, 20 degrees Celsius.
pub(crate) fn record(names: &str) -> String {
    let mut text = format!("{names}\n");
    for n in 0..1000 {
        let angle = std::f64::consts::TAU * 2.0 * f64::from(n) * 2e-3;
        let (x, f) = (5e-3 * libm::sin(angle), 1e3 * libm::sin(angle + 0.87));
        writeln!(text, "{:.3},{x:.7},{f:.3},20.0", f64::from(n) * 2e-3).unwrap();
    }
    text
}

/// The names of this project's columns.
pub(crate) const NAMES: &str = "time_s,displacement_m,force_n,temperature_degc";
