//! The scores as tables.

use super::answer::{Aim, Answer, Below, InRegimes, Score};
use super::errors::Errors;
use report::{Cell, Table};

/// What others have to know about every number.
pub(super) const CONDITIONS: [&str; 5] = [
    "emulated rig: servo-hydraulic with a dead time in series; all four dampers behind rigs; no \
     number here is of a real one",
    "track: class-6 track at the speed of the scenario, 12 s; hunting: the limit cycle far above the \
     critical speed, 5 s",
    "work: what the measured forces take from the vehicle per cycle of hunting; stroke: of the \
     dampers on their rigs; phase: of the rig at the frequency of hunting, negative where it is \
     late; all against the run with all dampers modelled",
    "critical: the speed below which no hunting stays, met within 0.5 km/h",
    "an empty cell: not asked for, or the vehicle left the track or lost its limit cycle",
];

/// The answer as text for a terminal.
pub fn text(answer: &Answer) -> String {
    let mut lines = Vec::new();
    for table in tables(answer) {
        lines.extend(table.lines());
        lines.push(String::new());
    }
    lines.extend(CONDITIONS.map(str::to_owned));
    lines.push(String::new());
    lines.extend(answer.aims.iter().map(in_words));
    lines.join("\n")
}

/// All tables that have a row.
pub(super) fn tables(answer: &Answer) -> Vec<Table> {
    let mut tables = vec![modelled(answer), nominal(answer)];
    if answer.scores.iter().any(|score| score.perturbed.is_some()) {
        tables.push(perturbed(answer));
    }
    if !answer.from_below.is_empty() {
        tables.push(from_below(&answer.from_below));
    }
    tables
}

/// An aim in a line.
pub(super) fn in_words(aim: &Aim) -> String {
    let Aim { criterion, unit, over, compensator, place, most, .. } = aim;
    let found = aim.found.map_or("lost".to_owned(), |found| format!("{found:.2} {unit}"));
    let met = if aim.is_met { "met" } else { "MISSED" };
    format!("{criterion}, {over}, {compensator}: {found} ({place}), at most {most} {unit}: {met}")
}

fn modelled(answer: &Answer) -> Table {
    let table = Table::new("All dampers modelled")
        .text("damper")
        .fixed("track at", "km/h", 0)
        .fixed("work", "J", 1)
        .fixed("stroke", "mm", 2)
        .fixed("hunting at", "km/h", 0)
        .fixed("frequency", "Hz", 3)
        .fixed("work", "J", 1)
        .fixed("stroke", "mm", 2)
        .written("critical", "km/h")
        .fixed("per % of damping", "km/h", 3);
    table.rows(answer.dampers.iter().map(|one| {
        [
            Cell::from(one.damper.name()),
            one.track.kmh.into(),
            one.track.work_j.into(),
            (1e3 * one.track.stroke_m).into(),
            one.hunting.kmh.into(),
            one.hunting_hz.into(),
            one.hunting.work_j.into(),
            (1e3 * one.hunting.stroke_m).into(),
            one.critical.map(|speed| speed.to_string()).into(),
            one.kmh_per_percent_of_damping.into(),
        ]
    }))
}

/// The columns of errors in a regime.
fn with_errors(table: Table, regime: &str) -> Table {
    table.fixed(&format!("{regime}: work"), "%", 2).fixed("stroke", "%", 2).fixed("phase", "deg", 3)
}

/// The cells of errors; empty where there are none.
fn cells(errors: Option<Errors>) -> [Cell; 3] {
    let of = |value: fn(&Errors) -> f64| Cell::from(errors.as_ref().map(value));
    [of(|one| one.work_percent), of(|one| one.stroke_percent), of(|one| one.phase_deg)]
}

fn first(score: &Score) -> [Cell; 3] {
    let dead_time_ms = Cell::from(u64::from(score.dead_time_ms));
    [score.damper.name().into(), score.compensator.into(), dead_time_ms]
}

fn nominal(answer: &Answer) -> Table {
    let table = Table::new("Nominal rig").text("damper").text("compensator");
    let table = table.number("dead time", "ms");
    let mut table = with_errors(with_errors(table, "track"), "hunting");
    let has_speeds = answer.scores.iter().any(|score| score.critical.is_some());
    if has_speeds {
        table = table.written("critical", "km/h").fixed("off by", "km/h", 1);
    }
    table.rows(answer.scores.iter().map(|score| {
        let InRegimes { track, hunting } = score.nominal;
        let mut row: Vec<Cell> = first(score).into();
        row.extend(cells(track));
        row.extend(cells(hunting));
        if has_speeds {
            row.push(score.critical.map(|speed| speed.to_string()).into());
            row.push(score.critical_error_kmh.into());
        }
        row
    }))
}

fn perturbed(answer: &Answer) -> Table {
    let rigs = answer.question.perturbed_rigs;
    let mut table = Table::new(&format!("{rigs} perturbed rigs: sizes of the errors"))
        .text("damper")
        .text("compensator")
        .number("dead time", "ms");
    for regime in ["track", "hunting"] {
        for (name, unit, decimals) in [("work", "%", 2), ("stroke", "%", 2), ("phase", "deg", 3)] {
            let named = if name == "work" { format!("{regime}: work") } else { name.to_owned() };
            table = table
                .fixed(&format!("{named} mean"), unit, decimals)
                .fixed("worst", unit, decimals);
        }
        table = table.number("lost", "");
    }
    let rows = answer.scores.iter().filter_map(|score| {
        let InRegimes { track, hunting } = score.perturbed?;
        let mut row: Vec<Cell> = first(score).into();
        for spread in [track, hunting] {
            for (mean, worst) in cells(spread.mean).into_iter().zip(cells(spread.worst)) {
                row.extend([mean, worst]);
            }
            row.push(spread.lost.into());
        }
        Some(row)
    });
    table.rows(rows)
}

fn from_below(all: &[Below]) -> Table {
    let table = Table::new("Critical speed from below, by ring-downs")
        .text("damper")
        .text("dampers are")
        .number("ring-downs", "")
        .written("from", "km/h")
        .written("extrapolated", "km/h")
        .written("95 %", "km/h")
        .fixed("largest stroke of a ram", "mm", 2);
    table.rows(all.iter().map(|one| {
        let found = &one.found;
        let kmh = |speed: Option<f64>| speed.map_or("-".to_owned(), |kmh| format!("{kmh:.1}"));
        let [low, high] = found.interval_kmh;
        let speeds = match found.ring_downs.as_slice() {
            [] => "-".to_owned(),
            [only] => format!("{:.0}", only.kmh),
            [first, .., last] => format!("{:.0} to {:.0}", first.kmh, last.kmh),
        };
        let how = match (one.compensator, one.dead_time_ms) {
            (Some(name), Some(dead_time_ms)) => format!("on rigs, {name}, {dead_time_ms} ms"),
            _ => "modelled".to_owned(),
        };
        [
            Cell::from(one.damper.name()),
            how.into(),
            (found.ring_downs.len() as u64).into(),
            speeds.into(),
            kmh(found.critical_kmh).into(),
            format!("{} to {}", kmh(low), kmh(high)).into(),
            (1e3 * found.largest_stroke_m).into(),
        ]
    }))
}
