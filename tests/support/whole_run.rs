//! A scenario from its first cycle to its last, in this process.

use super::session::{ready, session};
use hil_host::control::{Buses, Course, End, Pace, Requests};
use hil_host::record::Queues;
use scenario::run::Run;
use std::sync::atomic::AtomicBool;

/// Runs a whole scenario and gives its end and hash.
pub(crate) fn run_through(run: &Run) -> (End, u64) {
    let track = run.track.view();
    let session = session(run, &track);
    let mut course = Course::new(run, &track);
    let (mut state, mut buses) = ready(run, &session);
    let mut queues = Queues::default();
    let (mut recorder, drain) = queues.split();
    let done = AtomicBool::new(false);
    let end = std::thread::scope(|scope| {
        let done = &done;
        scope.spawn(move || drain.discard(done));
        let stop = Requests::armed();
        let mut buses = Buses::new(&mut buses, &mut recorder);
        let pace = &mut Pace::Fast;
        let end = session.run(&mut course, &mut state, &mut buses, pace, run.cycles(), &stop);
        done.store(true, std::sync::atomic::Ordering::Release);
        end
    });
    (end, state.hash)
}
