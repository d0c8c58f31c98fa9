//! What a reader of a difference has to know about the runs behind it.

use super::finished::FinishedRun;
use super::groups::Group;
use std::collections::BTreeSet;

/// Most keys that a line names.
const KEYS_MAX: usize = 4;

/// One sentence each.
pub(super) fn notes(groups: &[Group]) -> Vec<String> {
    let mut notes = Vec::new();
    for group in groups {
        notes.extend(same_computations(group));
        notes.extend(unlike_repeats(group));
    }
    let runs = || groups.iter().flat_map(|group| &group.runs);
    for run in runs() {
        if let [why, ..] = &run.not_held[..] {
            notes.push(format!("{}: completed and not held: {why}", shown(run)));
        }
    }
    let first = runs().next().map(|run| &run.program);
    if let Some(other) = runs().find(|run| Some(&run.program) != first) {
        notes.push(format!("runs of several versions of the program, such as {}", other.program));
    }
    if runs().all(|run| run.on_memory) {
        let emulated = "emulated rigs: their repeats differ by the noise of the sensors and by what \
            their files say, not by a damper that was mounted anew";
        notes.push(emulated.to_owned());
    }
    notes
}

/// Runs that were computed twice.
fn same_computations(group: &Group) -> Vec<String> {
    let repeats = group.is_repeat();
    let runs = group.runs.iter().zip(&repeats);
    let again = runs.filter(|(_, is_repeat)| !**is_repeat).map(|(run, _)| {
        let hash = &run.trajectory_hash;
        let first = group.runs.iter().find(|first| first.trajectory_hash == *hash).unwrap_or(run);
        format!(
            "{}: the same computation as {}, to the last bit: no repeat, and counted once",
            shown(run),
            shown(first)
        )
    });
    again.collect()
}

/// Keys in which named repeats differ, if they do.
fn unlike_repeats(group: &Group) -> Option<String> {
    let (first, others) = group.runs.split_first()?;
    let differing = |run: &FinishedRun| run.condition.differing(&first.condition);
    let keys: BTreeSet<String> = others.iter().flat_map(differing).map(|found| found.key).collect();
    let named: Vec<&str> = keys.iter().take(KEYS_MAX).map(String::as_str).collect();
    let (name, more) = (&group.name, keys.len().saturating_sub(KEYS_MAX));
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let named = named.join(", ");
    (!keys.is_empty()).then(|| {
        format!("the runs of {name} differ in {named}{more}: the spread of {name} holds that too")
    })
}

fn shown(run: &FinishedRun) -> String {
    run.path.display().to_string()
}
