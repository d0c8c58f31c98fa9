//! A signal of a frame: raw bits to a physical value and back.
//!
//! ```text
//! physical = raw factor + offset
//! ```
//!
//! The raw number is unsigned, signed in two's complement, or an IEEE float of 32 or 64 bits
//! (`SIG_VALTYPE_`). A raw number is rounded to the nearest, ties to even. A value beyond what the
//! bits or the limits of the DBC hold is saturated when it is written, and is no value when it is
//! read. Equal limits mean none.

use crate::field::Field;
use crate::multiplex::Presence;

/// How the bits are a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Unsigned,
    Signed,
    Float32,
    Float64,
}

/// A signal, ready to be read from a payload and written into one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    pub(crate) field: Field,
    pub(crate) kind: Kind,
    pub(crate) factor: f64,
    pub(crate) offset: f64,
    /// Lowest and highest physical value; none without limits.
    pub(crate) limits: Option<(f64, f64)>,
    pub(crate) presence: Presence,
}

/// What a payload has of a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Another page of a multiplexed message, or a payload that is too short.
    Absent,
    /// Not a number, or beyond the limits of the DBC.
    Invalid,
    /// The physical value, in the unit of the DBC.
    Valid(f64),
}

/// How a value fits into a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fit {
    /// To the resolution of the signal.
    Fits,
    /// It was beyond what the signal holds: the nearest that it holds was written.
    Saturated,
    /// Not a number: nothing was written.
    NotANumber,
}

impl Signal {
    /// The physical value in a payload.
    pub fn read(&self, data: &[u8]) -> Value {
        let Some(raw) = self.read_raw(data) else { return Value::Absent };
        let value = self.value_of(raw);
        let (low, high) = self.limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        // A limit is often the last raw value, to as many digits as its author liked.
        let margin = 0.5 * self.resolution();
        if value.is_finite() && value >= low - margin && value <= high + margin {
            Value::Valid(value)
        } else {
            Value::Invalid
        }
    }

    /// The bits in a payload as a number: for counters and codes.
    pub fn read_raw(&self, data: &[u8]) -> Option<u64> {
        let raw = self.field.get(data)?;
        self.presence.is_in(data).then_some(raw)
    }

    /// The physical value of raw bits, within the limits of the DBC or not.
    pub fn value_of(&self, raw: u64) -> f64 {
        let number = match self.kind {
            Kind::Unsigned => raw as f64,
            Kind::Signed => self.signed(raw) as f64,
            Kind::Float32 => f64::from(f32::from_bits(raw as u32)),
            Kind::Float64 => f64::from_bits(raw),
        };
        number * self.factor + self.offset
    }

    /// The raw bits of a physical value, to the resolution of the signal; `None` for one that it
    /// does not hold.
    pub fn raw_of(&self, value: f64) -> Option<u64> {
        match self.nearest(value) {
            (raw, Fit::Fits) => Some(raw),
            _ => None,
        }
    }

    /// The lowest and the highest physical value that bits and limits hold.
    pub fn range(&self) -> (f64, f64) {
        let ends = [f64::NEG_INFINITY, f64::INFINITY].map(|end| self.value_of(self.nearest(end).0));
        (ends[0].min(ends[1]), ends[0].max(ends[1]))
    }

    /// Writes a physical value, and the selectors of a multiplexed signal.
    pub fn write(&self, data: &mut [u8], value: f64) -> Fit {
        let (raw, fit) = self.nearest(value);
        if fit != Fit::NotANumber {
            self.write_raw(data, raw);
        }
        fit
    }

    /// Writes bits as they are; those that do not fit are left out.
    pub fn write_raw(&self, data: &mut [u8], raw: u64) {
        self.presence.select(data);
        self.field.set(data, raw & self.field.ones());
    }

    /// How many values a counter in this signal has: up to the upper limit of the DBC, or as many
    /// as its bits hold.
    ///
    /// ```
    /// let text = "BO_ 1 M: 1 R\n SG_ C : 0|4@1+ (1,0) [0|14] \"\" H\n";
    /// let database = dbc::Database::from_text("a.dbc".as_ref(), text)?;
    /// assert_eq!(database.signal("C")?.1.signal.modulus(), 15);
    /// # Ok::<(), dbc::DbcError>(())
    /// ```
    pub fn modulus(&self) -> u64 {
        let all = self.field.ones();
        let last = match self.limits {
            Some((_, high)) => ((high - self.offset) / self.factor).clamp(0.0, all as f64) as u64,
            None => all,
        };
        last.min(all).saturating_add(1)
    }

    /// Step from one value to the next (physical).
    pub fn resolution(&self) -> f64 {
        match self.kind {
            Kind::Unsigned | Kind::Signed => self.factor.abs(),
            Kind::Float32 | Kind::Float64 => 0.0,
        }
    }

    /// Whether its bits are a whole number that is not negative, as those of a counter are.
    pub fn is_whole(&self) -> bool {
        self.kind == Kind::Unsigned
    }

    /// Whether it is in every frame of its message.
    pub fn is_always_there(&self) -> bool {
        self.presence.is_always()
    }

    /// The first byte behind it.
    pub(crate) fn end(&self) -> usize {
        self.field.end()
    }

    /// The raw bits nearest to a physical value, and how it fits.
    fn nearest(&self, value: f64) -> (u64, Fit) {
        if value.is_nan() {
            return (0, Fit::NotANumber);
        }
        let (low, high) = self.limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let held = value.clamp(low, high);
        let (raw, is_cut) = self.raw((held - self.offset) / self.factor);
        (raw, if is_cut || held != value { Fit::Saturated } else { Fit::Fits })
    }

    /// The raw bits nearest to a number, and whether that was cut.
    fn raw(&self, number: f64) -> (u64, bool) {
        let ones = self.field.ones();
        match self.kind {
            Kind::Unsigned => {
                let whole = number.round_ties_even();
                // A conversion saturates.
                let raw = (whole as u64).min(ones);
                (raw, whole < 0.0 || whole > ones as f64)
            }
            Kind::Signed => {
                let (low, high) = (-((ones >> 1) as i64) - 1, (ones >> 1) as i64);
                let whole = number.round_ties_even();
                let raw = (whole as i64).clamp(low, high);
                (raw as u64 & ones, whole < low as f64 || whole > high as f64)
            }
            Kind::Float32 => {
                let most = f64::from(f32::MAX);
                let held = number.clamp(-most, most);
                (u64::from((held as f32).to_bits()), held != number)
            }
            Kind::Float64 => {
                let held = number.clamp(f64::MIN, f64::MAX);
                (held.to_bits(), held != number)
            }
        }
    }

    /// The bits in two's complement.
    fn signed(&self, raw: u64) -> i64 {
        let unused = 64 - self.field.bits;
        ((raw << unused) as i64) >> unused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(bits: u32, kind: Kind, factor: f64, limits: Option<(f64, f64)>) -> Signal {
        let field = Field::new(0, bits, true).unwrap();
        Signal { field, kind, factor, offset: 0.0, limits, presence: Presence::default() }
    }

    fn round_trip(signal: &Signal, value: f64) -> (Fit, Value) {
        let mut data = [0; 8];
        (signal.write(&mut data, value), signal.read(&data))
    }

    #[test]
    fn a_value_beyond_the_bits_is_saturated_and_never_wraps() {
        let unsigned = signal(8, Kind::Unsigned, 0.1, None);
        assert_eq!(round_trip(&unsigned, 60.0), (Fit::Saturated, Value::Valid(25.5)));
        assert_eq!(round_trip(&unsigned, -0.2), (Fit::Saturated, Value::Valid(0.0)));
        let signed = signal(8, Kind::Signed, 1.0, None);
        assert_eq!(round_trip(&signed, 128.0), (Fit::Saturated, Value::Valid(127.0)));
        assert_eq!(round_trip(&signed, -1e30), (Fit::Saturated, Value::Valid(-128.0)));
        let whole = signal(64, Kind::Signed, 1.0, None);
        assert_eq!(round_trip(&whole, -1e30), (Fit::Saturated, Value::Valid(-(2_f64.powi(63)))));
        let float = signal(32, Kind::Float32, 1.0, None);
        let most = f64::from(f32::MAX);
        assert_eq!(round_trip(&float, f64::INFINITY), (Fit::Saturated, Value::Valid(most)));
    }

    #[test]
    fn limits_of_the_dbc_hold_both_ways() {
        let limited = signal(16, Kind::Signed, 0.01, Some((-50.0, 50.0)));
        assert_eq!(round_trip(&limited, 50.004), (Fit::Saturated, Value::Valid(50.0)));
        let mut data = [0; 8];
        limited.write_raw(&mut data, 5001);
        assert_eq!(limited.read(&data), Value::Invalid);
        // 65.535 is not 65535 times 0.001 in binary.
        let exact = signal(16, Kind::Unsigned, 0.001, Some((0.0, 65.535)));
        exact.write_raw(&mut data, 65_535);
        assert!(matches!(exact.read(&data), Value::Valid(_)));
    }

    #[test]
    fn bits_and_limits_make_the_range() {
        let signed = signal(8, Kind::Signed, -0.5, None);
        assert_eq!(signed.range(), (-63.5, 64.0));
        assert_eq!(Signal { limits: Some((-1.0, 1000.0)), ..signed }.range(), (-1.0, 64.0));
        assert_eq!((signed.raw_of(64.0), signed.raw_of(64.5)), (Some(0x80), None));
        assert_eq!((signed.raw_of(f64::NAN), signed.raw_of(f64::INFINITY)), (None, None));
        assert_eq!(signed.value_of(0x80), 64.0);
    }

    #[test]
    fn not_a_number_is_neither_written_nor_read() {
        let float = signal(64, Kind::Float64, 1.0, None);
        let mut data = [1; 8];
        assert_eq!(float.write(&mut data, f64::NAN), Fit::NotANumber);
        assert_eq!(data, [1; 8]);
        float.write_raw(&mut data, f64::NAN.to_bits());
        assert_eq!(float.read(&data), Value::Invalid);
        assert_eq!(float.read(&[0; 4]), Value::Absent);
    }

    #[test]
    fn ties_go_to_the_even_raw_number() {
        let half = signal(8, Kind::Unsigned, 1.0, None);
        assert_eq!(round_trip(&half, 2.5).1, Value::Valid(2.0));
        assert_eq!(round_trip(&half, 3.5).1, Value::Valid(4.0));
        assert_eq!(half.modulus(), 256);
        assert_eq!(signal(64, Kind::Unsigned, 1.0, None).modulus(), u64::MAX);
    }
}
