//! Frames that are lost at random: a little is held over, a lot ends the run.

use super::{CyclesDone, FaultsArgs};
use crate::error::CommandError;
use crate::output::print;
use crate::stop;
use hil_host::faults::{Injected, Losses, lose_at_random};
use report::significant;
use scenario::run::{CYCLE_S, Overrides, Run};

/// Longest session (s).
const SESSION_S: f64 = 600.0;

/// Sessions with losses that end the run, in each direction.
const ENDING: usize = 100;

/// Cycles within which they are to end, and the least number that does.
const ENDS_WITHIN: u64 = 500;
const ENDS_AT_LEAST: usize = 99;

/// Loses frames and prints what became of the sessions; whether all was as expected.
pub(super) fn inject(args: &FaultsArgs, seconds: f64) -> Result<bool, CommandError> {
    let session_s = seconds.min(SESSION_S);
    let overrides = Overrides { duration_s: Some(session_s), ..Overrides::default() };
    let run = Run::load_at_usual_rate(&args.scenario, overrides)?;
    let sessions = |seconds: f64| (seconds / session_s).ceil().max(1.0) as usize;
    let cycles = (session_s / CYCLE_S).round() as u64;
    let of = |measurements: f64, sessions: usize| Losses {
        measurements,
        commands: 0.0,
        sessions,
        cycles,
    };
    let mut holds = true;
    for losses in [of(1e-3, sessions(seconds)), of(1e-2, sessions(seconds / 24.0))] {
        let injected = lose(&run, losses, args.seed)?;
        let done: u64 = injected.iter().map(|injected| injected.cycles).sum();
        let lost: u64 = injected.iter().map(|injected| injected.lost).sum();
        let ended = injected.iter().filter(|injected| injected.stop.is_some()).count();
        let violated = injected.iter().filter(|injected| injected.violation.is_some()).count();
        holds &= ended == 0 && violated == 0;
        print(&format!(
            "{} of the measurements lost: {} h in {} sessions, {lost} lost ({}), {ended} sessions \
             ended, {violated} violations",
            percent(losses.measurements),
            significant(done as f64 * CYCLE_S / 3600.0, 4),
            injected.len(),
            percent(lost as f64 / done.max(1) as f64),
        ))?;
    }
    let most = Losses { measurements: 0.1, commands: 0.0, sessions: ENDING, cycles: 1000 };
    let both =
        [(most, "measurements"), (Losses { measurements: 0.0, commands: 0.1, ..most }, "commands")];
    for (losses, what) in both {
        let injected = lose(&run, losses, args.seed)?;
        let ends_after = |injected: &Injected| {
            injected.cycles_to_detect().filter(|_| injected.violation.is_none())
        };
        let ended: Vec<u64> = injected.iter().filter_map(ends_after).collect();
        let in_time = ended.iter().filter(|cycles| **cycles <= ENDS_WITHIN).count();
        holds &= in_time >= ENDS_AT_LEAST;
        let latest = ended.iter().max().map_or("-".to_owned(), u64::to_string);
        print(&format!(
            "10 % of the {what} lost: {in_time} of {} sessions ended within {ENDS_WITHIN} cycles, \
             the latest after {latest}",
            injected.len()
        ))?;
    }
    Ok(holds)
}

fn lose(run: &Run, losses: Losses, seed: u64) -> Result<Vec<Injected>, CommandError> {
    let progress = CyclesDone::new("losses", losses.sessions as u64 * losses.cycles);
    Ok(lose_at_random(run, losses, seed, stop::flag(), &|done| progress.add(done))?)
}

fn percent(share: f64) -> String {
    format!("{} %", significant(share * 100.0, 3))
}
