//! Supervision of a bench: who may move what, what is believed, and how motion ends.
//!
//! | file | content |
//! | --- | --- |
//! | `state` | states and events of host and rig, and the outcome of each pair |
//! | `checks` | what is checked of a rig, with its limits and actions |
//! | `belief` | the checks of one rig, cycle by cycle |
//! | `cause` | what stopped a bench |
//! | `loss` | frames that do not arrive |
//! | `age` | how old a measurement is |
//! | `reached` | how far a signal has come towards its limit |
//! | `rule` | a limit on a signal, its debounce and its action |
//! | `findings` | the first cause that ends a run, and what ended nothing |
//! | `stuck` | a sensor that has frozen |
//! | `growth` | a motion that grows towards the end of the stroke |
//! | `second_sender` | frames of somebody else under the id of a peer |
//! | `work` | the work of a damper over a cycle of the motion |
//! | `ramp` | fading in and out |
//! | `limiter` | commands within what the ram can do |
//!
//! This is no safety function and claims no performance level: emergency stop, guard door and
//! pressure dump are hard-wired, and the limits of the bench controller rule.

mod age;
mod belief;
mod cause;
mod checks;
mod findings;
mod growth;
mod limiter;
mod loss;
mod ramp;
#[cfg(test)]
mod random;
mod reached;
mod rule;
mod second_sender;
mod state;
mod stuck;
mod work;

pub use age::{Age, AgeJudge, OLDEST_CYCLES};
pub use belief::{Arrival, Belief, Measured};
pub use cause::{Cause, Signal};
pub use checks::{BEYOND_STROKE_M, Checks, Condition, RESIDUAL_SHARE};
pub use findings::Noted;
pub use growth::Growth;
pub use limiter::{CommandLimits, Demand, Limited};
pub use loss::{LONG_CYCLES, Loss, LossLimits, LossVerdict, MostLost, SHORT_CYCLES};
pub use ramp::Ramp;
pub use reached::Reached;
pub use rule::{Action, Rule, RuleState};
pub use second_sender::{Frames, SecondSender};
pub use state::{Event, Outcome, State, write_diagram};
pub use stuck::{FEWEST_CYCLES, Stuck};
pub use work::{
    LEAST_AMPLITUDE_M, LEAST_FORCE_N, LEAST_STIFFNESS_N_PER_M, SUMMED, Work, WorkLimits,
    WorkVerdict,
};
