//! Sound rigs: how often does a detector raise a false alarm?

use super::{CyclesDone, FaultsArgs};
use crate::error::CommandError;
use crate::output::print;
use crate::stop;
use files::number;
use hil_host::Draw;
use hil_host::faults::{
    FalseAlarm, Heard, SoundCase, SoundScenarios, alarm_rate_bound_per_h, listen_to_sound_rigs,
    sound_cases,
};
use report::{Cell, Table, significant};
use scenario::run::CYCLE_S;
use std::collections::BTreeMap;

/// Runs the cases and prints their alarms; whether there was none.
pub(super) fn listen(args: &FaultsArgs, seconds: f64) -> Result<bool, CommandError> {
    let mut cases = sound_cases();
    let all = cases.len();
    if let Some(count) = args.cases {
        if count == 0 || count > all {
            let expected = format!("1 to {all}");
            return Err(CommandError::option(format!("--cases {count}"), expected));
        }
        let mut draw = Draw::seeded(args.seed, all as u64);
        while cases.len() > count {
            cases.remove(draw.number() as usize % cases.len());
        }
    }
    let scenarios = SoundScenarios { straight: &args.scenario, curve: &args.curve };
    let cycles = cases.len() as u64 * (seconds / CYCLE_S) as u64;
    let progress = CyclesDone::new("sound rigs", cycles);
    let done = |cycles| progress.add(cycles);
    let heard = listen_to_sound_rigs(scenarios, &cases, seconds, args.seed, stop::flag(), &done)?;
    drop(progress);
    let table = Table::new("")
        .text("rig")
        .text("track")
        .text("damper")
        .number("2a", "mm")
        .text("seed")
        .number("time", "h")
        .number("alarms", "")
        .text("signals");
    let mut lines = table.rows(heard.iter().map(cells)).lines();
    for heard in &heard {
        let messages = heard.alarms.iter();
        lines.extend(messages.map(|alarm| format!("{}: {}", in_words(heard.case), alarm.message)));
    }
    let hours: f64 = heard.iter().map(hours).sum();
    let alarms: usize = heard.iter().map(|heard| heard.alarms.len()).sum();
    let proven = if alarms == 0 {
        let bound = significant(alarm_rate_bound_per_h(hours), 3);
        format!("no alarm: a rate below {bound} per hour at 95 %")
    } else {
        format!("{alarms} alarms")
    };
    lines.push(format!(
        "{} of {all} cases, seed {}, {} hours: {proven}",
        cases.len(),
        args.seed,
        significant(hours, 4)
    ));
    print(&lines.join("\n"))?;
    Ok(alarms == 0)
}

fn hours(heard: &Heard) -> f64 {
    heard.cycles as f64 * CYCLE_S / 3600.0
}

/// The words of a case: rig, track, damper.
fn words(case: SoundCase) -> [&'static str; 3] {
    [
        if case.is_slow { "slow" } else { "laboratory" },
        if case.is_curve { "curve" } else { "straight" },
        if case.is_soft { "worn" } else { "new" },
    ]
}

fn in_words(case: SoundCase) -> String {
    let [rig, track, damper] = words(case);
    format!("{rig} rig, {track}, {damper} damper, 2a {} mm", number(case.clearance_2a_m * 1e3))
}

fn cells(heard: &Heard) -> [Cell; 8] {
    let mut signals: BTreeMap<&str, usize> = BTreeMap::new();
    for FalseAlarm { signal, .. } in &heard.alarms {
        *signals.entry(signal).or_default() += 1;
    }
    let signals: Vec<String> =
        signals.iter().map(|(signal, count)| format!("{signal} {count}")).collect();
    let [rig, track, damper] = words(heard.case);
    [
        rig.into(),
        track.into(),
        damper.into(),
        (heard.case.clearance_2a_m * 1e3).into(),
        heard.seed.to_string().into(),
        hours(heard).into(),
        (heard.alarms.len() as u64).into(),
        signals.join(", ").into(),
    ]
}
