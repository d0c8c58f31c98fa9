//! What is believed of a rig: each check with its limit, its debounce and its action.
//!
//! ```toml
//! [plausibility]                             # all of it may be left out; these are the defaults
//! force = { limit_ratio = 1.5, after_cycles = 2, action = "stop" }  # or limit_n
//! force_rate = { limit_n_per_cycle = 25e3, after_cycles = 2, action = "stop" }
//! displacement = { limit_m = 0.102, after_cycles = 2, action = "stop" }  # stroke_m + 2 mm
//! velocity = { limit_m_per_s = 0.8, after_cycles = 1, action = "power off" }
//! acceleration = { limit_m_per_s2 = 600.0, after_cycles = 3, action = "power off" }
//! tracking = { limit_m = 5e-3, after_cycles = 3, action = "power off" }
//! temperature = { limit_degc = 100.0, after_cycles = 100, action = "ramp out" }
//! residual = { limit_share = 0.333, after_cycles = 1, action = "log" }  # or limit_n
//! age = { limit_cycles = 5.0, after_cycles = 5, action = "stop" }
//! invalid_force = { after_cycles = 5, action = "stop" }
//! invalid_displacement = { after_cycles = 5, action = "power off" }
//! stuck_force = { after_cycles = 20, action = "ramp out" }
//! stuck_displacement = { after_cycles = 20, action = "power off" }
//! work = { limit_share = 0.333, action = "ramp out" }
//! work_of_ten = { limit_share = 0.1, action = "ramp out" }
//! lost_in_a_row = { after_cycles = 5, action = "stop" }
//! lost_of_50 = { limit_cycles = 8.0, action = "ramp out" }
//! lost_of_250 = { limit_cycles = 18.0, action = "ramp out" }
//! compensation = { action = "ramp out" }      # an adaptive compensator has run away
//! lost_rows = { after_cycles = 1000, action = "ramp out" }  # or log: the run goes on
//! ```
//! A signal is beyond its limit in `after_cycles` cycles in a row before its action follows. The
//! actions are
//!
//! | action | what happens |
//! | --- | --- |
//! | `log` | it is counted in `summary.json`; the value is believed, the run goes on |
//! | `hold` | the last believed force is held while the signal is beyond its limit |
//! | `ramp out` | the run ends in order |
//! | `stop` | SAFE: the ram is brought to rest and holds |
//! | `power off` | the same, and the rig is asked to drop its pressure |
//!
//! The force limit is a multiple of the largest force that the slot's model reaches on this track,
//! or a number of newtons. The residual is the rms over a second of the measured force less that of
//! the slot's model; its limit is a share of the force limit, or a number of newtons. Shares of the
//! work are those of the most work that force and stroke could do.
//!
//! The table is the host's alone. Of its numbers only the force limit is agreed with the rig when
//! it is armed: a rig has to keep it, and cannot know the others.

mod check;

pub use check::{ActionFile, CheckFile};

use crate::cycle::Rate;
use crate::error::ScenarioError;
use crate::source::Source;
use check::{Check, Limit, Signal};
use firmware_core::supervision::{
    Action, BEYOND_STROKE_M, Checks, Condition, LONG_CYCLES, LossLimits, OLDEST_CYCLES,
    RESIDUAL_SHARE, Rule, SHORT_CYCLES, WorkLimits,
};
use serde::{Deserialize, Serialize};

/// The table as it stands in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PlausibilityFile {
    /// Measured force.
    pub force: Option<CheckFile>,
    /// Change of the measured force in a cycle.
    pub force_rate: Option<CheckFile>,
    /// Measured displacement from mid-stroke.
    pub displacement: Option<CheckFile>,
    /// Speed of the measured displacement.
    pub velocity: Option<CheckFile>,
    /// Acceleration of the measured displacement.
    pub acceleration: Option<CheckFile>,
    /// Measured displacement less the command that it answers.
    pub tracking: Option<CheckFile>,
    /// Temperature of the damper.
    pub temperature: Option<CheckFile>,
    /// Rms of the measured force less that of the slot's model.
    pub residual: Option<CheckFile>,
    /// Age of a measurement.
    pub age: Option<CheckFile>,
    /// A force that is missing, or that the rig says is invalid.
    pub invalid_force: Option<CheckFile>,
    /// A displacement that is missing.
    pub invalid_displacement: Option<CheckFile>,
    /// A force that repeats one code while the ram moves.
    pub stuck_force: Option<CheckFile>,
    /// The same of the displacement.
    pub stuck_displacement: Option<CheckFile>,
    /// Work that a cycle of the motion gives back.
    pub work: Option<CheckFile>,
    /// Work that ten cycles of the motion give back.
    pub work_of_ten: Option<CheckFile>,
    /// Measurements, or commands, lost in a row.
    pub lost_in_a_row: Option<CheckFile>,
    /// The same, of 50.
    pub lost_of_50: Option<CheckFile>,
    /// The same, of 250.
    pub lost_of_250: Option<CheckFile>,
    /// An adaptive compensator whose estimate has run away.
    pub compensation: Option<CheckFile>,
    /// Rows of the record, lost in a row.
    pub lost_rows: Option<CheckFile>,
}

/// What is believed of the rigs of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausibility {
    /// The checks, whose limits of force and residual are those of each rig.
    checks: Checks,
    /// The largest believed force.
    pub force: ForceLimit,
    residual: ResidualLimit,
    /// Cycles in a row that the record may lose before the run ends in order; none: it goes on.
    pub lost_rows: Option<u32>,
}

/// The largest believed force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ForceLimit {
    /// So many times the largest force of the slot's model.
    Ratio(f64),
    /// A force (N).
    Force(f64),
}

/// The largest rms of the residual.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ResidualLimit {
    /// A share of the largest believed force.
    Share(f64),
    /// A force (N).
    Force(f64),
}

/// Room above the largest force of the slot's model.
const FORCE_RATIO: f64 = 1.5;

const FORCES_N: (f64, f64) = (100.0, 1e6);
const LONGEST_CYCLES: Option<u32> = Some(10_000);

/// Actions because of a signal that says nothing of a single force.
const WITHOUT_HOLD: &[ActionFile] =
    &[ActionFile::Log, ActionFile::RampOut, ActionFile::Stop, ActionFile::PowerOff];

/// A signal with one limit, a debounce, and a force that can be held.
const fn signal(name: &'static str, limits: &'static [(Limit, f64, f64)]) -> Signal {
    Signal { name, limits, most_cycles: LONGEST_CYCLES, actions: &ActionFile::ALL }
}

const FORCE: Signal =
    signal("force", &[(Limit::Ratio, 1.0, 100.0), (Limit::Force, FORCES_N.0, FORCES_N.1)]);
const FORCE_RATE: Signal = signal("force_rate", &[(Limit::ForcePerCycle, FORCES_N.0, FORCES_N.1)]);
const DISPLACEMENT: Signal = signal("displacement", &[(Limit::Displacement, 1e-3, 1.0)]);
const VELOCITY: Signal = signal("velocity", &[(Limit::Speed, 1e-3, 10.0)]);
const ACCELERATION: Signal = signal("acceleration", &[(Limit::Acceleration, 1.0, 1e6)]);
const TRACKING: Signal = signal("tracking", &[(Limit::Displacement, 1e-6, 1.0)]);
const TEMPERATURE: Signal =
    Signal { actions: WITHOUT_HOLD, ..signal("temperature", &[(Limit::Temperature, 0.0, 300.0)]) };
const RESIDUAL: Signal = Signal {
    actions: WITHOUT_HOLD,
    ..signal("residual", &[(Limit::Share, 1e-3, 100.0), (Limit::Force, 1.0, FORCES_N.1)])
};
const AGE: Signal = signal("age", &[(Limit::Cycles, 1.0, OLDEST_CYCLES as f64)]);
const INVALID_FORCE: Signal = signal("invalid_force", &[]);
const INVALID_DISPLACEMENT: Signal = signal("invalid_displacement", &[]);
const STUCK_FORCE: Signal = signal("stuck_force", &[]);
const STUCK_DISPLACEMENT: Signal = signal("stuck_displacement", &[]);
const WORK: Signal = Signal {
    most_cycles: None,
    actions: WITHOUT_HOLD,
    ..signal("work", &[(Limit::Share, 1e-3, 1.0)])
};
const WORK_OF_TEN: Signal = Signal { name: "work_of_ten", ..WORK };
/// A receiver that has lost more has lost the step of the counters.
const LOST_IN_A_ROW: Signal =
    Signal { most_cycles: Some(OLDEST_CYCLES as u32), ..signal("lost_in_a_row", &[]) };
const LOST_OF_50: Signal = Signal {
    most_cycles: None,
    ..signal("lost_of_50", &[(Limit::Cycles, 0.0, SHORT_CYCLES as f64)])
};
const LOST_OF_250: Signal = Signal {
    most_cycles: None,
    ..signal("lost_of_250", &[(Limit::Cycles, 0.0, LONG_CYCLES as f64)])
};

/// It has fallen back to its start values by itself: nothing has to stop at once.
const COMPENSATION: Signal =
    Signal { most_cycles: None, actions: WITHOUT_HOLD, ..signal("compensation", &[]) };

/// A disk that is full moves no ram: nothing has to stop at once.
const LOST_ROWS: Signal = Signal {
    most_cycles: Some(100_000_000),
    actions: &[ActionFile::Log, ActionFile::RampOut],
    ..signal("lost_rows", &[])
};
/// Rows in a row that the record may lose: those of a second.
fn usual_lost_rows(rate: Rate) -> Condition {
    Condition { cycles: rate.hz(), action: Action::RampOut }
}

/// The checks where a file says nothing, for commands up to a stroke (m) at a rate.
fn usual(stroke_m: f64, rate: Rate) -> Checks {
    // Range of the counters and largest force are those of each rig.
    let usual = Checks::usual(15, rate.cycle_s(), f64::INFINITY);
    // To the micrometre: a sum of decimal numbers is none.
    let limit = libm::round((stroke_m + BEYOND_STROKE_M) * 1e6) / 1e6;
    let displacement = Rule { limit, ..usual.displacement };
    Checks { displacement, ..usual }
}

impl PlausibilityFile {
    /// The same with every default written out, for commands up to a stroke (m).
    pub(crate) fn with_defaults(&self, stroke_m: f64, rate: Rate) -> Self {
        let checks = usual(stroke_m, rate);
        let of_rule = |signal: &Signal, given: &Option<CheckFile>, rule: Rule, limit| {
            let cycles = Some(rule.debounce_cycles);
            Some(signal.with_defaults(given.as_ref(), Some(limit), cycles, rule.action))
        };
        let rule = |signal: &_, given: &_, rule: Rule| of_rule(signal, given, rule, rule.limit);
        let condition = |signal: &Signal, given: &Option<CheckFile>, condition: Condition| {
            let cycles = Some(condition.cycles);
            Some(signal.with_defaults(given.as_ref(), None, cycles, condition.action))
        };
        let (lost, work) = (checks.lost, checks.work);
        let share = |signal: &Signal, given: &Option<CheckFile>, limit, action| {
            Some(signal.with_defaults(given.as_ref(), Some(limit), None, action))
        };
        let row = Condition { cycles: lost.in_a_row, action: checks.lost_in_a_row };
        let (short, long) = (f64::from(lost.in_short), f64::from(lost.in_long));
        Self {
            force: of_rule(&FORCE, &self.force, checks.force, FORCE_RATIO),
            force_rate: rule(&FORCE_RATE, &self.force_rate, checks.force_rate),
            displacement: rule(&DISPLACEMENT, &self.displacement, checks.displacement),
            velocity: rule(&VELOCITY, &self.velocity, checks.velocity),
            acceleration: rule(&ACCELERATION, &self.acceleration, checks.acceleration),
            tracking: rule(&TRACKING, &self.tracking, checks.tracking),
            temperature: rule(&TEMPERATURE, &self.temperature, checks.temperature),
            residual: of_rule(&RESIDUAL, &self.residual, checks.residual, RESIDUAL_SHARE),
            age: rule(&AGE, &self.age, checks.age),
            invalid_force: condition(&INVALID_FORCE, &self.invalid_force, checks.invalid_force),
            invalid_displacement: condition(
                &INVALID_DISPLACEMENT,
                &self.invalid_displacement,
                checks.invalid_displacement,
            ),
            stuck_force: condition(&STUCK_FORCE, &self.stuck_force, checks.stuck_force),
            stuck_displacement: condition(
                &STUCK_DISPLACEMENT,
                &self.stuck_displacement,
                checks.stuck_displacement,
            ),
            work: share(&WORK, &self.work, work.one_cycle, checks.wrong_sign),
            work_of_ten: share(
                &WORK_OF_TEN,
                &self.work_of_ten,
                work.ten_cycles,
                checks.wrong_phase,
            ),
            lost_in_a_row: condition(&LOST_IN_A_ROW, &self.lost_in_a_row, row),
            lost_of_50: share(&LOST_OF_50, &self.lost_of_50, short, checks.lost_of_50),
            lost_of_250: share(&LOST_OF_250, &self.lost_of_250, long, checks.lost_of_250),
            compensation: Some(COMPENSATION.with_defaults(
                self.compensation.as_ref(),
                None,
                None,
                checks.compensation,
            )),
            lost_rows: condition(&LOST_ROWS, &self.lost_rows, usual_lost_rows(rate)),
        }
    }

    /// Builds it, for commands up to a stroke (m).
    ///
    /// # Errors
    /// The first check that does not fit, with file and line.
    pub(crate) fn build(
        &self,
        source: &Source,
        stroke_m: f64,
        rate: Rate,
    ) -> Result<Plausibility, ScenarioError> {
        let usual = usual(stroke_m, rate);
        let force = check(source, &FORCE, self.force.as_ref());
        let residual = check(source, &RESIDUAL, self.residual.as_ref());
        let lost_in_a_row = check(source, &LOST_IN_A_ROW, self.lost_in_a_row.as_ref())
            .condition(Condition { cycles: usual.lost.in_a_row, action: usual.lost_in_a_row })?;
        let share = |signal, given: &Option<CheckFile>, limit, action| {
            let check = check(source, signal, given.as_ref());
            check.cycles_or(1)?;
            Ok::<_, ScenarioError>((check.limit_or(limit)?, check.action_or(action)?))
        };
        let (work, lost) = (usual.work, usual.lost);
        let (one_cycle, wrong_sign) = share(&WORK, &self.work, work.one_cycle, usual.wrong_sign)?;
        let (ten_cycles, wrong_phase) =
            share(&WORK_OF_TEN, &self.work_of_ten, work.ten_cycles, usual.wrong_phase)?;
        let (in_short, lost_of_50) =
            share(&LOST_OF_50, &self.lost_of_50, f64::from(lost.in_short), usual.lost_of_50)?;
        let (in_long, lost_of_250) =
            share(&LOST_OF_250, &self.lost_of_250, f64::from(lost.in_long), usual.lost_of_250)?;
        let rule = |signal, given: &Option<CheckFile>, usual| {
            check(source, signal, given.as_ref()).rule(usual)
        };
        let condition = |signal, given: &Option<CheckFile>, usual| {
            check(source, signal, given.as_ref()).condition(usual)
        };
        let without_limit = |check: &Check<'_>, usual: Rule| {
            Ok::<_, ScenarioError>(Rule {
                limit: usual.limit,
                debounce_cycles: check.cycles_or(usual.debounce_cycles)?,
                action: check.action_or(usual.action)?,
            })
        };
        let lost_rows = condition(&LOST_ROWS, &self.lost_rows, usual_lost_rows(rate))?;
        let run_away = check(source, &COMPENSATION, self.compensation.as_ref());
        run_away.limit()?;
        run_away.cycles_or(1)?;
        let checks = Checks {
            force: without_limit(&force, usual.force)?,
            force_rate: rule(&FORCE_RATE, &self.force_rate, usual.force_rate)?,
            displacement: rule(&DISPLACEMENT, &self.displacement, usual.displacement)?,
            velocity: rule(&VELOCITY, &self.velocity, usual.velocity)?,
            acceleration: rule(&ACCELERATION, &self.acceleration, usual.acceleration)?,
            tracking: rule(&TRACKING, &self.tracking, usual.tracking)?,
            temperature: rule(&TEMPERATURE, &self.temperature, usual.temperature)?,
            residual: without_limit(&residual, usual.residual)?,
            age: rule(&AGE, &self.age, usual.age)?,
            invalid_force: condition(&INVALID_FORCE, &self.invalid_force, usual.invalid_force)?,
            invalid_displacement: condition(
                &INVALID_DISPLACEMENT,
                &self.invalid_displacement,
                usual.invalid_displacement,
            )?,
            stuck_force: condition(&STUCK_FORCE, &self.stuck_force, usual.stuck_force)?,
            stuck_displacement: condition(
                &STUCK_DISPLACEMENT,
                &self.stuck_displacement,
                usual.stuck_displacement,
            )?,
            work: WorkLimits { one_cycle, ten_cycles },
            wrong_sign,
            wrong_phase,
            lost: LossLimits {
                in_a_row: lost_in_a_row.cycles,
                in_short: in_short as u32,
                in_long: in_long as u32,
            },
            lost_in_a_row: lost_in_a_row.action,
            lost_of_50,
            lost_of_250,
            compensation: run_away.action_or(usual.compensation)?,
            ..usual
        };
        Ok(Plausibility {
            checks,
            force: match force.limit()? {
                Some((Limit::Force, force_n)) => ForceLimit::Force(force_n),
                Some((_, ratio)) => ForceLimit::Ratio(ratio),
                None => ForceLimit::Ratio(FORCE_RATIO),
            },
            residual: match residual.limit()? {
                Some((Limit::Force, force_n)) => ResidualLimit::Force(force_n),
                Some((_, share)) => ResidualLimit::Share(share),
                None => ResidualLimit::Share(RESIDUAL_SHARE),
            },
            lost_rows: (lost_rows.action != Action::Log).then_some(lost_rows.cycles),
        })
    }
}

fn check<'a>(source: &'a Source, signal: &'a Signal, given: Option<&'a CheckFile>) -> Check<'a> {
    Check { signal, given, source }
}

impl Plausibility {
    /// The checks of a rig whose counters have this range, and whose force is believed up to
    /// `force_n`.
    pub fn checks(&self, counter_modulus: u8, force_n: f64) -> Checks {
        let residual_n = match self.residual {
            ResidualLimit::Share(share) => share * force_n,
            ResidualLimit::Force(residual_n) => residual_n,
        };
        Checks {
            counter_modulus,
            force: Rule { limit: force_n, ..self.checks.force },
            residual: Rule { limit: residual_n, ..self.checks.residual },
            ..self.checks
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn built(text: &str) -> Result<Plausibility, ScenarioError> {
        let source = Source::from_text(Path::new("table.toml"), text);
        source.parse::<PlausibilityFile>()?.build(&source, 0.1, Rate::Usual)
    }

    #[test]
    fn an_empty_table_has_the_usual_checks() {
        let table = built("").unwrap();
        assert_eq!(table.force, ForceLimit::Ratio(1.5));
        assert_eq!(table.checks(15, 40e3), Checks::usual(15, 1e-3, 40e3));
    }

    #[test]
    fn the_defaults_written_out_build_the_same_and_name_every_signal() {
        let text =
            toml::to_string(&PlausibilityFile::default().with_defaults(0.1, Rate::Usual)).unwrap();
        assert_eq!(built(&text).unwrap(), built("").unwrap());
        assert_eq!(text.matches("action = ").count(), 20, "{text}");
        assert_eq!(text.matches("after_cycles = ").count(), 15, "{text}");
    }

    #[test]
    fn a_check_may_change_its_limit_its_debounce_or_its_action_alone() {
        let table = built(
            "velocity = { limit_m_per_s = 0.5 }\ntracking = { after_cycles = 7 }\n\
             work = { action = \"log\" }\nforce = { limit_n = 12e3, action = \"hold\" }\n\
             residual = { limit_n = 900.0, action = \"ramp out\" }\n\
             lost_in_a_row = { after_cycles = 3 }\nlost_of_50 = { limit_cycles = 4 }\n\
             lost_rows = { action = \"log\" }",
        )
        .unwrap();
        assert_eq!((table.lost_rows, built("").unwrap().lost_rows), (None, Some(1000)));
        assert_eq!(table.force, ForceLimit::Force(12e3));
        let (checks, usual) = (table.checks(255, 12e3), Checks::usual(255, 1e-3, 12e3));
        let expected = Checks {
            force: Rule { action: Action::Hold, ..usual.force },
            velocity: Rule { limit: 0.5, ..usual.velocity },
            tracking: Rule { debounce_cycles: 7, ..usual.tracking },
            residual: Rule { limit: 900.0, debounce_cycles: 1, action: Action::RampOut },
            wrong_sign: Action::Log,
            lost: LossLimits { in_a_row: 3, in_short: 4, ..usual.lost },
            ..usual
        };
        assert_eq!(checks, expected);
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_line() {
        for (text, expected) in [
            (
                "\nvelocity = { limit_m = 0.5 }",
                "table.toml:2: velocity: found limit_m, expected limit_m_per_s, after_cycles, action",
            ),
            (
                "force = { limit_n = 1e4, limit_ratio = 2.0 }",
                "table.toml:1: force: expected one of limit_ratio, limit_n, after_cycles, action",
            ),
            ("age = { limit_cycles = 6 }", "table.toml:1: age.limit_cycles = 6, expected 1 to 5"),
            (
                "tracking = { after_cycles = 1.5 }",
                "table.toml:1: tracking.after_cycles = 1.5, expected a whole number from 1 to 10000",
            ),
            (
                "lost_in_a_row = { after_cycles = 6 }",
                "table.toml:1: lost_in_a_row.after_cycles = 6, expected a whole number from 1 to 5",
            ),
            (
                "work = { after_cycles = 2 }",
                "table.toml:1: work: found after_cycles, expected limit_share, action",
            ),
            (
                "work = { action = \"hold\" }",
                "table.toml: [plausibility] work: found action = \"hold\", expected one of \
                 log, ramp out, stop, power off",
            ),
            (
                "lost_rows = { action = \"stop\" }",
                "table.toml: [plausibility] lost_rows: found action = \"stop\", expected one of \
                 log, ramp out",
            ),
        ] {
            assert_eq!(built(text).unwrap_err().to_string(), expected);
        }
        for (text, named) in [
            ("force = { action = \"explode\" }", "ramp out"),
            ("forse = { limit_n = 1e4 }", "force_rate"),
        ] {
            let said = built(text).unwrap_err().to_string();
            assert!(said.starts_with("table.toml:1: ") && said.contains(named), "{said}");
        }
    }
}
