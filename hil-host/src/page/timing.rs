//! How long cycles took, and which frames passed the bus.

use super::traces::line;
use crate::counts::Counts;
use crate::options::PaceChoice;
use crate::statistics::{ClockTraces, Trace};
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
            Cell::from("vehicle step"),
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
        .panel_below("wake-up late by", "ms");
    section.plot(line(plot, "wake-up late by", &clock.lateness_ns, 1e-6))
}

/// The round trip of every rig over time.
fn round_trip(run: &Run, section: Section, clock: &ClockTraces) -> Section {
    let rigs: Vec<(&str, &Trace)> = run
        .slots
        .iter()
        .map(|slot| slot.place.as_str())
        .zip(&clock.round_trip_cycles)
        .filter(|(_, trace)| trace.value.iter().any(|cycles| cycles.is_finite()))
        .collect();
    if rigs.is_empty() {
        return section
            .text("No measurement of a rig was received, so there is no round trip to show.");
    }
    let names: Vec<&str> = rigs.iter().map(|(place, _)| *place).collect();
    let mut plot = Plot::new(&format!("Round trip of {}", names.join(", ")))
        .caption(
            "Cycles from a command to the cycle that receives the measurement which answers it: \
             the age in the record plus one. A cycle without a new valid measurement has no value.",
        )
        .x("time", "s")
        .y("round trip", "cycles");
    for (place, trace) in rigs {
        plot = line(plot, place, trace, 1.0);
    }
    section.plot(plot)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{InputKind, Row};
    use report::Report;
    use scenario::run::Overrides;
    use std::path::Path;

    /// The text of the two plots over time, with a measurement that is one cycle old or with none.
    fn shown(pace: PaceChoice, input: InputKind) -> String {
        let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let run = Run::load(&scenario, Overrides::default()).unwrap();
        let mut row = Row { skipped: 1, ..Row::default() };
        (row.input[0], row.age_cycles[0]) = (input, 1);
        let mut clock = ClockTraces::of_rows(1);
        clock.take(&row);
        let section = round_trip(&run, deadlines(pace, Section::new("T"), &clock), &clock);
        let html = Report::new("R").section(section).to_html().unwrap();
        html.split_once("<main>").unwrap().1.to_owned()
    }

    #[test]
    fn skipped_ticks_are_drawn_where_a_clock_sets_the_pace_and_round_trips_where_there_is_a_rig() {
        let clocked = shown(PaceChoice::Realtime, InputKind::Fresh);
        assert!(clocked.contains("Skipped ticks and late wake-ups"));
        assert!(clocked.contains("Round trip of front left<"));
        for input in [InputKind::NoRig, InputKind::Missing] {
            let fast = shown(PaceChoice::Fast, input);
            assert!(
                fast.contains("Pace fast: no clock sets deadlines, so no tick can be skipped.")
            );
            assert!(fast.contains("there is no round trip to show"));
            assert!(!fast.contains("Skipped ticks") && !fast.contains("Round trip of"));
        }
    }
}
