//! Ticks of a measurement: each of them is met or skipped, and none is counted twice.

/// Counts the ticks of a measurement of a known length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ticks {
    expected: u64,
    /// Ticks on which a cycle was run.
    pub(super) met: u64,
    /// Ticks that had passed before the cycle before them ended.
    pub(super) skipped: u64,
}

impl Ticks {
    pub(super) fn new(expected: u64) -> Self {
        Self { expected, met: 0, skipped: 0 }
    }

    /// Takes the next tick that was waited for, after so many that were skipped; false when it lies
    /// beyond the end. What is skipped beyond the end does not count.
    pub(super) fn take(&mut self, skipped: u64) -> bool {
        let left = self.expected - self.met - self.skipped;
        if skipped >= left {
            self.skipped += left;
            return false;
        }
        self.skipped += skipped;
        self.met += 1;
        debug_assert!(self.met + self.skipped <= self.expected, "more ticks than there are");
        true
    }

    /// Whether there is none left.
    pub(super) fn are_over(&self) -> bool {
        self.met + self.skipped == self.expected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tick_is_met_or_skipped_whatever_is_skipped_at_the_end() {
        // Ticks skipped before each that was waited for, and what is met and skipped in the end.
        let cases: [(&[u64], u64, u64); 5] = [
            (&[0; 10], 10, 0),
            (&[0, 3, 0, 0, 0, 0, 0], 7, 3),
            (&[0, 0, 99], 2, 8),
            (&[9], 1, 9),
            (&[10], 0, 10),
        ];
        for (skipped, met, lost) in cases {
            let mut ticks = Ticks::new(10);
            for (at, skipped) in skipped.iter().enumerate() {
                assert!(!ticks.are_over(), "over before {at}");
                ticks.take(*skipped);
            }
            assert!(ticks.are_over());
            assert_eq!((ticks.met, ticks.skipped), (met, lost));
        }
    }
}
