//! Bit fields of a payload, in either byte order.
//!
//! A DBC numbers the bits of a payload `8 byte + bit`, bit 0 being the least significant of its
//! byte. The start bit of a little-endian field is its least significant bit, that of a big-endian
//! (Motorola) field its most significant one; from there a big-endian field goes down to bit 0 of
//! its byte and on to bit 7 of the next.

/// Most bytes of a field of 64 bits that begins within a byte.
const MOST_BYTES: usize = 9;

/// Bytes of the longest frame.
const LONGEST_FRAME: usize = 64;

/// Where the bits of a signal are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Field {
    /// First byte.
    byte: usize,
    /// Bytes that it touches.
    bytes: usize,
    /// Bits right of it, in the number that those bytes make.
    shift: u32,
    /// Its length in bits.
    pub(crate) bits: u32,
    is_little_endian: bool,
}

impl Field {
    /// A field with the start bit of a DBC; `None` for a length that is not 1 to 64.
    pub(crate) const fn new(start: u32, bits: u32, is_little_endian: bool) -> Option<Self> {
        if bits == 0 || bits > 64 {
            return None;
        }
        let (byte, bit) = ((start / 8) as usize, start % 8);
        // Bits from the edge at which the field begins to that at which its last byte ends.
        let before = if is_little_endian { bit } else { 7 - bit };
        let bytes = (before + bits).div_ceil(8);
        let shift = if is_little_endian { bit } else { 8 * bytes - before - bits };
        Some(Self { byte, bytes: bytes as usize, shift, bits, is_little_endian })
    }

    /// The first byte behind it.
    pub(crate) const fn end(&self) -> usize {
        self.byte + self.bytes
    }

    /// Its bits as a number.
    pub(crate) const fn ones(&self) -> u64 {
        u64::MAX >> (64 - self.bits)
    }

    /// Reads it; `None` where the payload is too short.
    pub(crate) fn get(&self, data: &[u8]) -> Option<u64> {
        let data = data.get(self.byte..self.end())?;
        let number = data
            .iter()
            .enumerate()
            .fold(0_u128, |number, (place, byte)| number | u128::from(*byte) << self.place(place));
        Some((number >> self.shift) as u64 & self.ones())
    }

    /// Writes it; bytes that the payload does not have are left out.
    pub(crate) fn set(&self, data: &mut [u8], value: u64) {
        debug_assert!(value <= self.ones(), "{value} in {} bits", self.bits);
        debug_assert!(self.end() <= data.len(), "a field beyond {} bytes", data.len());
        let mask = u128::from(self.ones()) << self.shift;
        let number = u128::from(value & self.ones()) << self.shift;
        for place in 0..self.bytes {
            let Some(byte) = data.get_mut(self.byte + place) else { continue };
            let at = self.place(place);
            *byte = (*byte & !((mask >> at) as u8)) | (number >> at) as u8;
        }
    }

    /// Its bits in the longest frame.
    pub(crate) fn mask(&self) -> [u8; LONGEST_FRAME] {
        let mut data = [0; LONGEST_FRAME];
        if self.end() <= data.len() {
            self.set(&mut data, self.ones());
        }
        data
    }

    /// Bits right of the byte at a place.
    fn place(&self, place: usize) -> u32 {
        debug_assert!(place < self.bytes && self.bytes <= MOST_BYTES);
        let place = if self.is_little_endian { place } else { self.bytes - 1 - place };
        8 * place as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The bits of a field one by one, most significant first, as the rule in a DBC says.
    fn bits_of(start: u32, bits: u32, is_little_endian: bool) -> Vec<u32> {
        if is_little_endian {
            return (start..start + bits).rev().collect();
        }
        let down = |bit: &u32| Some(if bit.is_multiple_of(8) { bit + 15 } else { bit - 1 });
        std::iter::successors(Some(start), down).take(bits as usize).collect()
    }

    proptest! {
        #[test]
        fn a_field_is_the_bits_that_the_rule_names(
            start in 0_u32..448, bits in 1_u32..=64, is_little_endian: bool, value: u64,
            fill: [u8; 32],
        ) {
            let field = Field::new(start, bits, is_little_endian).unwrap();
            let value = value & field.ones();
            let mut data = [0_u8; 64];
            data[..32].copy_from_slice(&fill);
            let before = data;
            field.set(&mut data, value);
            prop_assert_eq!(field.get(&data), Some(value));
            let named = bits_of(start, bits, is_little_endian);
            let bit = |data: &[u8], bit: u32| data[bit as usize / 8] >> (bit % 8) & 1;
            let slowly =
                named.iter().fold(0_u64, |number, at| number << 1 | u64::from(bit(&data, *at)));
            prop_assert_eq!(slowly, value);
            for other in (0..512).filter(|bit| !named.contains(bit)) {
                prop_assert_eq!(bit(&data, other), bit(&before, other));
            }
        }
    }

    #[test]
    fn a_payload_that_is_too_short_has_no_field() {
        let field = Field::new(6, 4, true).unwrap();
        assert_eq!(field.get(&[0xFF]), None);
        assert_eq!(field.get(&[0xC0, 0x01]), Some(7));
        assert_eq!(Field::new(0, 65, true), None);
        assert_eq!(Field::new(0, 0, true), None);
    }
}
