//! Random faults, session after session, on one rig whose plant stays as it is.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, inject};
use super::table::ROWS;
use crate::BenchError;
use crate::bus::BusChoice;
use crate::control::{End, NoAnswer};
use crate::draw::Draw;
use crate::run::{Plan, Terms, session};
use can_protocol::{Node, Profile};
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

/// Cycles before the earliest fault: the coupling is faded in within a thousand.
const EARLIEST: u64 = 200;

/// Cycles that a session goes on after its fault.
const WATCHED: u64 = 1500;

/// Injects random faults at random times until so many cycles are done. `done` hears of them.
///
/// # Errors
/// The scenario has no rig.
pub fn schedule(
    run: &Run,
    seed: u64,
    cycles: u64,
    stop: &AtomicBool,
    done: &mut dyn FnMut(u64),
) -> Result<Survey, BenchError> {
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &plan.rigs, Terms::in_memory(Profile::Classical))?;
    let node = plan.rigs.first().map_or(Node::ALL[0], |rig| rig.node);
    let mut draw = Draw::seeded(seed, 0);
    let mut bus = FaultyBus::new(&run.rig, node, seed);
    let mut survey = Survey::default();
    while survey.cycles < cycles && !stop.load(Ordering::Relaxed) {
        let mut below = |most: u64| u64::from(draw.number()) % most;
        let fault = ROWS[below(ROWS.len() as u64) as usize].fault;
        let begin = EARLIEST + below(4000);
        let lasts = 1 + below(500);
        let injection = Injection { fault, begin, lasts, until: begin + lasts + WATCHED };
        let injected = match inject(&session, run, &mut bus, &injection) {
            Ok(injected) => injected,
            Err(NoAnswer::Refused { .. } | NoAnswer::Latched { .. } | NoAnswer::TooFar { .. }) => {
                // A ram at the end of its stroke or a damper under load: a fresh rig.
                survey.refused += 1;
                bus = FaultyBus::new(&run.rig, node, seed);
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
        if injected.violation.is_some() {
            survey.violations.push((fault, injected));
        }
        done(survey.cycles);
    }
    Ok(survey)
}
