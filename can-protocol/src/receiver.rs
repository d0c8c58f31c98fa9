//! The receiver: one status for every frame, and for every cycle without one.
//!
//! | status | when | data | watchdog |
//! | --- | --- | --- | --- |
//! | INITIAL | the first valid frame; plain also the second in a row of a new sequence | yes | fed |
//! | OK | the counter moved by 1 | yes | fed |
//! | `SOME_LOST` | the counter moved by 2 to `max_delta` | yes | fed |
//! | REPEATED | the last frame again, bit for bit | no | not fed |
//! | CONFLICT | another content under the counter of the last frame | no | not fed |
//! | `WRONG_SEQUENCE` | the counter moved further: an old frame, or a restarted sender | no | not fed |
//! | `WRONG_CRC` | CRC, length or a reserved code is wrong: not a frame of this peer | no | not fed |
//! | `NO_NEW_DATA` | a cycle without any frame | no | not fed |
//!
//! An old frame therefore changes nothing but a count. A receiver is plain or sealed:
//!
//! - **Plain**: it knows the peer by the `DataID` alone. A sender that restarted is taken up again
//!   when two of its frames follow each other with no accepted frame in between; that is INITIAL
//!   once more, and a run state above must decide whether to trust it.
//! - **Sealed** ([`Receiver::sealed`]): it knows the session's code and counts the sender's cycles
//!   from 0. A frame's cycle is the last accepted one plus the step of the counter, 0 to 14 (FD 0
//!   to 254), and its CRC must be sealed with that cycle. With the cycle one roll-over earlier it
//!   is an old frame, `WRONG_SEQUENCE`; with any other it is `WRONG_CRC`. A sender that restarted
//!   is never taken up again. A refused frame is tried as a plain one ([`Reception::plain`]):
//!   evidence of a second sender.
use crate::reception::{Counts, Reception, Status};
use crate::signal::{Field, Word};
use crate::{
    Command, CommandLayout, Error, Measurement, MeasurementLayout, MessageId, Node, Profile, Seal,
    SessionCode,
};
use core::marker::PhantomData;

/// A message that a receiver can follow: the command and the measurement.
pub trait Cyclic: Sized {
    /// The message's id.
    fn message_id(profile: Profile, node: Node) -> MessageId;
    /// The field of the counter.
    fn counter_field(profile: Profile) -> Field;
    /// The message in a plain frame, or in one with this seal.
    ///
    /// # Errors
    /// What the message's own `decode` or `decode_sealed` finds.
    fn decode_frame(id: u16, data: &[u8], seal: Option<Seal>) -> Result<Self, Error>;
    /// The frame's sequence number.
    fn counter(&self) -> u8;
}

impl Cyclic for Command {
    fn message_id(profile: Profile, node: Node) -> MessageId {
        MessageId::Command(profile, node)
    }
    fn counter_field(profile: Profile) -> Field {
        CommandLayout::of(profile).counter
    }
    fn decode_frame(id: u16, data: &[u8], seal: Option<Seal>) -> Result<Self, Error> {
        match seal {
            Some(seal) => Self::decode_sealed(id, data, seal),
            None => Self::decode(id, data),
        }
    }
    fn counter(&self) -> u8 {
        self.counter
    }
}

impl Cyclic for Measurement {
    fn message_id(profile: Profile, node: Node) -> MessageId {
        MessageId::Measurement(profile, node)
    }
    fn counter_field(profile: Profile) -> Field {
        MeasurementLayout::of(profile).counter
    }
    fn decode_frame(id: u16, data: &[u8], seal: Option<Seal>) -> Result<Self, Error> {
        match seal {
            Some(seal) => Self::decode_sealed(id, data, seal),
            None => Self::decode(id, data),
        }
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
///
/// The same in an armed session:
///
/// ```
/// # use can_protocol::{Command, Mode, Node, Profile, Receiver, ReceiverState, RunState, Status};
/// # use can_protocol::{Seal, SessionCode};
/// # let node = Node::new(2)?;
/// # let command = Command {
/// #     node, counter: 0, state: RunState::Run, mode: Mode::Hold, echo: None,
/// #     displacement_m: None, velocity_m_per_s: None, time_us: None,
/// # };
/// let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
/// let receiver = Receiver::<Command>::new(Profile::Classical, node, 5)?.sealed(code);
/// let mut state = ReceiverState::default();
/// let (frame, _) = command.encode_sealed(Profile::Classical, Seal { code, cycle: 0 });
/// let first = receiver.accept(&mut state, frame.id(), frame.data()).unwrap();
/// assert_eq!(first.status, Status::Initial);
/// let (foreign, _) = command.encode(Profile::Classical);
/// let refused = receiver.accept(&mut state, foreign.id(), foreign.data()).unwrap();
/// assert_eq!((refused.status, refused.plain), (Status::WrongCrc, true));
/// # Ok::<(), can_protocol::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Receiver<M> {
    profile: Profile,
    node: Node,
    max_delta: u8,
    /// The session's code; `None` for a plain receiver.
    session: Option<SessionCode>,
    message: PhantomData<M>,
}

/// Memory of a [`Receiver`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReceiverState {
    /// Counter of the last accepted frame.
    last: Option<u8>,
    /// Cycle of the last accepted frame; sealed only.
    cycle: Option<u32>,
    /// Payload of the last accepted frame.
    payload: Word,
    /// Counter of the last frame out of sequence, while nothing was accepted since; plain only.
    candidate: Option<u8>,
    counts: Counts,
}

impl ReceiverState {
    /// The counter to echo to the peer.
    pub fn echo(&self) -> Option<u8> {
        self.last
    }

    /// The sender's number of the last accepted frame, for a sealed receiver.
    pub fn cycle(&self) -> Option<u32> {
        self.cycle
    }

    /// How often each status occurred.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}

impl<M: Cyclic> Receiver<M> {
    /// A plain receiver that accepts counter steps up to `max_delta`; 1 tolerates no loss.
    ///
    /// # Errors
    /// [`Error::MaxDeltaRange`] outside 1 to 7 (FD: 127): half the counter's range, so that an old
    /// frame cannot pass for a new one.
    pub const fn new(profile: Profile, node: Node, max_delta: u8) -> Result<Self, Error> {
        let upper = profile.counter_modulus() / 2;
        if max_delta == 0 || max_delta > upper {
            return Err(Error::MaxDeltaRange { value: max_delta, upper });
        }
        Ok(Self { profile, node, max_delta, session: None, message: PhantomData })
    }

    /// The same receiver for an armed session. It needs a fresh [`ReceiverState`] and expects the
    /// sender's cycle 0.
    #[must_use]
    pub fn sealed(mut self, code: SessionCode) -> Self {
        self.session = Some(code);
        self
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
        let judged = match self.session {
            None => M::decode_frame(id, data, None)
                .map(|read| (self.judge(state, read.counter()), read)),
            Some(code) => self.open_sealed(state, code, id, data),
        };
        let (status, message) = match judged {
            Ok((status, read)) => (status, Ok(read)),
            Err(error) => (Status::WrongCrc, Err(error)),
        };
        let payload = Word::from_bytes(data.get(..data.len().min(16)).unwrap_or(data));
        let status = match status {
            Status::Repeated if payload != state.payload => Status::Conflict,
            status => status,
        };
        if status.delivers() {
            state.payload = payload;
        }
        let refused = self.session.is_some() && status == Status::WrongCrc;
        let plain = refused && M::decode_frame(id, data, None).is_ok();
        state.counts.count(status);
        state.counts.plain += u64::from(plain);
        Some(Reception {
            status,
            error: message.as_ref().err().copied(),
            data: message.ok().filter(|_| status.delivers()),
            plain,
        })
    }

    /// Note that a cycle passed without any frame.
    pub fn no_frame(&self, state: &mut ReceiverState) -> Status {
        state.counts.count(Status::NoNewData);
        Status::NoNewData
    }

    /// The counter of a payload that may be anything.
    fn counter_in(&self, data: &[u8]) -> u8 {
        let known = data.get(..data.len().min(16)).unwrap_or(data);
        Word::from_bytes(known).get(M::counter_field(self.profile)) as u8
    }

    /// A frame of an armed session: at the cycle that its counter gives, else one roll-over ago.
    fn open_sealed(
        &self,
        state: &mut ReceiverState,
        code: SessionCode,
        id: u16,
        data: &[u8],
    ) -> Result<(Status, M), Error> {
        let counter = self.counter_in(data);
        let modulus = u32::from(self.profile.counter_modulus());
        // Steps from the last accepted frame, or from the one before cycle 0.
        let (steps, cycle) = match (state.cycle, state.last) {
            (Some(cycle), Some(last)) => {
                let steps = u32::from(self.profile.counter_steps(last, counter));
                // A cycle number beyond 32 bits has no frame: the session is over.
                (steps, cycle.saturating_add(steps))
            }
            _ => (u32::from(counter) + 1, u32::from(counter)),
        };
        let decode = |cycle| M::decode_frame(id, data, Some(Seal { code, cycle }));
        match decode(cycle) {
            Ok(read) => Ok((self.judge_sealed(state, steps, cycle, counter), read)),
            Err(error) => {
                let old = cycle.checked_sub(modulus).filter(|_| steps > 0);
                match old.map(decode) {
                    Some(Ok(read)) => Ok((Status::WrongSequence, read)),
                    _ => Err(error),
                }
            }
        }
    }

    /// The status of a valid frame of an armed session.
    fn judge_sealed(
        &self,
        state: &mut ReceiverState,
        steps: u32,
        cycle: u32,
        counter: u8,
    ) -> Status {
        let status = match (state.cycle, steps) {
            (_, 0) => Status::Repeated,
            (_, steps) if steps > u32::from(self.max_delta) => Status::WrongSequence,
            (None, _) => Status::Initial,
            (Some(_), 1) => Status::Ok,
            (Some(_), _) => Status::SomeLost,
        };
        if status.delivers() {
            state.counts.lost_frames += u64::from(steps) - 1;
            (state.last, state.cycle) = (Some(counter), Some(cycle));
        }
        status
    }

    /// The status of a valid plain frame by its counter.
    fn judge(&self, state: &mut ReceiverState, counter: u8) -> Status {
        debug_assert!(
            self.max_delta >= 1 && self.max_delta <= self.profile.counter_modulus() / 2,
            "max_delta {}",
            self.max_delta
        );
        debug_assert!(counter < self.profile.counter_modulus(), "counter {counter}");
        let step = |from| self.profile.counter_steps(from, counter);
        let status = match state.last.map(step) {
            None => Status::Initial,
            Some(0) => Status::Repeated,
            Some(1) => Status::Ok,
            Some(steps) if steps <= self.max_delta => {
                state.counts.lost_frames += u64::from(steps) - 1;
                Status::SomeLost
            }
            Some(_) if state.candidate.map(step) == Some(1) => Status::Initial,
            Some(_) => Status::WrongSequence,
        };
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
