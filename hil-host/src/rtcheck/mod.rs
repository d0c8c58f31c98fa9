//! `yawbench rtcheck`: does this machine keep the pace of the loop?
//!
//! It runs what a run runs, without rigs: the loop's own clock ([`crate::clock::Pacer`]) and set-up
//! ([`crate::realtime`]), and in every cycle the step of the scenario's vehicle with modelled
//! dampers. Beside it, in a thread of its own, an announcement goes over the bus ten times a second
//! and its answer is timed. A page may be fed in every other second, to measure what it costs the
//! loop.
//!
//! [`budget`] times every stage of the loop at every rate, with an emulated rig.
//!
//! [`measure`] measures, [`Measured`] holds the times in histograms that were made before, and
//! [`RtCheck`] judges them. Judging is pure, so that its tests need no clock.

mod answer;
mod beside_page;
mod budget;
mod distribution;
mod measure;
mod result;
mod ticks;

pub use answer::{AnswerTimes, AnsweredBy};
pub use beside_page::{BesidePage, PartTimes};
pub use budget::{Budget, BudgetOptions, RateBudget, StageTimes, budget};
pub use distribution::{Bin, Distribution, histogram_lines};
pub use measure::{Measured, Options, measure};
pub use result::{AnswerResult, BesidePageResult, Outcome, PartResult, RtCheck, Setup};
