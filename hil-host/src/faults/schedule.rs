//! Random faults, session after session, on rigs whose plants stay as they are.
//!
//! The cycles are divided into shards of a fixed size. Each has a rig and a seed of its own, so the
//! result is the same whatever the number of cores.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, in_memory, inject, nodes};
use super::table::ROWS;
use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::{End, NoAnswer, Session};
use crate::draw::Draw;
use can_protocol::Node;
use rayon::prelude::*;
use scenario::run::Run;
use std::sync::atomic::{AtomicBool, Ordering};

/// What became of random faults.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// Control cycles done.
    pub cycles: u64,
    /// Faults injected.
    pub faults: u64,
    /// Sessions that went on.
    pub went_on: u64,
    /// Sessions that were ramped out.
    pub ramped_out: u64,
    /// Sessions that ended in the safe state.
    pub safe: u64,
    /// Sessions that could not begin, because the rig was not ready again.
    pub refused: u64,
    /// Faults with what they violated.
    pub violations: Vec<(Fault, Injected)>,
}

/// Cycles of a shard.
const SHARD_CYCLES: u64 = 100_000;

/// Cycles before the earliest fault: the coupling is faded in within a thousand.
const EARLIEST: u64 = 200;

/// Cycles that a session goes on after its fault.
const WATCHED: u64 = 1500;

/// Injects random faults at random times until so many cycles are done, on all cores. `done` hears
/// of cycles as they are done.
///
/// # Errors
/// The scenario has no rig.
pub fn schedule(
    run: &Run,
    seed: u64,
    cycles: u64,
    stop: &AtomicBool,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Survey, BenchError> {
    let shards: Vec<Survey> = in_memory(run, |session, node| {
        let one = |number: u64| {
            let cycles = (cycles - number * SHARD_CYCLES).min(SHARD_CYCLES);
            let shard = Shard { session, run, node, draw: Draw::seeded(seed, number) };
            shard.survey(cycles, stop, done)
        };
        (0..cycles.div_ceil(SHARD_CYCLES)).into_par_iter().map(one).collect()
    })?;
    let mut survey = Survey::default();
    for shard in shards {
        survey.add(shard);
    }
    Ok(survey)
}

impl Survey {
    fn add(&mut self, other: Self) {
        self.cycles += other.cycles;
        self.faults += other.faults;
        self.went_on += other.went_on;
        self.ramped_out += other.ramped_out;
        self.safe += other.safe;
        self.refused += other.refused;
        self.violations.extend(other.violations);
    }
}

/// One of the pieces that a schedule is divided into.
struct Shard<'a> {
    session: &'a Session<'a>,
    run: &'a Run,
    node: Node,
    draw: Draw,
}

impl Shard<'_> {
    fn survey(
        mut self,
        cycles: u64,
        stop: &AtomicBool,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Survey, BenchError> {
        let mut bus = self.bus();
        let mut survey = Survey::default();
        while survey.cycles < cycles && !stop.load(Ordering::Relaxed) {
            let injection = self.injection();
            let injected = match inject(self.session, self.run, &mut bus, &injection) {
                Ok(injected) => injected,
                Err(
                    NoAnswer::Refused { .. } | NoAnswer::Latched { .. } | NoAnswer::TooFar { .. },
                ) => {
                    // A ram at the end of its stroke or a damper under load: a fresh rig.
                    survey.refused += 1;
                    bus = self.bus();
                    continue;
                }
                Err(why) => return Err(why.on(&BusChoice::Memory)),
            };
            bus.mend();
            survey.cycles += injected.cycles;
            survey.faults += 1;
            match injected.end {
                None => survey.went_on += 1,
                Some(End::RampedOut) => survey.ramped_out += 1,
                Some(_) => survey.safe += 1,
            }
            done(injected.cycles);
            if injected.violation.is_some() {
                survey.violations.push((injection.fault, injected));
            }
        }
        Ok(survey)
    }

    /// A fresh rig on a bus whose faults have a seed of their own.
    fn bus(&mut self) -> FaultyBus {
        let seed = u64::from(self.draw.number());
        FaultyBus::new(&self.run.rig, self.node, seed).beside(nodes(self.session))
    }

    /// A fault of the table at a random time.
    fn injection(&mut self) -> Injection {
        let mut below = |most: u64| u64::from(self.draw.number()) % most;
        let fault = ROWS[below(ROWS.len() as u64) as usize].fault;
        let begin = EARLIEST + below(4000);
        let lasts = 1 + below(500);
        Injection { fault, begin, lasts, until: begin + lasts + WATCHED }
    }
}
