//! FNV-1a over words: the same number for the same content, today and with the next compiler.
//!
//! ```text
//! h = (h xor word) * 0x100000001b3, from 0xcbf29ce484222325
//! ```

/// The hash of nothing.
pub const START: u64 = 0xcbf2_9ce4_8422_2325;

/// Adds a word, or a byte.
///
/// ```
/// use firmware_core::fnv::{START, add};
/// // The published test vector of one byte "a".
/// assert_eq!(add(START, u64::from(b'a')), 0xaf63_dc4c_8601_ec8c);
/// ```
#[inline]
pub const fn add(hash: u64, word: u64) -> u64 {
    (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3)
}
