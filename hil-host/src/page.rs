//! `report.html`: what a person reads of a run.

use crate::columns::Columns;
use crate::summary::{DamperSummary, SEGMENT_S, Summary};
use firmware_core::vehicle::DAMPER_SLOTS;
use report::{Cell, Plot, Report, Section, Table, Tile, logarithmic_bins};
use scenario::run::{CYCLE_S, Run};
use signal::spectrum::Spectrum;

/// The report of a run; with `compared`, also what stands beside it.
pub fn page(
    run: &Run,
    summary: &Summary,
    columns: &Columns,
    bus_plan: &[String],
    compared: Option<Section>,
) -> Report {
    let first = columns.first_after(run.run_in_s);
    let mut report = Report::new(&run.title)
        .subtitle(&format!(
            "{} at {:.0} km/h, {:.1} s, bus {}, pace {}",
            run.vehicle_name, summary.speed_kmh, summary.duration_s, summary.bus, summary.pace
        ))
        .fact("trajectory hash", &summary.trajectory_hash)
        .section(overview(run, summary, columns));
    if let Some(section) = compared {
        report = report.section(section);
    }
    report = report.section(accelerations(columns, first));
    for section in [forces(run, columns, first), loops(run, columns, first)] {
        report = report.section(section);
    }
    if let Some(section) = watch(run, columns) {
        report = report.section(section);
    }
    report
        .section(spectra(run, columns, first))
        .section(timing(summary, columns))
        .section(bus(summary, bus_plan))
        .section(about(run))
}

/// Up to this length a whole trace is drawn beside an enlarged part (s).
const ZOOM_S: f64 = 2.0;

fn overview(run: &Run, summary: &Summary, columns: &Columns) -> Section {
    let state = Tile::text("state", &summary.state);
    let lost = Tile::count("measurements lost", summary.frames.lost);
    let mut section = Section::new("Overview")
        .tiles([
            if summary.state == "safe" { state.bad() } else { state.good() },
            Tile::count("cycles of 1 ms", summary.steps),
            Tile::number("vehicle step, median", summary.step_compute_us.p50, "µs"),
            Tile::count("slots skipped", summary.overruns),
            if summary.frames.lost > 0 { lost.bad() } else { lost },
        ])
        .table(damper_table(&summary.damper))
        .table(acceleration_table(summary));
    section = section.text(&format!(
        "Statistics leave out the first {:.1} s. Stroke: mean peak is the mean over half cycles. \
         Frequencies by two definitions: the peak of the stroke's spectrum above 0.5 Hz, and half \
         the rate of its zero crossings.",
        run.run_in_s
    ));
    if columns.left_out > 0 {
        section = section.warning(&format!(
            "The report shows the first {} cycles; {} more are in the record.",
            columns.time_s.len(),
            columns.left_out
        ));
    }
    if summary.record_dropped > 0 {
        section = section
            .warning(&format!("The recorder had no room for {} entries.", summary.record_dropped));
    }
    section
}

fn damper_table(dampers: &[DamperSummary]) -> Table {
    let mut table = Table::new("Yaw dampers")
        .text("damper")
        .text("is")
        .number("force min", "kN")
        .number("force max", "kN")
        .number("force rms", "kN")
        .number("stroke mean peak", "mm")
        .number("stroke max", "mm")
        .number("PSD peak", "Hz")
        .number("zero crossings", "Hz")
        .number("work", "J/s")
        .number("energy error", "%");
    for damper in dampers {
        table = table.row([
            Cell::from(damper.name.as_str()),
            Cell::from(damper.place.as_str()),
            (damper.force_n.min * 1e-3).into(),
            (damper.force_n.max * 1e-3).into(),
            (damper.force_n.rms * 1e-3).into(),
            damper.stroke_m.mean_peak.map(|m| m * 1e3).into(),
            (damper.stroke_m.max * 1e3).into(),
            damper.frequency_psd_peak_hz.into(),
            damper.frequency_zero_crossing_hz.into(),
            damper.work_per_s_j.into(),
            damper.exchanged_energy_error.map(|error| error * 100.0).into(),
        ]);
    }
    table
}

fn acceleration_table(summary: &Summary) -> Table {
    let mut table = Table::new("Accelerations, rms")
        .text("body")
        .number("lateral", "m/s²")
        .number("vertical", "m/s²");
    let bodies = [
        ("carbody", summary.accelerations.carbody),
        ("bogie, front", summary.accelerations.bogie_front),
        ("wheelset 1", summary.accelerations.wheelset_1),
    ];
    for (name, body) in bodies {
        table = table.row([
            Cell::from(name),
            body.map(|b| b.lateral_rms_m_per_s2).into(),
            body.map(|b| b.vertical_rms_m_per_s2).into(),
        ]);
    }
    table
}

fn accelerations(columns: &Columns, first: usize) -> Section {
    let time = &columns.time_s[first..];
    let trace = |index: usize| &columns.acceleration[index][first..];
    let section = Section::new("Accelerations");
    let plot = |title: &str, offset: usize| {
        Plot::new(title)
            .x("time", "s")
            .y("wheelset 1", "m/s²")
            .line("wheelset 1", time, trace(4 + offset))
            .panel_below("bogie, front", "m/s²")
            .line("bogie, front", time, trace(2 + offset))
            .panel_below("carbody", "m/s²")
            .line("carbody", time, trace(offset))
    };
    section
        .plot(plot("Lateral acceleration of wheelset, bogie and carbody", 0))
        .plot(plot("Vertical acceleration of wheelset, bogie and carbody", 1))
}

fn forces(run: &Run, columns: &Columns, first: usize) -> Section {
    let time = &columns.time_s[first..];
    let mut section = Section::new("Damper forces");
    // Left and right of a bogie together: one pushes while the other drags.
    for pair in run.slots.chunks(2).enumerate() {
        let (number, slots) = pair;
        let mut plot =
            Plot::new(&format!("Force of {}", names(slots))).x("time", "s").y("force", "kN");
        for (side, slot) in slots.iter().enumerate() {
            let force = kilo(&columns.force_n[2 * number + side][first..]);
            plot = plot.line(&slot.place, time, &force);
        }
        if let Some((from, to)) = liveliest(&columns.force_n[2 * number][first..], time) {
            plot = plot.zoom("Enlarged: the dead zone at every reversal", from..=to);
        }
        section = section.plot(plot);
    }
    section
}

fn names(slots: &[scenario::run::Slot]) -> String {
    slots.iter().map(|slot| slot.place.as_str()).collect::<Vec<_>>().join(" and ")
}

/// The window of [`ZOOM_S`] with the most work in it.
fn liveliest(force: &[f64], time: &[f64]) -> Option<(f64, f64)> {
    let from = *time.get(most_in(force, (ZOOM_S / CYCLE_S) as usize)?)?;
    Some((from, from + ZOOM_S))
}

/// Where the window with the greatest sum of squares begins; none in a trace hardly longer than it.
pub(crate) fn most_in(values: &[f64], window: usize) -> Option<usize> {
    let (mut sum, mut best, mut at) = (0.0, -1.0, 0);
    for (index, value) in values.iter().enumerate() {
        sum += value * value;
        if index >= window {
            sum -= values[index - window] * values[index - window];
        }
        if index + 1 >= window && sum > best {
            (best, at) = (sum, index + 1 - window);
        }
    }
    (values.len() > 2 * window).then_some(at)
}

pub(crate) fn kilo(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e-3).collect()
}

pub(crate) fn milli(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value * 1e3).collect()
}

fn loops(run: &Run, columns: &Columns, first: usize) -> Section {
    let mut section = Section::new("Loops");
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let force = kilo(&columns.force_n[slot][first..]);
        let stroke = milli(&columns.extension_m[slot][first..]);
        let rate = milli(&columns.rate_m_per_s[slot][first..]);
        section = section.plots([
            Plot::new(&format!("Force over displacement, {}", place.place))
                .x("displacement", "mm")
                .y("force", "kN")
                .line(&place.place, &stroke, &force),
            Plot::new(&format!("Force over velocity, {}", place.place))
                .x("velocity", "mm/s")
                .y("force", "kN")
                .line(&place.place, &rate, &force),
        ]);
    }
    section
}

/// Measured less modelled force of every watched rig, from the start of the run.
fn watch(run: &Run, columns: &Columns) -> Option<Section> {
    let mut section = Section::new("Watch over the rigs").text(
        "Force that a rig measured less the force of the model that the scenario names for it, driven \
         with the measured displacement. The usual residual is learnt first; drift is raised where \
         the running rms rises above the limit and taken back below two thirds of it.",
    );
    let mut table = Table::new("Residual")
        .text("damper")
        .number("rms, learnt", "N")
        .number("rms at the end", "N")
        .text("drift at the end")
        .number("drift first raised", "s")
        .number("cycles with drift", "");
    let mut any = false;
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let watched = &columns.watch[slot];
        if watched.verdict == 0 {
            continue;
        }
        any = true;
        let drift = ["no watch", "still learning", "no", "yes"];
        table = table.row([
            Cell::from(place.place.as_str()),
            watched.learnt_rms_n.into(),
            Some(watched.rms_n).filter(|rms| rms.is_finite()).into(),
            Cell::from(drift[usize::from(watched.verdict.min(3))]),
            watched.drift_since_s.into(),
            watched.drift_cycles.into(),
        ]);
        let known = columns.residual_limit_n[slot].iter().position(|limit| limit.is_finite());
        let time = &columns.time_s[..columns.residual_rms_n[slot].len()];
        let from = columns.residual_rms_n[slot].iter().position(|rms| rms.is_finite());
        let mut plot =
            Plot::new(&format!("Residual of {}", place.place)).x("time", "s").y("rms", "N");
        if let Some(from) = from {
            plot = plot.line("running rms", &time[from..], &columns.residual_rms_n[slot][from..]);
        }
        if let Some(known) = known {
            let limit = &columns.residual_limit_n[slot][known..];
            plot = plot.line("limit", &time[known..], limit);
        }
        section = section.plot(plot);
        if let Some(since_s) = watched.drift_since_s {
            section = section.warning(&format!(
                "{}: the rig's damper has not behaved like its model since {since_s:.3} s, for {} cycles.",
                place.place, watched.drift_cycles
            ));
        }
    }
    any.then(|| section.table(table))
}

/// Highest frequency that spectra show (Hz).
const SPECTRUM_TO_HZ: f64 = 50.0;

/// Frequencies (Hz) and densities of a trace, up to what a plot shows.
pub(crate) fn spectrum(values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    match Spectrum::welch(values, 1.0 / CYCLE_S, SEGMENT_S) {
        Ok(spectrum) => spectrum
            .lines()
            .filter(|(frequency, density)| {
                *frequency > 0.0 && *frequency <= SPECTRUM_TO_HZ && *density > 0.0
            })
            .unzip(),
        Err(_) => (Vec::new(), Vec::new()),
    }
}

fn spectra(run: &Run, columns: &Columns, first: usize) -> Section {
    let mut lateral = Plot::new("Lateral acceleration")
        .x("frequency", "Hz")
        .y("power spectral density", "(m/s²)²/Hz")
        .log_x()
        .log_y();
    for (name, index) in [("wheelset 1", 4), ("bogie, front", 2), ("carbody", 0)] {
        let (frequency, density) = spectrum(&columns.acceleration[index][first..]);
        lateral = lateral.line(name, &frequency, &density);
    }
    let mut strokes = Plot::new("Damper stroke")
        .x("frequency", "Hz")
        .y("power spectral density", "m²/Hz")
        .log_x()
        .log_y();
    for (slot, place) in run.slots.iter().enumerate().take(DAMPER_SLOTS) {
        let (frequency, density) = spectrum(&columns.extension_m[slot][first..]);
        strokes = strokes.line(&place.place, &frequency, &density);
    }
    Section::new("Spectra")
        .text(&format!("Welch's method, Hann window, segments of {SEGMENT_S} s with half overlap."))
        .plot(lateral)
        .plot(strokes)
}

fn timing(summary: &Summary, columns: &Columns) -> Section {
    let values = |histogram: &hdrhistogram::Histogram<u64>| -> Vec<f64> {
        let mut values = Vec::new();
        for bucket in histogram.iter_recorded() {
            // A value of the histogram stands for all cycles in its bucket; a few hundred of each
            // are enough for the shape, the table has the exact percentiles.
            let micros = bucket.value_iterated_to() as f64 * 1e-3;
            let count = bucket.count_since_last_iteration().min(2_000_000) as usize;
            values.extend(std::iter::repeat_n(micros, count));
        }
        values
    };
    let mut plot = Plot::new("Histogram of cycle and step times")
        .x("time", "µs")
        .y("cycles", "")
        .log_x()
        .log_y();
    for (name, histogram) in
        [("receive to send", &columns.cycle_ns), ("vehicle step", &columns.compute_ns)]
    {
        let (edges, counts) = logarithmic_bins(&values(histogram), 60);
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
    Section::new("Timing").plot(plot).table(table)
}

fn bus(summary: &Summary, plan: &[String]) -> Section {
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

fn about(run: &Run) -> Section {
    let mut section = Section::new("About this run").text(
        "A laboratory tool and no safety function. The record is record.npy (NumPy), the frames are \
         in bus.log (candump format), the scenario with all defaults is in scenario.toml.",
    );
    for note in &run.about {
        section = section.note(note);
    }
    section
        .text("The scenario with every default written out:")
        .preformatted(&run.effective.scenario)
}
