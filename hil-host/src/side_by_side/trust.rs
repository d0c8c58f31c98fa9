//! Is a difference larger than repeats of one condition differ among themselves?

use serde::Serialize;
use signal::repeats::{MeanDifference, Repeats, holm};

/// Probability of a claim too many, among all quantities together; and that of an interval which
/// does not hold the true difference, one by one.
pub(super) const LEVEL: f64 = 0.05;

/// What is claimed of a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trust {
    /// Repeats do not explain it.
    LargerThanRepeatability,
    /// Repeats may explain it.
    WithinRepeatability,
    /// A group has no spread: nothing is claimed.
    Unknown,
}

impl Trust {
    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LargerThanRepeatability => "larger than repeatability",
            Self::WithinRepeatability => "within repeatability",
            Self::Unknown => "unknown",
        }
    }
}

/// A difference of two groups in one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judged {
    /// Mean of the first; none where it has no value.
    pub(super) reference: Option<f64>,
    /// None where a group has no value.
    pub(super) difference: Option<f64>,
    /// Welch's; none where a group has no spread.
    pub(super) welch: Option<MeanDifference>,
    /// Holm's adjusted probability.
    pub(super) p_holm: Option<f64>,
    pub(super) trust: Trust,
}

/// Judges the differences of the second of each pair from the first, all of them together.
pub(super) fn judge(pairs: &[[Option<Repeats>; 2]]) -> Vec<Judged> {
    let between = |[one, other]: &[Option<Repeats>; 2]| {
        MeanDifference::between(one.as_ref()?, other.as_ref()?)
    };
    let welch: Vec<Option<MeanDifference>> = pairs.iter().map(between).collect();
    let p: Vec<f64> = welch.iter().flatten().map(|found| found.p).collect();
    let mut adjusted = holm(&p).into_iter();
    let judged = pairs.iter().zip(welch).map(|([one, other], welch)| {
        let p_holm = welch.and_then(|_| adjusted.next());
        Judged {
            reference: one.map(|one| one.mean),
            difference: one.zip(*other).map(|(one, other)| other.mean - one.mean),
            welch,
            p_holm,
            trust: match p_holm {
                None => Trust::Unknown,
                Some(p) if p <= LEVEL => Trust::LargerThanRepeatability,
                Some(_) => Trust::WithinRepeatability,
            },
        }
    });
    judged.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::random::Random;

    /// Quantities of a run, as many as a locomotive with four dampers has.
    const QUANTITIES: usize = 30;

    /// Two groups of repeats with the same spread; the second is off by so many deviations.
    fn pairs(random: &mut Random, counts: [usize; 2], off: f64) -> Vec<[Option<Repeats>; 2]> {
        let mut group = |count: usize, off: f64| {
            let values: Vec<f64> = (0..count).map(|_| 7.0 + off + random.gaussian()).collect();
            Repeats::of(&values)
        };
        (0..QUANTITIES).map(|_| [group(counts[0], 0.0), group(counts[1], off)]).collect()
    }

    /// In how many of a thousand comparisons anything is claimed.
    fn claims(seed: u64, counts: [usize; 2], off: f64) -> usize {
        let claims_one = |draw: &u64| {
            let judged = judge(&pairs(&mut Random::new(seed, *draw), counts, off));
            judged.iter().any(|found| found.trust == Trust::LargerThanRepeatability)
        };
        (0..1000).filter(claims_one).count()
    }

    #[test]
    fn a_condition_compared_with_itself_claims_nothing_more_often_than_the_level() {
        // 50 of 1000 expected at most, with a standard deviation of 7.
        for (seed, counts) in [(1, [3, 3]), (2, [2, 3]), (3, [6, 4]), (4, [2, 2])] {
            let found = claims(seed, counts, 0.0);
            assert!(found <= 64, "{counts:?}, seed {seed}: {found} of 1000");
        }
    }

    #[test]
    fn without_holm_nearly_every_comparison_of_30_quantities_would_claim_something() {
        let at_all = |draw: &u64| {
            let pairs = pairs(&mut Random::new(1, *draw), [3, 3], 0.0);
            judge(&pairs).iter().any(|found| found.welch.is_some_and(|welch| welch.p <= LEVEL))
        };
        let found = (0..1000).filter(at_all).count();
        assert!(found > 500, "{found} of 1000");
    }

    #[test]
    fn a_difference_far_beyond_the_spread_is_claimed() {
        let off = pairs(&mut Random::new(5, 0), [3, 3], 100.0);
        let judged = judge(&off);
        let claimed = |found: &&Judged| found.trust == Trust::LargerThanRepeatability;
        assert_eq!(judged.iter().filter(claimed).count(), QUANTITIES);
        assert!(judged.iter().all(|found| (found.difference.unwrap() - 100.0).abs() < 5.0));
    }

    #[test]
    fn a_group_of_one_run_is_never_a_claim_and_takes_no_share_of_the_level() {
        let single = Repeats::of(&[1e6]);
        let [one, other] = [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0]].map(|of| Repeats::of(&of));
        let judged = judge(&[[one, single], [one, other], [one, None]]);
        let [alone, both, absent] = judged[..] else { panic!("{judged:?}") };
        assert_eq!((alone.trust, alone.difference), (Trust::Unknown, Some(999_998.0)));
        assert_eq!((absent.trust, absent.difference), (Trust::Unknown, None));
        // Alone among the known: its probability is Welch's own.
        assert_eq!(both.p_holm, both.welch.map(|welch| welch.p));
        assert_eq!(both.trust, Trust::LargerThanRepeatability);
    }
}
