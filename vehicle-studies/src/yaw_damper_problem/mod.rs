//! A reference problem for compensators: a locomotive with its yaw dampers on emulated rigs.
//!
//! ```text
//! coupled run    vehicle -> wanted motion -> compensator -> rig with a damper -> force -> vehicle
//! all-model run  vehicle with the same dampers modelled in their places
//! ```
//! The scores of a compensator are the errors of the coupled run: of work per cycle, stroke and
//! phase, over irregular track and in the limit cycle, and of the critical speed. All four dampers
//! are behind rigs, so that nothing but the compensator holds the vehicle on its way. The rig is
//! servo-hydraulic, with a dead time in series.
//!
//! Others come in through CSV. A command is scored in open loop, on the rig alone: the motion is
//! given, and what the rig does to the vehicle is not in the score. A linear filter closes the loop
//! and is scored like ours.
//!
//! A second way to the critical speed comes from below: decay rates of ring-downs, extrapolated
//! ([`FromBelow`]).
//!
//! Read in this order:
//!
//! 1. [`Condition`], [`Regime`], [`Question`]: dampers, ways to run, what is asked.
//! 2. [`DataSheet`], `perturbed`: what is known of the rig, and rigs that differ.
//! 3. `recording`, [`Errors`]: what is compared; `case`: the vehicle and its all-model runs.
//! 4. [`Ours`], [`Candidate`], `exchange`, `open_loop`: compensators of ours and of others.
//! 5. [`RingDown`], [`FromBelow`].
//! 6. [`Problem`], `job`: all of it; [`Answer`], `aims`, [`text`], [`page`]: what is found.
//!
//! Limits: every rig is emulated, values are not rounded to the steps of frames, commands have no
//! limits, and no force is lost on a bus.

mod aims;
mod answer;
mod candidate;
mod case;
mod columns;
mod compensators;
mod condition;
mod data_sheet;
mod errors;
mod exchange;
mod from_below;
mod job;
mod loaded;
mod open_loop;
mod page;
mod perturbed;
mod problem;
mod problem_files;
mod question;
mod recording;
mod regime;
mod ring_down;
mod sine;
mod text;

pub use answer::{Aim, Answer, Below, InRegimes, Modelled, RESULT_OF, Score, Size, Spread};
pub use candidate::Candidate;
pub use compensators::{OURS, Ours};
pub use condition::{CONDITIONS, Condition};
pub use data_sheet::DataSheet;
pub use errors::{AIMS, Errors};
pub use exchange::{motion_csv, read_command, read_filter};
pub use from_below::{Climb, FromBelow};
pub use loaded::Loaded;
pub use page::page;
pub use problem::{Motion, Problem};
pub use problem_files::ProblemFile;
pub use question::{DEAD_TIMES_MS, Question};
pub use regime::{REGIMES, Regime};
pub use ring_down::{Release, RingDown};
pub use text::text;
