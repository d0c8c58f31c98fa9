//! Frames that are lost at random, for hours or until the run ends.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, in_memory, inject, nodes};
use crate::BenchError;
use crate::bus::BusChoice;
use crate::draw::Draw;
use rayon::prelude::*;
use scenario::run::Run;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cycle in which losses begin: the motion is faded in.
const BEGIN: u64 = 2000;

/// Sessions with losses, each with a seed of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses {
    /// Share of the measurements that are lost.
    pub measurements: f64,
    /// Share of the commands that are lost.
    pub commands: f64,
    /// Number of sessions.
    pub sessions: usize,
    /// Cycles of each with losses.
    pub cycles: u64,
}

/// Runs sessions with losses, on all cores; `done` hears of cycles as they are done.
///
/// # Errors
/// The scenario has no rig, or its rig cannot be armed.
pub fn lose_at_random(
    run: &Run,
    losses: Losses,
    seed: u64,
    stop: &AtomicBool,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Injected>, BenchError> {
    let Losses { measurements, commands, sessions, cycles } = losses;
    let fault = Fault::LoseAtRandom { measurements, commands };
    let injection = Injection { fault, begin: BEGIN, lasts: u64::MAX, until: BEGIN + cycles };
    in_memory(run, |session, node| {
        let one = |number: usize| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let seed = u64::from(Draw::seeded(seed, number as u64).number());
            let mut bus = FaultyBus::new(&run.rig, node, seed).beside(nodes(session));
            let injected = inject(session, run, &mut bus, &injection);
            done(cycles);
            Some(injected.map_err(|why| why.on(&BusChoice::Memory)))
        };
        (0..sessions).into_par_iter().filter_map(one).collect()
    })
}
