//! A message on a bus, and the time of its frame.

use can_protocol::{
    classical_extended_frame_bits, classical_frame_bits, fd_extended_frame_bits, fd_frame_bits,
};

/// A message as a bus carries it.
#[derive(Debug, Clone, PartialEq)]
pub struct BusMessage {
    /// Its name.
    pub name: String,
    /// Its id, 11 or 29 bits.
    pub id: u32,
    /// Whether the id has 29 bits.
    pub is_extended: bool,
    /// Payload, bytes.
    pub bytes: u32,
    /// Whether it is an FD frame.
    pub is_fd: bool,
    /// Whether its data go at the data bit rate.
    pub switches_rate: bool,
    /// Time from one to the next (s); `None` where it is sent on demand.
    pub period_s: Option<f64>,
}

/// Bit rates of a bus (bit/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BitRates {
    /// Nominal.
    pub nominal_bits_per_s: f64,
    /// Behind the switch of FD frames; without meaning where there are none.
    pub data_bits_per_s: f64,
}

impl BitRates {
    /// Time of a nominal bit, rounded up (ns).
    pub(super) fn bit_ns(&self) -> u64 {
        (1e9 / self.nominal_bits_per_s).ceil() as u64
    }

    /// Time of the longest frame of a message, rounded up (ns).
    ///
    /// ```
    /// use hil_host::doctor::{BitRates, BusMessage, response_times};
    /// let rates = BitRates { nominal_bits_per_s: 1e6, data_bits_per_s: 5e6 };
    /// let extended = BusMessage {
    ///     name: "TORQUE".to_owned(),
    ///     id: 0x18FF_0001,
    ///     is_extended: true,
    ///     bytes: 8,
    ///     is_fd: false,
    ///     switches_rate: false,
    ///     period_s: Some(0.01),
    /// };
    /// let found = response_times(&[extended], &rates);
    /// assert_eq!(found.messages[0].frame_us, 160.0);
    /// ```
    pub(super) fn frame_ns(&self, message: &BusMessage) -> u64 {
        let (nominal, data) = match (message.is_fd, message.is_extended) {
            (false, false) => (classical_frame_bits(message.bytes), 0),
            (false, true) => (classical_extended_frame_bits(message.bytes), 0),
            (true, false) => fd_frame_bits(fd_length(message.bytes)),
            (true, true) => fd_extended_frame_bits(fd_length(message.bytes)),
        };
        let data_rate =
            if message.switches_rate { self.data_bits_per_s } else { self.nominal_bits_per_s };
        let time_s = f64::from(nominal) / self.nominal_bits_per_s + f64::from(data) / data_rate;
        // A multiple of a nanosecond is not rounded up by the error of its division.
        (time_s * 1e9 - 1e-3).ceil() as u64
    }
}

/// The next length that FD knows.
fn fd_length(bytes: u32) -> u32 {
    let lengths = [12, 16, 20, 24, 32, 48, 64];
    lengths.into_iter().find(|length| bytes > 8 && bytes <= *length).unwrap_or(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_fd_does_not_know_are_filled_up() {
        for (bytes, length) in [(0, 0), (8, 8), (9, 12), (12, 12), (33, 48), (64, 64)] {
            assert_eq!(fd_length(bytes), length);
        }
    }
}
