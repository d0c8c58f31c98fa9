//! The samples of a track that is made stretch by stretch while it is served.
//!
//! ```text
//! server: first, present, next  <---- made ---- thread: makes the stretch that was asked for last
//!                               ---- wanted -->
//! ```
//! The server never waits: a sample of a stretch that is not there yet is served when it is. The
//! next stretch is made while the present one is served; where somebody asks for another place,
//! that one is made, and the first stretch is always there.

use crossbeam_channel::{Receiver, Sender, TryRecvError, bounded};
use firmware_core::track::IrregularitySample;
use nodes::track::Source;
use scenario::irregularity::{Samples, Stretches};
use scenario::run::Run;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;

/// No stretch is wanted.
const NONE: usize = usize::MAX;

/// A track of any length.
#[derive(Debug)]
pub(super) struct LongTrack<'a> {
    first: &'a Samples,
    later: Option<Later>,
}

/// The stretches behind the first.
#[derive(Debug)]
struct Later {
    stretches: Stretches,
    /// Those that are there: the one that was used last comes first.
    held: Vec<(usize, Samples)>,
    /// The stretch that the thread is to make; another number makes it stop.
    wanted: Arc<AtomicUsize>,
    orders: Option<Sender<usize>>,
    made: Receiver<(usize, Samples)>,
    has_failed: bool,
    thread: Option<JoinHandle<()>>,
}

/// Stretches that are kept besides the first.
const HELD: usize = 2;

impl<'a> LongTrack<'a> {
    /// The track of a run.
    pub(super) fn new(run: &'a Run) -> Self {
        let stretches = run.stretches.as_ref().filter(|stretches| stretches.count() > 1);
        Self { first: &run.track.samples, later: stretches.cloned().map(Later::begin) }
    }

    /// Whether there is no next stretch for want of whoever makes it.
    pub(super) fn has_failed(&self) -> bool {
        self.later.as_ref().is_some_and(|later| later.has_failed)
    }
}

impl Source for LongTrack<'_> {
    fn sample(&mut self, place: u32) -> Option<IrregularitySample> {
        let place = place as usize;
        if let Some(later) = &mut self.later {
            later.prepare(place);
        }
        let found = self.first.samples.get(place).copied();
        found.or_else(|| self.later.as_ref()?.sample(place))
    }
}

impl Later {
    fn begin(stretches: Stretches) -> Self {
        let (orders, ordered) = bounded::<usize>(1);
        let (out, made) = bounded(HELD);
        let wanted = Arc::new(AtomicUsize::new(NONE));
        let (from, still_wanted) = (stretches.clone(), Arc::clone(&wanted));
        let thread = std::thread::spawn(move || {
            for number in ordered {
                let mut samples = Samples::default();
                let goes_on = || still_wanted.load(Ordering::Relaxed) == number;
                if from.make(number, &mut samples, &goes_on) && out.send((number, samples)).is_err()
                {
                    return;
                }
            }
        });
        let (orders, thread) = (Some(orders), Some(thread));
        Self { stretches, held: Vec::new(), wanted, orders, made, has_failed: false, thread }
    }

    /// Has the stretch of a place made, or the one behind it.
    fn prepare(&mut self, place: usize) {
        loop {
            match self.made.try_recv() {
                Ok(made) => {
                    self.held.insert(0, made);
                    self.held.truncate(HELD);
                }
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    self.has_failed = true;
                    return;
                }
            }
        }
        let present = self.stretches.number_at(place);
        if let Some(used) = self.held.iter().position(|(number, _)| *number == present) {
            self.held.swap(0, used);
        }
        let is_there =
            |number: &usize| *number == 0 || self.held.iter().any(|(held, _)| held == number);
        let next = (present + 1).min(self.stretches.count() - 1);
        let missing = [present, next].into_iter().find(|number| !is_there(number));
        let Some(missing) = missing else { return };
        if self.wanted.swap(missing, Ordering::Relaxed) != missing
            && let Some(orders) = &self.orders
            && orders.try_send(missing).is_err()
        {
            // The thread still has an order that is wanted no more: the next call asks again.
            self.wanted.store(NONE, Ordering::Relaxed);
        }
    }

    fn sample(&self, place: usize) -> Option<IrregularitySample> {
        self.held.iter().find_map(|(_, stretch)| {
            stretch.samples.get(place.checked_sub(stretch.before)?).copied()
        })
    }
}

impl Drop for Later {
    fn drop(&mut self) {
        self.wanted.store(NONE, Ordering::Relaxed);
        self.orders = None;
        // Room for what it may have made meanwhile.
        while self.made.try_recv().is_ok() {}
        if let Some(thread) = self.thread.take() {
            let _panicked = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::run::Overrides;
    use scenario::source::Source as File;
    use std::path::Path;

    /// Twenty seconds of track as a whole, and the same in short stretches.
    fn tracks() -> (Run, Run) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(20.0), ..Overrides::default() };
        let whole = Run::from_source(&File::read(&path).unwrap(), overrides).unwrap();
        let mut run = whole.clone();
        let stretches = run.stretches.take().unwrap().of_samples(2048);
        assert!(stretches.make(0, &mut run.track.samples, &|| true));
        assert!(stretches.count() > 4);
        run.stretches = Some(stretches);
        (whole, run)
    }

    #[test]
    fn a_long_track_has_every_sample_of_the_track_as_a_whole() {
        let (whole, run) = tracks();
        let samples = &whole.track.samples.samples;
        let mut track = LongTrack::new(&run);
        // Now and then a request is lost and made again, two locomotives ask in turns, and in the
        // end one starts anew.
        let again = |n: u32| (n..n + 64).chain(n..n + 64);
        let count = samples.len() as u32;
        let far = (0..count - 64).step_by(64).flat_map(|n| again(n).chain(again(count - 64 - n)));
        for place in far.chain(0..3000) {
            let made = std::iter::repeat_with(|| track.sample(place)).flatten().next();
            assert_eq!(made, samples.get(place as usize).copied(), "{place}");
        }
        assert!(!track.has_failed());
    }

    #[test]
    fn a_stretch_that_is_not_there_is_not_waited_for() {
        let (_, run) = tracks();
        let mut track = LongTrack::new(&run);
        assert_eq!(track.sample(10_000), None, "it has just been asked for");
        assert!(track.sample(10).is_some(), "the first stretch is there meanwhile");
        assert_eq!(track.sample(u32::MAX), None);
    }
}
