//! `yawbench report`: the report of a run from the files in its folder, also of a killed one.

use super::about::{read_about, read_json};
use super::{EVENTS, RECORD, REPORT, SCENARIO, SUMMARY, around_stop};
use crate::BenchError;
use crate::counts::Counts;
use crate::page::{Ending, page};
use crate::record::read_events;
use crate::statistics::Statistics;
use crate::summary::{Asked, KeptSummary, Summary};
use files::ResultFolder;
use scenario::run::{Overrides, Run};
use std::path::{Path, PathBuf};

/// The report where the folder holds one with a comparison, which is not computed again.
const ALONE: &str = "report-without-comparison.html";

/// A report that was made from the files of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct LateReport {
    /// The report.
    pub path: PathBuf,
    /// What the record holds.
    pub summary: Summary,
    /// Whether the run has ended by itself: it has a summary.
    pub has_ended: bool,
}

/// Makes the report of a run from what is in its folder.
///
/// # Errors
/// The folder holds no run, or a file of it cannot be read; the report cannot be written.
pub fn report(folder: &Path) -> Result<LateReport, BenchError> {
    let folder = ResultFolder::existing(folder, "run")?;
    let about = read_about(&folder)?;
    let run = Run::load(&folder.file(SCENARIO), Overrides::default())?;
    let mut counts = Counts::default();
    let statistics = Statistics::of(&folder.file(RECORD), run.run_in_s, |row| counts.take(row))?;
    let summary = folder.file(SUMMARY);
    let kept: Option<KeptSummary> = match summary.symlink_metadata() {
        Ok(_) => Some(read_json(&summary, "the summary.json of a run")?),
        Err(_) => None,
    };
    let asked = Asked {
        bus: about.bus,
        pace: about.pace,
        bus_load: about.bus_load,
        watched: about.watched,
        hunting: about.hunting,
        rigs: about.rig_slots.len(),
        events: read_events(&folder.file(EVENTS)),
    };
    let summary = Summary::of_record(&run, &asked, (&counts, &statistics), kept.as_ref());
    let compared = kept.as_ref().is_some_and(|kept| kept.comparison.is_some());
    let name = if compared { ALONE } else { REPORT };
    let ending =
        if kept.is_some() { Ending::Known } else { Ending::Unknown { asked_cycles: about.cycles } };
    let rows = around_stop(&folder.file(RECORD), &summary)?;
    let seen = (&counts, &statistics, &*rows);
    let page = page(&run, &summary, seen, &about.bus_lines, None, ending);
    folder.write(name, &page.to_html()?)?;
    Ok(LateReport { path: folder.file(name), summary, has_ended: kept.is_some() })
}
