//! What a disk did not take, and when that ends a run.

use std::io;

/// Entries lost for longer than this end a run (ns).
const LONGEST_NS: u64 = 1_000_000_000;

/// Entries that a disk did not take.
#[derive(Debug, Default)]
pub(crate) struct Loss {
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
    /// Takes in how a write of `count` entries ended, the last of them of `time_ns`; true where the
    /// run has to end.
    pub(crate) fn take(&mut self, written: io::Result<()>, count: u64, time_ns: u64) -> bool {
        match written {
            Ok(()) => self.since_ns = None,
            Err(why) => {
                self.count += count;
                self.why = Some(why);
                let since_ns = *self.since_ns.get_or_insert(time_ns);
                self.too_long |= time_ns.saturating_sub(since_ns) > LONGEST_NS;
            }
        }
        self.too_long
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_loss_of_more_than_a_second_ends_a_run() {
        let full = || Err(io::ErrorKind::StorageFull.into());
        let mut loss = Loss::default();
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
}
