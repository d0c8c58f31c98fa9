//! From measured records to the effect that a damper model lacks.
//!
//! ```text
//! records -> nominal refitted -> screening -> fits of the best few -> left-out pieces -> accepted
//!                                    ^                                                   |
//!                                    +---------------------------------------------------+
//! ```
//!
//! All models run on the damper of `firmware_core`, in free-run simulation from the measured
//! displacement, so a model that is found here is what `run`, the rig emulator and the firmware
//! use. [`identify`] does it all: a [`Question`] in, an [`Identification`] out, with a [`Control`]
//! that reports progress and ends the work early.
//!
//! Read in this order; a file uses only those above it.
//!
//! | files | content |
//! | --- | --- |
//! | `control` | progress, and the flag that ends the work |
//! | `test_set`, `split` | records cut into pieces to leave out and independent blocks; the hold-out |
//! | `coordinate`, `grey_box` | a model as a vector of bounded parameters |
//! | `simulation`, `data_rate` | free-run simulation; the samples that a search needs |
//! | `gram`, `descent`, `fit`, `start` | normal equations, least squares, start values |
//! | `colour`, `chance`, `batches`, `few_strokes` | coloured noise, significance |
//! | `residual` | is the residual noise, or has it structure? |
//! | `linearised`, `folds`, `judged` | a fitted model, and its predictions of left-out pieces |
//! | `band`, `evidence`, `finding` | the vocabulary: evidence, accepted, rejected, not testable |
//! | `candidate`, `screening`, `short_list` | the catalogue against the residual, to first order |
//! | `trial`, `acceptance`, `canonical`, `settling` | a candidate fitted and judged; the rules |
//! | `sharing` | parameters that share one value where that is enough |
//! | `budget`, `round`, `pair`, `rejection` | the parts of one round of the search |
//! | `search` | the rounds, one effect after the other |
//! | `gate` | which of the accepted effects survive the tests held out |
//! | `empirical` | a map of the residual, if asked for |
//! | `uncertainty`, `cautions` | how well parameters are known; reasons for doubt |
//! | `error`, `question`, `result`, `identify` | files to a question; the whole; `result.json` |
//! | `next_test` | the motion that separates what these records cannot |
//! | `on_mass` | the other direction: force in, motion of a body out |
//! | `tables`, `summary`, `page`, `model_file`, `predictions` | text, report, `model.toml`, CSV files |
//!
//! Layers: the crate knows `measurement`, `scenario`, `signal`, `report`, `files` and the core, but
//! no bench and no vehicle.

mod acceptance;
mod band;
mod batches;
mod budget;
mod candidate;
mod canonical;
mod cautions;
mod chance;
mod colour;
mod control;
mod coordinate;
mod data_rate;
mod descent;
mod empirical;
mod error;
mod evidence;
mod few_strokes;
mod finding;
mod fit;
mod folds;
mod gate;
mod gram;
mod grey_box;
mod identify;
mod judged;
mod linearised;
mod model_file;
mod next_test;
pub mod on_mass;
mod page;
mod pair;
mod predictions;
mod question;
mod rejection;
mod residual;
pub mod result;
mod round;
mod screening;
mod search;
mod settling;
mod sharing;
mod short_list;
mod simulation;
mod split;
mod start;
mod summary;
mod tables;
mod test_set;
mod trial;
mod uncertainty;

pub use control::{Control, RoundProgress, Step};
pub use empirical::{Empirical, FittedMap, empirical};
pub use error::IdentificationError;
pub use fit::{Effort, Fit, fit};
pub use grey_box::{GreyBox, vector_of};
pub use identify::{Identification, identify};
pub use model_file::{MODEL, MODEL_WITH_MAP};
pub use next_test::{Motion, NextTest, next_tests};
pub use page::page;
pub use predictions::Prediction;
pub use question::{Question, QuestionFiles};
pub use search::search;
pub use simulation::{simulate, start_deflection_m};
pub use start::{NominalFit, nominal_fit};
pub use test_set::TestSet;
