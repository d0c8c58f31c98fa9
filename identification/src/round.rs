//! One round of the search: the candidates tried on a standing model, and their results.

use super::candidate::{Candidate, candidates};
use super::control::{Control, Steps};
use super::finding::NotTestable;
use super::judged::Judged;
use super::residual::motion::motion;
use super::residual::question::Answer;
use super::residual::repeat::repeat;
use super::screening::{Screened, screen};
use super::short_list::{hidden, listed, rehearsals, short_list};
use super::test_set::TestSet;
use super::trial::{Trial, rehearse, starts, try_candidate};

/// Candidates fitted to the whole tests per round.
const TRIED: usize = 5;
/// A model is far off when its error is more than this share of the force.
const FAR_OFF: f64 = 0.03;
/// A residual is far above its noise from this multiple.
const ABOVE_NOISE: f64 = 1.5;

/// One round: the candidates tried on a standing model, and their results.
pub(crate) struct Round {
    /// Its number in the search, from 1.
    pub number: usize,
    /// All candidates.
    pub tried: Vec<Candidate>,
    /// Their gains to first order.
    pub screened: Vec<Screened>,
    /// Candidates that the records cannot show.
    pub hidden: Vec<(usize, NotTestable)>,
    /// Candidates that the records can show.
    pub shown: Vec<usize>,
    /// Those that were fitted, by their error on pieces left out.
    pub trials: Vec<Trial>,
    /// The standing model is so far off that first-order screening says little.
    pub far_off: bool,
    /// The residual is so far above its noise that large effects must be missing: their gain to
    /// first order, with all other parameters fixed, says little.
    pub above_noise: bool,
}

impl Round {
    /// Screens, rehearses and tries in the round of this number. `others` are other minima of the
    /// nominal damper.
    pub(crate) fn run(
        standing: &Judged,
        others: &[Vec<f64>],
        (beginnings, tests): (&TestSet, &TestSet),
        number: usize,
        control: Control<'_>,
    ) -> Self {
        let steps = Steps::new(control, number, 1 + TRIED);
        steps.begin("screening");
        let mut round = Self::screened(standing, tests, control);
        let Self { tried, screened, shown, .. } = &round;
        let coarse = round.far_off || round.above_noise;
        let minima = if round.far_off { others } else { &[] };
        let listed = listed(standing, shown, screened, coarse);
        steps.expect(listed.len());
        let mut rehearsed = rehearsals(&listed, tried, screened, coarse, |index, which| {
            steps.begin(&format!("rehearsing {}", tried[index].effect.name));
            let starts = starts(standing, &tried[index], which, minima);
            rehearse(standing, &tried[index], &starts, beginnings, control)
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
            steps.begin(&format!("fitting {}", tried[*index].effect.name));
            trials.extend(try_candidate(
                standing,
                &tried[*index],
                (*index, &fit.values),
                tests,
                control,
            ));
        }
        trials
            .sort_by(|a, b| a.judged.left_out.total_n2().total_cmp(&b.judged.left_out.total_n2()));
        (round.number, round.trials) = (number, trials);
        round
    }

    /// Candidates on which the round says something: those that the records can show, and those
    /// that were fitted though they cannot.
    pub(crate) fn open(&self) -> impl Iterator<Item = usize> {
        let is_hidden = |index: &usize| self.hidden.iter().any(|(hidden, _)| hidden == index);
        (0..self.tried.len()).filter(move |index| self.has_tried(*index) || !is_hidden(index))
    }

    /// Effects that the records cannot show and that were not fitted.
    pub(crate) fn unseen(&self) -> impl Iterator<Item = &NotTestable> {
        let unseen = self.hidden.iter().filter(|(index, _)| !self.has_tried(*index));
        unseen.map(|(_, effect)| effect)
    }

    /// True when a candidate was fitted to the whole tests.
    pub(crate) fn has_tried(&self, candidate: usize) -> bool {
        self.trials.iter().any(|trial| trial.candidate == candidate)
    }

    /// Screens only.
    pub(crate) fn screened(standing: &Judged, tests: &TestSet, control: Control<'_>) -> Self {
        let tried = candidates(&standing.fit().model, tests);
        let screened = screen(&standing.linearised, &tried, tests, control);
        let hidden = hidden(&tried, &screened);
        // An effect that a poor model hides may show once the model is better.
        let far_off = far_off(standing, tests);
        let shown: Vec<usize> = (0..tried.len())
            .filter(|index| far_off || !hidden.iter().any(|(i, _)| i == index))
            .collect();
        let above_noise = above_noise(standing, tests);
        let number = 1;
        Self { number, tried, screened, hidden, shown, trials: Vec::new(), far_off, above_noise }
    }
}

fn far_off(standing: &Judged, tests: &TestSet) -> bool {
    standing.fit().rms_n(tests) > FAR_OFF * tests.rms_force_n()
}

fn above_noise(standing: &Judged, tests: &TestSet) -> bool {
    match repeat(&standing.linearised.residual_n, tests).noise_floor_n {
        Some(floor_n) => standing.fit().rms_n(tests) > ABOVE_NOISE * floor_n,
        // Without a floor: more of the force follows from the motion than the model knows.
        None => motion(standing.fit(), tests).answer == Answer::Yes,
    }
}
