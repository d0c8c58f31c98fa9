//! Evidence of a second sender under the id of one peer.
//!
//! A frame that is damaged on its way takes the place of the good one; a second sender's frame
//! comes in addition to it. So a cycle counts as disturbed when it has a bad frame and a good one:
//!
//! ```text
//! two different valid frames under one counter          evidence at once
//! a frame of another session next to a good one         evidence at once
//! three of ten cycles with a bad frame next to a good   evidence
//! ```
//!
//! A frame that is repeated bit for bit and a single bad frame are no evidence. By chance a bad
//! frame next to a good one passes for a foreign one once in 256 (FD 65,536).

/// Cycles that are looked at.
const WINDOW_CYCLES: u32 = 10;

/// Disturbed cycles among them that are evidence.
const MOST_DISTURBED: u32 = 3;

/// What came under one id in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "they are independent")]
pub struct Frames {
    /// A frame that was accepted.
    pub good: bool,
    /// A frame whose protection failed.
    pub bad: bool,
    /// A frame with another content under the counter of the last one.
    pub conflict: bool,
    /// A frame that was refused and is valid without this session's seal, or under another's.
    pub foreign: bool,
}

/// What is remembered of the last cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SecondSender {
    /// One bit for each cycle, set where it was disturbed.
    disturbed: u16,
}

impl SecondSender {
    /// Takes the frames of a cycle; whether there is evidence of a second sender.
    ///
    /// ```
    /// use firmware_core::supervision::{Frames, SecondSender};
    /// let mut judge = SecondSender::default();
    /// let disturbed = Frames { good: true, bad: true, ..Frames::default() };
    /// assert!(!judge.take(disturbed) && !judge.take(disturbed) && judge.take(disturbed));
    /// ```
    pub const fn take(&mut self, frames: Frames) -> bool {
        let is_disturbed = frames.good && frames.bad;
        let window = (1 << WINDOW_CYCLES) - 1;
        self.disturbed = ((self.disturbed << 1) | is_disturbed as u16) & window;
        frames.conflict
            || (frames.foreign && frames.good)
            || self.disturbed.count_ones() >= MOST_DISTURBED
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Frames = Frames { good: true, bad: false, conflict: false, foreign: false };
    const DISTURBED: Frames = Frames { bad: true, ..GOOD };

    #[test]
    fn three_of_ten_cycles_are_evidence_and_of_eleven_are_none() {
        for (gap, is_evidence) in [(3, true), (4, false)] {
            let mut judge = SecondSender::default();
            let mut found = false;
            for cycle in 0..=2 * (gap + 1) {
                found |= judge.take(if cycle % (gap + 1) == 0 { DISTURBED } else { GOOD });
            }
            // Cycles 0, 4 and 8 are within ten; 0, 5 and 10 are not.
            assert_eq!(found, is_evidence, "a gap of {gap} cycles");
        }
    }

    #[test]
    fn damaged_frames_in_place_of_good_ones_are_no_evidence() {
        let mut judge = SecondSender::default();
        let damaged = Frames { bad: true, foreign: true, ..Frames::default() };
        assert!((0..100).all(|_| !judge.take(damaged)));
    }

    #[test]
    fn another_content_or_a_foreign_frame_next_to_a_good_one_is_evidence_at_once() {
        assert!(SecondSender::default().take(Frames { conflict: true, ..Frames::default() }));
        assert!(SecondSender::default().take(Frames { foreign: true, ..DISTURBED }));
    }
}
