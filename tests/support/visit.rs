//! A virtual visit to a bench with a list of sines: `damper.toml`, `list.toml` and `bench/*.csv`.

use super::command::{output, yawbench};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A sine: name, millimetres, hertz, seconds.
pub(crate) type Sine = (&'static str, f64, f64, f64);

/// Records the sines, and what more a list of tests says, of a damper in a folder of this name.
pub(crate) fn visit(name: &str, damper: &str, sines: &[Sine], more: &str) -> PathBuf {
    let place = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    let mut list = String::new();
    for (name, amplitude_mm, frequency_hz, duration_s) in sines {
        writeln!(
            list,
            "[[test]]\nname = \"{name}\"\nduration_s = {duration_s}\n\
             sine = {{ amplitude_m = {amplitude_mm}e-3, frequency_hz = {frequency_hz} }}"
        )
        .unwrap();
    }
    list.push_str(more);
    std::fs::write(place.join("damper.toml"), damper).unwrap();
    std::fs::write(place.join("list.toml"), list).unwrap();
    said(&place, &["characterise", "damper.toml", "--tests", "list.toml", "--out", "bench"]);
    place
}

/// What a command prints; it must succeed.
pub(crate) fn said(place: &Path, args: &[&str]) -> String {
    let done = output(yawbench().args(args).current_dir(place));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(done.stdout).unwrap()
}

/// The text of a file.
pub(crate) fn text_of(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
