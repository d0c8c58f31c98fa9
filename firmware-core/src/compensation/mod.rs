//! What happens to the displacement on its way from the vehicle to a rig.
//!
//! A [`Compensator`] gives the rig a command that it answers, after its delay, with the wanted
//! motion: [`Feedforward`] with fixed coefficients, or [`Adaptive`], which follows a rig that
//! changes. [`damping_energy_lost`] states what a residual delay costs. `docs/rths-benchmark.md`
//! compares the compensators.
//!
//! A cycle costs 120 instructions with fixed coefficients and 1130 with adaptive ones (callgrind on
//! x86-64, rustc 1.95): less than 2 % of a step of the vehicle.

mod adaptive;
mod delay_cost;
mod differences;
mod feedforward;
mod filter;
mod load;
mod regression;
mod series;

pub use adaptive::{Adaptive, AdaptiveState, Answer, RUNAWAY_S};
pub use delay_cost::{damping_energy_lost, delay_that_costs};
pub(crate) use differences::Differences;
pub use feedforward::Feedforward;
pub use load::Load;
pub use series::Series;

use crate::command::Command;

/// How the delay of a rig is compensated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Compensator {
    /// Not at all.
    None,
    /// With fixed coefficients.
    Feedforward(Feedforward),
    /// With coefficients that follow the rig.
    Adaptive(Adaptive),
}

/// What a compensator remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompensatorState {
    differences: Differences,
    adaptive: Option<AdaptiveState>,
}

impl CompensatorState {
    /// The start of every one that does not adapt.
    pub(crate) const NEW: Self = Self { differences: Differences::NEW, adaptive: None };
}

// A rig's controller has room for this.
const _: () = assert!(size_of::<CompensatorState>() <= 4096);

impl Compensator {
    /// The state before the first cycle.
    pub fn start(&self) -> CompensatorState {
        let adaptive = match self {
            Self::Adaptive(adaptive) => Some(adaptive.start()),
            Self::None | Self::Feedforward(_) => None,
        };
        CompensatorState { adaptive, ..CompensatorState::NEW }
    }

    /// The command of this cycle for a wanted motion. `answer` is what has arrived from the rig
    /// since the last cycle, if anything.
    ///
    /// ```
    /// use firmware_core::command::Command;
    /// use firmware_core::compensation::{Compensator, Feedforward};
    /// let compensator = Compensator::Feedforward(Feedforward::polynomial(1, 0.01));
    /// let mut state = compensator.start();
    /// let wanted = Command { displacement_m: 1e-3, velocity_m_per_s: 0.1 };
    /// let command = compensator.step(&mut state, wanted, None, 1e-3);
    /// assert!((command.displacement_m - 2e-3).abs() < 1e-15);
    /// ```
    pub fn step(
        &self,
        state: &mut CompensatorState,
        wanted: Command,
        answer: Option<Answer>,
        period_s: f64,
    ) -> Command {
        debug_assert!(period_s > 0.0, "period of {period_s} s");
        match (self, &mut state.adaptive) {
            (Self::None, _) => wanted,
            (Self::Feedforward(fixed), _) => {
                let motion = state.differences.take(wanted, period_s).jerked(fixed.takes_jerk);
                fixed.series.with_delay(fixed.known_delay_s).command(&motion)
            }
            (Self::Adaptive(adaptive), Some(remembered)) => {
                let motion = state.differences.take(wanted, period_s).jerked(adaptive.takes_jerk);
                adaptive.step(remembered, &motion, answer, period_s)
            }
            (Self::Adaptive(_), None) => {
                debug_assert!(false, "a state of another compensator");
                wanted
            }
        }
    }

    /// The same with a further delay that is known, s.
    #[must_use]
    pub fn with_known_delay(self, known_delay_s: f64) -> Self {
        match self {
            Self::None => Self::None,
            Self::Feedforward(fixed) => Self::Feedforward(fixed.with_known_delay(known_delay_s)),
            Self::Adaptive(adaptive) => Self::Adaptive(adaptive.with_known_delay(known_delay_s)),
        }
    }

    /// The same that leaves the third derivative out: behind a contact it is an impulse.
    #[must_use]
    pub fn without_jerk(self) -> Self {
        match self {
            Self::None => Self::None,
            Self::Feedforward(fixed) => {
                Self::Feedforward(Feedforward { takes_jerk: false, ..fixed })
            }
            Self::Adaptive(adaptive) => Self::Adaptive(Adaptive { takes_jerk: false, ..adaptive }),
        }
    }

    /// What the compensator takes the rig for: the inverse of its transfer function.
    pub fn series(&self, state: &CompensatorState) -> Series {
        match (self, &state.adaptive) {
            (Self::None, _) => Series::IDENTITY,
            (Self::Feedforward(fixed), _) => fixed.series,
            (Self::Adaptive(adaptive), Some(remembered)) => adaptive.series(remembered),
            (Self::Adaptive(adaptive), None) => adaptive.start,
        }
    }
}

impl CompensatorState {
    /// Corrects the command of this cycle to what was sent, where a limit or a ramp changed it.
    pub fn sent(&mut self, command: Command) {
        if let Some(adaptive) = &mut self.adaptive {
            adaptive.correct(command.displacement_m);
        }
    }

    /// Whether an estimate has run away, so that its start values are in use for good.
    ///
    /// ```
    /// use firmware_core::compensation::Compensator;
    /// assert!(!Compensator::None.start().has_run_away());
    /// ```
    pub fn has_run_away(&self) -> bool {
        self.adaptive.as_ref().is_some_and(AdaptiveState::has_run_away)
    }
}

#[cfg(test)]
mod tests;
