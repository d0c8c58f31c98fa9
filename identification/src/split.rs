//! The tests that are held out by default.
//!
//! Whole tests are held out, a quarter of them and at least one, never the weakest or the
//! strongest: a model is asked to predict inside the range it has seen. A single test gives its
//! last 40 % of cycles.

use measurement::Measurement;
use signal::statistics::rms;

/// Share of a single test that the model is fitted to.
const SHARE_OF_ONE: f64 = 0.6;

/// Records to fit and records to hold out, in their order, and how they were chosen.
#[derive(Debug, Clone)]
pub(crate) struct Split {
    /// Fitted.
    pub train: Vec<Measurement>,
    /// Never fitted.
    pub holdout: Vec<Measurement>,
    /// The choice, in words.
    pub how: String,
}

/// Chooses the hold-out of records.
pub(crate) fn split(mut records: Vec<Measurement>) -> Split {
    if records.len() < 2 {
        let Some(record) = records.pop() else {
            return Split { train: vec![], holdout: vec![], how: String::new() };
        };
        return split_one(&record);
    }
    let mut by_force: Vec<(f64, usize)> =
        records.iter().enumerate().map(|(i, record)| (rms(&record.force_n), i)).collect();
    by_force.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let count = records.len();
    let held = (count / 4).max(1);
    // Evenly over the ranks from the second to the last but one.
    let inner = count.saturating_sub(2).max(1);
    let chosen: Vec<usize> = (0..held)
        .map(|k| {
            let rank = (2 * k + 1) * inner / (2 * held) + usize::from(count > 2);
            by_force[rank.min(count - 1)].1
        })
        .collect();
    let (mut train, mut holdout) = (Vec::new(), Vec::new());
    for (index, record) in records.into_iter().enumerate() {
        if chosen.contains(&index) { holdout.push(record) } else { train.push(record) }
    }
    let names: Vec<&str> = holdout.iter().map(|record| record.name.as_str()).collect();
    let how = format!(
        "no hold-out was given: {held} of {count} whole tests are held out: {}",
        names.join(", ")
    );
    Split { train, holdout, how }
}

fn split_one(record: &Measurement) -> Split {
    let samples = record.force_n.len();
    let wanted = (SHARE_OF_ONE * samples as f64) as usize;
    let nearest = record.cycles.iter().copied().min_by_key(|at| at.abs_diff(wanted));
    let at = nearest.filter(|at| at.abs_diff(wanted) < samples / 4).unwrap_or(wanted);
    let mut train = record.until(at);
    let mut holdout = record.since(at);
    train.name = format!("{}-first-part", record.name);
    holdout.name = format!("{}-last-part", record.name);
    let how = format!(
        "one test was given: its last part, from {:.3} s on, is held out",
        record.start_s + at as f64 * record.step_s
    );
    Split { train: vec![train], holdout: vec![holdout], how }
}
