//! The receiver: one status for every frame, and for every cycle without one.
//!
//! | status | when | data | watchdog |
//! | --- | --- | --- | --- |
//! | INITIAL | the first valid frame, or the second in a row of a new sequence | yes | fed |
//! | OK | the counter moved by 1 | yes | fed |
//! | `SOME_LOST` | the counter moved by 2 to `max_delta` | yes | fed |
//! | REPEATED | the counter did not move | no | not fed |
//! | `WRONG_SEQUENCE` | the counter moved further: an old frame, or a restarted sender | no | not fed |
//! | `WRONG_CRC` | CRC, length or a reserved code is wrong: not a frame of this peer | no | not fed |
//! | `NO_NEW_DATA` | a cycle without any frame | no | not fed |
//!
//! An old frame therefore changes nothing but a count. A sender that restarted is taken up again
//! when two of its frames follow each other with no accepted frame in between; that is INITIAL
//! once more, and a run state above must decide whether to trust it.
use crate::{Command, Error, Measurement, MessageId, Node, Profile};
use core::fmt;
use core::marker::PhantomData;

/// What a frame, or its absence, means to the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// The first valid frame of a sequence.
    Initial,
    /// Valid and next in order.
    Ok,
    /// Valid and new; fewer than `max_delta` frames before it were lost.
    SomeLost,
    /// The counter of the last frame again.
    Repeated,
    /// An old frame, or too many were lost.
    WrongSequence,
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
            Self::WrongCrc => "WRONG_CRC",
            Self::NoNewData => "NO_NEW_DATA",
        })
    }
}

/// A message that a receiver can follow: the command and the measurement.
pub trait Cyclic: Sized {
    /// The message's id.
    fn message_id(profile: Profile, node: Node) -> MessageId;
    /// The message in a frame.
    ///
    /// # Errors
    /// What the message's own `decode` finds.
    fn decode_frame(id: u16, data: &[u8]) -> Result<Self, Error>;
    /// The frame's sequence number.
    fn counter(&self) -> u8;
}

impl Cyclic for Command {
    fn message_id(profile: Profile, node: Node) -> MessageId {
        MessageId::Command(profile, node)
    }
    fn decode_frame(id: u16, data: &[u8]) -> Result<Self, Error> {
        Self::decode(id, data)
    }
    fn counter(&self) -> u8 {
        self.counter
    }
}

impl Cyclic for Measurement {
    fn message_id(profile: Profile, node: Node) -> MessageId {
        MessageId::Measurement(profile, node)
    }
    fn decode_frame(id: u16, data: &[u8]) -> Result<Self, Error> {
        Self::decode(id, data)
    }
    fn counter(&self) -> u8 {
        self.counter
    }
}

/// Follows one cyclic message of one node.
///
/// ```
/// use can_protocol::{Command, Mode, Node, Profile, Receiver, ReceiverState, RunState, Status};
/// let node = Node::new(2)?;
/// let receiver = Receiver::<Command>::new(Profile::Classical, node, 5)?;
/// let mut state = ReceiverState::default();
/// let command = Command {
///     node, counter: 0, state: RunState::Run, mode: Mode::Hold, echo: None,
///     displacement_m: None, velocity_m_per_s: None, time_us: None,
/// };
/// let (frame, _) = command.encode(Profile::Classical);
/// let first = receiver.accept(&mut state, frame.id(), frame.data()).unwrap();
/// assert_eq!((first.status, first.data), (Status::Initial, Some(command)));
/// let again = receiver.accept(&mut state, frame.id(), frame.data()).unwrap();
/// assert_eq!((again.status, again.data), (Status::Repeated, None));
/// assert_eq!(receiver.no_frame(&mut state), Status::NoNewData);
/// assert_eq!(state.echo(), Some(0));
/// # Ok::<(), can_protocol::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Receiver<M> {
    profile: Profile,
    node: Node,
    max_delta: u8,
    message: PhantomData<M>,
}

/// Memory of a [`Receiver`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReceiverState {
    /// Counter of the last accepted frame.
    last: Option<u8>,
    /// Counter of the last frame out of sequence, while nothing was accepted since.
    candidate: Option<u8>,
    counts: Counts,
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
    /// `WRONG_CRC`.
    pub wrong_crc: u64,
    /// `NO_NEW_DATA`.
    pub no_new_data: u64,
    /// Frames that the counter steps of `SOME_LOST` say are missing.
    pub lost_frames: u64,
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
}

impl ReceiverState {
    /// The counter to echo to the peer.
    pub fn echo(&self) -> Option<u8> {
        self.last
    }

    /// How often each status occurred.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}

impl<M: Cyclic> Receiver<M> {
    /// A receiver that accepts counter steps up to `max_delta`; 1 tolerates no loss.
    ///
    /// # Errors
    /// [`Error::MaxDeltaRange`] outside 1 to 7 (FD: 127): half the counter's range, so that an old
    /// frame cannot pass for a new one.
    pub const fn new(profile: Profile, node: Node, max_delta: u8) -> Result<Self, Error> {
        let upper = profile.counter_modulus() / 2;
        if max_delta == 0 || max_delta > upper {
            return Err(Error::MaxDeltaRange { value: max_delta, upper });
        }
        Ok(Self { profile, node, max_delta, message: PhantomData })
    }

    /// The message that is followed.
    pub fn message_id(&self) -> MessageId {
        M::message_id(self.profile, self.node)
    }

    /// Judge one frame. `None`: another id, not for this receiver, and nothing changed.
    pub fn accept(&self, state: &mut ReceiverState, id: u16, data: &[u8]) -> Option<Reception<M>> {
        if id != self.message_id().raw() {
            return None;
        }
        Some(match M::decode_frame(id, data) {
            Ok(message) => {
                let status = self.judge(state, message.counter());
                Reception { status, data: status.delivers().then_some(message), error: None }
            }
            Err(error) => {
                state.counts.wrong_crc += 1;
                Reception { status: Status::WrongCrc, data: None, error: Some(error) }
            }
        })
    }

    /// Note that a cycle passed without any frame.
    pub fn no_frame(&self, state: &mut ReceiverState) -> Status {
        state.counts.no_new_data += 1;
        Status::NoNewData
    }

    /// The status of a valid frame by its counter.
    fn judge(&self, state: &mut ReceiverState, counter: u8) -> Status {
        debug_assert!(
            self.max_delta >= 1 && self.max_delta <= self.profile.counter_modulus() / 2,
            "max_delta {}",
            self.max_delta
        );
        debug_assert!(counter < self.profile.counter_modulus(), "counter {counter}");
        let step = |from| self.profile.counter_steps(from, counter);
        let counts = &mut state.counts;
        let status = match state.last.map(step) {
            None => Status::Initial,
            Some(0) => Status::Repeated,
            Some(1) => Status::Ok,
            Some(steps) if steps <= self.max_delta => {
                counts.lost_frames += u64::from(steps) - 1;
                Status::SomeLost
            }
            Some(_) if state.candidate.map(step) == Some(1) => Status::Initial,
            Some(_) => Status::WrongSequence,
        };
        *match status {
            Status::Initial => &mut counts.initial,
            Status::Ok => &mut counts.ok,
            Status::SomeLost => &mut counts.some_lost,
            Status::Repeated => &mut counts.repeated,
            Status::WrongSequence => &mut counts.wrong_sequence,
            Status::WrongCrc => &mut counts.wrong_crc,
            Status::NoNewData => &mut counts.no_new_data,
        } += 1;
        if status.delivers() {
            (state.last, state.candidate) = (Some(counter), None);
        } else if status == Status::WrongSequence {
            state.candidate = Some(counter);
        }
        debug_assert!(
            !status.delivers() || (state.last == Some(counter) && state.candidate.is_none()),
            "what delivers data is the last frame"
        );
        debug_assert!(state.last.is_some(), "a frame was accepted before or is now");
        status
    }
}
