//! What is checked of a rig: the limits, how long each may be passed, and what happens then.

use super::age::OLDEST_CYCLES;
use super::loss::LossLimits;
use super::rule::{Action, Rule};
use super::stuck::FEWEST_CYCLES;
use super::work::WorkLimits;

/// Share of the largest believed force that the rms of the residual may have.
pub const RESIDUAL_SHARE: f64 = 1.0 / 3.0;

/// Change of the measured speed from cycle to cycle that no sound rig shows (m/s).
const SPEED_CHANGE_M_PER_S: f64 = 0.6;

/// A condition that a limit does not describe, with its debounce and its action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// Cycles in a row for which it holds, at least 1.
    pub cycles: u32,
    /// What happens then.
    pub action: Action,
}

/// Parameters of the checks of one rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checks {
    /// Range of the counters.
    pub counter_modulus: u8,
    /// Length of a cycle, s.
    pub cycle_s: f64,
    /// Speed of the command from which live sensors change, m/s.
    pub moving_m_per_s: f64,
    /// Measured force, N.
    pub force: Rule,
    /// Change of the measured force from cycle to cycle, N.
    pub force_rate: Rule,
    /// Measured displacement from mid-stroke, m.
    pub displacement: Rule,
    /// Speed of the measured displacement, m/s.
    pub velocity: Rule,
    /// Acceleration of the measured displacement, m/s2.
    pub acceleration: Rule,
    /// Measured displacement less the command that it answers, m.
    pub tracking: Rule,
    /// Temperature of the damper, degrees Celsius.
    pub temperature: Rule,
    /// Rms of the measured force less that of the slot's model over the last second, N.
    pub residual: Rule,
    /// Age of a measurement, cycles: at most [`OLDEST_CYCLES`].
    pub age: Rule,
    /// The force is missing, or the rig says that its sensor is invalid.
    pub invalid_force: Condition,
    /// The displacement is missing.
    pub invalid_displacement: Condition,
    /// The force sensor repeats one code while the ram moves.
    pub stuck_force: Condition,
    /// The displacement sensor repeats one code while the ram moves.
    pub stuck_displacement: Condition,
    /// Shares of the most possible work that a damper may give back.
    pub work: WorkLimits,
    /// What a cycle of the motion with the wrong sign of the work asks for.
    pub wrong_sign: Action,
    /// What ten cycles of the motion asks for that give work back.
    pub wrong_phase: Action,
    /// How many measurements, or commands, may be lost.
    pub lost: LossLimits,
    /// What losses in a row ask for.
    pub lost_in_a_row: Action,
    /// What losses over the short window ask for.
    pub lost_of_50: Action,
    /// What losses over the long window ask for.
    pub lost_of_250: Action,
    /// What an adaptive compensator asks for whose estimate has run away.
    pub compensation: Action,
}

/// How far a measured displacement may be beyond the furthest command (m): twice what 20 kN do to a
/// fixture of 20 MN/m.
pub const BEYOND_STROKE_M: f64 = 2e-3;

impl Checks {
    /// The same within the force (N) and the stroke of commands (m) that a rig has agreed to.
    #[must_use]
    pub const fn within(self, force_n: f64, stroke_m: f64) -> Self {
        const fn tighter(rule: Rule, limit: f64) -> Rule {
            Rule { limit: rule.limit.min(limit), ..rule }
        }
        Self {
            force: tighter(self.force, force_n),
            displacement: tighter(self.displacement, stroke_m + BEYOND_STROKE_M),
            ..self
        }
    }

    /// The checks of a rig with counters of this range and cycles of this length.
    ///
    /// The force may reach `force_n`, and the residual [`RESIDUAL_SHARE`] of it. It may change by
    /// 25 kN in a cycle: at the end of a clearance of 8 mm an attachment of 12.5 MN/m is met at 0.2
    /// m/s, which is 2.5 kN per millisecond, and a spike of a sensor is larger than ten times that.
    /// The displacement may move at 0.8 m/s, twice what a hunting locomotive asks for. It may be 5
    /// mm off its command, and 2 mm beyond the stroke of the commands, which is 100 mm.
    ///
    /// **Acceleration.** It is the second difference of three measurements, so that noise of `s`
    /// rms becomes `sqrt(6) s / T^2` rms: 0.5 m/s2 with the noise of 0.2 um and the steps of 0.2 um
    /// of the laboratory rig. Seven times that, 3.6 m/s2, is passed in 3.6 million cycles with a
    /// probability of 1e-5. Commands add their 20 m/s2. A clock that slips by a period moves the
    /// ram by `v T`, which reads as `v / T`: 500 m/s2 at the highest speed of a command. A force
    /// that changes by 2.5 kN in a cycle bends a fixture of 40 MN/m by 63 um: 63 m/s2. The sum of
    /// all four is 587 m/s2. The limit is 600 m/s2, in three cycles in a row. All but the commands
    /// grow with the rate, and so does the limit, `0.6 m/s / T`: 1200 m/s2 at 2 kHz, where the sum
    /// is 1160, and 2400 at 4 kHz, where it is 2330.
    pub const fn usual(counter_modulus: u8, cycle_s: f64, force_n: f64) -> Self {
        use Action::{Log, PowerOff, RampOut, Stop};
        const fn rule(limit: f64, debounce_cycles: u32, action: Action) -> Rule {
            Rule { limit, debounce_cycles, action }
        }
        const fn condition(cycles: u32, action: Action) -> Condition {
            Condition { cycles, action }
        }
        Self {
            counter_modulus,
            cycle_s,
            moving_m_per_s: 1e-3,
            force: rule(force_n, 2, Stop),
            force_rate: rule(25e3, 2, Stop),
            displacement: rule(0.102, 2, Stop),
            velocity: rule(0.8, 1, PowerOff),
            acceleration: rule(SPEED_CHANGE_M_PER_S / cycle_s, 3, PowerOff),
            tracking: rule(5e-3, 3, PowerOff),
            temperature: rule(100.0, 100, RampOut),
            residual: rule(RESIDUAL_SHARE * force_n, 1, Log),
            age: rule(OLDEST_CYCLES as f64, 5, Stop),
            invalid_force: condition(5, Stop),
            invalid_displacement: condition(5, PowerOff),
            stuck_force: condition(FEWEST_CYCLES, RampOut),
            stuck_displacement: condition(FEWEST_CYCLES, PowerOff),
            work: WorkLimits::USUAL,
            wrong_sign: RampOut,
            wrong_phase: RampOut,
            lost: LossLimits::USUAL,
            lost_in_a_row: Stop,
            lost_of_50: RampOut,
            lost_of_250: RampOut,
            compensation: RampOut,
        }
    }
}
