//! The merged table of a campaign: how often `identify` is right, where, and how far off it is.
//!
//! Cases that failed count as wrong. The table has no times in it, so the same cases give the same
//! bytes.

use super::aims::{Aim, aims, floor_is_right, has_to_be_right};
use super::line::CaseResult;
use super::verdict::{counts, is_right};
use super::wilson::Rate;
use serde::Serialize;
use std::collections::BTreeMap;

/// Rates by the levels of two factors.
pub type Grid = BTreeMap<String, BTreeMap<String, Rate>>;

/// How one truth fared at one size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Kind of truth.
    pub kind: String,
    /// What was missing.
    pub truth: String,
    /// Wanted size, in multiples of the noise.
    pub size: f64,
    /// Cases that are right.
    pub right: Rate,
    /// Cases whose size could not be reached, not in the rate.
    pub not_reached: usize,
    /// Median size of those, in multiples of the noise.
    pub size_not_reached: Option<f64>,
    /// Median of the error on the third set over that of the true damper.
    pub over_truth: Option<f64>,
    /// Numbers of the cases that are wrong.
    pub wrong: Vec<usize>,
}

/// Median errors of a kind of truth, in multiples of the noise of the records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Medians {
    /// Kind of truth.
    pub kind: String,
    /// Number of cases.
    pub cases: usize,
    /// Error on the third set of the refitted nominal damper.
    pub before: Option<f64>,
    /// With effects.
    pub after: Option<f64>,
    /// Of the true damper.
    pub truth: Option<f64>,
    /// Noise floor, where it is known.
    pub floor: Option<f64>,
}

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Seed of the campaign.
    pub seed: u64,
    /// Cases were brief.
    pub brief: bool,
    /// Number of cases.
    pub cases: usize,
    /// Cases without an identification: number and reason.
    pub failures: Vec<(usize, String)>,
    /// Rates with targets, and those next to them.
    pub aims: Vec<Aim>,
    /// Truth by truth and size by size, the worst first.
    pub rows: Vec<Row>,
    /// Right cases by motion and kind of truth, without small effects.
    pub by_motion: Grid,
    /// The same by noise.
    pub by_noise: Grid,
    /// Known noise floors that are right, by motion and noise.
    pub floors: Grid,
    /// What was said (the first name, `(nothing)`, `(unexplained)` or `(not judged)`) for each
    /// truth of at least three times the noise.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Names that cases gave together, and how often: computed groups.
    pub groups: BTreeMap<String, usize>,
    /// Coverage by parameter.
    pub coverage: BTreeMap<String, Rate>,
    /// Errors by kind.
    pub medians: Vec<Medians>,
    /// Cases whose named model is worse than the refit on the third set: number and ratio.
    pub worse_than_refit: Vec<(usize, f64)>,
    /// Cases whose next test did not separate the rivals: number, rivals and test.
    pub not_separated: Vec<(usize, String)>,
}

impl Table {
    /// Makes the table of merged lines.
    pub fn new(lines: &[CaseResult]) -> Self {
        let failures = lines.iter().filter_map(|line| Some((line.index, line.failure.clone()?)));
        let right = |line: &CaseResult| has_to_be_right(line).then(|| is_right(line));
        Self {
            seed: lines.first().map_or(0, |line| line.campaign_seed),
            brief: lines.first().is_some_and(|line| line.brief),
            cases: lines.len(),
            failures: failures.collect(),
            aims: aims(lines),
            rows: rows(lines),
            by_motion: grid(lines, |line| [&line.motion, &line.kind], right),
            by_noise: grid(lines, |line| [&line.noise, &line.kind], right),
            floors: grid(lines, |line| [&line.motion, &line.noise], floor_is_right),
            confusion: confusion(lines),
            groups: groups(lines),
            coverage: coverage(lines),
            medians: medians(lines),
            worse_than_refit: worse_than_refit(lines),
            not_separated: not_separated(lines),
        }
    }

    /// True when no target is missed.
    pub fn meets_targets(&self) -> bool {
        self.aims.iter().all(|aim| aim.met != Some(false))
    }
}

/// Rates by two levels; cases without a vote are not in them.
fn grid<'a>(
    lines: &'a [CaseResult],
    levels: impl Fn(&'a CaseResult) -> [&'a String; 2],
    vote: impl Fn(&'a CaseResult) -> Option<bool>,
) -> Grid {
    let mut votes: BTreeMap<String, BTreeMap<String, Vec<bool>>> = BTreeMap::new();
    for line in lines {
        if let Some(vote) = vote(line) {
            let [row, column] = levels(line);
            votes.entry(row.clone()).or_default().entry(column.clone()).or_default().push(vote);
        }
    }
    let rates = |row: BTreeMap<String, Vec<bool>>| {
        row.into_iter().map(|(name, votes)| (name, Rate::of(votes.into_iter()))).collect()
    };
    votes.into_iter().map(|(name, row)| (name, rates(row))).collect()
}

fn rows(lines: &[CaseResult]) -> Vec<Row> {
    let mut by: BTreeMap<(String, String, u64), Vec<&CaseResult>> = BTreeMap::new();
    for line in lines {
        let truth = match line.kind.as_str() {
            "nothing" => format!("{} noise", line.noise),
            "pair" => "two effects, both named".to_owned(),
            "hydraulic" => line.damper.clone(),
            "wrong_datasheet" if line.truth.is_empty() => "nothing missing".to_owned(),
            "wrong_datasheet" => "one effect missing".to_owned(),
            _ => line.truth.join(" "),
        };
        let tenths = (10.0 * line.size) as u64;
        by.entry((line.kind.clone(), truth, tenths)).or_default().push(line);
    }
    let mut rows: Vec<Row> = by
        .into_iter()
        .map(|((kind, truth, tenths), lines)| {
            let (counted, apart): (Vec<&CaseResult>, Vec<&CaseResult>) =
                lines.into_iter().partition(|line| counts(line));
            Row {
                size: tenths as f64 / 10.0,
                right: Rate::of(counted.iter().map(|line| is_right(line))),
                not_reached: apart.len(),
                size_not_reached: median(apart.iter().flat_map(|line| line.sizes.iter().copied())),
                over_truth: median(counted.iter().filter_map(|line| line.over_truth())),
                wrong: counted.iter().filter(|l| !is_right(l)).map(|l| l.index).collect(),
                kind,
                truth,
            }
        })
        .collect();
    // Small effects may be missed; they come last.
    rows.sort_by(|a, b| {
        let weak = |row: &Row| row.size > 0.0 && row.size < 3.0;
        let rate = |row: &Row| row.right.rate.unwrap_or(2.0);
        weak(a).cmp(&weak(b)).then(rate(a).total_cmp(&rate(b)))
    });
    rows
}

fn confusion(lines: &[CaseResult]) -> BTreeMap<String, BTreeMap<String, usize>> {
    let mut table: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for line in lines.iter().filter(|line| has_to_be_right(line)) {
        let truth = match line.kind.as_str() {
            "nothing" => "(nothing)".to_owned(),
            "effect" | "outside" | "hidden" => line.truth.join(" "),
            "neighbour" => {
                format!("{} near {}", line.truth.join(" "), line.near.as_deref().unwrap_or("-"))
            }
            "hydraulic" => "(hydraulic)".to_owned(),
            _ => continue,
        };
        let said = match line.named.first() {
            Some(name) if line.right_names().any(|right| right == name.name) => name.name.clone(),
            Some(name) if line.first_is_right() => format!("{} or the truth", name.name),
            Some(name) => name.name.clone(),
            None if line.failure.is_some() => "(failed)".to_owned(),
            None if line.says_unexplained() => "(unexplained)".to_owned(),
            None if line.is_clean() => "(nothing)".to_owned(),
            None => "(not judged)".to_owned(),
        };
        *table.entry(truth).or_default().entry(said).or_default() += 1;
    }
    table
}

fn groups(lines: &[CaseResult]) -> BTreeMap<String, usize> {
    let mut groups = BTreeMap::new();
    for named in lines.iter().flat_map(|line| &line.named) {
        if !named.alternatives.is_empty() {
            let mut members = named.alternatives.clone();
            members.push(named.name.clone());
            members.sort();
            *groups.entry(members.join(", ")).or_default() += 1;
        }
    }
    groups
}

fn coverage(lines: &[CaseResult]) -> BTreeMap<String, Rate> {
    let mut by: BTreeMap<String, Vec<bool>> = BTreeMap::new();
    for interval in lines.iter().flat_map(|line| &line.intervals) {
        by.entry(interval.parameter.clone()).or_default().push(interval.covers);
    }
    by.into_iter().map(|(name, covers)| (name, Rate::of(covers.into_iter()))).collect()
}

fn medians(lines: &[CaseResult]) -> Vec<Medians> {
    let mut by: BTreeMap<&str, Vec<&CaseResult>> = BTreeMap::new();
    for line in lines {
        by.entry(&line.kind).or_default().push(line);
    }
    by.into_iter()
        .map(|(kind, lines)| {
            let errors =
                || lines.iter().filter_map(|line| Some((line.true_noise_n?, line.errors?)));
            let floors = lines.iter().filter_map(|line| {
                Some(line.noise_floor_n? / line.true_noise_n.filter(|noise| *noise > 0.0)?)
            });
            Medians {
                kind: kind.to_owned(),
                cases: lines.len(),
                before: median(errors().map(|(noise_n, e)| e.before_n / noise_n)),
                after: median(errors().map(|(noise_n, e)| e.after_n / noise_n)),
                truth: median(errors().filter_map(|(noise_n, e)| Some(e.truth_n? / noise_n))),
                floor: median(floors),
            }
        })
        .collect()
}

fn worse_than_refit(lines: &[CaseResult]) -> Vec<(usize, f64)> {
    let worse = |line: &CaseResult| Some((line.index, line.over_refit()?));
    lines.iter().filter_map(worse).filter(|(_, ratio)| *ratio > 1.0).collect()
}

fn not_separated(lines: &[CaseResult]) -> Vec<(usize, String)> {
    let of = |line: &CaseResult| {
        let next = line.next_test.as_ref().filter(|next| next.separated == Some(false))?;
        let [one, other] = &next.rivals;
        let test = next.proposed.as_deref().unwrap_or("-");
        Some((line.index, format!("{one} or {other} by {test}")))
    };
    lines.iter().filter_map(of).collect()
}

/// The middle value; the mean of two.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    let lower = if values.len().is_multiple_of(2) { values[values.len() / 2 - 1] } else { upper };
    Some(0.5 * (lower + upper))
}
