//! Ticks that the host has just skipped: after them a rig is found silent or safe that is sound.

/// A cause within so many cycles of a skipped tick may come from it.
const JUST_CYCLES: u64 = 10;

/// Ticks skipped in the last cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct RecentSkips {
    ticks: u64,
    /// Cycle of the last of them.
    cycle: u64,
}

impl RecentSkips {
    /// Notes ticks that were skipped before a cycle.
    pub(super) fn skip(&mut self, cycle: u64, ticks: u64) {
        self.ticks = self.just_before(cycle).saturating_add(ticks);
        self.cycle = cycle;
    }

    /// Ticks that were skipped just before a cycle.
    pub(super) fn just_before(&self, cycle: u64) -> u64 {
        if cycle <= self.cycle.saturating_add(JUST_CYCLES) { self.ticks } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skips_that_follow_each_other_add_up_and_old_ones_are_forgotten() {
        let mut skips = RecentSkips::default();
        assert_eq!(skips.just_before(5), 0);
        skips.skip(100, 2);
        skips.skip(105, 3);
        assert_eq!(
            (skips.just_before(106), skips.just_before(115), skips.just_before(116)),
            (5, 5, 0)
        );
        skips.skip(200, 1);
        assert_eq!(skips.just_before(200), 1);
    }
}
