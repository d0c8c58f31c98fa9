//! What comes of it, as JSON has it. The schema is `docs/schema/compare.schema.json`.

use super::aba::{Aba, around};
use super::condition::Differing;
use super::groups::Group;
use super::notes::notes;
use super::trust::{Judged, LEVEL, Trust, judge};
use crate::comparison::Figure;
use serde::Serialize;
use signal::repeats::Repeats;

/// Runs side by side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SideBySide {
    /// Version of this format.
    pub format: u32,
    /// Probability of one claim too many or more, among all of them.
    pub level: f64,
    /// How that is kept: `holm`.
    pub multiplicity: &'static str,
    /// The groups; the others are compared with the first.
    pub groups: Vec<ComparedGroup>,
    /// Every quantity, group by group.
    pub repeats: Vec<QuantityRepeats>,
    /// Every group but the first, compared with that.
    pub comparisons: Vec<GroupComparison>,
    /// Whether the difference or repeatability is larger: one line for each comparison, or one that
    /// says that there is none.
    pub in_words: Vec<String>,
    /// What one has to know about the runs, one sentence each.
    pub notes: Vec<String>,
}

/// Repeats of one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedGroup {
    /// What it is called.
    pub name: String,
    /// In the order in which they began.
    pub runs: Vec<ComparedRun>,
    /// In what its files differ from those of the first group.
    pub differing: Vec<Differing>,
}

/// A run of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedRun {
    /// Its folder.
    pub run: String,
    /// Title of its scenario.
    pub title: String,
    /// When it began, since 1970 (s).
    pub started_unix_s: f64,
    /// Its trajectory hash.
    pub trajectory_hash: String,
    /// False for a computation that another run of the group has made already.
    pub is_repeat: bool,
}

/// A quantity in every group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityRepeats {
    /// What it is.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// In the order of the groups.
    pub groups: Vec<Spread>,
}

/// Repeats of a quantity in a group; null where there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Spread {
    pub count: usize,
    pub mean: Option<f64>,
    /// With n - 1; null of a single run.
    pub standard_deviation: Option<f64>,
    pub min: Option<f64>,
    pub max: Option<f64>,
}

/// A group against the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupComparison {
    /// The group.
    pub group: String,
    /// The first group.
    pub against: String,
    /// The runs that show the drift of the bench; null without an ABA test.
    pub aba: Option<Aba>,
    /// Only clearances and stiffnesses differ in the files.
    pub is_wear: bool,
    /// Quantities whose difference is larger than repeatability.
    pub larger: usize,
    /// Quantities whose difference is within repeatability.
    pub within: usize,
    /// Quantities of which nothing is claimed.
    pub unknown: usize,
    /// Quantities of the larger ones in which the drift is more than half of the difference.
    pub drifted: usize,
    /// Every quantity.
    pub quantities: Vec<Difference>,
}

/// A difference in a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// What it is.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// Mean of the group less that of the first.
    pub difference: Option<f64>,
    /// Mean of the first group.
    pub reference: Option<f64>,
    /// The 95 % interval of the difference, one by one; null without a spread.
    pub interval: Option<[f64; 2]>,
    /// Degrees of freedom of that.
    pub degrees_of_freedom: Option<f64>,
    /// Probability of a difference as large by chance, one by one.
    pub p: Option<f64>,
    /// The same among all quantities of all groups.
    pub p_holm: Option<f64>,
    /// Last less first run of the ABA test.
    pub drift: Option<f64>,
    /// What is claimed.
    pub trust: Trust,
}

impl SideBySide {
    /// Of groups with the figures of their runs.
    pub(super) fn of(groups: &[Group], figures: &[Vec<Vec<Figure>>]) -> Self {
        debug_assert_eq!(groups.len(), figures.len(), "figures of other groups");
        let (quantities, missing) = common(figures);
        let repeats: Vec<Vec<Option<Repeats>>> = quantities
            .iter()
            .map(|(quantity, _)| {
                let pairs = groups.iter().zip(figures);
                pairs.map(|(group, figures)| repeats(group, figures, quantity)).collect()
            })
            .collect();
        let pairs = || (1..groups.len()).flat_map(|n| repeats.iter().map(move |of| [of[0], of[n]]));
        let mut judged = judge(&pairs().collect::<Vec<_>>()).into_iter();
        let comparisons = (1..groups.len()).map(|n| {
            let judged: Vec<Judged> = judged.by_ref().take(quantities.len()).collect();
            compared([(&groups[0], &figures[0]), (&groups[n], &figures[n])], &quantities, &judged)
        });
        let mut notes = notes(groups);
        if missing > 0 {
            notes.push(format!("{missing} quantities are not in every run and are left out"));
        }
        Self {
            format: 1,
            level: LEVEL,
            multiplicity: "holm",
            comparisons: comparisons.collect(),
            in_words: Vec::new(),
            groups: groups.iter().map(ComparedGroup::of).collect(),
            repeats: quantities
                .iter()
                .zip(&repeats)
                .map(|(&(quantity, unit), groups)| QuantityRepeats {
                    quantity: quantity.to_owned(),
                    unit,
                    groups: groups.iter().map(|found| Spread::of(found.as_ref())).collect(),
                })
                .collect(),
            notes,
        }
    }
}

/// Names and units of the quantities that every run has, and how many others there are.
fn common(figures: &[Vec<Vec<Figure>>]) -> (Vec<(&str, &'static str)>, usize) {
    let runs = || figures.iter().flatten();
    let mut all: Vec<(&str, &'static str)> = Vec::new();
    for figure in runs().flatten() {
        if !all.contains(&(&*figure.quantity, figure.unit)) {
            all.push((&figure.quantity, figure.unit));
        }
    }
    let count = all.len();
    all.retain(|(name, _)| runs().all(|run| run.iter().any(|figure| figure.quantity == *name)));
    let missing = count - all.len();
    (all, missing)
}

fn value(figures: &[Figure], quantity: &str) -> Option<f64> {
    figures.iter().find(|figure| figure.quantity == quantity)?.value
}

/// The repeats of a quantity in a group, each computation once.
fn repeats(group: &Group, figures: &[Vec<Figure>], quantity: &str) -> Option<Repeats> {
    let runs = group.is_repeat().into_iter().zip(figures);
    let values = runs.filter(|(is_repeat, _)| *is_repeat);
    let values: Vec<f64> = values.filter_map(|(_, figures)| value(figures, quantity)).collect();
    Repeats::of(&values)
}

fn compared(
    groups: [(&Group, &Vec<Vec<Figure>>); 2],
    quantities: &[(&str, &'static str)],
    judged: &[Judged],
) -> GroupComparison {
    let [(reference, _), (group, _)] = groups;
    let found = around([reference, group]);
    let drift = |quantity: &str| {
        let (which, [first, last]) = found?;
        let of = |run: usize| value(&groups[which].1[run], quantity);
        Some(of(last)? - of(first)?)
    };
    let rows = quantities.iter().zip(judged).map(|(&(quantity, unit), judged)| Difference {
        quantity: quantity.to_owned(),
        unit,
        difference: judged.difference,
        reference: judged.reference,
        interval: judged.welch.map(|welch| welch.interval(LEVEL)),
        degrees_of_freedom: judged.welch.map(|welch| welch.freedom),
        p: judged.welch.map(|welch| welch.p),
        p_holm: judged.p_holm,
        drift: drift(quantity),
        trust: judged.trust,
    });
    let rows: Vec<Difference> = rows.collect();
    let count = |trust: Trust| rows.iter().filter(|row| row.trust == trust).count();
    GroupComparison {
        group: group.name.clone(),
        against: reference.name.clone(),
        aba: found.map(|(which, ends)| {
            let group = groups[which].0;
            let [first, last] = ends.map(|run| group.runs[run].path.display().to_string());
            Aba { group: group.name.clone(), first, last }
        }),
        is_wear: !group.differing.is_empty() && group.differing.iter().all(Differing::is_wear),
        larger: count(Trust::LargerThanRepeatability),
        within: count(Trust::WithinRepeatability),
        unknown: count(Trust::Unknown),
        drifted: rows.iter().filter(|row| row.is_drifted()).count(),
        quantities: rows,
    }
}

impl ComparedGroup {
    fn of(group: &Group) -> Self {
        let runs = group.runs.iter().zip(group.is_repeat()).map(|(run, is_repeat)| ComparedRun {
            run: run.path.display().to_string(),
            title: run.title.clone(),
            started_unix_s: run.started_unix_s,
            trajectory_hash: run.trajectory_hash.clone(),
            is_repeat,
        });
        Self { name: group.name.clone(), runs: runs.collect(), differing: group.differing.clone() }
    }
}

impl Spread {
    fn of(repeats: Option<&Repeats>) -> Self {
        Self {
            count: repeats.map_or(0, |found| found.count),
            mean: repeats.map(|found| found.mean),
            standard_deviation: repeats.and_then(|found| found.deviation),
            min: repeats.map(|found| found.range.0),
            max: repeats.map(|found| found.range.1),
        }
    }
}

impl Difference {
    /// The difference over the size of the first group's mean (%).
    pub(super) fn percent(&self) -> Option<f64> {
        let reference = self.reference.filter(|reference| *reference != 0.0)?;
        Some(100.0 * self.difference? / reference.abs())
    }

    /// Whether the drift of the bench is more than half of a difference that is claimed.
    pub(super) fn is_drifted(&self) -> bool {
        let is_claimed = self.trust == Trust::LargerThanRepeatability;
        let both = self.drift.zip(self.difference);
        is_claimed && both.is_some_and(|(drift, difference)| drift.abs() > 0.5 * difference.abs())
    }
}
