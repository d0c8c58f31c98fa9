//! Trips of many questions that share batches of four.
//!
//! A search runs one trip after the other, so the lanes of a batch are filled by others: four to a
//! core are worked on at once, each on a thread of its own. A thread with a trip puts it among
//! those that wait. As many threads as there are cores take up to four that can join each other,
//! run one leg of them and put them back; the others sleep until their own has ended. Who meets
//! whom depends on chance, and no answer does ([`super::leg`]).

use super::leg::{self, LANES, Traveller};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Threads more than there are lanes: some are between two trips.
const SPARE: usize = 2;

/// Where trips wait for their next leg.
#[derive(Debug)]
pub struct Together {
    cores: usize,
    shared: Mutex<Shared>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Shared {
    /// Trips between two legs, with their numbers, in the order in which they came.
    waiting: VecDeque<(u64, Box<Traveller>)>,
    /// Trips that were ever begun.
    numbered: u64,
    /// Legs under way.
    legs: usize,
    /// A leg that panicked has lost its trips.
    is_broken: bool,
}

impl Together {
    /// For as many cores as the thread pool of its caller has.
    pub fn on_all_cores() -> Self {
        Self::on(rayon::current_num_threads())
    }

    /// For so many cores.
    pub fn on(cores: usize) -> Self {
        debug_assert!(cores > 0, "no core");
        Self { cores, shared: Mutex::default(), changed: Condvar::new() }
    }

    /// Does work on so many threads that their trips fill batches on all cores.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let threads = LANES * self.cores + SPARE;
        match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => pool.install(work),
            // A machine that has no more threads.
            Err(_) => work(),
        }
    }

    /// Runs a trip to its end; earlier once `stop` is set.
    pub(super) fn run(&self, trip: Traveller, stop: &AtomicBool) -> Box<Traveller> {
        let mut trip = Box::new(trip);
        if trip.has_ended() {
            return trip;
        }
        let mut shared = self.lock();
        let number = shared.numbered;
        shared.numbered += 1;
        shared.waiting.push_back((number, trip));
        loop {
            assert!(!shared.is_broken, "a trip beside this one has panicked");
            let place = shared.waiting.iter().position(|(waiting, _)| *waiting == number);
            if let Some(place) = place
                && (shared.waiting[place].1.has_ended() || stop.load(Ordering::Relaxed))
                && let Some((_, own)) = shared.waiting.remove(place)
            {
                trip = own;
                return trip;
            }
            let mut group =
                if shared.legs < self.cores { shared.next_group(self.cores) } else { Vec::new() };
            if group.is_empty() {
                shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            shared.legs += 1;
            drop(shared);
            let under_way = UnderWay(self);
            let (numbers, mut trips): (Vec<u64>, Vec<Box<Traveller>>) = group.drain(..).unzip();
            leg::run(&mut trips);
            shared = self.lock();
            shared.waiting.extend(numbers.into_iter().zip(trips));
            shared.legs -= 1;
            std::mem::forget(under_way);
            self.changed.notify_all();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shared {
    /// Trips for a leg: the first that waits and those that can join it, so many that no core is
    /// left without any.
    fn next_group(&mut self, cores: usize) -> Vec<(u64, Box<Traveller>)> {
        let open = |trip: &Traveller| !trip.has_ended();
        let count = self.waiting.iter().filter(|(_, trip)| open(trip)).count();
        let most = count.div_ceil(cores - self.legs).min(LANES);
        let mut group: Vec<(u64, Box<Traveller>)> = Vec::with_capacity(LANES);
        let mut place = 0;
        while group.len() < most && place < self.waiting.len() {
            let trip = &self.waiting[place].1;
            let joins = open(trip) && group.first().is_none_or(|(_, first)| first.can_join(trip));
            match if joins { self.waiting.remove(place) } else { None } {
                Some(chosen) => group.push(chosen),
                None => place += 1,
            }
        }
        group
    }
}

/// A leg under way: dropped only by a panic, of which those who wait have to know.
struct UnderWay<'a>(&'a Together);

impl Drop for UnderWay<'_> {
    fn drop(&mut self) {
        self.0.lock().is_broken = true;
        self.0.changed.notify_all();
    }
}
