//! Which runs are repeats of one condition, and what cannot stand beside what.

use super::condition::{Differing, Surroundings};
use super::finished::FinishedRun;
use crate::BenchError;
use std::path::PathBuf;

/// The runs that are set side by side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RunGroups {
    /// Grouped by what they recorded: the same condition, the same group.
    ByCondition(Vec<PathBuf>),
    /// Grouped by the user, with names.
    Named(Vec<(String, Vec<PathBuf>)>),
}

/// Repeats of one condition.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    pub(super) name: String,
    /// In the order in which they began.
    pub(super) runs: Vec<FinishedRun>,
    /// In what it differs from the first group.
    pub(super) differing: Vec<Differing>,
}

impl RunGroups {
    /// All of them, in the order in which they were named.
    pub(super) fn paths(&self) -> Vec<&PathBuf> {
        match self {
            Self::ByCondition(paths) => paths.iter().collect(),
            Self::Named(groups) => groups.iter().flat_map(|(_, paths)| paths).collect(),
        }
    }

    /// The groups of these runs, which are those of [`paths`](Self::paths).
    ///
    /// # Errors
    /// A run that cannot stand beside another one.
    pub(super) fn of(&self, runs: Vec<FinishedRun>) -> Result<Vec<Group>, BenchError> {
        debug_assert_eq!(runs.len(), self.paths().len(), "other runs");
        refuse_twice(&runs)?;
        refuse_one_force_beside_others(&runs)?;
        let mut groups = match self {
            Self::ByCondition(_) => by_condition(runs),
            Self::Named(named) => {
                let mut runs = runs.into_iter();
                let of = |(name, paths): &(String, Vec<PathBuf>)| Group {
                    name: name.clone(),
                    runs: runs.by_ref().take(paths.len()).collect(),
                    differing: Vec::new(),
                };
                named.iter().map(of).collect()
            }
        };
        for group in &groups {
            refuse_mixed(group)?;
        }
        if let Some((reference, others)) = groups.split_first_mut() {
            for group in others {
                let [one, other] = [&reference.runs[0], &group.runs[0]];
                group.differing = other.condition.differing(&one.condition);
                refuse_confounded(group, one)?;
            }
        }
        for group in &mut groups {
            group.runs.sort_by(|a, b| a.started_unix_s.total_cmp(&b.started_unix_s));
        }
        Ok(groups)
    }
}

impl Group {
    /// Whether each run is a computation of its own. Two with one trajectory hash are the same one,
    /// to the last bit, and say nothing about how well it repeats.
    pub(super) fn is_repeat(&self) -> Vec<bool> {
        let hash = |run: &FinishedRun| run.trajectory_hash.clone();
        let before = |n: usize| self.runs.iter().take(n).map(hash);
        self.runs.iter().enumerate().map(|(n, run)| before(n).all(|h| h != hash(run))).collect()
    }
}

/// Groups A, B, C in the order of their first runs.
fn by_condition(runs: Vec<FinishedRun>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for run in runs {
        let same = groups.iter_mut().find(|group| group.runs[0].condition == run.condition);
        if let Some(group) = same {
            group.runs.push(run);
        } else {
            let name = letters(groups.len());
            groups.push(Group { name, runs: vec![run], differing: Vec::new() });
        }
    }
    groups
}

/// A, B, ..., Z, A2, B2.
fn letters(index: usize) -> String {
    let letter = char::from(b'A' + (index % 26) as u8);
    let round = index / 26 + 1;
    if round == 1 { letter.to_string() } else { format!("{letter}{round}") }
}

fn refused(run: &FinishedRun, found: String, expected: String) -> BenchError {
    BenchError::Incomparable { run: run.path.clone(), found, expected }
}

/// The same folder, or a copy of it.
fn refuse_twice(runs: &[FinishedRun]) -> Result<(), BenchError> {
    for (n, run) in runs.iter().enumerate() {
        let is_copy = |other: &&FinishedRun| {
            other.place == run.place
                || (other.trajectory_hash == run.trajectory_hash
                    && other.started_unix_s == run.started_unix_s)
        };
        if let Some(other) = runs[..n].iter().find(is_copy) {
            let found = format!("the same run as {}", shown(other));
            return Err(refused(run, found, "each run once".to_owned()));
        }
    }
    Ok(())
}

/// One force on several bogies is another vehicle: of both bogies one is driven by the other.
fn refuse_one_force_beside_others(runs: &[FinishedRun]) -> Result<(), BenchError> {
    let one_force = runs.iter().find(|run| run.has_other_bogie);
    let other = runs.iter().find(|run| !run.has_other_bogie);
    let (Some(run), Some(other)) = (one_force, other) else { return Ok(()) };
    let found = "on = \"other_bogie\": one measured force on several bogies".to_owned();
    Err(refused(run, found, format!("no such run beside others, such as {}", shown(other))))
}

/// Repeats have vehicle, speed, track and duration in common.
fn refuse_mixed(group: &Group) -> Result<(), BenchError> {
    let Some((first, others)) = group.runs.split_first() else { return Ok(()) };
    for run in others {
        let differing = run.condition.differing(&first.condition);
        if let Some(key) = differing.iter().find(|key| key.surroundings().is_some()) {
            let expected = format!("that of {}, which is named as a repeat of it", shown(first));
            return Err(refused(run, key.shown(), expected));
        }
    }
    Ok(())
}

/// Vehicle, speed, track or duration may be what differs; then nothing else may.
fn refuse_confounded(group: &Group, reference: &FinishedRun) -> Result<(), BenchError> {
    let mut kinds: Vec<(Option<Surroundings>, &Differing)> =
        group.differing.iter().map(|key| (key.surroundings(), key)).collect();
    kinds.sort_by_key(|(kind, _)| kind.is_none());
    kinds.dedup_by_key(|(kind, _)| *kind);
    let [(Some(_), one), (_, other), ..] = kinds[..] else { return Ok(()) };
    let found = format!("another {} and another {}", one.shown(), other.shown());
    let expected = format!("only one of them to differ from {}", shown(reference));
    Err(refused(&group.runs[0], found, expected))
}

fn shown(run: &FinishedRun) -> String {
    files::quoted(&run.path.display().to_string()).to_string()
}
