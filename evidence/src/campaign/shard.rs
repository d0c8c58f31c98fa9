//! Many cases, in shards that can be stopped and continued ([`signal::shards`]).

use super::case::Case;
use super::design::deck;
use super::line::CaseResult;
use super::score::score;
use crate::error::EvidenceError;
use files::{Identity, ResultFolder};
use serde::Serialize;
use signal::SignalError;
use signal::shards::{self, Computed, Item, Shard, Work};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// Hash over the sources of the crates that compute a case, made by the build script.
const PROGRAM: &str = env!("CAMPAIGN_SOURCES");

/// A campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Campaign {
    /// Number of cases.
    pub cases: usize,
    /// Seed.
    pub seed: u64,
    /// Fewer tests per case, to try the campaign itself.
    pub brief: bool,
}

/// What the identity of a campaign holds of the question: all that a case depends on apart from its
/// number. The number of cases is no part of it, so a campaign can be extended.
#[derive(Serialize)]
struct QuestionForm {
    seed: u64,
    brief: bool,
}

impl Campaign {
    /// The identity of its cases.
    ///
    /// # Errors
    /// None: the question always serialises.
    pub fn identity(&self) -> Result<Identity, EvidenceError> {
        let question = QuestionForm { seed: self.seed, brief: self.brief };
        Identity::new(&question, BTreeMap::new(), PROGRAM)
            .map_err(|why| EvidenceError::NotSerialised(why.to_string()))
    }

    /// Runs one case; none once `stop` is set.
    pub fn case(&self, index: usize, stop: &AtomicBool) -> Option<CaseResult> {
        let Self { seed, brief, .. } = *self;
        score(&Case::draw(seed, index, brief), seed, brief, stop)
    }

    /// Number of cases of one whole campaign, in which every combination of the design is there.
    pub fn whole() -> usize {
        deck().len()
    }

    /// Runs the cases of a shard that its file in `folder` does not hold yet. `progress` gets each
    /// case when it is done, the number of cases done now and the number to do. Once `stop` is set
    /// no further case begins, and those at work end without a result.
    ///
    /// # Errors
    /// A file that cannot be read or written, or that belongs to another campaign.
    pub fn run(
        &self,
        shard: Shard,
        folder: &ResultFolder,
        stop: &AtomicBool,
        progress: &(dyn Fn(&CaseResult, usize, usize) + Sync),
    ) -> Result<Computed, EvidenceError> {
        let Self { cases, seed, brief } = *self;
        let work = Work { items: cases, name: name(seed, brief), identity: &self.identity()? };
        let case =
            |index| -> Result<Option<CaseResult>, SignalError> { Ok(self.case(index, stop)) };
        Ok(shards::run(&work, shard, folder, stop, &case, progress)?)
    }
}

impl Item for CaseResult {
    const SINGULAR: &'static str = "case";
    const PLURAL: &'static str = "cases";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        name(self.campaign_seed, self.brief)
    }

    fn lasting(&self) -> Self {
        Self { sizing_seconds: 0.0, seconds: 0.0, next_test_seconds: 0.0, ..self.clone() }
    }
}

fn name(seed: u64, brief: bool) -> String {
    format!("{} cases of seed {seed}", if brief { "brief" } else { "whole" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_identity_holds_seed_and_length_of_tests_and_not_the_number_of_cases() {
        let of = |cases, seed, brief| Campaign { cases, seed, brief }.identity().unwrap().name();
        assert_eq!(of(3, 1, true), of(1254, 1, true));
        assert_ne!(of(3, 1, true), of(3, 2, true));
        assert_ne!(of(3, 1, true), of(3, 1, false));
    }
}
