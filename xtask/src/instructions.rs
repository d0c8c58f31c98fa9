//! `cargo xtask instructions`: what a cycle costs in instructions, counted by callgrind.
//!
//! A count does not depend on what else the machine does. The bench `instructions` runs with two
//! numbers of cycles; the difference is free of what happens before the first one. The counts that
//! are committed in `benches/instructions.toml` are from one compiler; another one may count a few
//! per cent otherwise, so a difference is reported and only a rise of more than 3 % fails.

use std::path::Path;
use std::process::Command;

use crate::callgrind::Counts;
use crate::debian;
use crate::run::{Outcome, Run};

const CYCLES: [u32; 2] = [1000, 3000];

/// What is counted: a step with four modelled dampers and one with a rig, the other creep laws, and
/// four vehicles side by side.
const KINDS: [&str; 5] = ["step", "rig", "polach", "fastsim", "batch"];

/// Rise over the committed count that fails, %.
const RISE_PERCENT: f64 = 3.0;

/// Counts every kind of cycle and compares them with the committed counts.
pub(crate) fn count(run: &mut Run) -> Outcome {
    if let Err(reason) = debian::ensure("valgrind", &["valgrind"]) {
        return Outcome::Skipped(reason);
    }
    let committed = run.root.join("benches/instructions.toml");
    let mut all = Outcome::Passed;
    let mut counted = Vec::new();
    for kind in KINDS {
        match per_cycle(run, kind) {
            Ok(count) => counted.push((kind, count)),
            Err(reason) => return Outcome::Failed(reason),
        }
    }
    for (kind, count) in &counted {
        let Some(before) = kept(&committed, kind) else {
            return Outcome::Failed(format!("{}: no count of {kind}", committed.display()));
        };
        let rise = 100.0 * (count.instructions / before - 1.0);
        run.note(format!(
            "{kind}: {:.0} instructions a cycle, {rise:+.2} % of {before:.0}; memory is copied or \
             filled {:.2} times",
            count.instructions, count.copies
        ));
        if rise > RISE_PERCENT {
            all = all.and(Outcome::Failed(format!("{kind} is dearer by {rise:.1} %")));
        }
    }
    if let [(_, step), (_, rig), ..] = counted.as_slice() {
        run.note(format!(
            "a rig slot costs {:.0} instructions more than a modelled one",
            rig.instructions - step.instructions
        ));
    }
    all
}

/// A committed count: `step = 123456` in a line of its own.
pub(crate) fn kept(file: &Path, kind: &str) -> Option<f64> {
    let text = std::fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(kind)?.trim().strip_prefix('='))?;
    line.trim().replace('_', "").parse().ok()
}

fn per_cycle(run: &Run, kind: &str) -> Result<Counts, String> {
    let [few, many] = CYCLES.map(|cycles| counts(run, kind, cycles));
    Ok(Counts::per_cycle(few?, many?, CYCLES[1] - CYCLES[0]))
}

/// What a whole run of the bench came to.
fn counts(run: &Run, kind: &str, cycles: u32) -> Result<Counts, String> {
    let folder = run.temporary();
    let file = folder.map_err(|error| format!("a folder for callgrind: {error}"))?.join("counts");
    let mut cargo: Command = run.cargo();
    cargo.args(["bench", "--bench", "instructions", "--", kind, &cycles.to_string()]);
    let runner = format!("valgrind --tool=callgrind --callgrind-out-file={}", file.display());
    // For whichever target this is: the name of the variable holds it.
    let target = format!("{}_UNKNOWN_LINUX_GNU", std::env::consts::ARCH.to_uppercase());
    cargo.env(format!("CARGO_TARGET_{target}_RUNNER"), runner);
    let output = cargo.output().map_err(|error| format!("cargo bench: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let counted = std::fs::read_to_string(&file).ok().and_then(|text| Counts::read(&text));
    counted
        .ok_or_else(|| format!("callgrind counted nothing: {}", text.lines().last().unwrap_or("")))
}
