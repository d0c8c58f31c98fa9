//! What the loop does from arming to its end: it runs a vehicle, or follows a motion.

use crate::bus::Bus;
use crate::control::{Buses, Course, End, Motion, NoAnswer, Pace, Requests, Session, SessionState};

/// The work of a loop that is recorded.
pub(super) trait Work {
    /// Arms the rigs: the next cycle moves them.
    ///
    /// # Errors
    /// A rig that is not armed; those that were are disarmed.
    fn arm<B: Bus>(
        &self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer>;

    /// Cycle after cycle, to the end.
    fn run<B: Bus>(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        requests: &Requests,
    ) -> End;
}

/// A vehicle on its track, coupled to its rigs, for so many cycles of RUN.
#[derive(Debug)]
pub(super) struct Coupled<'s> {
    /// Its thread has begun: it must not inherit what the loop asks of the kernel.
    pub(super) course: Course<'s>,
    pub(super) cycles: u64,
}

impl Work for Coupled<'_> {
    fn arm<B: Bus>(
        &self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        session.arm(state, buses, requests)
    }

    fn run<B: Bus>(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        requests: &Requests,
    ) -> End {
        session.run(&mut self.course, state, buses, pace, self.cycles, requests)
    }
}

/// A motion in open loop.
#[derive(Debug)]
pub(super) struct OpenLoop<'m, M>(pub(super) &'m mut M);

impl<M: Motion> Work for OpenLoop<'_, M> {
    fn arm<B: Bus>(
        &self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        session.arm_open_loop(&*self.0, state, buses, requests)
    }

    fn run<B: Bus>(
        &mut self,
        session: &Session<'_>,
        state: &mut SessionState,
        buses: &mut Buses<'_, '_, B>,
        pace: &mut Pace,
        requests: &Requests,
    ) -> End {
        session.open_loop(self.0, state, buses, pace, requests)
    }
}
