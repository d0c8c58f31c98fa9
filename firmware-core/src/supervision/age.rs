//! How old a measurement is, from the counters that travel.
//!
//! A measurement echoes the counter of the command that it answers. With the counter of the last
//! command sent, its age in cycles is their difference, modulo the counter's range `m` (15, with FD
//! 255):
//!
//! ```text
//! age = (sent - echo) mod m
//! ```
//!
//! One counter alone proves little, so two have to agree: the measurement's own counter must have
//! advanced, and by as many steps as cycles have passed, at most [`OLDEST_CYCLES`] fewer (a frame
//! that was held up) or one more (a rig whose clock is fast). A lost command makes the echo old and
//! leaves the rig's own counter in step.
//!
//! Limits: both counters repeat after `m` cycles, and frames of 15, 16 or 30 cycles look new. The
//! upper bits of the cycle number, which the protocol puts into the CRC, tell them apart.

/// Oldest measurement that is believed, cycles.
pub const OLDEST_CYCLES: u8 = 5;

/// Steps from one counter to another, modulo their range.
const fn steps(from: u8, to: u8, modulus: u8) -> u8 {
    debug_assert!(from < modulus && to < modulus && modulus > 2);
    if to >= from { to - from } else { modulus - from + to }
}

/// A measurement's place among the cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Age {
    /// New, and so many cycles old.
    New(u8),
    /// Older than is believed, or out of step.
    Old,
    /// It answers no command yet.
    Unknown,
}

/// The age of the measurements of one rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AgeJudge {
    last: Option<Last>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Last {
    counter: u8,
    age: u8,
    /// Cycles since it was new.
    cycles: u32,
}

impl AgeJudge {
    /// Notes that a cycle begins.
    pub fn cycle(&mut self) {
        if let Some(last) = &mut self.last {
            last.cycles = last.cycles.saturating_add(1);
        }
    }

    /// Notes cycles that the host has missed: the rig has gone on, and its counter with it.
    pub fn skip(&mut self, cycles: u32) {
        if let Some(last) = &mut self.last {
            last.cycles = last.cycles.saturating_add(cycles);
        }
    }

    /// Judges a measurement: its counter, the counter that it echoes, and that of the last command.
    ///
    /// ```
    /// use firmware_core::supervision::{Age, AgeJudge};
    /// let mut judge = AgeJudge::default();
    /// assert_eq!(judge.take(3, Some(7), 8, 15), Age::New(1));
    /// judge.cycle();
    /// // Ten cycles old: its echo is too far behind.
    /// assert_eq!(judge.take(8, Some(13), 8, 15), Age::Old);
    /// assert_eq!(judge.take(4, Some(8), 9, 15), Age::New(1));
    /// ```
    pub fn take(&mut self, counter: u8, echo: Option<u8>, sent: u8, modulus: u8) -> Age {
        let Some(echo) = echo else { return Age::Unknown };
        let age = steps(echo, sent, modulus);
        if age > OLDEST_CYCLES {
            return Age::Old;
        }
        if let Some(last) = self.last {
            let counted = u64::from(last.counter) + u64::from(last.cycles);
            // Never zero; the compiler does not know it where the modulus is no constant.
            let due = counted % u64::from(modulus.max(1));
            let behind = steps(counter, due as u8, modulus);
            let is_in_step = behind <= OLDEST_CYCLES || behind == modulus - 1;
            if counter == last.counter || !is_in_step {
                return Age::Old;
            }
        }
        self.last = Some(Last { counter, age, cycles: 0 });
        Age::New(age)
    }

    /// Age of the last new measurement in this cycle: it grows until the next one. 254 cycles count
    /// for more.
    pub fn age_cycles(&self) -> Option<u8> {
        let age = |last: Last| u32::from(last.age).saturating_add(last.cycles).min(254);
        self.last.map(|last| age(last) as u8)
    }

    /// Forgets the last measurement: the next one that echoes a command begins the sequence.
    pub fn restart(&mut self) {
        self.last = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODULUS: u8 = 15;

    /// A rig that answers every command, and a line that delays its answers by `delay(cycle)`
    /// cycles. Returns what the host judges, cycle by cycle.
    fn judged(cycles: u32, delay: impl Fn(u32) -> u32) -> impl Iterator<Item = Age> {
        let mut judge = AgeJudge::default();
        (1..cycles).map(move |cycle| {
            judge.cycle();
            let Some(origin) = cycle.checked_sub(delay(cycle)) else { return Age::Unknown };
            let counter = |cycle: u32| (cycle % u32::from(MODULUS)) as u8;
            judge.take(counter(origin), Some(counter(origin)), counter(cycle), MODULUS)
        })
    }

    #[test]
    fn a_steady_delay_of_at_most_five_is_new() {
        for delay in 1..=5 {
            let ages: heapless::Vec<Age, 200> = judged(200, |_| delay).collect();
            assert!(ages[10..].iter().all(|age| *age == Age::New(delay as u8)), "{delay}");
        }
    }

    #[test]
    fn frames_of_ten_and_fourteen_cycles_are_old() {
        // Row 7 of the faults that were tried: a frame ten cycles old was accepted as new.
        for delay in 6..=14 {
            assert!(judged(200, |n| if n == 100 { delay } else { 1 }).nth(99) == Some(Age::Old));
        }
    }

    #[test]
    fn after_a_delay_grows_by_a_cycle_the_sequence_goes_on() {
        let ages: heapless::Vec<Age, 200> = judged(200, |n| if n < 100 { 1 } else { 2 }).collect();
        // In the cycle of the change the frame that was taken comes again.
        assert_eq!(ages[99], Age::Old);
        assert!(ages[100..].iter().all(|age| *age == Age::New(2)));
    }

    #[test]
    fn a_delay_that_creeps_is_seen_at_every_step_and_ends_at_five() {
        let ages: heapless::Vec<Age, 2000> = judged(2000, |n| 1 + n / 200).collect();
        let oldest =
            ages.iter().filter_map(|age| if let Age::New(n) = age { Some(*n) } else { None });
        assert_eq!(oldest.max(), Some(5));
        assert!(ages[1000..].iter().all(|age| *age == Age::Old));
    }

    #[test]
    fn a_delay_that_shrinks_by_a_cycle_is_in_step_and_by_two_is_not() {
        let ages: heapless::Vec<Age, 200> = judged(200, |n| if n < 100 { 3 } else { 2 }).collect();
        assert!(ages[3..99].iter().all(|age| *age == Age::New(3)));
        assert!(ages[99..].iter().all(|age| *age == Age::New(2)));
        let ages: heapless::Vec<Age, 200> = judged(200, |n| if n < 100 { 3 } else { 1 }).collect();
        assert_eq!(ages[99], Age::Old);
    }

    #[test]
    fn after_a_restart_any_counter_begins_the_sequence() {
        let mut judge = AgeJudge::default();
        assert_eq!(judge.take(3, Some(7), 8, MODULUS), Age::New(1));
        judge.cycle();
        assert_eq!(judge.take(12, Some(8), 9, MODULUS), Age::Old);
        // What is believed is a cycle older than it was.
        assert_eq!(judge.age_cycles(), Some(2));
        judge.restart();
        assert_eq!((judge.age_cycles(), judge.take(12, Some(8), 9, MODULUS)), (None, Age::New(1)));
    }

    #[test]
    fn a_host_that_missed_three_cycles_found_its_rig_out_of_step_for_ever() {
        for missed in 1..=4_u8 {
            let mut judge = AgeJudge::default();
            assert_eq!(judge.take(7, Some(7), 7, MODULUS), Age::New(0));
            judge.cycle();
            judge.skip(u32::from(missed));
            // The rig has answered the last command once in every cycle.
            let counter = (8 + missed) % MODULUS;
            assert_eq!(judge.take(counter, Some(8), 8, MODULUS), Age::New(0), "{missed}");
            judge.cycle();
            assert_eq!(judge.take((counter + 1) % MODULUS, Some(9), 9, MODULUS), Age::New(0));
        }
    }

    #[test]
    fn a_lost_frame_and_a_lost_command_leave_the_sequence_whole() {
        let mut judge = AgeJudge::default();
        assert_eq!(judge.take(0, Some(0), 1, MODULUS), Age::New(1));
        judge.cycle();
        // Nothing came; one cycle later the rig has sent two frames.
        judge.cycle();
        assert_eq!(judge.take(2, Some(2), 3, MODULUS), Age::New(1));
        judge.cycle();
        // A command was lost: the rig answers in time and echoes the one before.
        assert_eq!(judge.take(3, Some(2), 4, MODULUS), Age::New(2));
    }
}
