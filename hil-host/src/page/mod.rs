//! `report.html`: what a person reads of a run.

mod last_second;
mod motion;
mod overview;
mod rigs;
mod spectra;
mod timing;
mod traces;
mod watch;

pub(crate) use traces::{kilo, milli, most_in, spectrum};

use crate::columns::Columns;
use crate::record::Row;
use crate::summary::Summary;
pub(crate) use last_second::SHOWN_CYCLES;
use last_second::last_second;
use motion::{accelerations, forces, loops};
use overview::{about, overview};
use report::{Report, Section};
use rigs::rigs;
use scenario::run::Run;
use spectra::spectra;
use timing::{bus, timing};
use watch::watch;

/// How much is known of the end of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// It ended by itself.
    Known,
    /// It was killed.
    Unknown {
        /// Control cycles that it was asked for.
        asked_cycles: u64,
    },
}

/// The report of a run; with `compared`, also the section of its comparison. `around_stop` are the
/// rows around the cycle that stopped it.
pub(crate) fn page(
    run: &Run,
    summary: &Summary,
    (columns, around_stop): (&Columns, &[Row]),
    bus_plan: &[String],
    compared: Option<Section>,
    ending: Ending,
) -> Report {
    // A run that ended before its run-in was over is shown whole.
    let after = columns.first_after(run.run_in_s);
    let first = if after < columns.time_s.len() { after } else { 0 };
    let mut report = Report::new(&run.title)
        .subtitle(&format!(
            "{} at {:.0} km/h, {:.1} s, bus {}, pace {}",
            run.vehicle_name,
            summary.speed_kmh,
            summary.duration_s,
            summary.bus,
            summary.pace.name()
        ))
        .fact("trajectory hash", &summary.trajectory_hash);
    if let Some(section) = last_second(run, summary, around_stop) {
        report = report.section(section);
    }
    report = report.section(overview(run, summary, columns, ending));
    if let Some(section) = compared {
        report = report.section(section);
    }
    report = report.section(accelerations(columns, first));
    for section in [forces(run, columns, first), loops(run, columns, first)] {
        report = report.section(section);
    }
    if let Some(section) = rigs(run, columns, first) {
        report = report.section(section);
    }
    if let Some(section) = watch(run, columns) {
        report = report.section(section);
    }
    report = report.section(spectra(run, columns, first)).section(timing(summary, columns));
    if ending == Ending::Known {
        report = report.section(bus(summary, bus_plan));
    }
    report.section(about(run))
}
