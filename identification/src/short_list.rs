//! The candidates that are worth a fit, and those that these records cannot show.

use super::candidate::Candidate;
use super::evidence::LEAST_GAIN;
use super::finding::NotTestable;
use super::fit::Fit;
use super::judged::Judged;
use super::screening::Screened;
use rayon::prelude::*;

/// A candidate whose screened gain is below this share is not fitted.
const LEAST_SCREENED: f64 = 0.005;
/// Candidates rehearsed per round, by plain and by whitened gain.
const LISTED: (usize, usize) = (6, 3);
/// Start values of a candidate that are fitted.
const STARTS: usize = 4;
/// An effect of which less than this share remains is absorbed by the nominal parameters.
const LEAST_UNABSORBED: f64 = 0.01;
/// An effect that stands out by fewer standard errors at its usual size cannot show.
const LEAST_STANDING_OUT: f64 = 1.0;

/// Candidates that the records cannot show, with the reason.
pub(crate) fn hidden(tried: &[Candidate], screened: &[Screened]) -> Vec<(usize, NotTestable)> {
    let mut hidden = Vec::new();
    for (index, candidate) in tried.iter().enumerate() {
        let starts = || screened.iter().filter(|screened| screened.candidate == index);
        let unabsorbed = starts().map(Screened::unabsorbed).fold(0.0, f64::max);
        let standing_out = starts().map(Screened::standing_out).fold(0.0, f64::max);
        let gain = starts().map(|start| start.gain(None)).fold(0.0, f64::max);
        let why = if starts().next().is_none() {
            "no damper of this size can have it".to_owned()
        } else if standing_out == 0.0 {
            "nothing in these records excites it".to_owned()
        } else if unabsorbed < LEAST_UNABSORBED {
            format!(
                "the other parameters do the same: {:.2} % of it remains after their refit",
                100.0 * unabsorbed
            )
        } else if standing_out < LEAST_STANDING_OUT && gain < LEAST_GAIN {
            format!("at its usual size it stands out by {standing_out:.2} standard errors")
        } else {
            continue;
        };
        let name = candidate.effect.name;
        let test_that_would = candidate.effect.shown_by;
        hidden.push((index, NotTestable { name, why, test_that_would }));
    }
    hidden
}

/// The candidates to rehearse: all where first order says little, otherwise those that screening
/// ranks first, with all pieces and without each of them.
pub(crate) fn listed(
    standing: &Judged,
    shown: &[usize],
    screened: &[Screened],
    coarse: bool,
) -> Vec<usize> {
    if coarse {
        shown.to_vec()
    } else {
        short_list(screened, shown, standing.left_out.squares_n2.len())
    }
}

/// Fits of listed candidates to the beginnings of the tests.
pub(crate) fn rehearsals(
    listed: &[usize],
    tried: &[Candidate],
    screened: &[Screened],
    coarse: bool,
    rehearse: impl Fn(usize, &[usize]) -> Option<Fit> + Sync,
) -> Vec<(usize, Fit)> {
    listed
        .par_iter()
        .filter_map(|index| {
            let which: Vec<usize> = if coarse {
                (0..tried[*index].starts.len()).collect()
            } else {
                let mut starts: Vec<&Screened> =
                    screened.iter().filter(|s| s.candidate == *index).collect();
                starts.sort_by(|a, b| b.gain(None).total_cmp(&a.gain(None)));
                starts.iter().take(STARTS).map(|s| s.start).collect()
            };
            rehearse(*index, &which).map(|fit| (*index, fit))
        })
        .collect()
}

/// The candidates that screening ranks first, also when a piece is left out.
pub(crate) fn short_list(screened: &[Screened], shown: &[usize], pieces: usize) -> Vec<usize> {
    let ranked = |gain: &dyn Fn(&Screened) -> f64| {
        let mut best: Vec<(f64, usize)> = shown
            .iter()
            .filter_map(|index| {
                let starts = screened.iter().filter(|s| s.candidate == *index);
                starts.map(gain).max_by(f64::total_cmp).map(|gain| (gain, *index))
            })
            .filter(|(gain, _)| *gain > LEAST_SCREENED)
            .collect();
        best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best
    };
    let mut listed: Vec<usize> = Vec::new();
    let mut list = |ranked: Vec<(f64, usize)>, count: usize| {
        for (_, index) in ranked.into_iter().take(count) {
            if !listed.contains(&index) {
                listed.push(index);
            }
        }
    };
    list(ranked(&|s| s.gain(None)), LISTED.0);
    list(ranked(&|s| s.whitened_gain(None)), LISTED.1);
    for piece in 0..pieces {
        list(ranked(&|s| s.gain(Some(piece))), 1);
    }
    listed
}
