//! What is believed of a rig, cycle by cycle.
//!
//! ```text
//! frame -> age and step of its counters -> sound? -> limits -> force for the vehicle
//!              lost, old: the last force holds        a cause ends the run
//! ```
//!
//! [`Belief::take`] judges what arrived in a cycle. It gives the force to use, and the first cause
//! that asks for an end. Every check counts cycles; none reads a clock.
//!
//! Limits: a gain error of 10 % or an offset within the limits is a possible damper, and no check
//! of this kind can find it while the bench runs.

use super::age::{Age, AgeJudge};
use super::cause::{Cause, Signal};
use super::loss::{Loss, LossVerdict, MOST_IN_A_ROW, MOST_IN_LONG, MOST_IN_SHORT};
use super::rule::{Action, Rule, RuleState};
use super::stuck::{FEWEST_CYCLES, Stuck};
use super::work::{Work, WorkVerdict};
use crate::guard::{Command, ForceInput};

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

/// Parameters of the checks of one rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checks {
    /// Range of the counters.
    pub counter_modulus: u8,
    /// Length of a cycle, s.
    pub cycle_s: f64,
    /// Measured force, N.
    pub force: Rule,
    /// Change of the measured force from cycle to cycle, N.
    pub force_rate: Rule,
    /// Speed of the measured displacement, m/s.
    pub velocity: Rule,
    /// Measured displacement less the command that it answers, m.
    pub tracking: Rule,
    /// Speed of the command from which live sensors change, m/s.
    pub moving_m_per_s: f64,
    /// What a frozen force sensor asks for.
    pub stuck_force: Action,
    /// What a frozen displacement sensor asks for.
    pub stuck_displacement: Action,
    /// What work that is given back asks for.
    pub work: Action,
}

impl Checks {
    /// The checks of a rig with counters of this range and cycles of this length.
    ///
    /// The force may reach `force_n`. It may change by 25 kN in a cycle: at the end of a clearance
    /// of 8 mm an attachment of 12.5 MN/m is met at 0.2 m/s, which is 2.5 kN per millisecond, and a
    /// spike of a sensor is larger than ten times that. The displacement may move at 0.8 m/s, twice
    /// what a hunting locomotive asks for. It may be 5 mm off its command.
    pub const fn usual(counter_modulus: u8, cycle_s: f64, force_n: f64) -> Self {
        Self {
            counter_modulus,
            cycle_s,
            force: Rule { limit: force_n, debounce_cycles: 2, action: Action::Stop },
            force_rate: Rule { limit: 25e3, debounce_cycles: 2, action: Action::Stop },
            velocity: Rule { limit: 0.8, debounce_cycles: 1, action: Action::PowerOff },
            tracking: Rule { limit: 5e-3, debounce_cycles: 3, action: Action::PowerOff },
            moving_m_per_s: 1e-3,
            stuck_force: Action::RampOut,
            stuck_displacement: Action::PowerOff,
            work: Action::RampOut,
        }
    }
}

/// Commands that are remembered: the oldest that a believed measurement can answer, and itself.
const REMEMBERED: usize = 8;

/// What the checks of one rig remember.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Belief {
    age: AgeJudge,
    begun: bool,
    /// Whether this cycle has a new measurement.
    is_new: bool,
    last_echo: Option<u8>,
    measurements: Loss,
    commands: Loss,
    invalid_cycles: u32,
    old_cycles: u32,
    blind_cycles: u32,
    force: RuleState,
    force_rate: RuleState,
    velocity: RuleState,
    tracking: RuleState,
    stuck_force: Stuck,
    stuck_displacement: Stuck,
    work: Work,
    last_force_n: Option<f64>,
    last_displacement_m: Option<f64>,
    since_displacement: u32,
    sent: [Command; REMEMBERED],
    next: usize,
    cause: Option<Cause>,
    /// The strongest action that any cause has asked for.
    action: Option<Action>,
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
        let input = match (arrival, sent) {
            (Arrival::Frame(measured), Some(sent)) => self.judge(checks, &measured, sent),
            // Before the first command there is nothing to answer.
            (Arrival::Frame(_) | Arrival::Nothing, _) => ForceInput::Missing,
            (Arrival::Damaged, _) => ForceInput::Invalid,
        };
        let is_new = core::mem::take(&mut self.is_new);
        self.begun |= matches!(input, ForceInput::Fresh(_));
        if self.begun {
            self.count_losses(is_new);
        }
        debug_assert!(
            self.cause.is_none_or(|cause| cause.action != Action::Log),
            "what is only logged ends nothing"
        );
        input
    }

    /// Lets cycles pass that the host has missed, and in which its rig went on.
    pub fn skip(&mut self, cycles: u32) {
        self.age.skip(cycles);
        self.since_displacement = self.since_displacement.saturating_add(cycles);
    }

    /// Fills the memory of commands with the place where the ram stands when it is coupled.
    pub fn begin(&mut self, command: Command) {
        self.sent = [command; REMEMBERED];
    }

    /// The strongest action that has been asked for: the first cause may ask to ramp out, and a
    /// later one to stop.
    pub fn action(&self) -> Option<Action> {
        self.action
    }

    /// The first cause that asks for an end.
    pub fn cause(&self) -> Option<Cause> {
        self.cause
    }

    /// Age of the last believed measurement, cycles.
    pub fn age_cycles(&self) -> Option<u8> {
        self.age.age_cycles()
    }

    /// Losses of measurements and of commands.
    pub fn losses(&self) -> (&Loss, &Loss) {
        (&self.measurements, &self.commands)
    }

    fn judge(&mut self, checks: &Checks, measured: &Measured, sent: u8) -> ForceInput {
        if !measured.runs {
            return ForceInput::Invalid;
        }
        let age = match self.age.take(measured.counter, measured.echo, sent, checks.counter_modulus)
        {
            Age::New(age) => age,
            Age::Old => {
                self.old_cycles = self.old_cycles.saturating_add(1);
                self.fail_if(
                    self.old_cycles >= MOST_IN_A_ROW,
                    Signal::OldMeasurements,
                    (f64::from(self.old_cycles), f64::from(MOST_IN_A_ROW)),
                    Action::Stop,
                );
                return ForceInput::Missing;
            }
            Age::Unknown => return ForceInput::Missing,
        };
        (self.is_new, self.old_cycles) = (true, 0);
        self.note_echo(measured.echo);
        self.judge_displacement(checks, measured, age);
        self.judge_force(checks, measured, age)
    }

    /// A measurement that echoes the same command as the last one tells of a lost command.
    fn note_echo(&mut self, echo: Option<u8>) {
        let verdict = self.commands.take(self.begun && echo == self.last_echo);
        self.last_echo = echo;
        self.on_loss(verdict, Signal::LostCommands);
    }

    fn count_losses(&mut self, came: bool) {
        let verdict = self.measurements.take(!came);
        self.on_loss(verdict, Signal::LostMeasurements);
    }

    fn on_loss(&mut self, verdict: LossVerdict, signal: Signal) {
        let loss = if signal == Signal::LostCommands { &self.commands } else { &self.measurements };
        let (short, long) = loss.in_windows();
        let (count, most, action) = match verdict {
            LossVerdict::Holds => return,
            LossVerdict::Stop => (loss.in_a_row(), MOST_IN_A_ROW, Action::Stop),
            LossVerdict::RampOut if short > MOST_IN_SHORT => {
                (short, MOST_IN_SHORT, Action::RampOut)
            }
            LossVerdict::RampOut => (long, MOST_IN_LONG, Action::RampOut),
        };
        self.fail_if(true, signal, (f64::from(count), f64::from(most)), action);
    }

    fn judge_displacement(&mut self, checks: &Checks, measured: &Measured, age: u8) {
        let Some(displacement_m) = measured.displacement_m else {
            self.blind_cycles = self.blind_cycles.saturating_add(1);
            let cycles = (f64::from(self.blind_cycles), f64::from(MOST_IN_A_ROW));
            let is_blind = self.blind_cycles >= MOST_IN_A_ROW;
            self.fail_if(is_blind, Signal::InvalidDisplacement, cycles, Action::PowerOff);
            return;
        };
        self.blind_cycles = 0;
        let answered = self.answered(age);
        if let Some(last_m) = self.last_displacement_m.replace(displacement_m) {
            let time_s = f64::from(self.since_displacement.max(1)) * checks.cycle_s;
            let speed = (displacement_m - last_m) / time_s;
            let action = checks.velocity.take(&mut self.velocity, speed);
            self.on_rule(action, Signal::Velocity, speed, checks.velocity.limit);
        }
        self.since_displacement = 0;
        let error_m = displacement_m - answered.displacement_m;
        let action = checks.tracking.take(&mut self.tracking, error_m);
        self.on_rule(action, Signal::Tracking, error_m, checks.tracking.limit);
        let moves = answered.velocity_m_per_s.abs() > checks.moving_m_per_s;
        let is_stuck =
            self.stuck_displacement.take(displacement_m.to_bits(), f64::NAN.to_bits(), moves);
        let cycles = f64::from(FEWEST_CYCLES);
        self.fail_if(
            is_stuck,
            Signal::StuckDisplacement,
            (cycles, cycles),
            checks.stuck_displacement,
        );
    }

    fn judge_force(&mut self, checks: &Checks, measured: &Measured, age: u8) -> ForceInput {
        let Some(force_n) = measured.force_n.filter(|_| measured.is_valid) else {
            self.invalid_cycles = self.invalid_cycles.saturating_add(1);
            let cycles = (f64::from(self.invalid_cycles), f64::from(MOST_IN_A_ROW));
            let is_dead = self.invalid_cycles >= MOST_IN_A_ROW;
            self.fail_if(is_dead, Signal::InvalidForce, cycles, Action::Stop);
            return ForceInput::Invalid;
        };
        self.invalid_cycles = 0;
        let action = checks.force.take(&mut self.force, force_n);
        self.on_rule(action, Signal::Force, force_n, checks.force.limit);
        let change_n = self.last_force_n.map_or(0.0, |last_n| force_n - last_n);
        let action = checks.force_rate.take(&mut self.force_rate, change_n);
        self.on_rule(action, Signal::ForceRate, change_n, checks.force_rate.limit);
        let moves = self.answered(age).velocity_m_per_s.abs() > checks.moving_m_per_s;
        let is_stuck = self.stuck_force.take(force_n.to_bits(), 0.0_f64.to_bits(), moves);
        let cycles = f64::from(FEWEST_CYCLES);
        self.fail_if(is_stuck, Signal::StuckForce, (cycles, cycles), checks.stuck_force);
        if let Some(displacement_m) = measured.displacement_m {
            let verdict = self.work.take(displacement_m, force_n);
            let gives_back = verdict != WorkVerdict::Passive;
            let work = (self.work.last_cycle_j(), 0.0);
            self.fail_if(gives_back, Signal::Work, work, checks.work);
        }
        let is_within =
            force_n.abs() <= checks.force.limit && change_n.abs() <= checks.force_rate.limit;
        if !is_within {
            // One such value is held over, as one that is lost; the next is compared with the last
            // that was believed.
            self.is_new = false;
            return ForceInput::Invalid;
        }
        self.last_force_n = Some(force_n);
        ForceInput::Fresh(force_n)
    }

    /// The command that a measurement of an age answers.
    fn answered(&self, age: u8) -> Command {
        let place = (self.next + REMEMBERED - usize::from(age) % REMEMBERED) % REMEMBERED;
        self.sent.get(place).copied().unwrap_or_default()
    }

    fn on_rule(&mut self, action: Option<Action>, signal: Signal, value: f64, limit: f64) {
        if let Some(action) = action {
            self.fail_if(action > Action::Hold, signal, (value, limit), action);
        }
    }

    fn fail_if(&mut self, is_so: bool, signal: Signal, at: (f64, f64), action: Action) {
        if is_so && action > Action::Hold {
            let (value, limit) = at;
            self.cause = self.cause.or(Some(Cause { signal, value, limit, action }));
            self.action = self.action.max(Some(action));
        }
    }
}
