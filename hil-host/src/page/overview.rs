//! The overview: tiles, dampers, accelerations, and where the rest is.

use super::Ending;
use crate::control::End;
use crate::counts::Counts;
use crate::summary::{DamperSummary, StandInSummary, Summary};
use report::{Cell, Section, Table, Tile};
use scenario::run::Run;

pub(super) fn overview(run: &Run, summary: &Summary, counts: &Counts, ending: Ending) -> Section {
    let is_bad = matches!(summary.state, End::Safe | End::RampedOut) || summary.cause.is_some();
    let state = match ending {
        Ending::Known if is_bad => Tile::text("state", summary.state.name()).bad(),
        Ending::Known if !summary.not_held.is_empty() => {
            Tile::text("state", "completed, not held").doubtful()
        }
        Ending::Known => Tile::text("state", summary.state.name()).good(),
        Ending::Unknown { .. } => Tile::text("state", "no end recorded").bad(),
        Ending::Contradicted { .. } => Tile::text("state", "unknown").bad(),
    };
    let lost = Tile::count("measurements lost", summary.frames.lost);
    let mut section = Section::new("Overview");
    if let Ending::Unknown { asked_cycles } = ending {
        section = section.warning(&format!(
            "This run has no summary.json: its program was killed, or the power failed. The report \
             is made from record.npy, which holds {} cycles of the {asked_cycles} that were asked \
             for. How the run ended is not known; the frames on the bus are in bus.log.",
            counts.rows()
        ));
    }
    if let Ending::Contradicted { counted_cycles } = ending {
        section = section.warning(&format!(
            "record.npy is not whole, or not the record of this run: summary.json counts \
             {counted_cycles} cycles, the record holds {} and ends with cycle {}. This report shows \
             what is in the record; how the run ended is not known.",
            counts.rows(),
            counts.last.0
        ));
    }
    if let Some(cause) = &summary.cause {
        section = section.warning(&format!("Stopped {}.", cause.message));
    }
    for label in &summary.labels {
        section = section.warning(&format!(
            "In this run {label}. Its bogies do not move alike: it shows no critical speed and no \
             ride."
        ));
    }
    if summary.not_held.is_empty() {
        for drop_out in &summary.drop_outs {
            section = section.warning(&format!("{}.", drop_out.why.message));
        }
    }
    for reason in &summary.not_held {
        section = section.warning(&format!("Completed, not held: {reason}."));
    }
    for damper in &summary.damper {
        if let Some(warning) = damper.tracking.and_then(|tracking| tracking.warning()) {
            section = section.warning(&format!("{}: {warning}.", damper.name));
        }
        if let Some(warning) = damper.stand_in.as_ref().and_then(StandInSummary::warning) {
            section = section.warning(&format!("{}: {warning}.", damper.name));
        }
    }
    if let Some(fault) = &summary.record_fault {
        section = section.warning(fault);
    }
    section = section
        .tiles([
            state,
            Tile::count(&format!("cycles of {}", run.rate.cycle_in_words()), summary.steps),
            Tile::number("vehicle step, median", summary.step_compute_us.p50, "µs"),
            Tile::count("ticks skipped", summary.overruns),
            if summary.frames.lost > 0 { lost.bad() } else { lost },
        ])
        .table(damper_table(&summary.damper, summary.statistics_s > 0.0))
        .table(acceleration_table(summary));
    section = section.text(&format!(
        "Statistics leave out the first {:.1} s. Stroke: mean peak is the mean over half cycles. \
         Frequencies by two definitions: the peak of the stroke's spectrum above 0.5 Hz, and half \
         the rate of its zero crossings.",
        run.run_in_s
    ));
    if summary.record_dropped > 0 {
        section = section.warning(&format!(
            "The recorder or the disk had no room for {} entries.",
            summary.record_dropped
        ));
    }
    section
}

fn damper_table(dampers: &[DamperSummary], has_statistics: bool) -> Table {
    let known = |value: f64| Cell::from(has_statistics.then_some(value));
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
        .number("energy, vehicle less rig", "%");
    for damper in dampers {
        table = table.row([
            Cell::from(damper.name.as_str()),
            Cell::from(damper.place.as_str()),
            known(damper.force_n.min * 1e-3),
            known(damper.force_n.max * 1e-3),
            known(damper.force_n.rms * 1e-3),
            damper.stroke_m.mean_peak.map(|m| m * 1e3).into(),
            known(damper.stroke_m.max * 1e3),
            damper.frequency_psd_peak_hz.into(),
            damper.frequency_zero_crossing_hz.into(),
            known(damper.work_per_s_j),
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
        let known = body.filter(|_| summary.statistics_s > 0.0);
        table = table.row([
            Cell::from(name),
            known.map(|b| b.lateral_rms_m_per_s2).into(),
            known.map(|b| b.vertical_rms_m_per_s2).into(),
        ]);
    }
    table
}

pub(super) fn about(run: &Run) -> Section {
    let mut section = Section::new("About this run").text(
        "A laboratory tool and no safety function. The record is record.npy (NumPy), the frames \
         are in bus.log (candump format), the scenario with all defaults is in scenario.toml.",
    );
    for note in &run.about {
        section = section.note(note);
    }
    section
        .text("The scenario with every default written out:")
        .preformatted(&run.effective.scenario)
}
