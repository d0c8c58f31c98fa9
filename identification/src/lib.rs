//! From measured records to the effect that a damper model lacks.
//!
//! ```text
//! records -> nominal model refitted -> screening -> fit of the best few -> left-out tests -> accepted
//!                                          ^                                                  |
//!                                          +--------------------------------------------------+
//! ```
//!
//! All models run on the damper of `firmware_core`, free-running from measured displacement: what is
//! found here is what `run`, the rig emulator and the firmware use. The steps have a file each:
//!
//! | file | what |
//! | --- | --- |
//! | [`tests_at_hand`] | records cut into pieces to leave out and blocks that are independent |
//! | [`grey_box`], [`coordinate`] | models as vectors of bounded parameters |
//! | [`canonical`] | one way to say what two sets of parameters say alike |
//! | [`simulation`], [`fit`], [`start`] | free-running simulation, least squares, start values |
//! | [`candidate`], [`screening`] | the catalogue against the residual, to first order |
//! | [`trial`], [`folds`] | one candidate fitted and judged on what it has not seen |
//! | [`short_list`], [`acceptance`] | which are worth a fit; which are accepted, and rivals |
//! | [`search`], [`settling`] | the rounds: several effects; an accepted model at its bottom |
//! | [`left_over`] | is the rest noise? |
//! | [`empirical`] | a map on the rest, where somebody wants one: no physics |
//! | [`uncertainty`] | how well parameters are known |
//! | [`cautions`] | what to ask before believing the numbers |
//! | [`identify`](mod@identify), [`result`] | the whole, and how it is written |
//! | [`page`] | the report for people |

pub mod acceptance;
pub mod candidate;
pub mod canonical;
pub mod cautions;
pub mod chance;
pub mod colour;
pub mod coordinate;
pub mod empirical;
pub mod fit;
pub mod folds;
pub mod gram;
pub mod grey_box;
pub mod identify;
pub mod left_over;
pub mod page;
pub mod pair;
pub mod result;
pub mod round;
pub mod screening;
pub mod search;
pub mod settling;
pub mod short_list;
pub mod simulation;
pub mod split;
pub mod start;
pub mod tests_at_hand;
pub mod trial;
pub mod uncertainty;

pub use identify::{Identification, IdentifyError, Question, identify};
