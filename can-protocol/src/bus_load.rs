//! Bus load from worst-case frame lengths, known before a run.
//!
//! A classical frame of `n` bytes with an 11-bit id has at most
//! `8 n + 47 + floor((34 + 8 n - 1) / 4)` bits: 47 of overhead with the 3 of the interframe space,
//! and a stuff bit for every 4 of the 34 + 8 n that are stuffed (8 bytes: 135). A 29-bit id has 20
//! more, all of them stuffed: 18 of the id, SRR and IDE or RRS (8 bytes: 160). This protocol has
//! none; the buses of others do.
//!
//! An FD frame with bit-rate switch has a slow and a fast part. Slow: 17 bits from start of frame
//! to BRS and 13 from the CRC delimiter to the interframe space. Fast: ESI, 4 bits of length, the
//! data, 4 bits of stuff count, CRC (17 bits up to 16 bytes, else 21) and its fixed stuff bits (6
//! or 7). Dynamic stuff bits, at most one per 4 bits from start of frame to the last data bit,
//! count where they fall: 4 slow ones, the rest fast.
//!
//! Real frames are shorter (about a tenth on average); error frames and retransmissions come on
//! top. So the cyclic pair should stay below half of the bus.
use crate::{MessageId, Node, Profile, Sender};
use core::fmt;

/// What a load means for a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// At most 50 %.
    Accept,
    /// Above 50 %: one retransmission may already delay a cycle.
    Warn,
    /// Above 80 %, or no number at all.
    Refuse,
}

impl Verdict {
    /// The verdict on a share of the bus.
    pub fn of(load: f64) -> Self {
        match load {
            load if load <= 0.5 => Self::Accept,
            load if load <= 0.8 => Self::Warn,
            _ => Self::Refuse,
        }
    }
}

/// What is to run over one bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusPlan {
    /// The profile of commands and measurements.
    pub profile: Profile,
    /// Rigs on this bus.
    pub rigs: u8,
    /// Cycles per second.
    pub rate_hz: f64,
    /// Nominal bit rate, bit/s.
    pub nominal_bits_per_s: f64,
    /// Bit rate behind the switch, bit/s; without meaning for the classical profile.
    pub data_bits_per_s: f64,
}

impl BusPlan {
    /// Worst-case share of the bus that commands and measurements take.
    ///
    /// ```
    /// use can_protocol::{BusPlan, Profile, Verdict};
    /// let one_rig = BusPlan {
    ///     profile: Profile::Classical,
    ///     rigs: 1,
    ///     rate_hz: 1000.0,
    ///     nominal_bits_per_s: 1e6,
    ///     data_bits_per_s: 5e6,
    /// };
    /// assert!((one_rig.cyclic_load() - 0.270).abs() < 1e-12);
    /// assert_eq!(one_rig.verdict(), Verdict::Accept);
    /// assert_eq!(BusPlan { rigs: 4, ..one_rig }.verdict(), Verdict::Refuse);
    /// ```
    pub fn cyclic_load(&self) -> f64 {
        let node = Node::ALL[0];
        let pair_s = self.frame_time_s(MessageId::Command(self.profile, node))
            + self.frame_time_s(MessageId::Measurement(self.profile, node));
        f64::from(self.rigs) * self.rate_hz * pair_s
    }

    /// Worst-case share of sync, heartbeats, telemetry and residuals at their usual rates; faults
    /// not counted.
    pub fn background_load(&self) -> f64 {
        let node = Node::ALL[0];
        let share = |message: MessageId| {
            let per_s = message.nominal_period_us().map_or(0.0, |us| 1e6 / f64::from(us));
            per_s * self.frame_time_s(message)
        };
        share(MessageId::Sync)
            + share(MessageId::Heartbeat(Sender::Host))
            + f64::from(self.rigs)
                * (share(MessageId::Heartbeat(Sender::Rig(node)))
                    + share(MessageId::Telemetry(node))
                    + share(MessageId::Residual(node)))
    }

    /// The verdict on [`BusPlan::cyclic_load`].
    pub fn verdict(&self) -> Verdict {
        Verdict::of(self.cyclic_load())
    }

    /// Longest time of one frame of a message on this bus, s.
    pub fn frame_time_s(&self, message: MessageId) -> f64 {
        let bytes = message.payload_len() as u32;
        match message.profile() {
            Profile::Classical => f64::from(classical_frame_bits(bytes)) / self.nominal_bits_per_s,
            Profile::Fd => {
                let (nominal, data) = fd_frame_bits(bytes);
                f64::from(nominal) / self.nominal_bits_per_s
                    + f64::from(data) / self.data_bits_per_s
            }
        }
    }
}

/// One line for before a run.
impl fmt::Display for BusPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { profile, rigs, rate_hz, nominal_bits_per_s, data_bits_per_s } = self;
        write!(f, "bus load {:.1} % worst case", 100.0 * self.cyclic_load())?;
        write!(f, " (and {:.1} % of slow messages)", 100.0 * self.background_load())?;
        write!(f, ": {rigs} rig(s) at {rate_hz:.0} Hz, ")?;
        match profile {
            Profile::Classical => write!(f, "classical {} kbit/s", nominal_bits_per_s / 1e3),
            Profile::Fd => {
                write!(f, "FD {}/{} kbit/s", nominal_bits_per_s / 1e3, data_bits_per_s / 1e3)
            }
        }
    }
}

/// Most bits of a classical frame with an 11-bit id, interframe space included.
///
/// ```
/// assert_eq!(can_protocol::classical_frame_bits(8), 135);
/// ```
pub const fn classical_frame_bits(bytes: u32) -> u32 {
    8 * bytes + 47 + (34 + 8 * bytes - 1) / 4
}

/// Most bits of an FD frame with an 11-bit id: at the nominal rate, and behind the switch.
///
/// ```
/// let (nominal, data) = can_protocol::fd_frame_bits(16);
/// assert_eq!((nominal, data), (34, 193)); // 34 + 193 / 5 = 72.6 us at 1/5 Mbit/s
/// ```
pub const fn fd_frame_bits(bytes: u32) -> (u32, u32) {
    fd_bits(17, bytes)
}

/// Most bits of a classical frame with a 29-bit id, interframe space included.
///
/// ```
/// assert_eq!(can_protocol::classical_extended_frame_bits(8), 160);
/// ```
pub const fn classical_extended_frame_bits(bytes: u32) -> u32 {
    8 * bytes + 67 + (54 + 8 * bytes - 1) / 4
}

/// Most bits of an FD frame with a 29-bit id: at the nominal rate, and behind the switch.
///
/// ```
/// let (nominal, data) = can_protocol::fd_extended_frame_bits(8);
/// assert_eq!((nominal, data), (57, 114)); // 18 more of the id, SRR, and their stuff bits
/// ```
pub const fn fd_extended_frame_bits(bytes: u32) -> (u32, u32) {
    fd_bits(36, bytes)
}

/// Bits of an FD frame with `head` bits from start of frame to BRS.
const fn fd_bits(head: u32, bytes: u32) -> (u32, u32) {
    let (crc, fixed_stuff) = if bytes <= 16 { (17, 6) } else { (21, 7) };
    let tail = 13;
    let length_and_data = 1 + 4 + 8 * bytes;
    let stuff = (head + length_and_data - 1) / 4;
    let slow_stuff = (head - 1) / 4;
    (head + tail + slow_stuff, length_and_data + 4 + crc + fixed_stuff + stuff - slow_stuff)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Profile::{Classical, Fd};

    #[test]
    fn classical_frames_take_the_published_time() {
        for (bytes, bits) in [(1, 65), (2, 75), (6, 115), (8, 135)] {
            assert_eq!(classical_frame_bits(bytes), bits);
        }
    }

    #[test]
    fn a_long_id_takes_its_bits_and_their_stuff_bits() {
        // Davis and others (2007): 55 + 10 n bits with an 11-bit id, 80 + 10 n with a 29-bit id.
        for bytes in 0..=8 {
            assert_eq!(classical_frame_bits(bytes), 55 + 10 * bytes);
            assert_eq!(classical_extended_frame_bits(bytes), 80 + 10 * bytes);
        }
        for bytes in [8, 16, 32, 64] {
            let (short, long) = (fd_frame_bits(bytes), fd_extended_frame_bits(bytes));
            // 19 bits more, with 4 stuff bits before BRS and one that may fall behind it.
            assert_eq!(long.0 - short.0, 19 + 4);
            assert!(long.1.abs_diff(short.1) <= 1);
        }
    }

    #[test]
    fn fd_frames_take_the_tabled_time() {
        // Bytes, data rate in Mbit/s, µs at a nominal 1 Mbit/s.
        for (bytes, rate, time_us) in [
            (8, 5.0, 56.6),
            (8, 8.0, 48.1),
            (16, 2.0, 130.5),
            (16, 5.0, 72.6),
            (16, 8.0, 58.1),
            (32, 5.0, 105.6),
            (32, 8.0, 78.8),
            (64, 5.0, 169.6),
            (64, 8.0, 118.8),
        ] {
            let (nominal, data) = fd_frame_bits(bytes);
            let found = f64::from(nominal) + f64::from(data) / rate;
            assert!((found - time_us).abs() < 0.051, "{bytes} bytes at {rate}: {found} us");
        }
    }

    #[test]
    fn the_load_of_the_cyclic_pair_is_as_tabled() {
        let plan = |profile, rigs, rate_hz, data_bits_per_s| BusPlan {
            profile,
            rigs,
            rate_hz,
            nominal_bits_per_s: 1e6,
            data_bits_per_s,
        };
        for (plan, percent, verdict) in [
            (plan(Classical, 1, 1e3, 5e6), 27.0, Verdict::Accept),
            (plan(Classical, 1, 2e3, 5e6), 54.0, Verdict::Warn),
            (plan(Classical, 1, 4e3, 5e6), 108.0, Verdict::Refuse),
            (plan(Classical, 2, 1e3, 5e6), 54.0, Verdict::Warn),
            (plan(Classical, 4, 1e3, 5e6), 108.0, Verdict::Refuse),
            (plan(Fd, 1, 1e3, 5e6), 14.5, Verdict::Accept),
            (plan(Fd, 1, 2e3, 5e6), 29.0, Verdict::Accept),
            (plan(Fd, 1, 4e3, 5e6), 58.1, Verdict::Warn),
            (plan(Fd, 1, 5e3, 5e6), 72.6, Verdict::Warn),
            (plan(Fd, 1, 4e3, 8e6), 46.5, Verdict::Accept),
            (plan(Fd, 4, 1e3, 5e6), 58.1, Verdict::Warn),
            (plan(Fd, 4, 1e3, 8e6), 46.5, Verdict::Accept),
        ] {
            let found = 100.0 * plan.cyclic_load();
            assert!((found - percent).abs() < 0.051, "{plan:?}: {found} %");
            assert_eq!(plan.verdict(), verdict, "{plan:?}");
        }
    }

    #[test]
    fn a_plan_without_a_bit_rate_is_refused() {
        let plan = BusPlan {
            profile: Profile::Fd,
            rigs: 1,
            rate_hz: 1e3,
            nominal_bits_per_s: 1e6,
            data_bits_per_s: 0.0,
        };
        assert_eq!(plan.verdict(), Verdict::Refuse);
        assert_eq!(BusPlan { data_bits_per_s: f64::NAN, ..plan }.verdict(), Verdict::Refuse);
    }

    #[test]
    fn slow_messages_stay_small() {
        let plan = BusPlan {
            profile: Profile::Classical,
            rigs: 1,
            rate_hz: 1e3,
            nominal_bits_per_s: 1e6,
            data_bits_per_s: 1e6,
        };
        // Sync 10 x 135, two heartbeats 50 x 135, telemetry and residual 20 x 115, all per million.
        let expected = (1350.0 + 2.0 * 6750.0 + 2.0 * 2300.0) * 1e-6;
        assert!((plan.background_load() - expected).abs() < 1e-12);
    }
}
