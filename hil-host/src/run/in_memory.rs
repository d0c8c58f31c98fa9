//! A scenario on emulated rigs in memory, cycle by cycle, as fast as the machine computes.

use super::plan::Plan;
use super::setup::{Terms, session};
use crate::BenchError;
use crate::bus::{BusChoice, MemoryBus};
use crate::clock::Tick;
use crate::control::{Buses, Course, End, Ending, Requests, Session, SessionState};
use crate::record::{Queues, Row};
use crate::rig::RigNode;
use scenario::run::Run;
use std::ops::ControlFlow;
use std::time::Duration;

/// How long the rigs in memory may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);

/// Runs a scenario for so many cycles of RUN. `begin` changes the state before the first cycle,
/// `take` sees every row and may break off, and `close` gives the result from the state at the end;
/// none where `take` has broken off.
///
/// # Errors
/// A scenario that cannot run in memory; those of `take`.
pub(crate) fn in_memory<T>(
    run: &Run,
    terms: Terms,
    begin: impl FnOnce(&mut SessionState),
    cycles: u64,
    mut take: impl FnMut(&Row) -> Result<ControlFlow<()>, BenchError>,
    close: impl FnOnce(&Session<'_>, &SessionState, End) -> T,
) -> Result<Option<T>, BenchError> {
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let mut course = Course::new(run, &track);
    let session = session(run, &track, &plan.rigs, terms)?;
    // Whatever a slot names: each bus is one in memory.
    let bus = |number: usize| {
        let rigs = plan.rigs.iter().filter(move |rig| rig.bus == number);
        MemoryBus::new(rigs.map(|rig| RigNode::new(&run.rig, rig.node, terms.profile)))
    };
    let mut buses: Vec<MemoryBus> = (0..plan.buses.len()).map(bus).collect();
    let mut state = session.start(session.line.start(run.start.state.clone()));
    session
        .greet(&mut state, &mut buses, PATIENCE, &Requests::armed())
        .map_err(|why| why.on(&BusChoice::Memory))?;
    begin(&mut state);
    let mut queues = Queues::default();
    // The frames of this bus are not kept.
    let (mut recorder, _frames) = queues.split();
    let mut buses = Buses::new(&mut buses, &mut recorder);
    let mut ending = Ending::default();
    loop {
        let track = course.track();
        while !course.is_passed(&state.line) {
            let row = session.cycle_on(&track, &mut state, &mut buses, Tick::default());
            if take(&row)?.is_break() {
                return Ok(None);
            }
            if let Some(end) = ending.take(&session, &mut state, cycles, false) {
                return Ok(Some(close(&session, &state, end)));
            }
        }
        course.change()?;
    }
}
