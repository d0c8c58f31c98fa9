//! `yawbench report`: the report of a run from the files in its folder, also of a killed one.

use super::about::{check_format, read_about, read_json};
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
    /// How much is known of its end.
    pub ending: Ending,
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
    let record = folder.file(RECORD);
    let statistics = Statistics::of(&record, run.run_in_s, run.cycle_s(), |row| counts.take(row))?;
    let kept = kept_summary(&folder)?;
    let ending = match &kept {
        Some(kept) if is_of(kept, &counts) => Ending::Known,
        Some(kept) => Ending::Contradicted { counted_cycles: kept.cycles },
        None => Ending::Unknown { asked_cycles: about.cycles },
    };
    // A summary that is not that of the record says nothing about it.
    let kept = kept.filter(|_| ending == Ending::Known);
    let asked = Asked {
        bus: about.bus,
        pace: about.pace,
        bus_load: about.bus_load,
        watched: about.watched,
        hunting: about.hunting,
        rigs: about.rig_slots.len(),
        calibrations: about.calibrations,
        events: read_events(&folder.file(EVENTS)),
    };
    let summary = Summary::of_record(&run, &asked, (&counts, &statistics), kept.as_ref());
    let compared = kept.as_ref().is_some_and(|kept| kept.comparison.is_some());
    let name = if compared { ALONE } else { REPORT };
    let rows = around_stop(&folder.file(RECORD), &summary)?;
    let seen = (&counts, &statistics, &*rows);
    let page = page(&run, &summary, seen, &about.bus_lines, None, ending);
    folder.write(name, &page.to_html()?)?;
    Ok(LateReport { path: folder.file(name), summary, ending })
}

/// What the program has written at the end of a run; none of one that was killed.
pub(crate) fn kept_summary(folder: &ResultFolder) -> Result<Option<KeptSummary>, BenchError> {
    let summary = folder.file(SUMMARY);
    match summary.symlink_metadata() {
        Ok(_) => {
            let kept: KeptSummary = read_json(&summary, "the summary.json of a run")?;
            check_format(&summary, kept.format)?;
            Ok(Some(kept))
        }
        Err(_) => Ok(None),
    }
}

/// Whether a summary is that of a record: the same cycles and, where no row is lost, the same
/// trajectory.
fn is_of(kept: &KeptSummary, counts: &Counts) -> bool {
    let (last_cycle, hash) = counts.last;
    let is_same = last_cycle == kept.cycles && format!("{hash:016x}") == kept.trajectory_hash;
    let is_whole = counts.rows() == kept.cycles;
    if kept.record_dropped == 0 { is_same && is_whole } else { last_cycle <= kept.cycles }
}
