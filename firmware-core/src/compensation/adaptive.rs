//! Adaptive time series: a series whose coefficients follow the rig.
//!
//! The command `u` is regressed on the measured displacement `x` and its first two derivatives,
//!
//! ```text
//! u = a0 x + a1 x' + a2 x''        all low-passed by the same filter, both of one instant
//! ```
//!
//! with exponential forgetting and a ridge towards the start values. Where the motion is too small
//! to learn from, the coefficients hold. They are bounded three times: each to a reach around its
//! start value and to a rate of change, and all of them by the gain of the command at a mode of the
//! rig. The rule `a2 = a1^2 / 2` exceeds this gain on rigs of a high order, and the loop then
//! chatters at the mode. Where the gain is at its bound, `a2` is held and the lower orders make up
//! for it. That is no fault: more delay asks for more gain than the rig bears. An estimate that
//! stays beyond its reach for longer than [`RUNAWAY_S`] is one: it has run away, and the
//! compensator goes back to its start values for good.
//!
//! What the load takes is put on top of the series ([`Load`]) and taken off the command before it
//! is learned from, so that the coefficients are those of a rig without load.
//!
//! A static error of the measured displacement biases `a0`, because it looks like a gain while the
//! motion has a mean.

use super::differences::Kinematics;
use super::filter::Filter;
use super::load::{Felt, Load};
use super::regression::Regression;
use super::series::Series;
use crate::command::Command;
use crate::ring::Ring;
use core::f64::consts::TAU;

/// How long an estimate may stay beyond its reach, s.
pub const RUNAWAY_S: f64 = 1.0;
/// Cycles for which commands are kept; a power of two.
const KEPT: usize = 64;
/// Most answers in a row that may be missing; the displacement is interpolated over them.
const GAP_MAX: u32 = 8;
/// The filter forgets its start within so many radians of its cut-off.
const SETTLING_RAD: f64 = 8.0;
/// Weight of a prior that holds its coefficient.
const HELD: f64 = 1e9;
/// Frequency at which the inputs of the regression are of equal size, Hz.
const SCALE_HZ: f64 = 5.0;

/// The measured answer of a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Measured displacement, m.
    pub displacement_m: f64,
    /// Measured force of the same instant, N.
    pub force_n: f64,
    /// Cycles since the command of the same instant; 0: the command of this cycle.
    pub age_cycles: u32,
}

/// Parameters of the adaptive time series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Start values; the third-order coefficient stays as it is.
    pub start: Series,
    /// What the load takes from the rig, which is known; the series stands for the rest.
    pub load: Load,
    /// Further delay of the loop that is known, s.
    pub known_delay_s: f64,
    /// Whether the third derivative counts.
    pub takes_jerk: bool,
    /// Most difference of each coefficient from its start value.
    pub reach: [f64; 3],
    /// Most change of each coefficient per second.
    pub rate_per_s: [f64; 3],
    /// Frequency of the gain check, Hz: a mode of the rig.
    pub gain_check_hz: f64,
    /// Most gain at this frequency, as a multiple of that of the start values.
    pub gain_ratio: f64,
    /// Time constant of the forgetting, s.
    pub forgetting_s: f64,
    /// Weight of the start values, as a share of the sum of the squared displacement.
    pub ridge: f64,
    /// Cut-off of both filters, Hz.
    pub cut_off_hz: f64,
    /// Least motion to learn from: rms velocity over the angular frequency of 5 Hz, m.
    pub excitation_m: f64,
}

/// What an adaptive time series remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptiveState {
    coefficients: [f64; 3],
    felt: Felt,
    /// The last commands, as many as are known.
    sent_m: Ring<f64, KEPT>,
    known: usize,
    /// Age of the last answer that was used.
    age_cycles: Option<u32>,
    command: Filter,
    motion: Filter,
    settling_rad: f64,
    regression: Regression,
    outside_s: f64,
    has_run_away: bool,
}

impl Adaptive {
    /// Usual bounds around start values, which come from an identification of the rig: 10 % of the
    /// gain, half of the delay and 2 ms, what such a delay changes in the second order, and a gain
    /// at the mode of the rig that is at most a quarter higher.
    pub fn new(start: Series, gain_check_hz: f64) -> Self {
        let [a0, a1, a2, _] = start.0.map(f64::abs);
        let delay = 0.5 * a1 + 2e-3;
        Self {
            start,
            load: Load::default(),
            known_delay_s: 0.0,
            takes_jerk: true,
            reach: [0.1 * a0, delay, 0.5 * (a2 + a1 * delay)],
            rate_per_s: [0.2 * a0, 5e-3, a2 + 0.1 * a1 * a1],
            gain_check_hz,
            gain_ratio: 1.25,
            forgetting_s: 1.0,
            ridge: 1e-3,
            cut_off_hz: 20.0,
            excitation_m: 1e-4,
        }
    }

    /// Compensates a known delay outside of the rig too.
    #[must_use]
    pub const fn with_known_delay(self, known_delay_s: f64) -> Self {
        Self { known_delay_s, ..self }
    }

    /// The state before the first cycle.
    pub(super) const fn start(&self) -> AdaptiveState {
        let [a0, a1, a2, _] = self.start.0;
        AdaptiveState {
            coefficients: [a0, a1, a2],
            felt: Felt::NOTHING,
            sent_m: Ring::filled(0.0),
            known: 0,
            age_cycles: None,
            command: Filter::resting(0.0),
            motion: Filter::resting(0.0),
            settling_rad: 0.0,
            regression: Regression::EMPTY,
            outside_s: 0.0,
            has_run_away: false,
        }
    }

    /// The series in use.
    pub(super) const fn series(&self, state: &AdaptiveState) -> Series {
        let [a0, a1, a2] = state.coefficients;
        let [.., a3] = self.start.0;
        Series([a0, a1, a2, a3])
    }

    /// The command of this cycle; then the answer is learned from, for the next one.
    pub(super) fn step(
        &self,
        state: &mut AdaptiveState,
        motion: &Kinematics,
        answer: Option<Answer>,
        period_s: f64,
    ) -> Command {
        let free = self.series(state).with_delay(self.known_delay_s).command(motion);
        let force_n = answer.map(|answer| answer.force_n);
        let load = self.load.command(&mut state.felt, motion, force_n, period_s);
        let command = Command {
            displacement_m: free.displacement_m + load.displacement_m,
            velocity_m_per_s: free.velocity_m_per_s + load.velocity_m_per_s,
        };
        state.keep(command.displacement_m);
        if state.has_run_away {
            let [a0, a1, a2, _] = self.start.0;
            self.approach(state, [a0, a1, a2], period_s);
        } else if let Some(answer) = answer.filter(|answer| answer.displacement_m.is_finite())
            && let Some(cycles) = self.pair(state, answer, load.displacement_m, period_s)
        {
            self.learn(state, f64::from(cycles) * period_s);
        }
        command
    }

    /// Takes answer and command of one instant into the filters, the command without the
    /// displacement for the load; the cycles since the last pair,
    /// or nothing where the filters have not settled.
    fn pair(
        &self,
        state: &mut AdaptiveState,
        answer: Answer,
        load_m: f64,
        period_s: f64,
    ) -> Option<u32> {
        let Answer { displacement_m, age_cycles, .. } = answer;
        let command_m = state.sent(age_cycles)? - load_m;
        let since = state.age_cycles.map(|last| last.checked_sub(age_cycles));
        let angle = TAU * self.cut_off_hz * period_s;
        match since {
            // Not newer than the last one.
            Some(None | Some(0)) => return None,
            Some(Some(cycles @ 1..=GAP_MAX)) => {
                let from_m = state.motion.input();
                for cycle in 1..=cycles {
                    let share = f64::from(cycle) / f64::from(cycles);
                    state.motion.step(from_m + share * (displacement_m - from_m), angle);
                    let then_m = state.sent(age_cycles + (cycles - cycle));
                    let then_m = then_m.map_or(command_m, |sent_m| sent_m - load_m);
                    state.command.step(then_m, angle);
                }
                state.settling_rad = (state.settling_rad - f64::from(cycles) * angle).max(0.0);
            }
            // The first one, or the first after a long gap.
            None | Some(Some(_)) => {
                state.motion = Filter::resting(displacement_m);
                state.command = Filter::resting(command_m);
                state.settling_rad = SETTLING_RAD;
            }
        }
        state.age_cycles = Some(age_cycles);
        let cycles = since.flatten().unwrap_or(1);
        (state.settling_rad == 0.0).then_some(cycles)
    }

    /// Adds the filtered pair to the sums and moves the coefficients towards the estimate.
    fn learn(&self, state: &mut AdaptiveState, passed_s: f64) {
        let [x, dx, ddx] = state.motion.output();
        let [u, ..] = state.command.output();
        let ratio = self.cut_off_hz / SCALE_HZ;
        let inputs = [x, ratio * dx, ratio * ratio * ddx];
        let kept = self.forgetting_s / (self.forgetting_s + passed_s);
        state.regression.add(inputs, u, passed_s, kept);
        let [displacement, velocity, _] = state.regression.squares();
        // Sums that have overflowed are not too small: their estimate is outside of its bounds.
        if velocity < self.excitation_m * self.excitation_m * self.forgetting_s {
            state.outside_s = 0.0;
            return;
        }
        let free = self.ridge * displacement;
        let [a0, a1, a2, a3] = self.start.0;
        let estimate = self.solved(state, a2, free, free);
        let [r0, r1, r2] = self.reach;
        let [e0, e1, e2] = estimate;
        let is_inside = (e0 - a0).abs() <= r0 && (e1 - a1).abs() <= r1 && (e2 - a2).abs() <= r2;
        state.outside_s = if is_inside { 0.0 } else { state.outside_s + passed_s };
        state.has_run_away = state.outside_s > RUNAWAY_S;
        if !(e0.is_finite() && e1.is_finite() && e2.is_finite()) {
            return;
        }
        let near =
            |[e0, e1, e2]: [f64; 3]| [within(e0, a0, r0), within(e1, a1, r1), within(e2, a2, r2)];
        let bounded = near(estimate);
        let [.., highest] = self.within_gain(bounded, a3);
        let goal = if highest == e2 {
            bounded
        } else {
            // The lower orders make up for the second one where it is held at a bound.
            near(self.solved(state, highest, free, HELD * displacement))
        };
        self.approach(state, goal, passed_s);
    }

    /// The least-squares estimate, with a prior of the second order and the weights of the priors.
    fn solved(&self, state: &AdaptiveState, a2: f64, free: f64, second: f64) -> [f64; 3] {
        let omega = TAU * SCALE_HZ;
        let [a0, a1, ..] = self.start.0;
        let prior = [a0, omega * a1, omega * omega * a2];
        let [e0, e1, e2] = state.regression.solve(prior, [free, free, second]);
        [e0, e1 / omega, e2 / (omega * omega)]
    }

    /// Moves the coefficients towards a goal, at most by their rates and within the gain.
    fn approach(&self, state: &mut AdaptiveState, goal: [f64; 3], passed_s: f64) {
        let mut next = state.coefficients;
        for ((value, goal), rate) in next.iter_mut().zip(goal).zip(self.rate_per_s) {
            let most = rate * passed_s;
            *value += (goal - *value).max(-most).min(most);
        }
        let [.., a3] = self.start.0;
        state.coefficients = self.within_gain(next, a3);
    }

    /// The coefficients, of which the first order and then the second are brought so near to their
    /// start values that the gain at the mode keeps its bound.
    fn within_gain(&self, [a0, a1, a2]: [f64; 3], a3: f64) -> [f64; 3] {
        let omega = TAU * self.gain_check_hz;
        let square = omega * omega;
        let [start_0, _, start_2, _] = self.start.0;
        let start_real = start_0 - start_2 * square;
        let most = self.gain_ratio * self.start.gain(self.gain_check_hz);
        // The imaginary part w (a1 - a3 w^2) leaves room for the real part of the start values.
        let imaginary_most = crate::sqrt::sqrt((most * most - start_real * start_real).max(0.0));
        let a1 = within(a1, a3 * square, imaginary_most / omega);
        let imaginary = omega * (a1 - a3 * square);
        let real_most = crate::sqrt::sqrt((most * most - imaginary * imaginary).max(0.0));
        [a0, a1, within(a2, a0 / square, real_most / square)]
    }
}

/// A value within a reach of another.
fn within(value: f64, of: f64, reach: f64) -> f64 {
    value.max(of - reach).min(of + reach)
}

impl AdaptiveState {
    /// Whether the estimate has run away, so that the start values are in use for good.
    pub(super) const fn has_run_away(&self) -> bool {
        self.has_run_away
    }

    /// Corrects the command of this cycle to what was sent.
    pub(super) fn correct(&mut self, displacement_m: f64) {
        self.sent_m.correct(displacement_m);
    }

    /// Keeps the command of a cycle, which makes the last answer a cycle older.
    fn keep(&mut self, displacement_m: f64) {
        self.age_cycles = self.age_cycles.map(|age| age.saturating_add(1));
        self.known = (self.known + 1).min(KEPT);
        self.sent_m.keep(displacement_m);
    }

    /// The command so many cycles ago, if it is kept and a number.
    fn sent(&self, age_cycles: u32) -> Option<f64> {
        let age = age_cycles as usize;
        if age >= self.known {
            return None;
        }
        self.sent_m.ago(age).filter(|sent| sent.is_finite())
    }
}
