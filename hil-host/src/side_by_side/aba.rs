//! An ABA test: one condition before and after the other.

use super::groups::Group;
use serde::Serialize;

/// The runs of one group between which the other group was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Aba {
    /// The group that was measured before and after.
    pub group: String,
    /// Its first run.
    pub first: String,
    /// Its last run.
    pub last: String,
}

/// Index of a group that was measured before and after the other one, with its first and its last
/// run; none where one group was over before the other began. A computation that was repeated to
/// the last bit is no second measurement.
pub(super) fn around(groups: [&Group; 2]) -> Option<(usize, [usize; 2])> {
    let starts = groups.map(|group| {
        let runs = group.runs.iter().zip(group.is_repeat()).enumerate();
        let repeats = runs.filter(|(_, (_, is_repeat))| *is_repeat);
        repeats.map(|(n, (run, _))| (n, run.started_unix_s)).collect::<Vec<_>>()
    });
    [[0, 1], [1, 0]].into_iter().find_map(|[one, other]| {
        let (first, last) = (starts[one].first()?, starts[one].last()?);
        let is_between = |(_, start): &(usize, f64)| first.1 < *start && *start < last.1;
        starts[other].iter().any(is_between).then_some((one, [first.0, last.0]))
    })
}
