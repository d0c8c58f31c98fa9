//! What a run measured on a damper, read back as a test: from its bus log or from its record.

mod log;
mod reader;
mod run;
#[cfg(test)]
mod tests;

pub use log::read_bus_log;
pub use reader::RunRecords;
pub use run::read_record;

use log::rigs_in_log;
use measurement::Series;
use measurement::mapping::Extension;
use std::path::{Path, PathBuf};

/// A series of a file and a part of it, without samples.
fn empty(path: &Path, part: &str) -> Series {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Series {
        name: format!("{}-{part}", stem.unwrap_or_default()),
        file: PathBuf::from(path),
        lines: Vec::new(),
        time_s: Vec::new(),
        time_resolution_s: Vec::new(),
        displacement_m: Vec::new(),
        force_n: Vec::new(),
        velocity_m_per_s: None,
        temperature_degc: None,
        is_integrated: false,
        extension: Extension::Positive,
        repairs: Vec::new(),
        columns: ["time_s", "displacement_m", "force_n"].map(str::to_owned),
    }
}
