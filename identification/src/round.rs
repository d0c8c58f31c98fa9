//! One round of the search: what is tried on a standing model, and what comes of it.

use super::candidate::{Candidate, candidates};
use super::left_over::repeat::repeat;
use super::screening::{Screened, screen};
use super::search::{NotTestable, Progress};
use super::short_list::{hidden, rehearsals, short_list};
use super::tests_at_hand::TestsAtHand;
use super::trial::{Judged, Trial, rehearse, starts, try_candidate};

/// Candidates fitted to the whole tests per round.
const TRIED: usize = 5;
/// A model is far off when its error is more than this share of the force.
const FAR_OFF: f64 = 0.03;
/// A residual is far above its noise from this multiple.
const ABOVE_NOISE: f64 = 1.5;

/// One round: what was tried on a standing model, and what came of it.
pub struct Round {
    /// All candidates.
    pub tried: Vec<Candidate>,
    /// What they do to first order.
    pub screened: Vec<Screened>,
    /// Candidates that the records cannot show.
    pub hidden: Vec<(usize, NotTestable)>,
    /// Candidates that they can.
    pub shown: Vec<usize>,
    /// Those that were fitted, by their error on pieces left out.
    pub trials: Vec<Trial>,
    /// The standing model is so far off that first-order screening says little.
    pub far_off: bool,
    /// The residual is so far above its noise that a part of it must be due to large effects: what they do to
    /// first order, with all other parameters as they are, says little.
    pub above_noise: bool,
}

impl Round {
    /// Screens, rehearses and tries. `others` are other minima of the nominal damper.
    pub fn of(
        standing: &Judged,
        others: &[Vec<f64>],
        beginnings: &TestsAtHand,
        tests: &TestsAtHand,
        progress: Progress<'_>,
    ) -> Self {
        progress("screening");
        let mut round = Self::screened(standing, tests);
        let Self { tried, screened, shown, .. } = &round;
        let coarse = round.far_off || round.above_noise;
        let minima = if round.far_off { others } else { &[] };
        let mut rehearsed = rehearsals(standing, tried, shown, screened, coarse, |index, which| {
            progress(&format!("rehearsing {}", tried[index].effect.name));
            let starts = starts(standing, &tried[index], which, minima);
            rehearse(standing, &tried[index], &starts, beginnings)
        });
        rehearsed.sort_by(|a, b| a.1.total_n2().total_cmp(&b.1.total_n2()).then(a.0.cmp(&b.0)));
        let tops = short_list(screened, shown, 0);
        let mut place = 0;
        // The best rehearsals, and the two that screening would have taken.
        rehearsed.retain(|(index, _)| {
            place += 1;
            place <= TRIED || tops.iter().take(2).any(|top| top == index)
        });
        let mut trials: Vec<Trial> = Vec::new();
        for (index, fit) in &rehearsed {
            progress(&format!("fitting {}", tried[*index].effect.name));
            trials.extend(try_candidate(standing, &tried[*index], (*index, &fit.values), tests));
        }
        trials
            .sort_by(|a, b| a.judged.left_out.total_n2().total_cmp(&b.judged.left_out.total_n2()));
        round.trials = trials;
        round
    }

    /// Screens only.
    pub fn screened(standing: &Judged, tests: &TestsAtHand) -> Self {
        let tried = candidates(&standing.standing.fit.model, tests);
        let screened = screen(&standing.standing, &tried, tests);
        let hidden = hidden(&tried, &screened);
        // What a model that is far off cannot show may show when it is near.
        let far_off = far_off(standing, tests);
        let shown: Vec<usize> = (0..tried.len())
            .filter(|index| far_off || !hidden.iter().any(|(i, _)| i == index))
            .collect();
        let above_noise = above_noise(standing, tests);
        Self { tried, screened, hidden, shown, trials: Vec::new(), far_off, above_noise }
    }
}

fn far_off(standing: &Judged, tests: &TestsAtHand) -> bool {
    standing.standing.fit.rms_n(tests) > FAR_OFF * tests.rms_force_n()
}

fn above_noise(standing: &Judged, tests: &TestsAtHand) -> bool {
    let floor_n = repeat(&standing.standing.residual_n, tests).noise_floor_n;
    floor_n.is_some_and(|floor_n| standing.standing.fit.rms_n(tests) > ABOVE_NOISE * floor_n)
}
