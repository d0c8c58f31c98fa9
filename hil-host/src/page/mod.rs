//! `report.html`: what a person reads of a run.

mod events;
mod last_second;
mod motion;
mod overview;
mod rigs;
mod spectra;
mod timing;
mod traces;
mod watch;

pub(crate) use traces::{kilo, milli, spectrum};

use crate::counts::Counts;
use crate::record::Row;
use crate::statistics::Statistics;
use crate::summary::Summary;
use events::events;
pub(crate) use last_second::SHOWN_MS;
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
pub enum Ending {
    /// It ended by itself.
    Known,
    /// It was killed.
    Unknown {
        /// Control cycles that it was asked for.
        asked_cycles: u64,
    },
    /// Its summary is not that of the record.
    Contradicted {
        /// Control cycles that the summary counts.
        counted_cycles: u64,
    },
}

/// The report of a run; with `compared`, also the section of its comparison. `around_stop` are the
/// rows around the cycle that stopped it.
pub(crate) fn page(
    run: &Run,
    summary: &Summary,
    (counts, statistics, around_stop): (&Counts, &Statistics, &[Row]),
    bus_plan: &[String],
    compared: Option<Section>,
    ending: Ending,
) -> Report {
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
    report = report.section(overview(run, summary, counts, ending));
    if let Some(section) = compared {
        report = report.section(section);
    }
    report = report.section(accelerations(&statistics.traces));
    for section in [forces(run, &statistics.traces), loops(run, &statistics.traces)] {
        report = report.section(section);
    }
    if let Some(section) = rigs(run, summary, statistics) {
        report = report.section(section);
    }
    if let Some(section) = watch(run, counts, &statistics.traces) {
        report = report.section(section);
    }
    report = report.section(spectra(run, &statistics.shown)).section(timing(
        run,
        summary,
        counts,
        &statistics.traces.clock,
    ));
    if let Some(section) = events(summary) {
        report = report.section(section);
    }
    if ending == Ending::Known {
        report = report.section(bus(summary, bus_plan));
    }
    report.section(about(run))
}
