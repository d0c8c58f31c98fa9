//! The two profiles: what differs between a classical and an FD bus, and how counters run.

/// Classical CAN (8 bytes, 1 kHz) or CAN FD (16 bytes, 2 to 4 kHz).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Profile {
    /// Classical CAN: 8 bytes, CRC-8, 4-bit counter.
    Classical,
    /// CAN FD with bit-rate switch: 16 bytes, CRC-16, 8-bit counter, time stamps.
    Fd,
}

impl Profile {
    /// Counters run from 0 up to this number, exclusive; the number itself is the code for
    /// *invalid* (counter) and *none yet* (echo).
    ///
    /// ```
    /// use can_protocol::Profile;
    /// assert_eq!(Profile::Classical.counter_modulus(), 15);
    /// assert_eq!(Profile::Fd.counter_modulus(), 255);
    /// ```
    pub const fn counter_modulus(self) -> u8 {
        match self {
            Self::Classical => 15,
            Self::Fd => 255,
        }
    }

    /// The counter of the frame after the one with `counter`.
    ///
    /// ```
    /// use can_protocol::Profile;
    /// assert_eq!(Profile::Classical.next_counter(14), 0);
    /// assert_eq!(Profile::Fd.next_counter(14), 15);
    /// ```
    pub const fn next_counter(self, counter: u8) -> u8 {
        let next = counter.saturating_add(1);
        if next >= self.counter_modulus() { 0 } else { next }
    }

    /// Frames from counter `from` to counter `to`, going forward: 0 when equal.
    ///
    /// With `from` the echo that a peer returned and `to` the counter last sent, this is the
    /// loop's delay in cycles, modulo the counter's range.
    ///
    /// ```
    /// use can_protocol::Profile;
    /// assert_eq!(Profile::Classical.counter_steps(13, 1), 3);
    /// ```
    pub const fn counter_steps(self, from: u8, to: u8) -> u8 {
        let modulus = self.counter_modulus();
        let (from, to) = (from % modulus, to % modulus);
        if to >= from { to - from } else { modulus - from + to }
    }

    /// Payload of the cyclic messages, bytes.
    pub const fn cyclic_len(self) -> usize {
        match self {
            Self::Classical => 8,
            Self::Fd => 16,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_visits_every_code_but_the_invalid_one() {
        for profile in [Profile::Classical, Profile::Fd] {
            let mut counter = 0;
            for step in 0..profile.counter_modulus() {
                assert_eq!(counter, step);
                let next = profile.next_counter(counter);
                assert_eq!(profile.counter_steps(counter, next), 1);
                assert_eq!(profile.counter_steps(0, counter), step);
                counter = next;
            }
            assert_eq!(counter, 0);
            assert_eq!(profile.next_counter(255), 0, "an invalid counter starts afresh");
        }
    }
}
