//! The track under a run, stretch by stretch.
//!
//! A thread makes the next stretches while the vehicle runs on the present one. Two buffers go
//! round between it and the loop, through two bounded queues:
//! ```text
//!          made                          used
//! thread ---------> loop: present ----------------> thread
//! ```
//! The loop changes the stretch after it has sent the commands of a cycle, and there it neither
//! allocates nor frees. The thread polls for used buffers, so that no wake-up call is made either.
//!
//! A stretch is ready minutes before it is needed. If one is not, the loop waits for it; the slots
//! that pass meanwhile are counted as skipped, and rigs act as on any host that is late.

use crate::BenchError;
use crossbeam_channel::{Receiver, Sender, bounded};
use firmware_core::line::LineState;
use firmware_core::track::Track;
use scenario::irregularity::{Samples, Stretches};
use scenario::run::Run;
use scenario::track::OwnedTrack;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Buffers that go round.
const BUFFERS: usize = 2;

/// How often the thread looks for a used buffer.
const POLL: Duration = Duration::from_millis(20);

/// The track of a run with its present stretch.
#[derive(Debug)]
pub struct Course<'a> {
    first: &'a Track<'a>,
    /// The present stretch; none while it is the first.
    later: Option<OwnedTrack>,
    /// Number of the present stretch.
    number: usize,
    /// Distance of the vehicle at which the stretch changes (m).
    change_m: f64,
    ahead: Option<Ahead>,
}

/// Stretches that are made ahead of the vehicle.
#[derive(Debug)]
struct Ahead {
    stretches: Stretches,
    made: Receiver<Samples>,
    /// Either end is held here too: a buffer stays in the queue even if nobody refills it.
    used: (Sender<Samples>, Receiver<Samples>),
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The thread that makes the track has failed: there is no next stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoStretch;

impl From<NoStretch> for BenchError {
    fn from(NoStretch: NoStretch) -> Self {
        Self::Thread { name: "makes the track" }
    }
}

impl<'a> Course<'a> {
    /// The course of a run, which begins with `first`: the track of the run as a step sees it.
    /// Where the run needs more than one stretch, a thread begins with the next ones.
    pub fn new(run: &Run, first: &'a Track<'a>) -> Self {
        let stretches = run.stretches.as_ref().filter(|stretches| stretches.count() > 1);
        let change_m = stretches.map_or(f64::INFINITY, |stretches| stretches.change_m(0));
        let ahead = stretches.map(|stretches| Ahead::begin(stretches.clone()));
        Self { first, later: None, number: 0, change_m, ahead }
    }

    /// The track with the present stretch.
    pub fn track(&self) -> Track<'_> {
        self.later.as_ref().map_or_else(|| self.first.clone(), OwnedTrack::view)
    }

    /// Whether the vehicle has come to where the stretch changes.
    pub fn is_passed(&self, state: &LineState) -> bool {
        state.vehicle.distance_m.lane(0) >= self.change_m
    }

    /// Whether the next stretch can be had without waiting for it.
    pub fn is_ready(&self) -> bool {
        self.ahead.as_ref().is_some_and(|ahead| !ahead.made.is_empty())
    }

    /// Goes on to the next stretch.
    ///
    /// # Errors
    /// There is none; the present one stays.
    pub fn change(&mut self) -> Result<(), NoStretch> {
        // Whatever comes of it, this is done once.
        self.change_m = f64::INFINITY;
        let Some(ahead) = &self.ahead else { return Err(NoStretch) };
        let next = ahead.made.recv().map_err(|_| NoStretch)?;
        debug_assert!(next.before > 0, "the first stretch is not made again");
        if let Some(present) = &mut self.later {
            let used = std::mem::replace(&mut present.samples, next);
            let full = ahead.used.0.try_send(used);
            debug_assert!(full.is_ok(), "the queue has room for every buffer");
        } else {
            self.later = Some(OwnedTrack { layout: self.first.layout.clone(), samples: next });
        }
        self.number += 1;
        self.change_m = ahead.stretches.change_m(self.number);
        Ok(())
    }
}

impl Ahead {
    fn begin(stretches: Stretches) -> Self {
        let (to_loop, made) = bounded(BUFFERS);
        let used = bounded(BUFFERS);
        for _ in 0..BUFFERS {
            let full = used.0.try_send(Samples::default());
            debug_assert!(full.is_ok(), "the queue has room for every buffer");
        }
        let stop = Arc::new(AtomicBool::new(false));
        let thread = {
            let (stretches, used, stop) = (stretches.clone(), used.1.clone(), Arc::clone(&stop));
            std::thread::spawn(move || make(&stretches, &to_loop, &used, &stop))
        };
        Self { stretches, made, used, stop, thread: Some(thread) }
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // One that has failed has ended too.
            let _ended = thread.join();
        }
    }
}

/// Makes one stretch after the other, from the second on.
fn make(
    stretches: &Stretches,
    made: &Sender<Samples>,
    used: &Receiver<Samples>,
    stop: &AtomicBool,
) {
    let goes_on = || !stop.load(Ordering::Relaxed);
    for number in 1..stretches.count() {
        let mut samples = loop {
            match used.try_recv() {
                Ok(samples) => break samples,
                Err(_) if goes_on() => std::thread::sleep(POLL),
                Err(_) => return,
            }
        };
        if !stretches.make(number, &mut samples, &goes_on) || made.try_send(samples).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::run::Overrides;
    use std::path::Path;

    #[test]
    fn a_day_holds_three_stretches_and_is_set_up_at_once() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(86_400.0), ..Overrides::default() };
        let run = Run::load(&path, overrides).unwrap();
        let first = run.track.samples.samples.len();
        // 24 h at 160 km/h are 3840 km; the fades and the measurement of the delay take 8 s more.
        let whole = first + run.track.samples.behind;
        assert!((38_403_000..38_405_000).contains(&whole), "{whole}");
        assert!(first * (1 + BUFFERS) <= 800_000, "{first}");
        let track = run.track.view();
        let mut course = Course::new(&run, &track);
        course.change().unwrap();
        let track = course.track();
        assert!(track.irregularity.samples.len() <= first);
        let from_m = 0.1 * track.irregularity.before as f64;
        assert!((26e3..27e3).contains(&from_m), "{from_m}");
        // The end does not wait for the stretch that is being made.
        drop(course);
    }

    #[test]
    fn a_course_without_a_next_stretch_says_so_once_and_stays() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(3.0), ..Overrides::default() };
        let run = Run::load(&path, overrides).unwrap().in_stretches_of(1024);
        let track = run.track.view();
        let mut course = Course::new(&run, &track);
        assert!(course.change_m < 100.0);
        // As if the thread had failed.
        course.ahead.as_mut().unwrap().made = bounded(0).1;
        assert_eq!((course.change(), course.change_m), (Err(NoStretch), f64::INFINITY));
        assert_eq!(course.track(), track);
    }

    #[test]
    fn a_short_run_has_one_stretch_and_no_thread() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(500.0), ..Overrides::default() };
        let run = Run::load(&path, overrides).unwrap();
        let track = run.track.view();
        let mut course = Course::new(&run, &track);
        assert!(course.ahead.is_none() && run.track.samples.behind == 0);
        assert_eq!((course.change_m, course.change()), (f64::INFINITY, Err(NoStretch)));
        assert_eq!(course.track(), track);
    }
}
