//! Numbers that look random and are the same everywhere.

/// Marsaglia's xorshift over 64 bits (Journal of Statistical Software 8, 2003).
#[derive(Debug, Clone, PartialEq)]
pub struct Random(u64);

impl Random {
    /// From a seed; zero, which would stay zero, is taken as one.
    pub(crate) const fn new(seed: u64) -> Self {
        Self(if seed == 0 { 1 } else { seed })
    }

    /// The next word.
    pub(crate) const fn word(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// The next 32 bits.
    pub(crate) const fn half(&mut self) -> u32 {
        (self.word() >> 32) as u32
    }

    /// The next byte: the upper bits are the better ones.
    pub(crate) const fn byte(&mut self) -> u8 {
        (self.word() >> 56) as u8
    }

    /// A number from -1 to below 1.
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
    pub(crate) fn within_one(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
