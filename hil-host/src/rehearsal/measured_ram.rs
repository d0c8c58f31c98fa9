//! How late the ram of a rig is, from a folder in which it was measured.
//!
//! The delay is that of the measured displacement which arrives in a cycle against the command that
//! leaves in it. An open loop measures it for every test (`tracking.json`), a run for every rig
//! (`summary.json`). The largest one counts: a servo rig is late by its load.

use crate::BenchError;
use crate::measured_ram::MeasuredRam;
use crate::run::{SUMMARY, check_format, read_json};
use files::quoted;
use serde::Deserialize;
use std::path::Path;

/// How the ram has followed the tests of an open loop: a file in its folder.
pub const TRACKING: &str = "tracking.json";

/// What is read of it.
#[derive(Debug, Deserialize)]
struct KeptOpenLoop {
    format: u32,
    tests: Vec<KeptTest>,
}

#[derive(Debug, Deserialize)]
struct KeptTest {
    name: String,
    delay_s: Option<f64>,
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

impl MeasuredRam {
    /// From the folder of an open loop or of a run.
    ///
    /// # Errors
    /// The folder has no such file, or the file has no delay.
    pub fn read(folder: &Path) -> Result<Self, BenchError> {
        let (file, delays) = if folder.join(TRACKING).is_file() {
            let file = folder.join(TRACKING);
            let kept: KeptOpenLoop = read_json(&file, "the tracking.json of an open loop")?;
            check_format(&file, kept.format)?;
            let delays = kept.tests.into_iter().map(|test| (test.name, test.delay_s));
            (file, delays.collect::<Vec<_>>())
        } else if folder.join(SUMMARY).is_file() {
            let file = folder.join(SUMMARY);
            let kept: KeptSummary = read_json(&file, "the summary.json of a run")?;
            check_format(&file, kept.format)?;
            let delay = |damper: KeptDamper| Some((damper.name, damper.tracking?.ram_delay_s));
            (file, kept.damper.into_iter().filter_map(delay).collect())
        } else {
            return Err(BenchError::Kept {
                file: folder.to_owned(),
                found: format!("neither {TRACKING} nor {SUMMARY}"),
                expected: "the folder of an open loop or of a run",
            });
        };
        let known = delays.into_iter().filter_map(|(name, delay_s)| Some((name, delay_s?)));
        let latest = known.max_by(|one, other| one.1.total_cmp(&other.1));
        let Some((name, delay_s)) = latest else {
            let found = "no delay of a ram".to_owned();
            return Err(BenchError::Kept { file, found, expected: "one of a ram that moved" });
        };
        let file = file.display().to_string();
        Ok(Self { delay_s, source: format!("{}, {}", quoted(&file), quoted(&name)) })
    }
}
