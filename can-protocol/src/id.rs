//! The nodes on the bus and the ids of their messages.
//!
//! Ids are ordered by urgency, since the lower id wins: pressure off, sync, commands, measurements,
//! faults, telemetry, residuals, track, arming, heartbeats. The `DataID` that enters a frame's CRC
//! is `0x5000 + id`, so that a frame sent under a wrong id fails its check.
use crate::{Error, Profile, TrackPart};
use core::fmt;

/// The number of a rig, 1 to 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(u8);

impl Node {
    /// All four rigs.
    pub const ALL: [Self; 4] = [Self(1), Self(2), Self(3), Self(4)];

    /// The rig of this number.
    ///
    /// # Errors
    /// [`Error::NodeRange`] outside 1 to 4.
    pub const fn new(value: u8) -> Result<Self, Error> {
        if value >= 1 && value <= 4 { Ok(Self(value)) } else { Err(Error::NodeRange { value }) }
    }

    /// The number, 1 to 4.
    pub const fn number(self) -> u8 {
        self.0
    }
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Sender of a message that both sides have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sender {
    /// The model's side, number 0.
    Host,
    /// A rig.
    Rig(Node),
}

impl Sender {
    /// 0 for the host, else the rig's number.
    pub const fn number(self) -> u8 {
        match self {
            Self::Host => 0,
            Self::Rig(node) => node.number(),
        }
    }

    /// The sender of a number.
    ///
    /// # Errors
    /// [`Error::NodeRange`] above 4.
    pub const fn new(number: u8) -> Result<Self, Error> {
        match (number, Node::new(number)) {
            (0, _) => Ok(Self::Host),
            (_, Ok(node)) => Ok(Self::Rig(node)),
            (_, Err(error)) => Err(error),
        }
    }
}

impl fmt::Display for Sender {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Host => f.write_str("HOST"),
            Self::Rig(node) => node.fmt(f),
        }
    }
}

/// A message of the protocol, as its frame id states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MessageId {
    /// `0x040 + n`, n = 0 for all rigs: the host asks to drop the pressure.
    PressureOff(Option<Node>),
    /// `0x080`: period, pace and time, from the host to all rigs.
    Sync,
    /// `0x100 + n`, FD `0x110 + n`: the host commands a rig.
    Command(Profile, Node),
    /// `0x200 + n`, FD `0x210 + n`: a rig answers.
    Measurement(Profile, Node),
    /// `0x300 + n`: what went wrong, on change.
    Fault(Sender),
    /// `0x400 + n`: slow values of a rig.
    Telemetry(Node),
    /// `0x500 + n`: how far a rig's damper is from its model, from the host.
    Residual(Node),
    /// `0x540`: a locomotive asks for its track.
    TrackRequest,
    /// `0x541`: a track server says which track it has.
    TrackOffer,
    /// `0x542` and `0x543`: a track server hands over half a sample.
    TrackSample(TrackPart),
    /// `0x600 + n`: the host asks a rig in the arming exchange.
    ArmRequest(Node),
    /// `0x610 + n`: the rig answers.
    ArmAnswer(Node),
    /// `0x700 + n`: alive, and in which state.
    Heartbeat(Sender),
}

impl MessageId {
    /// The 11-bit frame id.
    ///
    /// ```
    /// use can_protocol::{MessageId, Node, Profile};
    /// assert_eq!(MessageId::Measurement(Profile::Fd, Node::new(3)?).raw(), 0x213);
    /// # Ok::<(), can_protocol::Error>(())
    /// ```
    pub const fn raw(self) -> u16 {
        let (base, number) = match self {
            Self::PressureOff(None) => (0x040, 0),
            Self::PressureOff(Some(node)) => (0x040, node.number()),
            Self::Sync => (0x080, 0),
            Self::Command(Profile::Classical, node) => (0x100, node.number()),
            Self::Command(Profile::Fd, node) => (0x110, node.number()),
            Self::Measurement(Profile::Classical, node) => (0x200, node.number()),
            Self::Measurement(Profile::Fd, node) => (0x210, node.number()),
            Self::Fault(sender) => (0x300, sender.number()),
            Self::Telemetry(node) => (0x400, node.number()),
            Self::Residual(node) => (0x500, node.number()),
            Self::TrackRequest => (0x540, 0),
            Self::TrackOffer => (0x540, 1),
            Self::TrackSample(TrackPart::CentreLine) => (0x540, 2),
            Self::TrackSample(TrackPart::Rails) => (0x540, 3),
            Self::ArmRequest(node) => (0x600, node.number()),
            Self::ArmAnswer(node) => (0x610, node.number()),
            Self::Heartbeat(sender) => (0x700, sender.number()),
        };
        base + number as u16
    }

    /// The message of a frame id, `None` when it is not ours.
    pub fn from_raw(id: u16) -> Option<Self> {
        let number = (id & 0xF) as u8;
        let node = Node::new(number).ok();
        let sender = Sender::new(number).ok();
        match id & !0xF {
            0x040 if number == 0 => Some(Self::PressureOff(None)),
            0x040 => node.map(|node| Self::PressureOff(Some(node))),
            0x080 if number == 0 => Some(Self::Sync),
            0x100 => node.map(|node| Self::Command(Profile::Classical, node)),
            0x110 => node.map(|node| Self::Command(Profile::Fd, node)),
            0x200 => node.map(|node| Self::Measurement(Profile::Classical, node)),
            0x210 => node.map(|node| Self::Measurement(Profile::Fd, node)),
            0x300 => sender.map(Self::Fault),
            0x400 => node.map(Self::Telemetry),
            0x500 => node.map(Self::Residual),
            0x540 => match number {
                0 => Some(Self::TrackRequest),
                1 => Some(Self::TrackOffer),
                2 => Some(Self::TrackSample(TrackPart::CentreLine)),
                3 => Some(Self::TrackSample(TrackPart::Rails)),
                _ => None,
            },
            0x600 => node.map(Self::ArmRequest),
            0x610 => node.map(Self::ArmAnswer),
            0x700 => sender.map(Self::Heartbeat),
            _ => None,
        }
    }

    /// Every message of every node in both profiles, in the order of their ids.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..=0x7FF).filter_map(Self::from_raw)
    }

    /// Whether only a host sends it.
    pub const fn is_of_host(self) -> bool {
        match self {
            Self::PressureOff(_)
            | Self::Sync
            | Self::Command(..)
            | Self::Residual(_)
            | Self::TrackRequest
            | Self::ArmRequest(_)
            | Self::Fault(Sender::Host)
            | Self::Heartbeat(Sender::Host) => true,
            Self::Measurement(..)
            | Self::Telemetry(_)
            | Self::TrackOffer
            | Self::TrackSample(_)
            | Self::ArmAnswer(_)
            | Self::Fault(Sender::Rig(_))
            | Self::Heartbeat(Sender::Rig(_)) => false,
        }
    }

    /// Whether it is between a locomotive and its track server: no rig sends or reads it.
    pub const fn is_of_track(self) -> bool {
        matches!(self, Self::TrackRequest | Self::TrackOffer | Self::TrackSample(_))
    }

    /// The number that enters the CRC in front of the payload: `0x5000 + id`.
    pub const fn data_id(self) -> u16 {
        0x5000 + self.raw()
    }

    /// Payload length, bytes.
    pub const fn payload_len(self) -> usize {
        match self {
            Self::Sync
            | Self::TrackRequest
            | Self::TrackOffer
            | Self::TrackSample(_)
            | Self::ArmRequest(_)
            | Self::ArmAnswer(_)
            | Self::Heartbeat(_) => 8,
            Self::Command(profile, _) | Self::Measurement(profile, _) => profile.cyclic_len(),
            Self::PressureOff(_) | Self::Fault(_) | Self::Telemetry(_) | Self::Residual(_) => 6,
        }
    }

    /// The frame format: FD (with bit-rate switch) only for the FD variants of the cyclic pair.
    pub const fn profile(self) -> Profile {
        match self {
            Self::Command(profile, _) | Self::Measurement(profile, _) => profile,
            _ => Profile::Classical,
        }
    }

    /// Usual time between two frames in µs; `None` when sent on change. For the cyclic pair the
    /// sync message rules; these are 1 kHz classical and 2 kHz FD.
    pub const fn nominal_period_us(self) -> Option<u32> {
        match self {
            Self::Sync => Some(100_000),
            Self::Command(Profile::Classical, _) | Self::Measurement(Profile::Classical, _) => {
                Some(1_000)
            }
            Self::Command(Profile::Fd, _) | Self::Measurement(Profile::Fd, _) => Some(500),
            Self::PressureOff(_)
            | Self::Fault(_)
            | Self::TrackRequest
            | Self::TrackOffer
            | Self::TrackSample(_)
            | Self::ArmRequest(_)
            | Self::ArmAnswer(_) => None,
            Self::Telemetry(_) | Self::Residual(_) => Some(50_000),
            Self::Heartbeat(_) => Some(20_000),
        }
    }
}

/// The message's name in the DBC.
impl fmt::Display for MessageId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PressureOff(None) => f.write_str("PRESSURE_OFF_ALL"),
            Self::PressureOff(Some(node)) => write!(f, "PRESSURE_OFF_{node}"),
            Self::Sync => f.write_str("SYNC"),
            Self::Command(Profile::Classical, node) => write!(f, "CMD_{node}"),
            Self::Command(Profile::Fd, node) => write!(f, "CMD_FD_{node}"),
            Self::Measurement(Profile::Classical, node) => write!(f, "MEAS_{node}"),
            Self::Measurement(Profile::Fd, node) => write!(f, "MEAS_FD_{node}"),
            Self::Fault(sender) => write!(f, "FAULT_{sender}"),
            Self::Telemetry(node) => write!(f, "TELEMETRY_{node}"),
            Self::Residual(node) => write!(f, "RESIDUAL_{node}"),
            Self::TrackRequest => f.write_str("TRACK_REQUEST"),
            Self::TrackOffer => f.write_str("TRACK_OFFER"),
            Self::TrackSample(TrackPart::CentreLine) => f.write_str("TRACK_CENTRE_LINE"),
            Self::TrackSample(TrackPart::Rails) => f.write_str("TRACK_RAILS"),
            Self::ArmRequest(node) => write!(f, "ARM_REQUEST_{node}"),
            Self::ArmAnswer(node) => write!(f, "ARM_ANSWER_{node}"),
            Self::Heartbeat(sender) => write!(f, "HEARTBEAT_{sender}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_messages_are_one_to_one() {
        for id in 0..=u16::MAX {
            if let Some(message) = MessageId::from_raw(id) {
                assert_eq!(message.raw(), id);
            }
        }
        // 5 pressure off, sync, 4 x (command + measurement) x 2, 5 faults, 4 telemetry,
        // 4 residuals, 4 of track, 4 x (request + answer) of arming, 5 heartbeats.
        assert_eq!(MessageId::all().count(), 5 + 1 + 16 + 5 + 4 + 4 + 4 + 8 + 5);
    }

    #[test]
    fn pressure_off_sync_commands_and_measurements_win_the_bus() {
        let rank = |message| match message {
            MessageId::PressureOff(_) => 0,
            MessageId::Sync => 1,
            MessageId::Command(..) => 2,
            MessageId::Measurement(..) => 3,
            _ => 4,
        };
        assert!(MessageId::all().is_sorted_by_key(rank));
    }
}
