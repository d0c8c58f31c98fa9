//! How long cycles took, and which frames passed the bus.

use super::traces::line;
use crate::counts::Counts;
use crate::options::PaceChoice;
use crate::statistics::ClockTraces;
use crate::summary::Summary;
use hdrhistogram::iterators::IterationValue;
use report::{Cell, Plot, Section, Table, logarithmic_bins_of_counts};
use scenario::run::Run;

pub(super) fn timing(
    run: &Run,
    summary: &Summary,
    counts: &Counts,
    clock: &ClockTraces,
) -> Section {
    let values = |histogram: &hdrhistogram::Histogram<u64>| -> Vec<(f64, u64)> {
        // A value of the histogram stands for all cycles in its bucket.
        let of_bucket = |bucket: IterationValue<u64>| {
            (bucket.value_iterated_to() as f64 * 1e-3, bucket.count_since_last_iteration())
        };
        histogram.iter_recorded().map(of_bucket).collect()
    };
    let mut plot = Plot::new("Histogram of cycle and step times")
        .x("time", "µs")
        .y("cycles", "")
        .log_x()
        .log_y();
    for (name, histogram) in
        [("receive to send", &counts.cycle_ns), ("vehicle step", &counts.compute_ns)]
    {
        let (edges, counts) = logarithmic_bins_of_counts(&values(histogram), 60);
        if !counts.is_empty() {
            plot = plot.bars(name, &edges, &counts);
        }
    }
    let mut table = Table::new("Times")
        .text("what")
        .number("median", "µs")
        .number("99 %", "µs")
        .number("99.9 %", "µs")
        .number("largest", "µs");
    let cycle = summary.cycle_time_us;
    let step = summary.step_compute_us;
    table = table
        .row([
            Cell::from("receive to send"),
            cycle.p50.into(),
            cycle.p99.into(),
            cycle.p99_9.into(),
            cycle.max.into(),
        ])
        .row([
            Cell::from("vehicle step of 1 ms"),
            step.p50.into(),
            step.p99.into(),
            Cell::Empty,
            step.max.into(),
        ]);
    if let Some(late) = summary.lateness_us {
        table = table.row([
            Cell::from("wake-up late by"),
            late.p50.into(),
            late.p99.into(),
            late.p99_9.into(),
            late.max.into(),
        ]);
    }
    let section = Section::new("Timing").plot(plot).table(table);
    round_trip(run, deadlines(summary.pace, section, clock), clock)
}

/// Skipped ticks and late wake-ups over time, where a clock sets the pace.
fn deadlines(pace: PaceChoice, section: Section, clock: &ClockTraces) -> Section {
    if pace != PaceChoice::Realtime {
        return section.text(&format!(
            "Pace {}: no clock sets deadlines, so no tick can be skipped.",
            pace.name()
        ));
    }
    let plot = Plot::new("Skipped ticks and late wake-ups")
        .caption("From the first cycle of the record, before RUN, to the last one.")
        .x("time", "s")
        .y("ticks skipped", "");
    let plot = line(plot, "ticks skipped since the first cycle", &clock.skipped, 1.0)
        .panel_below("wake-up late by", "µs");
    section.plot(line(plot, "wake-up late by", &clock.lateness_ns, 1e-3))
}

/// The round trip of every rig over time.
fn round_trip(run: &Run, section: Section, clock: &ClockTraces) -> Section {
    let mut plot = Plot::new("Round trip of the rigs")
        .caption(
            "Cycles from a command to the cycle that receives the measurement which answers it; a \
             gap where no valid new one arrived. It is the age in the record plus one.",
        )
        .x("time", "s")
        .y("round trip", "cycles");
    let mut any = false;
    for (place, trace) in run.slots.iter().zip(&clock.round_trip_cycles) {
        if trace.value.iter().any(|cycles| cycles.is_finite()) {
            any = true;
            plot = line(plot, &place.place, trace, 1.0);
        }
    }
    if any {
        section.plot(plot)
    } else {
        section.text("No measurement of a rig was received, so there is no round trip to show.")
    }
}

pub(super) fn bus(summary: &Summary, plan: &[String]) -> Section {
    let frames = summary.frames;
    let counters = summary.bus_counters;
    let mut section = Section::new("Bus");
    for line in plan {
        section = section.text(line);
    }
    section.table(
        Table::new("Frames")
            .text("what")
            .number("count", "")
            .row([Cell::from("commands sent"), frames.sent.into()])
            .row([Cell::from("measurements received"), frames.received.into()])
            .row([Cell::from("measurements lost"), frames.lost.into()])
            .row([Cell::from("wrong CRC"), frames.crc_errors.into()])
            .row([Cell::from("repeated"), frames.repeated.into()])
            .row([Cell::from("wrong sequence"), frames.wrong_sequence.into()])
            .row([Cell::from("commands not taken by the bus"), frames.late.into()])
            .row([Cell::from("all frames sent"), counters.sent.into()])
            .row([Cell::from("all frames received"), counters.received.into()])
            .row([Cell::from("lost in the receive queue"), counters.receive_dropped.into()])
            .row([Cell::from("error frames"), counters.error_frames.into()]),
    )
}
