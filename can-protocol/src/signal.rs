//! Signals: bit fields of a payload and the fixed-point values in them.
//!
//! A payload of up to 16 bytes is one little-endian number ([`Word`]): bit `i` of byte `k` is bit
//! `8 k + i` of the number, so a field is a shift and a mask and cannot miss the payload.
//! A physical value is `code x lsb`, two's complement, rounded half to even. The codes span
//! `-(2^(n-1) - 1)` to `2^(n-1) - 1`; what lies beyond takes the nearest of them and is reported;
//! the most negative code `-2^(n-1)` means *invalid*.
use crate::wire_enum::WireEnum;
use crate::{Error, MessageId};

bitflags::bitflags! {
    /// What did not fit when a frame was encoded. Physical values then sit at the end of their
    /// range (NaN: at the invalid code), counters at their invalid code; nothing wraps.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Saturated: u8 {
        /// The displacement.
        const DISPLACEMENT = 1;
        /// The velocity.
        const VELOCITY = 1 << 1;
        /// The force.
        const FORCE = 1 << 2;
        /// The temperature.
        const TEMPERATURE = 1 << 3;
        /// The counter, or the echo, is beyond the profile's range.
        const COUNTER = 1 << 4;
        /// A sample of the track.
        const TRACK = 1 << 5;
    }
}

/// A run of bits in the payload, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    start_bit: u32,
    bits: u32,
}

impl Field {
    /// Only for the layout constants: a field that does not fit stops the build.
    pub(crate) const fn new(start_bit: u32, bits: u32) -> Self {
        assert!(bits >= 1 && bits <= 32 && start_bit + bits <= 128);
        Self { start_bit, bits }
    }

    /// Position of the least significant bit.
    pub const fn start_bit(self) -> u32 {
        self.start_bit
    }

    /// Width in bits, 1 to 32.
    pub const fn bits(self) -> u32 {
        self.bits
    }

    /// The code of all ones.
    pub const fn ones(self) -> u32 {
        u32::MAX >> (32 - self.bits)
    }
}

/// The physical quantity of a fixed-point signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Metres here, millimetres in the DBC.
    Displacement,
    /// Metres per second here, millimetres per second in the DBC.
    Velocity,
    /// Newtons.
    Force,
    /// Degrees Celsius.
    Temperature,
}

/// A signed physical value in a [`Field`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPoint {
    field: Field,
    /// Codes per SI unit: a whole number, so that a decimal lsb such as 0.1 µm is exact.
    lsb_per_unit: f64,
    quantity: Quantity,
}

impl FixedPoint {
    pub(crate) const fn new(
        start_bit: u32,
        bits: u32,
        lsb_per_unit: u32,
        quantity: Quantity,
    ) -> Self {
        Self { field: Field::new(start_bit, bits), lsb_per_unit: lsb_per_unit as f64, quantity }
    }

    /// Where it sits.
    pub const fn field(self) -> Field {
        self.field
    }

    /// Codes per SI unit (per degree Celsius for a temperature).
    pub const fn lsb_per_unit(self) -> f64 {
        self.lsb_per_unit
    }

    /// What it is.
    pub const fn quantity(self) -> Quantity {
        self.quantity
    }

    /// The largest code; the smallest valid one is its negative.
    pub const fn max_code(self) -> i32 {
        (self.field.ones() >> 1) as i32
    }

    /// The code that means *invalid*, the most negative one.
    pub const fn invalid_code(self) -> i32 {
        -self.max_code() - 1
    }

    /// The largest value, in SI; the smallest is its negative.
    pub fn max_value(self) -> f64 {
        f64::from(self.max_code()) / self.lsb_per_unit
    }

    /// The code of a value, and whether the value had to be saturated. NaN becomes invalid and is
    /// reported as well.
    pub fn code(self, value: Option<f64>) -> (i32, bool) {
        let Some(value) = value else { return (self.invalid_code(), false) };
        debug_assert!(self.lsb_per_unit >= 1.0, "{} codes per unit", self.lsb_per_unit);
        let limit = self.max_code();
        let code = libm::rint(value * self.lsb_per_unit);
        if code.is_nan() {
            (self.invalid_code(), true)
        } else if code > f64::from(limit) {
            (limit, true)
        } else if code < f64::from(-limit) {
            (-limit, true)
        } else {
            (code as i32, false)
        }
    }

    /// The value of a code, `None` when invalid.
    pub fn value(self, code: i32) -> Option<f64> {
        debug_assert!(
            code >= self.invalid_code() && code <= self.max_code(),
            "code {code} in {} bits",
            self.field.bits
        );
        (code != self.invalid_code()).then(|| f64::from(code) / self.lsb_per_unit)
    }
}

/// A payload as one little-endian number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Word(u128);

impl Word {
    /// The number of a payload of at most 16 bytes.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        debug_assert!(bytes.len() <= 16, "a payload of {} bytes", bytes.len());
        let mut padded = [0; 16];
        for (to, from) in padded.iter_mut().zip(bytes) {
            *to = *from;
        }
        Self(u128::from_le_bytes(padded))
    }

    /// The payload of the number.
    pub const fn to_bytes(self) -> [u8; 16] {
        self.0.to_le_bytes()
    }

    /// Write a code over a field that is still zero; bits beyond the field are cut.
    pub const fn put(&mut self, field: Field, code: u32) {
        debug_assert!(self.get(field) == 0, "a field is written once");
        self.0 |= ((code & field.ones()) as u128) << field.start_bit;
    }

    /// Read a field.
    pub const fn get(self, field: Field) -> u32 {
        (self.0 >> field.start_bit) as u32 & field.ones()
    }

    /// Write a physical value; true when it had to be saturated.
    pub fn put_fixed(&mut self, signal: FixedPoint, value: Option<f64>) -> bool {
        let (code, saturated) = signal.code(value);
        self.put(signal.field, code as u32);
        saturated
    }

    /// Read a physical value.
    pub fn get_fixed(self, signal: FixedPoint) -> Option<f64> {
        let unused = 32 - signal.field.bits;
        signal.value(((self.get(signal.field) << unused) as i32) >> unused)
    }

    /// Write a counter or an echo. The field's code of all ones stands for *none*; a number beyond
    /// the counter's range becomes that too, and is reported.
    pub fn put_counter(&mut self, field: Field, counter: Option<u8>) -> bool {
        let code = counter.map_or(field.ones(), u32::from).min(field.ones());
        self.put(field, code);
        counter.is_some() && code == field.ones()
    }

    /// Read a counter or an echo.
    pub fn get_counter(self, field: Field) -> Option<u8> {
        let code = self.get(field);
        (code != field.ones()).then_some(code as u8)
    }

    /// The counter of a message: a frame without one is refused.
    pub(crate) fn counter(self, message: MessageId, field: Field) -> Result<u8, Error> {
        let (id, code) = (message.raw(), self.get(field));
        self.get_counter(field).ok_or(Error::ReservedCode { id, field: "counter", code })
    }

    /// The value of a code in a message: a frame with a reserved code is refused.
    pub(crate) fn code<T: WireEnum>(self, message: MessageId, field: Field) -> Result<T, Error> {
        let (id, code) = (message.raw(), self.get(field));
        T::of_code(code).ok_or(Error::ReservedCode { id, field: T::FIELD, code })
    }

    /// Write a time, modulo the field's range. All ones mean *none*, so a time that lands on that
    /// code is sent one microsecond early.
    pub fn put_time(&mut self, field: Field, time_us: Option<u32>) {
        let none = field.ones();
        self.put(field, time_us.map_or(none, |time_us| (time_us & none).min(none - 1)));
    }

    /// Read a time.
    pub fn get_time(self, field: Field) -> Option<u32> {
        let code = self.get(field);
        (code != field.ones()).then_some(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORCE: FixedPoint = FixedPoint::new(16, 20, 5, Quantity::Force);

    #[test]
    fn halves_round_to_the_even_code() {
        for (force_n, code) in
            [(0.1, 0), (0.3, 2), (0.5, 2), (0.7, 4), (-0.1, 0), (-0.3, -2), (-0.5, -2)]
        {
            assert_eq!(FORCE.code(Some(force_n)), (code, false), "{force_n} N");
        }
    }

    #[test]
    fn a_value_beyond_the_range_saturates_and_says_so() {
        let limit = 524_287;
        assert_eq!(FORCE.max_value(), 104_857.4);
        assert_eq!(FORCE.code(Some(104_857.4)), (limit, false));
        assert_eq!(FORCE.code(Some(104_857.49)), (limit, false), "within half an lsb");
        assert_eq!(FORCE.code(Some(104_857.6)), (limit, true));
        assert_eq!(FORCE.code(Some(-104_857.6)), (-limit, true), "not the invalid code");
        assert_eq!(FORCE.code(Some(f64::INFINITY)), (limit, true));
        assert_eq!(FORCE.code(Some(f64::NEG_INFINITY)), (-limit, true));
        assert_eq!(FORCE.code(Some(f64::MAX)), (limit, true));
    }

    #[test]
    fn the_most_negative_code_means_invalid() {
        assert_eq!(FORCE.code(None), (-524_288, false));
        assert_eq!(FORCE.code(Some(f64::NAN)), (-524_288, true));
        assert_eq!(FORCE.value(-524_288), None);
        assert_eq!(FORCE.value(-524_287), Some(-104_857.4));
    }

    #[test]
    fn fields_of_all_widths_keep_to_their_bits() {
        for bits in 1..=32 {
            for start_bit in [0, 3, 64, 96] {
                let field = Field::new(start_bit, bits);
                let mut word = Word::default();
                word.put(field, u32::MAX);
                assert_eq!(word.get(field), field.ones());
                assert_eq!(word.0.count_ones(), bits);
                assert_eq!(word.0.trailing_zeros(), start_bit);
            }
        }
    }

    #[test]
    fn a_time_on_the_none_code_is_sent_one_microsecond_early() {
        let field = Field::new(104, 24);
        for (time_us, read) in [
            (Some(5), Some(5)),
            (Some(0x0100_0005), Some(5)),
            (Some(0x00FF_FFFF), Some(0x00FF_FFFE)),
            (None, None),
        ] {
            let mut word = Word::default();
            word.put_time(field, time_us);
            assert_eq!(word.get_time(field), read);
        }
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "a field is written once")]
    fn a_field_that_is_written_twice_stops_a_debug_build() {
        let mut word = Word::default();
        word.put(Field::new(8, 4), 3);
        word.put(Field::new(8, 4), 4);
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "a payload of 17 bytes")]
    fn a_payload_that_is_too_long_stops_a_debug_build() {
        let _ = Word::from_bytes(&[0; 17]);
    }
}
