//! What is believed of a rig, cycle by cycle.
//!
//! ```text
//! frame -> age and step of its counters -> sound? -> limits -> force for the vehicle
//!              lost, old: the last force holds        a cause ends the run
//! ```
//!
//! [`Belief::take`] judges what arrived in a cycle. It gives the force to use, and the first cause
//! that asks for an end. [`Belief::temperature`] and [`Belief::residual`] judge what comes by
//! another way. Every check counts cycles; none reads a clock. A check whose action is to log or to
//! hold ends nothing and is noted ([`Noted`]); while one holds, the last believed force is used.
//!
//! Limits: a gain error of 10 % or an offset within the limits is a possible damper, and no check
//! of this kind can find it while the bench runs.

use super::age::{Age, AgeJudge};
use super::cause::{Cause, Signal};
use super::checks::{Checks, Condition};
use super::findings::{Findings, Noted};
use super::loss::{Loss, LossVerdict, MostLost};
use super::reached::Reached;
use super::rule::{Action, Rule, RuleState};
use super::stuck::Stuck;
use super::work::{GivenBack, Work};
use crate::command::Command;
use crate::guard::ForceInput;

/// A measurement, as it came off the bus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The rig's own counter.
    pub counter: u8,
    /// Counter of the command that it answers.
    pub echo: Option<u8>,
    /// Displacement, m.
    pub displacement_m: Option<f64>,
    /// Force, N, tension positive.
    pub force_n: Option<f64>,
    /// False where the rig says that its sensor is invalid.
    pub is_valid: bool,
    /// Whether the rig follows commands.
    pub runs: bool,
}

/// What a cycle has of a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Arrival {
    /// The newest measurement.
    Frame(Measured),
    /// Nothing.
    Nothing,
    /// Frames that failed their check.
    Damaged,
}

/// Commands that are remembered: the oldest that a believed measurement can answer, and itself.
const REMEMBERED: usize = 8;

/// Time over which the rms of the residual forgets, s.
const RESIDUAL_S: f64 = 1.0;

/// What the checks of one rig remember.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Belief {
    age: AgeJudge,
    /// Age of the oldest measurement so far, cycles.
    oldest_cycles: u8,
    begun: bool,
    /// Whether the rig was coupled, and every cycle is to bring a measurement.
    is_coupled: bool,
    /// Whether this cycle has a new measurement.
    is_new: bool,
    last_echo: Option<u8>,
    measurements: Loss,
    /// Cycles in a row in which frames came, and all of them failed their check.
    damaged_cycles: u32,
    commands: Loss,
    invalid_cycles: u32,
    old_cycles: u32,
    blind_cycles: u32,
    force: RuleState,
    force_rate: RuleState,
    displacement: RuleState,
    velocity: RuleState,
    acceleration: RuleState,
    tracking: RuleState,
    temperature: RuleState,
    residual: RuleState,
    /// Running mean of the squared residual, N2.
    residual2: f64,
    stuck_force: Stuck,
    stuck_displacement: Stuck,
    work: Work,
    last_force_n: Option<f64>,
    last_displacement_m: Option<f64>,
    /// Change of the displacement in the last cycle, where both ends of it were measured, m.
    last_step_m: Option<f64>,
    since_displacement: u32,
    sent: [Command; REMEMBERED],
    next: usize,
    found: Findings,
}

impl Belief {
    /// Notes the command that a cycle has sent.
    pub fn sent(&mut self, command: Command) {
        self.next = (self.next + 1) % REMEMBERED;
        if let Some(place) = self.sent.get_mut(self.next) {
            *place = command;
        }
    }

    /// Judges what arrived since the command with the counter `sent`: the force for the vehicle.
    pub fn take(&mut self, checks: &Checks, arrival: Arrival, sent: Option<u8>) -> ForceInput {
        self.age.cycle();
        self.since_displacement = self.since_displacement.saturating_add(1);
        let is_damaged = arrival == Arrival::Damaged;
        self.damaged_cycles = if is_damaged { self.damaged_cycles.saturating_add(1) } else { 0 };
        let input = match (arrival, sent) {
            (Arrival::Frame(measured), Some(sent)) => self.judge(checks, &measured, sent),
            // Before the first command there is nothing to answer.
            (Arrival::Frame(_) | Arrival::Nothing, _) => ForceInput::Missing,
            (Arrival::Damaged, _) => ForceInput::Invalid,
        };
        let input = match input {
            ForceInput::Fresh(_) if self.found.holds() => ForceInput::Invalid,
            input => input,
        };
        let is_new = core::mem::take(&mut self.is_new);
        let has_come = matches!(input, ForceInput::Fresh(_));
        // The first command was sent in the cycle of the coupling: its answer is due in the next.
        if self.begun || has_come {
            self.count_losses(checks, is_new);
        }
        self.begun |= has_come || self.is_coupled;
        self.found.end_cycle();
        input
    }

    /// Lets cycles pass that the host has missed, and in which its rig went on.
    pub fn skip(&mut self, cycles: u32) {
        self.age.skip(cycles);
        self.since_displacement = self.since_displacement.saturating_add(cycles);
    }

    /// Judges the temperature that the rig reports (degrees Celsius), before [`Belief::take`].
    pub fn temperature(&mut self, checks: &Checks, temperature_degc: f64) {
        self.found.on_rule(
            &checks.temperature,
            &mut self.temperature,
            Signal::Temperature,
            temperature_degc,
        );
    }

    /// Judges the measured force of a cycle less that of the slot's model (N).
    pub fn residual(&mut self, checks: &Checks, residual_n: f64) {
        let share = (checks.cycle_s / RESIDUAL_S).min(1.0);
        self.residual2 += share * (residual_n * residual_n - self.residual2);
        self.found.on_rule(
            &checks.residual,
            &mut self.residual,
            Signal::Residual,
            crate::sqrt::sqrt(self.residual2),
        );
    }

    /// Takes that an adaptive compensator has fallen back to its start values, for good.
    pub fn compensation(&mut self, checks: &Checks, has_run_away: bool) {
        if has_run_away {
            let (signal, action) = (Signal::Compensation, checks.compensation);
            self.found.act(Cause { signal, value: 1.0, limit: f64::INFINITY, action });
        }
    }

    /// What was beyond a limit and ended nothing, by signal.
    pub fn noted(&self) -> impl Iterator<Item = Noted> + '_ {
        self.found.noted()
    }

    /// Begins with the cycle in which a rig is coupled: fills the memory of commands with the place
    /// where its ram stands. From the next cycle on measurements can be lost.
    pub fn begin(&mut self, command: Command) {
        self.sent = [command; REMEMBERED];
        self.is_coupled = true;
    }

    /// The strongest action that has been asked for: the first cause may ask to ramp out, and a
    /// later one to stop.
    pub fn action(&self) -> Option<Action> {
        self.found.action()
    }

    /// The first cause that asks for an end.
    pub fn cause(&self) -> Option<Cause> {
        self.found.cause()
    }

    /// Age of the measurement that is believed, cycles: it grows while nothing new comes.
    pub fn age_cycles(&self) -> Option<u8> {
        self.age.age_cycles()
    }

    /// Losses of measurements and of commands.
    pub fn losses(&self) -> (&Loss, &Loss) {
        (&self.measurements, &self.commands)
    }

    /// How far every signal that has a limit has come towards it.
    pub fn reached(&self, checks: &Checks) -> [Reached; Reached::COUNT] {
        let [one_cycle, ten_cycles] = self.work.most_given();
        let (measurements, commands) = (self.measurements.most(), self.commands.most());
        let most = |of: fn(&MostLost) -> u32| f64::from(of(&measurements).max(of(&commands)));
        let rule = Reached::of_rule;
        let (count, share) = (Reached::of_count, Reached::of_share);
        [
            rule(Signal::Displacement, &checks.displacement, &self.displacement),
            rule(Signal::Velocity, &checks.velocity, &self.velocity),
            rule(Signal::Acceleration, &checks.acceleration, &self.acceleration),
            rule(Signal::Tracking, &checks.tracking, &self.tracking),
            rule(Signal::Force, &checks.force, &self.force),
            rule(Signal::ForceRate, &checks.force_rate, &self.force_rate),
            rule(Signal::Residual, &checks.residual, &self.residual),
            rule(Signal::Temperature, &checks.temperature, &self.temperature),
            share("work", one_cycle, checks.work.one_cycle, checks.wrong_sign),
            share("work_of_ten", ten_cycles, checks.work.ten_cycles, checks.wrong_phase),
            Reached {
                has_tripped: self
                    .cause()
                    .is_some_and(|cause| cause.signal == Signal::OldMeasurements),
                ..count("age", f64::from(self.oldest_cycles), checks.age.limit, checks.age.action)
            },
            // One cycle less than those that are too many.
            count(
                "lost_in_a_row",
                most(|lost| lost.in_a_row),
                f64::from(checks.lost.in_a_row) - 1.0,
                checks.lost_in_a_row,
            ),
            count(
                "lost_of_50",
                most(|lost| lost.in_short),
                f64::from(checks.lost.in_short),
                checks.lost_of_50,
            ),
            count(
                "lost_of_250",
                most(|lost| lost.in_long),
                f64::from(checks.lost.in_long),
                checks.lost_of_250,
            ),
        ]
    }

    fn judge(&mut self, checks: &Checks, measured: &Measured, sent: u8) -> ForceInput {
        if !measured.runs {
            return ForceInput::Invalid;
        }
        let age = self.age.take(measured.counter, measured.echo, sent, checks.counter_modulus);
        if let Age::New(cycles) = age {
            self.oldest_cycles = self.oldest_cycles.max(cycles);
        }
        let age = match age {
            Age::New(age) if f64::from(age) <= checks.age.limit => age,
            Age::New(_) | Age::Old => {
                self.old_cycles = self.old_cycles.saturating_add(1);
                let cycles = checks.age.debounce_cycles;
                let condition = Condition { cycles, action: checks.age.action };
                self.found.on_condition(condition, self.old_cycles, Signal::OldMeasurements);
                return ForceInput::Missing;
            }
            Age::Unknown => return ForceInput::Missing,
        };
        (self.is_new, self.old_cycles) = (true, 0);
        self.note_echo(checks, measured.echo);
        self.judge_displacement(checks, measured, age);
        self.judge_force(checks, measured, age)
    }

    /// A measurement that echoes the same command as the last one tells of a lost command.
    fn note_echo(&mut self, checks: &Checks, echo: Option<u8>) {
        let is_lost = self.begun && echo == self.last_echo;
        let verdict = self.commands.take(&checks.lost, is_lost);
        self.last_echo = echo;
        self.on_loss(checks, verdict, Signal::LostCommands);
    }

    fn count_losses(&mut self, checks: &Checks, came: bool) {
        let verdict = self.measurements.take(&checks.lost, !came);
        // Where all of them came and failed their check, none was lost on the way.
        let has_come = !came && self.damaged_cycles >= self.measurements.in_a_row();
        let signal = if has_come && verdict == LossVerdict::Row {
            Signal::WrongSeal
        } else {
            Signal::LostMeasurements
        };
        self.on_loss(checks, verdict, signal);
    }

    fn on_loss(&mut self, checks: &Checks, verdict: LossVerdict, signal: Signal) {
        let loss = if signal == Signal::LostCommands { &self.commands } else { &self.measurements };
        let (short, long) = loss.in_windows();
        let lost = checks.lost;
        let (count, most, action) = match verdict {
            LossVerdict::Holds => return,
            LossVerdict::Row => (loss.in_a_row(), lost.in_a_row, checks.lost_in_a_row),
            LossVerdict::Short => (short, lost.in_short, checks.lost_of_50),
            LossVerdict::Long => (long, lost.in_long, checks.lost_of_250),
        };
        self.found.act(Cause { signal, value: f64::from(count), limit: f64::from(most), action });
    }

    fn judge_displacement(&mut self, checks: &Checks, measured: &Measured, age: u8) {
        let Some(displacement_m) = measured.displacement_m else {
            self.blind_cycles = self.blind_cycles.saturating_add(1);
            let (condition, cycles) = (checks.invalid_displacement, self.blind_cycles);
            self.found.on_condition(condition, cycles, Signal::InvalidDisplacement);
            return;
        };
        self.blind_cycles = 0;
        self.found.on_rule(
            &checks.displacement,
            &mut self.displacement,
            Signal::Displacement,
            displacement_m,
        );
        self.judge_motion(checks, displacement_m);
        let answered = self.answered(age);
        let error_m = displacement_m - answered.displacement_m;
        self.found.on_rule(&checks.tracking, &mut self.tracking, Signal::Tracking, error_m);
        let moves = answered.velocity_m_per_s.abs() > checks.moving_m_per_s;
        let condition = checks.stuck_displacement;
        let (code, resting) = (displacement_m.to_bits(), f64::NAN.to_bits());
        let is_stuck = self.stuck_displacement.take(condition.cycles, code, resting, moves);
        let cycles = if is_stuck { condition.cycles } else { 0 };
        self.found.on_condition(condition, cycles, Signal::StuckDisplacement);
    }

    /// Speed and acceleration of the displacement.
    fn judge_motion(&mut self, checks: &Checks, displacement_m: f64) {
        let cycles = core::mem::take(&mut self.since_displacement).max(1);
        let Some(last_m) = self.last_displacement_m.replace(displacement_m) else { return };
        let step_m = displacement_m - last_m;
        let speed = step_m / (f64::from(cycles) * checks.cycle_s);
        self.found.on_rule(&checks.velocity, &mut self.velocity, Signal::Velocity, speed);
        let before_m = core::mem::replace(&mut self.last_step_m, (cycles == 1).then_some(step_m));
        if let (Some(before_m), 1) = (before_m, cycles) {
            let acceleration = (step_m - before_m) / (checks.cycle_s * checks.cycle_s);
            self.found.on_rule(
                &checks.acceleration,
                &mut self.acceleration,
                Signal::Acceleration,
                acceleration,
            );
        }
    }

    fn judge_force(&mut self, checks: &Checks, measured: &Measured, age: u8) -> ForceInput {
        let Some(force_n) = measured.force_n.filter(|_| measured.is_valid) else {
            self.invalid_cycles = self.invalid_cycles.saturating_add(1);
            let (condition, cycles) = (checks.invalid_force, self.invalid_cycles);
            self.found.on_condition(condition, cycles, Signal::InvalidForce);
            return ForceInput::Invalid;
        };
        self.invalid_cycles = 0;
        self.found.on_rule(&checks.force, &mut self.force, Signal::Force, force_n);
        let change_n = self.last_force_n.map_or(0.0, |last_n| force_n - last_n);
        self.found.on_rule(&checks.force_rate, &mut self.force_rate, Signal::ForceRate, change_n);
        let moves = self.answered(age).velocity_m_per_s.abs() > checks.moving_m_per_s;
        let condition = checks.stuck_force;
        let (code, resting) = (force_n.to_bits(), 0.0_f64.to_bits());
        let is_stuck = self.stuck_force.take(condition.cycles, code, resting, moves);
        let cycles = if is_stuck { condition.cycles } else { 0 };
        self.found.on_condition(condition, cycles, Signal::StuckForce);
        if let Some(displacement_m) = measured.displacement_m {
            self.judge_work(checks, displacement_m, force_n);
        }
        let passes = |rule: &Rule, value: f64| {
            value.abs() <= rule.limit || (value.is_finite() && rule.action <= Action::Hold)
        };
        if !passes(&checks.force, force_n) || !passes(&checks.force_rate, change_n) {
            // One such value is held over, as one that is lost; the next is compared with the last
            // that was believed.
            self.is_new = false;
            return ForceInput::Invalid;
        }
        if !self.found.holds() {
            self.last_force_n = Some(force_n);
        }
        ForceInput::Fresh(force_n)
    }

    fn judge_work(&mut self, checks: &Checks, displacement_m: f64, force_n: f64) {
        self.work.take(&checks.work, displacement_m, force_n, checks.cycle_s);
        let found = [
            (self.work.wrong_sign(), checks.wrong_sign),
            (self.work.wrong_phase(), checks.wrong_phase),
        ];
        for (given, action) in found {
            let Some(GivenBack { work_j: value, limit_j: limit }) = given else { continue };
            self.found.act(Cause { signal: Signal::Work, value, limit, action });
        }
    }

    /// The command that a measurement of an age answers.
    fn answered(&self, age: u8) -> Command {
        let place = (self.next + REMEMBERED - usize::from(age) % REMEMBERED) % REMEMBERED;
        self.sent.get(place).copied().unwrap_or_default()
    }
}
