//! What a disk did not take, and when that ends a run.

use std::io;

/// Entries that a disk did not take.
#[derive(Debug)]
pub(crate) struct Loss {
    /// Entries lost for longer than this end a run (ns); none: it goes on.
    longest_ns: Option<u64>,
    /// How many.
    pub(crate) count: u64,
    /// What the system said last.
    pub(crate) why: Option<io::Error>,
    /// Time of the first lost entry since the last one that was written (ns).
    since_ns: Option<u64>,
    /// Whether it lasted longer than a run goes on.
    pub(crate) too_long: bool,
}

impl Loss {
    /// Nothing is lost yet; a loss of more than `longest_ns` ends the run.
    pub(crate) const fn ending_after(longest_ns: Option<u64>) -> Self {
        Self { longest_ns, count: 0, why: None, since_ns: None, too_long: false }
    }

    /// Takes in how a write of `count` entries ended, the last of them of `time_ns`; true where the
    /// run has to end.
    pub(crate) fn take(&mut self, written: io::Result<()>, count: u64, time_ns: u64) -> bool {
        match written {
            Ok(()) => self.since_ns = None,
            Err(why) => {
                self.count += count;
                self.why = Some(why);
                let since_ns = *self.since_ns.get_or_insert(time_ns);
                let lost_ns = time_ns.saturating_sub(since_ns);
                self.too_long |= self.longest_ns.is_some_and(|longest_ns| lost_ns > longest_ns);
            }
        }
        self.too_long
    }

    /// Takes in how the last write ended: what is not on the disk then is lost, however short.
    pub(crate) fn finish(&mut self, finished: io::Result<()>) {
        if let (Err(why), false) = (finished, self.too_long) {
            self.why = Some(why);
            self.too_long = self.longest_ns.is_some();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_loss_of_more_than_a_second_ends_a_run() {
        let full = || Err(io::ErrorKind::StorageFull.into());
        let mut loss = Loss::ending_after(Some(1_000_000_000));
        assert!(!loss.take(full(), 10, 5_000_000_000));
        assert!(!loss.take(full(), 10, 6_000_000_000));
        // Somebody makes room, and the disk is full again.
        assert!(!loss.take(Ok(()), 10, 6_010_000_000));
        assert!(!loss.take(full(), 10, 6_020_000_000));
        assert!(!loss.take(full(), 10, 7_020_000_000));
        assert!(loss.take(full(), 10, 7_030_000_000));
        assert_eq!((loss.count, loss.too_long), (50, true));
        assert!(loss.why.is_some());
    }

    #[test]
    fn a_run_that_may_go_on_counts_its_loss_for_ever() {
        let full = || Err(io::ErrorKind::StorageFull.into());
        let mut loss = Loss::ending_after(None);
        for hour in 0..24 {
            assert!(!loss.take(full(), 1000, hour * 3_600_000_000_000));
        }
        loss.finish(full());
        assert_eq!((loss.count, loss.too_long), (24_000, false));
    }
}
