//! The tests that are held out by default.
//!
//! Whole tests are held out, a quarter of them and at least one, never the weakest or the
//! strongest: a model is asked to predict inside the range it has seen. A single test gives its
//! last 40 % of cycles. Nothing is held out where too few of its samples would count after the
//! run-in.

use measurement::Measurement;
use signal::statistics::rms;

/// Share of a single test that the model is fitted to.
const SHARE_OF_ONE: f64 = 0.6;
/// Fewest samples after the run-in, and their shortest duration (s), that an error is stated on.
const SAMPLES_LEAST: usize = 20;
const SECONDS_LEAST: f64 = 0.5;

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
    if is_too_short(chosen.iter().map(|index| &records[*index])) {
        return Split { train: records, holdout: vec![], how: nothing("the tests are too short") };
    }
    let (mut train, mut holdout) = (Vec::new(), Vec::new());
    for (index, record) in records.into_iter().enumerate() {
        if chosen.contains(&index) { holdout.push(record) } else { train.push(record) }
    }
    let names: Vec<&str> = holdout.iter().map(|record| record.name.as_str()).collect();
    let how = format!(
        "no hold-out was given: {held} of {count} whole tests {} held out: {}",
        if held == 1 { "is" } else { "are" },
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
    if is_too_short([&holdout]) {
        let how = nothing("the only test is too short");
        return Split { train: vec![record.clone()], holdout: vec![], how };
    }
    train.name = format!("{}-first-part", record.name);
    holdout.name = format!("{}-last-part", record.name);
    let how = format!(
        "one test was given: its last part, from {:.3} s on, is held out",
        record.start_s + at as f64 * record.step_s
    );
    Split { train: vec![train], holdout: vec![holdout], how }
}

/// Too few samples count to state an error on them.
fn is_too_short<'a>(records: impl IntoIterator<Item = &'a Measurement>) -> bool {
    let counted = |record: &Measurement| record.len().saturating_sub(record.run_in);
    let (samples, seconds) = records.into_iter().fold((0, 0.0), |(samples, seconds), record| {
        let counted = counted(record);
        (samples + counted, seconds + counted as f64 * record.step_s)
    });
    samples < SAMPLES_LEAST || seconds < SECONDS_LEAST
}

fn nothing(why: &str) -> String {
    format!(
        "no hold-out was given, and nothing is held out: {why} for a part of {SECONDS_LEAST} s and \
         {SAMPLES_LEAST} samples after its run-in"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::Series;

    /// A sine of 1.25 Hz at 200 Hz.
    fn sine(samples: usize) -> Measurement {
        let w = std::f64::consts::TAU * 1.25;
        let x = |n: usize| 5e-3 * libm::sin(w * n as f64 * 5e-3);
        let f = |n: usize| 4e3 * libm::cos(w * n as f64 * 5e-3);
        let (x, f) = ((0..samples).map(x).collect(), (0..samples).map(f).collect());
        Measurement::from_series(Series::sampled("a", 200.0, x, f)).unwrap()
    }

    #[test]
    fn a_hold_out_of_one_sample_ended_in_an_error_of_a_plot() {
        for samples in 300..600 {
            let split = split(vec![sine(samples)]);
            let Some(held) = split.holdout.first() else {
                assert_eq!(split.train[0].len(), samples);
                assert!(split.how.contains("nothing is held out: the only test is too short"));
                continue;
            };
            let counted = held.len() - held.run_in;
            assert!(counted >= 100, "{samples}: {counted}");
        }
        assert!(split(vec![sine(2000)]).how.starts_with("one test was given: its last part"));
        assert!(split(vec![sine(2000), sine(1900)]).how.contains("1 of 2 whole tests is held out"));
    }
}
