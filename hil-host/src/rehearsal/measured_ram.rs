//! How late the ram of a rig is, from a folder in which it was measured.
//!
//! The delay is that of the measured displacement which arrives in a cycle against the command that
//! leaves in it. An open loop measures it for every test (`tracking.json`), a run for every rig
//! (`summary.json`).

use crate::BenchError;
use crate::measured_ram::{MeasuredRam, MeasuredRams, RamTest, Whose};
use crate::run::{SUMMARY, check_format, read_json};
use files::quoted;
use scenario::rig::DELAY_MAX_S;
use scenario::run::CYCLE_S;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// How the ram has followed the tests of an open loop: a file in its folder.
pub const TRACKING: &str = "tracking.json";

/// What is read of it.
#[derive(Debug, Deserialize)]
struct KeptOpenLoop {
    format: u32,
    node: u8,
    tests: Vec<KeptTest>,
}

#[derive(Debug, Deserialize)]
struct KeptTest {
    name: String,
    delay_s: Option<f64>,
    /// None in a file of an earlier version: such a test is near no frequency.
    #[serde(default)]
    frequency_hz: Option<f64>,
}

/// What is read of `summary.json`.
#[derive(Debug, Deserialize)]
struct KeptSummary {
    format: u32,
    damper: Vec<KeptDamper>,
}

#[derive(Debug, Deserialize)]
struct KeptDamper {
    name: String,
    tracking: Option<KeptTracking>,
}

#[derive(Debug, Deserialize)]
struct KeptTracking {
    /// None in a file of an earlier version.
    #[serde(default)]
    ram_delay_s: Option<f64>,
}

impl MeasuredRams {
    /// From folders of open loops or of runs.
    ///
    /// # Errors
    /// A folder has no such file, the file has no delay, or one that no rig has.
    pub fn read(folders: &[PathBuf]) -> Result<Self, BenchError> {
        let mut all = Vec::new();
        for folder in folders {
            all.extend(tests_in(folder)?);
        }
        Ok(Self(all))
    }
}

fn tests_in(folder: &Path) -> Result<Vec<RamTest>, BenchError> {
    let (tracking, summary) = (folder.join(TRACKING), folder.join(SUMMARY));
    let mut tests = Vec::new();
    let file = if tracking.is_file() {
        let kept: KeptOpenLoop = read_json(&tracking, "the tracking.json of an open loop")?;
        check_format(&tracking, kept.format)?;
        for KeptTest { name, delay_s, frequency_hz } in kept.tests {
            let Some(delay_s) = delay_s else { continue };
            let frequency_hz = Some(frequency_hz.unwrap_or(f64::NAN));
            tests.push(test(&tracking, &name, Whose::Node(kept.node), frequency_hz, delay_s)?);
        }
        tracking
    } else if summary.is_file() {
        let kept: KeptSummary = read_json(&summary, "the summary.json of a run")?;
        check_format(&summary, kept.format)?;
        for KeptDamper { name, tracking } in kept.damper {
            let Some(delay_s) = tracking.and_then(|tracking| tracking.ram_delay_s) else {
                continue;
            };
            tests.push(test(&summary, &name, Whose::Place(name.clone()), None, delay_s)?);
        }
        summary
    } else {
        return Err(BenchError::Kept {
            file: folder.to_owned(),
            found: format!("neither {TRACKING} nor {SUMMARY}"),
            expected: "the folder of an open loop or of a run",
        });
    };
    if tests.is_empty() {
        let found = "no delay of a ram".to_owned();
        return Err(BenchError::Kept { file, found, expected: "one of a ram that moved" });
    }
    Ok(tests)
}

fn test(
    file: &Path,
    name: &str,
    whose: Whose,
    frequency_hz: Option<f64>,
    delay_s: f64,
) -> Result<RamTest, BenchError> {
    // A ram that is not late may be measured to be early by its noise.
    if !(-CYCLE_S..=DELAY_MAX_S).contains(&delay_s) {
        let found = format!("a ram that is {:.3} ms late in {}", 1e3 * delay_s, quoted(name));
        return Err(BenchError::Kept { file: file.to_owned(), found, expected: "0 to 64 ms" });
    }
    let file = file.display().to_string();
    let source = format!("{}, {}", quoted(&file), quoted(name));
    Ok(RamTest { whose, frequency_hz, ram: MeasuredRam { delay_s, source } })
}
