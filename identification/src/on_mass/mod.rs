//! Force in, motion out: a body on a damper or a spring, its force measured and its motion
//! predicted. This is what a bench with a mass on the damper records, or a drop tower, or a public
//! benchmark of nonlinear identification.
//!
//! ```text
//! m y'' = u - k0 y - c0 y' - F(y, y')
//! ```
//!
//! The search starts from the linear body (`m`, `k0`, `c0` free), or from the body on the damper of
//! a datasheet, and adds one law of motion after the other. Everything runs free: the force goes
//! in, and no measured motion is used but that of the first sample, where a record moves there.
//!
//! | files | content |
//! | --- | --- |
//! | `travel`, `law` | hysteresis that is exact in travel; the laws of motion |
//! | `body` | one step of a body |
//! | `inter_sample`, `periods`, `record` | the force between samples; periods; a record |
//! | `linear`, `model`, `fit` | start without a simulation; parameters; least squares |
//! | `control`, `candidates`, `search` | progress; one round; the rounds |
//! | `holdout` | models on records held out, and how many laws these keep |
//! | `question`, `identify`, `result` | files to a question; the whole; `result.json` |
//! | `summary`, `page`, `predictions` | text, report, CSV files |

mod body;
mod candidates;
mod control;
mod fit;
mod holdout;
mod identify;
mod inter_sample;
mod law;
mod linear;
mod model;
mod page;
mod periods;
mod predictions;
mod question;
mod record;
mod result;
mod search;
mod summary;
mod travel;

pub use control::OnMassControl;
pub use identify::{OnMass, identify_on_mass};
pub use page::on_mass_page;
pub use question::OnMassQuestion;
pub use result::{
    CandidateErrors, LawFound, ModelErrors, OnMassParameter, OnMassResult, OnMassVerdict,
    RecordErrors, RoundErrors, Unexplained,
};
