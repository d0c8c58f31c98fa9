//! The problem, loaded: vehicles, rig, all-model runs; and how a candidate is scored.

use super::answer::{Answer, Below, InRegimes, Modelled, RESULT_OF, Score, Size, Spread};
use super::candidate::Candidate;
use super::case::{Case, Reference};
use super::compensators::Ours;
use super::condition::Condition;
use super::data_sheet::DataSheet;
use super::errors::Errors;
use super::from_below::FromBelow;
use super::job::{Job, Outcome};
use super::perturbed;
use super::question::Question;
use super::regime::{REGIMES, Regime};
use super::{aims, open_loop};
use crate::critical_speed::Critical;
use crate::error::StudyError;
use crate::study::PROGRAM;
use files::Identity;
use firmware_core::command::Command;
use rayon::prelude::*;
use scenario::rig::RigSetup;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The compensator and the dead time (ms) with which a critical speed is approached from below.
const FROM_BELOW: (Ours, u16) = (Ours::Inverse, 5);
/// Share by which the damping is changed to either side for the sensitivity.
const DAMPING_CHANGE: f64 = 0.1;

/// The reference problem.
#[derive(Debug)]
pub struct Problem<'a> {
    scenario: PathBuf,
    cases: Vec<(Case<'a>, [Reference; 2])>,
}

/// A motion that a rig is wanted to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Motion {
    /// The state of the dampers.
    pub damper: Condition,
    /// The regime.
    pub regime: Regime,
}

impl Motion {
    /// Its name, such as `new-track`.
    pub fn name(self) -> String {
        format!("{}-{}", self.damper.name(), self.regime.name())
    }
}

impl<'a> Problem<'a> {
    /// Reads the scenario and runs the vehicle with all dampers modelled; work ends once the flag
    /// is set.
    ///
    /// # Errors
    /// A scenario that cannot be read or does not fit; work that is stopped.
    pub fn load(
        scenario: &Path,
        dampers: &[Condition],
        stop: &'a AtomicBool,
    ) -> Result<Self, StudyError> {
        let case = |condition: &Condition| Case::load(scenario, *condition, stop);
        let cases: Result<Vec<Case<'a>>, StudyError> = dampers.iter().map(case).collect();
        let referred = |case: Case<'a>| -> Result<_, StudyError> {
            let references = case.references()?;
            Ok((case, references))
        };
        let cases: Result<Vec<_>, StudyError> = cases?.into_par_iter().map(referred).collect();
        Ok(Self { scenario: scenario.to_owned(), cases: cases? })
    }

    /// The identity of a question about it.
    ///
    /// # Errors
    /// A question that cannot be serialised.
    pub fn identity<Q: serde::Serialize>(&self, question: &Q) -> Result<Identity, StudyError> {
        let mut inputs = BTreeMap::new();
        for (case, _) in &self.cases {
            inputs.extend(case.inputs.clone());
        }
        Identity::new(question, inputs, PROGRAM)
            .map_err(|why| StudyError::NotSerialised(why.to_string()))
    }

    /// How the nominal rig answers with each damper mounted.
    pub(super) fn sheets(&self) -> impl Iterator<Item = (Condition, &DataSheet)> {
        self.cases.iter().map(|(case, _)| (case.condition, &case.sheet))
    }

    /// The motions that a rig is wanted to follow.
    pub fn motions(&self) -> impl Iterator<Item = Motion> {
        let dampers = self.cases.iter().map(|(case, _)| case.condition);
        dampers.flat_map(|damper| REGIMES.map(|regime| Motion { damper, regime }))
    }

    /// The motion of the front left damper with all dampers modelled, cycle by cycle.
    pub fn wanted(&self, motion: Motion) -> &[Command] {
        let (_, reference) = self.of(motion);
        reference.recording.dampers.first().map_or(&[], |damper| &damper.wanted)
    }

    /// The nominal rig, without dead time.
    pub(super) fn rig(&self) -> Option<&RigSetup> {
        self.cases.first().map(|(case, _)| &case.rig)
    }

    fn of(&self, motion: Motion) -> (&Case<'a>, &Reference) {
        let found = self.cases.iter().find(|(case, _)| case.condition == motion.damper);
        debug_assert!(found.is_some(), "{motion:?} is not loaded");
        let (case, references) = found.unwrap_or(&self.cases[0]);
        (case, Self::regime(references, motion.regime))
    }

    fn regime(references: &[Reference; 2], regime: Regime) -> &Reference {
        let [track, hunting] = references;
        match regime {
            Regime::Track => track,
            Regime::Hunting => hunting,
        }
    }

    /// The errors of a command for a motion on the nominal rig with a dead time (ms), against the
    /// front left damper of the all-model run; none where nothing moves.
    pub fn open_loop(
        &self,
        motion: Motion,
        dead_time_ms: u16,
        command: &[Command],
    ) -> Option<Errors> {
        let (case, reference) = self.of(motion);
        let rig = RigSetup { delay_cycles: dead_time_ms, ..case.rig.clone() };
        let found = open_loop::commanded(&rig, motion.regime, self.wanted(motion), command);
        let hunting_hz = reference.observed.frequency_hz;
        let modelled = reference.recording.first().observed(hunting_hz)?;
        Some(Errors::of(&found.observed(hunting_hz)?, &modelled))
    }

    /// The command of a compensator of ours for a motion, and its errors.
    pub fn own_command(
        &self,
        motion: Motion,
        dead_time_ms: u16,
        ours: Ours,
    ) -> (Vec<Command>, Option<Errors>) {
        let (case, reference) = self.of(motion);
        let rig = RigSetup { delay_cycles: dead_time_ms, ..case.rig.clone() };
        let hunting_hz = reference.observed.frequency_hz;
        let late_s = 1e-3 * f64::from(dead_time_ms);
        let compensator = ours.compensator(&case.sheet, late_s, hunting_hz);
        let wanted = self.wanted(motion);
        let (found, command) = open_loop::compensated(&rig, motion.regime, wanted, &compensator);
        let modelled = reference.recording.first().observed(hunting_hz);
        let errors = found
            .observed(hunting_hz)
            .zip(modelled)
            .map(|(found, modelled)| Errors::of(&found, &modelled));
        (command, errors)
    }

    /// Scores candidates on all cores; `done` is called with the runs that are done and all.
    ///
    /// # Errors
    /// Work that is stopped.
    pub fn score(
        &self,
        question: &Question,
        candidates: &[Candidate],
        stop: &AtomicBool,
        done: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Answer, StudyError> {
        let jobs = Job::all(question, candidates);
        let count = AtomicUsize::new(0);
        let outcomes: Result<Vec<(Job, Outcome)>, StudyError> = jobs
            .par_iter()
            .map(|job| {
                if stop.load(Ordering::Relaxed) {
                    return Err(StudyError::Stopped);
                }
                let outcome = self.outcome(*job, question, candidates)?;
                done(count.fetch_add(1, Ordering::Relaxed) + 1, jobs.len());
                Ok((*job, outcome))
            })
            .collect();
        Ok(self.answer(question, candidates, &Found(outcomes?)))
    }

    fn outcome(
        &self,
        job: Job,
        question: &Question,
        candidates: &[Candidate],
    ) -> Result<Outcome, StudyError> {
        let (case, references) = &self.cases[job.case()];
        let hunting_hz = Self::regime(references, Regime::Hunting).observed.frequency_hz;
        let about = (&case.sheet, hunting_hz);
        Ok(match job {
            Job::Errors { candidate, dead_time_ms, rig, regime, .. } => {
                let rig = perturbed::rig(&case.rig, question.seed, rig);
                let rigs = candidates[candidate].rigs(&rig, dead_time_ms, about);
                let reference = Self::regime(references, regime);
                Outcome::Errors(case.errors(rigs, reference)?)
            }
            Job::Critical { candidate, dead_time_ms, .. } => {
                let rigs = candidates[candidate].rigs(&case.rig, dead_time_ms, about);
                Outcome::Critical(case.critical(Some(rigs))?)
            }
            Job::Modelled { .. } => Outcome::Critical(case.critical(None)?),
            Job::MoreDamping { .. } => {
                Outcome::Critical(case.critical_with_damping(1.0 + DAMPING_CHANGE)?)
            }
            Job::LessDamping { .. } => {
                Outcome::Critical(case.critical_with_damping(1.0 - DAMPING_CHANGE)?)
            }
            Job::FromBelow { on_rigs, climb, .. } => {
                let (ours, dead_time_ms) = FROM_BELOW;
                let rigs = Candidate::Ours(ours).rigs(&case.rig, dead_time_ms, about);
                let coupled = case.equipped.behind(rigs);
                let equipped = if on_rigs { &coupled } else { &case.equipped };
                Outcome::FromBelow(FromBelow::of(equipped, climb)?)
            }
        })
    }

    fn answer(&self, question: &Question, candidates: &[Candidate], found: &Found) -> Answer {
        let (mut dampers, mut scores, mut from_below) = (Vec::new(), Vec::new(), Vec::new());
        for (number, (case, references)) in self.cases.iter().enumerate() {
            let modelled = modelled(number, case, references, found);
            for (candidate, named) in candidates.iter().enumerate() {
                for dead_time_ms in &question.dead_times_ms {
                    let cell = (number, candidate, *dead_time_ms);
                    let rigs = question.rigs(case.condition);
                    let critical = found.critical(Job::critical(cell));
                    let kmh = |speed: Option<Critical>| speed.and_then(Critical::kmh);
                    scores.push(Score {
                        damper: case.condition,
                        compensator: named.name(),
                        dead_time_ms: *dead_time_ms,
                        nominal: in_regimes(|regime| found.errors(Job::errors(cell, 0, regime))),
                        critical,
                        critical_error_kmh: kmh(critical)
                            .zip(kmh(modelled.critical))
                            .map(|(own, other)| own - other),
                        perturbed: (rigs > 0 && named.compensates()).then(|| {
                            in_regimes(|regime| {
                                let of = |rig| found.errors(Job::errors(cell, rig, regime));
                                Spread::of(&(1..=rigs).map(of).collect::<Vec<_>>())
                            })
                        }),
                    });
                }
            }
            dampers.push(modelled);
            for (job, outcome) in &found.0 {
                let (Job::FromBelow { case: of, on_rigs, .. }, Outcome::FromBelow(below)) =
                    (job, outcome)
                else {
                    continue;
                };
                if *of == number {
                    let (ours, dead_time_ms) = FROM_BELOW;
                    from_below.push(Below {
                        damper: case.condition,
                        compensator: on_rigs.then(|| ours.name()),
                        dead_time_ms: on_rigs.then_some(dead_time_ms),
                        found: below.clone(),
                    });
                }
            }
        }
        let aims = aims::of(&scores);
        Answer {
            format: 1,
            result_of: RESULT_OF,
            scenario: self.scenario.display().to_string(),
            question: question.clone(),
            dampers,
            scores,
            from_below,
            aims,
        }
    }
}

/// What the jobs have found.
struct Found(Vec<(Job, Outcome)>);

impl Found {
    fn get(&self, job: Job) -> Option<&Outcome> {
        self.0.iter().find(|(one, _)| *one == job).map(|(_, outcome)| outcome)
    }

    fn errors(&self, job: Job) -> Option<Errors> {
        match self.get(job) {
            Some(Outcome::Errors(errors)) => *errors,
            _ => None,
        }
    }

    fn critical(&self, job: Job) -> Option<Critical> {
        match self.get(job) {
            Some(Outcome::Critical(critical)) => Some(*critical),
            _ => None,
        }
    }
}

fn in_regimes<T>(of: impl Fn(Regime) -> T) -> InRegimes<T> {
    InRegimes { track: of(Regime::Track), hunting: of(Regime::Hunting) }
}

fn modelled(
    number: usize,
    case: &Case<'_>,
    references: &[Reference; 2],
    found: &Found,
) -> Modelled {
    let size = |regime: Regime| {
        let observed = Problem::regime(references, regime).observed;
        let kmh = 3.6 * case.regime_m_per_s(regime);
        Size { kmh, work_j: observed.work_j, stroke_m: observed.stroke_m }
    };
    let kmh = |job: Job| found.critical(job).and_then(Critical::kmh);
    let more = kmh(Job::MoreDamping { case: number });
    let less = kmh(Job::LessDamping { case: number });
    let per_percent = |(more, less): (f64, f64)| (more - less) / (200.0 * DAMPING_CHANGE);
    Modelled {
        damper: case.condition,
        track: size(Regime::Track),
        hunting: size(Regime::Hunting),
        hunting_hz: Problem::regime(references, Regime::Hunting).observed.frequency_hz,
        data_sheet: case.sheet.clone(),
        critical: found.critical(Job::Modelled { case: number }),
        kmh_per_percent_of_damping: more.zip(less).map(per_percent),
    }
}
