//! Frames: id, payload, and whether its CRC is repaired first, so that what lies behind the CRC is
//! reached.
//!
//! A message that is decoded and encoded again gives the same frame, and decoding that gives the
//! same message.

use can_protocol::protection::checksum;
use can_protocol::{
    Command, Measurement, Message, MessageId, Node, Profile, Receiver, ReceiverState, Seal,
    SessionCode,
};

pub(crate) fn frames(bytes: &[u8]) {
    let mut receivers = Receivers::new();
    let mut rest = bytes;
    while let Some((frame, after)) = Raw::take(rest) {
        rest = after;
        if let Ok(message) = Message::decode(frame.id, frame.data()) {
            again(&message, frame.id);
        }
        receivers.take(&frame);
    }
}

/// A message with everything in its range survives the way to a frame and back.
fn again(message: &Message, id: u16) {
    let profile = MessageId::from_raw(id).map_or(Profile::Classical, MessageId::profile);
    let (frame, saturated) = message.encode(profile);
    assert!(saturated.is_empty(), "{message}: {saturated:?} of a message that came in a frame");
    match Message::decode(frame.id(), frame.data()) {
        Ok(second) => assert_eq!(second.encode(profile).0, frame, "{message} does not stay"),
        Err(error) => panic!("{message} is encoded and cannot be decoded: {error}"),
    }
}

/// A frame as it came.
pub(crate) struct Raw {
    pub(crate) id: u16,
    length: usize,
    data: [u8; 64],
}

impl Raw {
    /// Takes a frame from the front: its id by number or as two bytes, its length, its payload.
    pub(crate) fn take(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (&[kind, first, second], rest) = bytes.split_first_chunk::<3>()?;
        let known = MessageId::all().nth(usize::from(first));
        let id = match known {
            Some(message) if kind & 1 == 0 => message.raw(),
            _ => u16::from_le_bytes([first, second]) & 0x7FF,
        };
        let message = MessageId::from_raw(id);
        let usual = message.map_or(8, MessageId::payload_len);
        let length = if kind & 2 == 0 { usual } else { usize::from(second & 63) };
        let (payload, rest) = rest.split_at(length.min(rest.len()));
        let mut raw = Self { id, length: payload.len(), data: [0; 64] };
        raw.data[..payload.len()].copy_from_slice(payload);
        if let Some(message) = message.filter(|_| kind & 4 == 0 && payload.len() == usual) {
            raw.repair(message);
        }
        Some((raw, rest))
    }

    /// Puts the right CRC in front.
    fn repair(&mut self, message: MessageId) {
        let crc = checksum(message, self.data()).to_le_bytes();
        let width = match message.profile() {
            Profile::Fd => 2,
            Profile::Classical => 1,
        };
        self.data[..width].copy_from_slice(&crc[..width]);
    }

    pub(crate) fn data(&self) -> &[u8] {
        &self.data[..self.length]
    }
}

/// Receivers of both profiles, plain and sealed.
struct Receivers {
    commands: [(Receiver<Command>, ReceiverState); 4],
    measurements: [(Receiver<Measurement>, ReceiverState); 4],
}

impl Receivers {
    fn new() -> Self {
        let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
        let kinds = [
            (Profile::Classical, false),
            (Profile::Classical, true),
            (Profile::Fd, false),
            (Profile::Fd, true),
        ];
        let sound = "a step of 5 is in the range of both profiles";
        let commands = kinds.map(|(profile, sealed)| {
            let receiver = Receiver::new(profile, Node::ALL[0], 5).expect(sound);
            (if sealed { receiver.sealed(code) } else { receiver }, ReceiverState::default())
        });
        let measurements = kinds.map(|(profile, sealed)| {
            let receiver = Receiver::new(profile, Node::ALL[0], 5).expect(sound);
            (if sealed { receiver.sealed(code) } else { receiver }, ReceiverState::default())
        });
        Self { commands, measurements }
    }

    fn take(&mut self, frame: &Raw) {
        for (receiver, state) in &mut self.commands {
            let before = state.clone();
            let taken = receiver.accept(state, frame.id, frame.data());
            assert!(taken.is_some() || *state == before, "a frame of others changed a receiver");
        }
        for (receiver, state) in &mut self.measurements {
            let before = state.clone();
            let taken = receiver.accept(state, frame.id, frame.data());
            assert!(taken.is_some() || *state == before, "a frame of others changed a receiver");
        }
        let seal = Seal { code: SessionCode::of(1, 2), cycle: u32::from(frame.id) };
        let _ = Command::decode_sealed(frame.id, frame.data(), seal);
        let _ = Measurement::decode_sealed(frame.id, frame.data(), seal);
    }
}
