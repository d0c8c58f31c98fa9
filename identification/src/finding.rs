//! The vocabulary of a search: effects that were accepted, rejected, or cannot show in the records.

use super::evidence::Evidence;
use super::judged::Judged;

/// An effect that was found missing.
#[derive(Debug, Clone)]
pub struct Accepted {
    /// Its name.
    pub name: &'static str,
    /// The evidence for it when it was accepted.
    pub evidence: Evidence,
    /// Effects that the records cannot distinguish from it.
    pub alternatives: Vec<&'static str>,
    /// The effect without which it was not accepted, and whose evidence this is too.
    pub together_with: Option<&'static str>,
}

/// A candidate that was not accepted.
#[derive(Debug, Clone)]
pub struct Rejected {
    /// Its name.
    pub name: &'static str,
    /// The reason.
    pub why: String,
    /// Share of the squared error on left-out pieces that it would remove, if it was fitted.
    pub holdout_gain: Option<f64>,
}

/// An effect that the records cannot show.
#[derive(Debug, Clone)]
pub struct NotTestable {
    /// Its name.
    pub name: &'static str,
    /// The reason.
    pub why: String,
    /// The test that would show it.
    pub test_that_would: &'static str,
}

/// A candidate that was fitted in a round in which another one was accepted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outdone {
    pub(crate) name: &'static str,
    pub(crate) gain: f64,
    pub(crate) by: &'static str,
    pub(crate) gain_of_other: f64,
}

/// The findings of a search.
#[derive(Debug, Clone)]
pub struct Findings {
    /// The nominal model, refitted.
    pub refitted: Judged,
    /// The model with every accepted effect.
    pub with_effects: Judged,
    /// The accepted effects, in the order of the model.
    pub accepted: Vec<Accepted>,
    /// The other candidates, by their error on left-out pieces.
    pub rejected: Vec<Rejected>,
    /// Effects that the records cannot show.
    pub not_testable: Vec<NotTestable>,
    /// The search ended at its limit of work.
    pub cut_short: bool,
    /// The search was interrupted; the findings are those of the rounds before.
    pub interrupted: bool,
}
