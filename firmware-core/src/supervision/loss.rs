//! Frames that do not arrive: in a row, over a short and over a long window.
//!
//! A frame lost now and then is held over. Three rules end a run:
//!
//! | lost | reaction | why |
//! | --- | --- | --- |
//! | 5 cycles in a row | stop | the ram of 76 mm/s has moved on by 0.4 mm |
//! | more than 8 of 50 cycles | ramp out | a burst, or loss far above ordinary noise |
//! | more than 18 of 250 cycles | ramp out | steady loss: one frame in ten |
//!
//! With independent losses of 1 % the windows trip less than once in 3,000 hours at 1 kHz; with 10
//! % in either direction they trip within 500 cycles in more than 99 of 100 cases. Both directions
//! are counted, each with a [`Loss`] of its own: the measurements that do not come, and the
//! commands that a measurement's echo does not confirm.

/// Cycles of the short window.
pub const SHORT_CYCLES: usize = 50;
/// Cycles of the long window.
pub const LONG_CYCLES: usize = 250;

/// How much may be lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LossLimits {
    /// Losses in a row that are too many. A receiver loses its step after five.
    pub in_a_row: u32,
    /// Most losses in the short window.
    pub in_short: u32,
    /// Most losses in the long window.
    pub in_long: u32,
}

impl LossLimits {
    /// Those of the table above.
    pub const USUAL: Self = Self { in_a_row: 5, in_short: 8, in_long: 18 };
}

/// What the losses so far are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LossVerdict {
    /// Few: the last good value holds.
    Holds,
    /// Too many of the long window.
    Long,
    /// Too many of the short window.
    Short,
    /// Too many in a row.
    Row,
}

/// Losses of one direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Loss {
    in_a_row: u32,
    short: Window<1>,
    long: Window<4>,
    total: u64,
    most: MostLost,
}

/// The most that was lost so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MostLost {
    /// In a row.
    pub in_a_row: u32,
    /// In the short window.
    pub in_short: u32,
    /// In the long window.
    pub in_long: u32,
}

impl Loss {
    /// Takes one cycle, and gives the verdict after it.
    ///
    /// ```
    /// use firmware_core::supervision::{Loss, LossLimits, LossVerdict};
    /// let mut loss = Loss::default();
    /// let verdicts: [LossVerdict; 5] =
    ///     core::array::from_fn(|_| loss.take(&LossLimits::USUAL, true));
    /// assert_eq!(verdicts[3..], [LossVerdict::Holds, LossVerdict::Row]);
    /// ```
    pub fn take(&mut self, limits: &LossLimits, is_lost: bool) -> LossVerdict {
        self.in_a_row = if is_lost { self.in_a_row.saturating_add(1) } else { 0 };
        self.total += u64::from(is_lost);
        self.short.push(is_lost, SHORT_CYCLES);
        self.long.push(is_lost, LONG_CYCLES);
        self.most = MostLost {
            in_a_row: self.most.in_a_row.max(self.in_a_row),
            in_short: self.most.in_short.max(self.short.count),
            in_long: self.most.in_long.max(self.long.count),
        };
        if self.in_a_row >= limits.in_a_row {
            LossVerdict::Row
        } else if self.short.count > limits.in_short {
            LossVerdict::Short
        } else if self.long.count > limits.in_long {
            LossVerdict::Long
        } else {
            LossVerdict::Holds
        }
    }

    /// Cycles in a row without a frame.
    pub fn in_a_row(&self) -> u32 {
        self.in_a_row
    }

    /// Lost within the short and within the long window.
    pub fn in_windows(&self) -> (u32, u32) {
        (self.short.count, self.long.count)
    }

    /// The most that was lost so far.
    pub fn most(&self) -> MostLost {
        self.most
    }

    /// Lost in all.
    pub fn total(&self) -> u64 {
        self.total
    }
}

/// A ring of the last cycles, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Window<const WORDS: usize> {
    bits: [u64; WORDS],
    next: usize,
    count: u32,
}

impl<const WORDS: usize> Default for Window<WORDS> {
    fn default() -> Self {
        Self { bits: [0; WORDS], next: 0, count: 0 }
    }
}

impl<const WORDS: usize> Window<WORDS> {
    /// Replaces the oldest of `cycles` bits.
    fn push(&mut self, bit: bool, cycles: usize) {
        debug_assert!(cycles <= 64 * WORDS && self.next < cycles, "{} of {cycles}", self.next);
        let (word, mask) = (self.next / 64, 1 << (self.next % 64));
        if let Some(word) = self.bits.get_mut(word) {
            self.count -= u32::from(*word & mask != 0);
            *word = if bit { *word | mask } else { *word & !mask };
            self.count += u32::from(bit);
        }
        self.next = (self.next + 1) % cycles;
        debug_assert_eq!(
            self.count,
            self.bits.iter().map(|word| word.count_ones()).sum::<u32>(),
            "the count is that of the bits"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::uniform;
    use super::*;

    const USUAL: LossLimits = LossLimits::USUAL;

    /// Cycle of the first verdict of losses that follow a rule.
    fn first(cycles: u32, verdict: LossVerdict, is_lost: impl Fn(u32) -> bool) -> Option<u32> {
        let mut loss = Loss::default();
        (0..cycles).find(|cycle| loss.take(&USUAL, is_lost(*cycle)) == verdict)
    }

    #[test]
    fn four_in_a_row_hold_and_five_stop() {
        assert_eq!(first(1000, LossVerdict::Row, |n| n % 100 < 4), None);
        assert_eq!(first(1000, LossVerdict::Row, |n| n >= 100), Some(104));
    }

    #[test]
    fn nine_of_fifty_ramp_out_and_eight_do_not() {
        // The ninth of every second cycle from 100 on is lost in cycle 116.
        assert_eq!(first(1000, LossVerdict::Short, |n| n >= 100 && n.is_multiple_of(2)), Some(116));
        let eight = |n: u32| n < 16 && n.is_multiple_of(2);
        assert_eq!(first(1000, LossVerdict::Short, eight), None);
        // Nine over 51 cycles never are in one window of 50.
        let spread = |n: u32| n == 50 || (n < 16 && n.is_multiple_of(2));
        assert_eq!(first(1000, LossVerdict::Short, spread), None);
    }

    #[test]
    fn four_of_every_five_lost_for_ever_ran_to_the_end() {
        // Row 2 of the faults that were tried: the run ended as completed.
        assert_eq!(first(1000, LossVerdict::Short, |n| n % 5 != 0), Some(11));
    }

    #[test]
    fn one_in_ten_ramps_out_by_the_long_window() {
        // Regular losses of one in ten: five of fifty, and the nineteenth in cycle 180.
        assert_eq!(first(1000, LossVerdict::Long, |n| n % 10 == 0), Some(180));
        assert_eq!(first(100_000, LossVerdict::Long, |n| n % 14 == 0), None);
    }

    #[test]
    fn one_per_cent_holds_for_an_hour_and_ten_per_cent_does_not_last_half_a_second() {
        let mut state = 20_261_129;
        let mut loss = Loss::default();
        let holds = (0..3_600_000)
            .all(|_| loss.take(&USUAL, uniform(&mut state) < 0.01) == LossVerdict::Holds);
        assert!(holds, "{loss:?}");
        let ends = |_: &u32| {
            let (mut there, mut back) = (Loss::default(), Loss::default());
            (0..500).any(|_| {
                let lost = [uniform(&mut state) < 0.1, uniform(&mut state) < 0.1];
                there.take(&USUAL, lost[0]).max(back.take(&USUAL, lost[1])) != LossVerdict::Holds
            })
        };
        assert_eq!((0..1000).filter(ends).count(), 1000);
    }
}
