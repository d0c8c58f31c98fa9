//! The merged table of a campaign: how often `identify` is right, where, and how far off it is.
//!
//! A name is right if it is the truth or has it among the alternatives that `identify` computed
//! from the records. Effects whose size could not be reached are counted apart and by no target;
//! cases that failed count as wrong. The table has no times in it, so the same cases give the same
//! bytes.

use super::plan::HIDDEN;
use super::score::CaseResult;
use super::wilson::Rate;
use firmware_core::damper::effects::CATALOGUE;
use serde::Serialize;
use std::collections::BTreeMap;

/// Error on the hold-out over that of the true damper that is good enough.
pub(super) const LARGEST_RATIO: f64 = 1.15;

/// A rate that has a target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Aim {
    /// What is counted.
    pub what: String,
    /// The rate.
    pub rate: Rate,
    /// Where it should lie, both ends included.
    pub target: (f64, f64),
    /// It does; none without cases.
    pub met: Option<bool>,
    /// The target lies inside the interval of the rate: more cases might turn it.
    pub open: bool,
}

/// How one truth fared at one size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Kind of case.
    pub kind: String,
    /// What was missing.
    pub truth: String,
    /// Wanted size, in multiples of the noise.
    pub size: f64,
    /// The first name is right; outside the catalogue: it is said to be unexplained.
    pub right: Rate,
    /// Cases whose size could not be reached, not in the rate.
    pub not_reached: usize,
    /// Median of the error on the hold-out over that of the true damper.
    pub over_truth: Option<f64>,
    /// Numbers of the cases that are wrong.
    pub wrong: Vec<usize>,
}

/// Median errors of a kind of case, in multiples of the noise floor that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Medians {
    /// Kind of case.
    pub kind: String,
    /// Number of cases.
    pub cases: usize,
    /// Error on the hold-out of the refitted nominal damper.
    pub before: Option<f64>,
    /// With effects.
    pub after: Option<f64>,
    /// Of the true damper.
    pub truth: Option<f64>,
    /// Noise floor over the rms of the noise.
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
    /// Rates with targets.
    pub aims: Vec<Aim>,
    /// Truth by truth and size by size, the worst first.
    pub rows: Vec<Row>,
    /// What was said (the first name, `(nothing)` or `(unexplained)`) for each truth of at least
    /// three times the noise.
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Names that cases gave together, and how often: computed groups.
    pub groups: BTreeMap<String, usize>,
    /// Coverage by parameter.
    pub coverage: BTreeMap<String, Rate>,
    /// Errors by kind.
    pub medians: Vec<Medians>,
}

impl Table {
    /// Makes the table of merged lines.
    pub fn new(lines: &[CaseResult]) -> Self {
        let failures = lines.iter().filter_map(|line| Some((line.index, line.failure.clone()?)));
        Self {
            seed: lines.first().map_or(0, |line| line.campaign_seed),
            brief: lines.first().is_some_and(|line| line.brief),
            cases: lines.len(),
            failures: failures.collect(),
            aims: aims(lines),
            rows: rows(lines),
            confusion: confusion(lines),
            groups: groups(lines),
            coverage: coverage(lines),
            medians: medians(lines),
        }
    }

    /// True when no target is missed.
    pub fn meets_targets(&self) -> bool {
        self.aims.iter().all(|aim| aim.met != Some(false))
    }
}

/// The case is as it should be, as far as names go.
pub fn is_right(line: &CaseResult) -> bool {
    if line.failure.is_some() {
        return false;
    }
    match line.kind.as_str() {
        "nothing" => line.named.is_empty(),
        "outside" => line.says_unexplained() && line.named.is_empty(),
        "hydraulic" => !line.named.iter().any(|name| is_foreign(&name.name)),
        "wrong_datasheet" => line.datasheet_moved == Some(false),
        "pair" => line.truth.iter().all(|truth| line.named.iter().any(|name| name.may_be(truth))),
        _ if line.truth.iter().any(|truth| truth == HIDDEN) => line.named.is_empty(),
        _ => line.first_is_right(),
    }
}

/// The hydraulic dampers do not have this effect.
fn is_foreign(effect: &str) -> bool {
    CATALOGUE.iter().any(|info| info.name == effect && !info.in_hydraulic_model)
}

fn aims(lines: &[CaseResult]) -> Vec<Aim> {
    let of = |kind: &'static str| lines.iter().filter(move |line| line.kind == kind);
    let shown = |line: &&CaseResult| line.reached && !line.truth.iter().any(|name| name == HIDDEN);
    let effects = || of("effect").filter(shown);
    let no_name = |line: &CaseResult| line.failure.is_none() && line.named.is_empty();
    let aim = |what: &str, rate: Rate, target: (f64, f64)| Aim {
        what: what.to_owned(),
        met: rate.rate.map(|rate| (target.0..=target.1).contains(&rate)),
        open: [target.0, target.1]
            .iter()
            .any(|end| *end < 1.0 && rate.lower < *end && *end < rate.upper),
        rate,
        target,
    };
    let mut aims = Vec::new();
    for (colour, coloured) in [("white", false), ("coloured", true)] {
        let cases = of("nothing").filter(|line| line.coloured == coloured);
        let what = format!("nothing missing, {colour} noise: nothing named");
        aims.push(aim(&what, Rate::of(cases.map(no_name)), (0.99, 1.0)));
    }
    aims.push(aim(
        "nothing missing: nothing said to be unexplained",
        Rate::of(of("nothing").map(|line| line.verdict == "no_missing_effect")),
        (0.95, 1.0),
    ));
    aims.push(aim(
        "an effect of 3 times the noise and more: named first or in its group",
        Rate::of(effects().filter(|line| line.size >= 3.0).map(is_right)),
        (0.95, 1.0),
    ));
    for size in [3.0, 10.0] {
        let cases = effects().filter(|line| line.size == size);
        let what = format!("an effect of {size} times the noise: named first or in its group");
        aims.push(aim(&what, Rate::of(cases.map(is_right)), (0.95, 1.0)));
    }
    let outside = || of("outside").filter(|line| line.reached);
    aims.push(aim(
        "outside the catalogue: said to be unexplained",
        Rate::of(outside().map(CaseResult::says_unexplained)),
        (0.95, 1.0),
    ));
    aims.push(aim(
        "outside the catalogue: never a clean fit",
        Rate::of(outside().map(|line| line.failure.is_none() && line.says_unexplained())),
        (1.0, 1.0),
    ));
    let ratios = lines.iter().filter_map(CaseResult::over_truth);
    aims.push(aim(
        "held-out error at most 1.15 times that of the true damper",
        Rate::of(ratios.map(|ratio| ratio <= LARGEST_RATIO)),
        (0.95, 1.0),
    ));
    let intervals = lines.iter().flat_map(|line| &line.intervals);
    aims.push(aim(
        "stated 95 % intervals hold the truth",
        Rate::of(intervals.map(|interval| interval.covers)),
        (0.90, 0.98),
    ));
    aims.push(aim(
        "a wrong datasheet changes nothing",
        Rate::of(lines.iter().filter_map(|line| line.datasheet_moved).map(|moved| !moved)),
        (1.0, 1.0),
    ));
    aims.push(aim(
        "hydraulic damper: nothing named that it does not have",
        Rate::of(of("hydraulic").map(is_right)),
        (0.95, 1.0),
    ));
    aims
}

fn rows(lines: &[CaseResult]) -> Vec<Row> {
    let mut by: BTreeMap<(String, String, u64), Vec<&CaseResult>> = BTreeMap::new();
    for line in lines {
        let truth = match line.kind.as_str() {
            "nothing" if line.coloured => "coloured noise".to_owned(),
            "nothing" => "white noise".to_owned(),
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
            let apart = |line: &&&CaseResult| !line.reached && truth != HIDDEN;
            let counted: Vec<&CaseResult> =
                lines.iter().filter(|line| !apart(line)).copied().collect();
            Row {
                size: tenths as f64 / 10.0,
                right: Rate::of(counted.iter().map(|line| is_right(line))),
                not_reached: lines.len() - counted.len(),
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
    for line in lines.iter().filter(|line| line.reached && !(0.1..3.0).contains(&line.size)) {
        let truth = match line.kind.as_str() {
            "nothing" => "(nothing)".to_owned(),
            "effect" | "outside" => line.truth.join(" "),
            "hydraulic" => "(hydraulic)".to_owned(),
            _ => continue,
        };
        let said = match line.named.first() {
            Some(name) if line.truth.contains(&name.name) => name.name.clone(),
            Some(name) if line.first_is_right() => format!("{} or the truth", name.name),
            Some(name) => name.name.clone(),
            None if line.failure.is_some() => "(failed)".to_owned(),
            None if line.says_unexplained() => "(unexplained)".to_owned(),
            None => "(nothing)".to_owned(),
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
                || lines.iter().filter_map(|line| line.errors.map(|errors| (line.noise_n, errors)));
            Medians {
                kind: kind.to_owned(),
                cases: lines.len(),
                before: median(errors().map(|(_, e)| e.before_n / e.floor_n)),
                after: median(errors().map(|(_, e)| e.after_n / e.floor_n)),
                truth: median(errors().filter_map(|(_, e)| Some(e.truth_n? / e.floor_n))),
                floor: median(errors().map(|(noise_n, e)| e.floor_n / noise_n)),
            }
        })
        .collect()
}

/// The middle value; the mean of two.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    let lower = if values.len().is_multiple_of(2) { values[values.len() / 2 - 1] } else { upper };
    Some(0.5 * (lower + upper))
}
