//! What a receiver says of a frame: its status, its data, and how often each status occurred.
use crate::Error;
use core::fmt;

/// What a frame, or its absence, means to the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// The first valid frame of a sequence.
    Initial,
    /// Valid and next in order.
    Ok,
    /// Valid and new; fewer than `max_delta` frames before it were lost.
    SomeLost,
    /// The last frame again, bit for bit.
    Repeated,
    /// An old frame, or too many were lost.
    WrongSequence,
    /// Another content under the counter of the last frame: there are two senders.
    Conflict,
    /// The protection does not hold.
    WrongCrc,
    /// No frame in this cycle.
    NoNewData,
}

impl Status {
    /// Whether the frame's data are to be used.
    pub const fn delivers(self) -> bool {
        matches!(self, Self::Initial | Self::Ok | Self::SomeLost)
    }

    /// Whether a watchdog starts anew: only on frames that are valid and new.
    pub const fn feeds_watchdog(self) -> bool {
        self.delivers()
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Initial => "INITIAL",
            Self::Ok => "OK",
            Self::SomeLost => "SOME_LOST",
            Self::Repeated => "REPEATED",
            Self::WrongSequence => "WRONG_SEQUENCE",
            Self::Conflict => "CONFLICT",
            Self::WrongCrc => "WRONG_CRC",
            Self::NoNewData => "NO_NEW_DATA",
        })
    }
}

/// How often each status occurred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// INITIAL.
    pub initial: u64,
    /// OK.
    pub ok: u64,
    /// `SOME_LOST`.
    pub some_lost: u64,
    /// REPEATED.
    pub repeated: u64,
    /// `WRONG_SEQUENCE`.
    pub wrong_sequence: u64,
    /// CONFLICT.
    pub conflict: u64,
    /// `WRONG_CRC`.
    pub wrong_crc: u64,
    /// `NO_NEW_DATA`.
    pub no_new_data: u64,
    /// Frames that the counter steps of `SOME_LOST` say are missing.
    pub lost_frames: u64,
    /// Frames that a sealed receiver refused and that are valid plain frames.
    pub plain: u64,
}

/// The result of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reception<M> {
    /// The status.
    pub status: Status,
    /// The data, when the status delivers.
    pub data: Option<M>,
    /// What was wrong, when the status is [`Status::WrongCrc`].
    pub error: Option<Error>,
    /// Whether a sealed receiver refused the frame while it is a valid plain one: somebody sends on
    /// this id who is not armed. A damaged frame looks like that once in 256 (FD 65,536).
    pub plain: bool,
}

impl Counts {
    /// Count one status.
    pub(crate) fn count(&mut self, status: Status) {
        *match status {
            Status::Initial => &mut self.initial,
            Status::Ok => &mut self.ok,
            Status::SomeLost => &mut self.some_lost,
            Status::Repeated => &mut self.repeated,
            Status::WrongSequence => &mut self.wrong_sequence,
            Status::Conflict => &mut self.conflict,
            Status::WrongCrc => &mut self.wrong_crc,
            Status::NoNewData => &mut self.no_new_data,
        } += 1;
    }
}
