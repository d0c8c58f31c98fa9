//! What is asked of the scores: the worst of every criterion over dampers, regimes and dead times.

use super::answer::{Aim, InRegimes, Score, Spread};
use super::compensators::Ours;
use super::errors::{AIMS, Errors};

/// The compensator that the aims are asked of.
pub(super) const ASKED: Ours = Ours::Adaptive;

/// A criterion: its name, its unit, and the error that it is.
type Criterion = (&'static str, &'static str, fn(&Errors) -> f64);

/// The errors of a score over some rigs; none where they were not asked for.
type OverRigs = fn(&Score) -> Option<InRegimes<Option<Errors>>>;

const CRITERIA: [Criterion; 3] = [
    ("work per cycle", "%", |errors| errors.work_percent),
    ("stroke", "%", |errors| errors.stroke_percent),
    ("phase", "degrees", |errors| errors.phase_deg),
];

/// The aims, asked of our best compensator; of a single candidate of somebody else's if there is
/// no other.
pub(super) fn of(scores: &[Score]) -> Vec<Aim> {
    let asked = scores.iter().any(|score| score.compensator == ASKED.name());
    let is_asked =
        |score: &&Score| score.damper.has_aims() && (!asked || score.compensator == ASKED.name());
    let asked: Vec<&Score> = scores.iter().filter(is_asked).collect();
    let Some(first) = asked.first() else { return Vec::new() };
    let on_rigs = asked.iter().any(|score| score.perturbed.is_some());
    let mut overs: Vec<(&'static str, OverRigs)> =
        vec![("nominal rig", |score| Some(score.nominal))];
    if on_rigs {
        overs.push(("perturbed rigs", perturbed));
    }
    let mut aims = Vec::new();
    for (over, errors) in overs {
        for ((criterion, unit, value), most) in CRITERIA.into_iter().zip(AIMS.all()) {
            let mut found = Some(0.0_f64);
            let mut place = String::new();
            for score in &asked {
                let Some(InRegimes { track, hunting }) = errors(score) else { continue };
                for (regime, errors) in [("track", track), ("hunting", hunting)] {
                    let size = errors.map(|errors| value(&errors).abs());
                    // A motion that is lost is the worst of all, and so is what is no number.
                    let is_worse = match (size, found) {
                        (_, None) => false,
                        (None, Some(_)) => true,
                        (Some(size), Some(most)) => size.is_nan() || size > most,
                    };
                    if is_worse {
                        found = size.filter(|size| size.is_finite());
                        let damper = score.damper.name();
                        place = format!("{damper}, {regime}, {} ms", score.dead_time_ms);
                    }
                }
            }
            let is_met = found.is_some_and(|found| found <= most);
            let compensator = first.compensator;
            aims.push(Aim { criterion, unit, over, compensator, found, place, most, is_met });
        }
    }
    aims
}

fn perturbed(score: &Score) -> Option<InRegimes<Option<Errors>>> {
    let InRegimes { track, hunting } = score.perturbed?;
    let worst = |spread: Spread| spread.worst.filter(|_| spread.lost == 0);
    Some(InRegimes { track: worst(track), hunting: worst(hunting) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaw_damper_problem::condition::Condition;

    fn score(damper: Condition, work_percent: f64, lost: bool) -> Score {
        let errors = Errors { work_percent, stroke_percent: -1.0, phase_deg: 0.1 };
        Score {
            damper,
            compensator: ASKED.name(),
            dead_time_ms: 5,
            nominal: InRegimes { track: Some(errors), hunting: (!lost).then_some(errors) },
            critical: None,
            critical_error_kmh: None,
            perturbed: None,
        }
    }

    #[test]
    fn the_worst_size_counts_and_a_lost_motion_misses_every_aim() {
        let met = of(&[score(Condition::New, -1.5, false), score(Condition::Worn, 1.0, false)]);
        assert_eq!(met.len(), 3);
        assert!(met.iter().all(|aim| aim.is_met), "{met:?}");
        assert_eq!((met[0].found, met[0].place.as_str()), (Some(1.5), "new, track, 5 ms"));
        let missed = of(&[score(Condition::New, -2.5, false)]);
        assert_eq!(missed.iter().map(|aim| aim.is_met).collect::<Vec<_>>(), [false, true, true]);
        let lost = of(&[score(Condition::New, 0.1, true)]);
        assert!(lost.iter().all(|aim| !aim.is_met && aim.found.is_none()), "{lost:?}");
        // Soft attachments are shown and not asked.
        assert!(of(&[score(Condition::Soft, 9.0, false)]).is_empty());
        assert!(!of(&[score(Condition::New, f64::NAN, false)])[0].is_met);
    }
}
