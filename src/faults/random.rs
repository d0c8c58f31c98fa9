//! Random faults at random times.

use super::{CyclesDone, FaultsArgs};
use crate::error::CommandError;
use crate::output::print;
use crate::stop;
use hil_host::faults::{Survey, schedule};
use scenario::run::Run;

/// Violations that are printed.
const MOST_LINES: usize = 20;

/// Injects random faults and prints what became of them; whether every invariant held.
pub(super) fn inject(run: &Run, args: &FaultsArgs) -> Result<bool, CommandError> {
    let progress = CyclesDone::new("random faults", args.cycles);
    let survey = schedule(run, args.seed, args.cycles, stop::flag(), &|done| progress.add(done))?;
    drop(progress);
    let Survey { cycles, faults, went_on, ramped_out, safe, refused, violations } = &survey;
    let mut lines = vec![format!(
        "{cycles} cycles with {faults} random faults, seed {}: {went_on} sessions went on, \
         {ramped_out} ramped out, {safe} ended in the safe state, {refused} could not begin; {} \
         violations",
        args.seed,
        violations.len()
    )];
    let described = violations.iter().filter_map(|(fault, injected)| {
        Some(format!("{fault:?} from cycle {}: {}", injected.begin, injected.violation?))
    });
    lines.extend(described.take(MOST_LINES));
    print(&lines.join("\n"))?;
    Ok(violations.is_empty())
}
