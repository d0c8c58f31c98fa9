//! The sealed receiver with real frames: its statuses, and the odds that the docs state, counted.
use crate::support::samples;
use can_protocol::{
    Command, Frame, Mode, Node, Profile, Receiver, ReceiverState, RunState, Seal, SessionCode,
    SessionHistory, Status,
};
use proptest::prelude::*;

use Profile::{Classical, Fd};
use Status::{Conflict, Initial, Ok as Accepted, Repeated, SomeLost, WrongCrc, WrongSequence};

const NODE: Node = Node::ALL[0];
/// Host and rig of the running session, of one before it, and of one more.
const NUMBERS: [(u32, u32); 3] = [(0x1234_5678, 0xDEAD_BEEF), (1, 2), (0xFFFF_FFFF, 0)];

fn code(session: usize) -> SessionCode {
    SessionCode::of(NUMBERS[session].0, NUMBERS[session].1)
}

fn command(displacement_m: f64) -> Command {
    Command {
        node: NODE,
        counter: 0,
        state: RunState::Run,
        mode: Mode::Follow,
        echo: Some(3),
        displacement_m: Some(displacement_m),
        velocity_m_per_s: None,
        time_us: None,
    }
}

fn frame(profile: Profile, code: SessionCode, cycle: u32) -> Frame {
    let displacement_m = f64::from(cycle % 100) * 1e-5;
    command(displacement_m).encode_sealed(profile, Seal { code, cycle }).0
}

/// A sealed receiver and its memory.
struct Armed {
    receiver: Receiver<Command>,
    state: ReceiverState,
}

impl Armed {
    fn new(profile: Profile, code: SessionCode) -> Self {
        let receiver = Receiver::new(profile, NODE, 5).expect("5 is in range").sealed(code);
        Self { receiver, state: ReceiverState::default() }
    }

    /// Status, and whether the frame is a valid plain one.
    fn hear(&mut self, frame: &Frame) -> (Status, bool) {
        let reception = self.receiver.accept(&mut self.state, frame.id(), frame.data());
        let reception = reception.expect("our own id");
        assert_eq!(reception.data.is_some(), reception.status.delivers());
        assert_eq!(reception.error.is_some(), reception.status == WrongCrc);
        (reception.status, reception.plain)
    }

    fn status(&mut self, frame: &Frame) -> Status {
        self.hear(frame).0
    }
}

#[test]
fn a_session_in_order_over_many_roll_overs() {
    for profile in [Classical, Fd] {
        let mut armed = Armed::new(profile, code(0));
        for cycle in 0..20_000 {
            let expected = if cycle == 0 { Initial } else { Accepted };
            assert_eq!(armed.status(&frame(profile, code(0), cycle)), expected, "{cycle}");
            assert_eq!(armed.state.cycle(), Some(cycle));
        }
        assert_eq!(armed.state.counts().ok, 19_999);
    }
}

#[test]
fn losses_old_frames_and_repeats() {
    let mut armed = Armed::new(Classical, code(0));
    let of = |cycle| frame(Classical, code(0), cycle);
    for (cycle, expected) in [
        (2, Initial), // 0 and 1 are missing
        (3, Accepted),
        (3, Repeated),
        (8, SomeLost),       // 4 to 7
        (14, WrongSequence), // a step of 6
        (7, WrongSequence),
        (3, WrongSequence),
        (9, Accepted),
        (13, SomeLost),
        (18, SomeLost), // over the roll-over
        (13, WrongSequence),
        (4, WrongSequence), // 14 cycles old, the oldest within a roll-over
        (3, WrongCrc),      // 15 cycles old: the counter of the last frame, another roll-over
        (19, Accepted),
    ] {
        assert_eq!(armed.status(&of(cycle)), expected, "{cycle}");
    }
    assert_eq!(armed.state.counts().lost_frames, 2 + 4 + 3 + 4);
}

#[test]
fn another_content_under_the_last_counter_is_a_conflict() {
    let seal = Seal { code: code(0), cycle: 0 };
    for profile in [Classical, Fd] {
        for sealed in [true, false] {
            let receiver = Receiver::<Command>::new(profile, NODE, 5).unwrap();
            let receiver = if sealed { receiver.sealed(code(0)) } else { receiver };
            let mut armed = Armed { receiver, state: ReceiverState::default() };
            let of = |displacement_m| {
                let command = command(displacement_m);
                let encoded = if sealed {
                    command.encode_sealed(profile, seal)
                } else {
                    command.encode(profile)
                };
                encoded.0
            };
            assert_eq!(armed.status(&of(1e-3)), Initial);
            assert_eq!(armed.status(&of(1e-3)), Repeated);
            assert_eq!(armed.status(&of(2e-3)), Conflict);
            assert_eq!(armed.status(&of(1e-3)), Repeated, "the first content stays the last one");
            let counts = armed.state.counts();
            assert_eq!((counts.repeated, counts.conflict), (2, 1));
        }
    }
    assert_eq!(Conflict.to_string(), "CONFLICT");
    assert!(!Conflict.delivers() && !Conflict.feeds_watchdog());
}

#[test]
fn a_restarted_sender_is_never_taken_up_again() {
    let mut armed = Armed::new(Classical, code(0));
    for cycle in 0..1000 {
        armed.status(&frame(Classical, code(0), cycle));
    }
    // Cycles 0 to 999 once more, and then a sender that knows no session.
    for cycle in 0..1000 {
        let status = armed.status(&frame(Classical, code(0), cycle));
        assert!(!status.delivers(), "{cycle} {status}");
    }
    // One of its roll-overs had the mask 0, that of a plain frame.
    assert_eq!(armed.state.counts().plain, 15);
    for cycle in 0..200 {
        let plain = Command { counter: cycle % 15, ..command(0.0) }.encode(Classical).0;
        assert_eq!(armed.hear(&plain), (WrongCrc, true));
    }
    assert_eq!(armed.state.counts().plain, 215);
    assert_eq!(armed.status(&frame(Classical, code(0), 1000)), Accepted);
}

#[test]
fn the_session_ends_before_its_cycle_number_does() {
    let last = u32::MAX;
    let seal = Seal { code: code(0), cycle: last };
    let (frame, _) = command(0.0).encode_sealed(Fd, seal);
    assert_eq!(Command::decode_sealed(frame.id(), frame.data(), seal).unwrap().counter, 0);
}

/// Of all frames of a session that are a multiple of the modulus old, one in 256 (FD 65,536)
/// passes, and none of the first 255 (65,535).
#[test]
fn a_frame_of_15_cycles_ago_fails_in_255_of_256_cases() {
    for (profile, masks, origins) in [(Classical, 256_u32, 400), (Fd, 65_536, 3)] {
        let modulus = u32::from(profile.counter_modulus());
        for (session, origin) in
            (0..3).flat_map(|session| (0..origins).map(move |at| (session, at)))
        {
            let old = frame(profile, code(session), origin);
            let passes = |age: u32| {
                let seal = Seal { code: code(session), cycle: origin + age * modulus };
                Command::decode_sealed(old.id(), old.data(), seal).is_ok()
            };
            let turns: u32 = if profile == Classical { 4 } else { 1 };
            let passed: Vec<u32> = (1..=turns * masks).filter(|age| passes(*age)).collect();
            let expected: Vec<u32> = (1..=turns).map(|turn| turn * masks).collect();
            assert_eq!(passed, expected, "{profile:?} session {session} cycle {origin}");
        }
    }
}

/// Of all CRCs that a foreign frame may carry, one passes: 1 in 256 (FD 65,536).
#[test]
fn a_foreign_frame_passes_by_chance_once_in_256() {
    for (profile, bytes, masks) in [(Classical, 1, 256_u32), (Fd, 2, 65_536)] {
        for cycle in [0, 1, 14, 254, 3840, 1_000_000] {
            let foreign = command(0.05).encode_sealed(profile, Seal { code: code(2), cycle }).0;
            let mut data = foreign.data().to_vec();
            let seal = Seal { code: code(0), cycle };
            let mut passed = 0;
            for crc in 0..masks {
                data[..bytes].copy_from_slice(&crc.to_le_bytes()[..bytes]);
                passed += u32::from(Command::decode_sealed(foreign.id(), &data, seal).is_ok());
            }
            assert_eq!(passed, 1, "{profile:?} {cycle}");
        }
    }
}

/// Every pair of roll-overs of two sessions: 1 in 256 agrees, none of them in one cycle.
#[test]
fn a_frame_of_an_old_session_passes_by_chance_once_in_256() {
    for (running, old) in [(0, 1), (1, 2), (2, 0)] {
        let seal = |session, turn: u32| Seal { code: code(session), cycle: turn * 15 };
        let pairs = (0..256).flat_map(|now| (0..256).map(move |then| (now, then)));
        let passed: Vec<(u32, u32)> = pairs
            .filter(|(now, then)| {
                let replayed = frame(Classical, code(old), then * 15);
                let seal = seal(running, *now);
                Command::decode_sealed(replayed.id(), replayed.data(), seal).is_ok()
            })
            .collect();
        assert_eq!(passed.len(), 256);
        assert!(passed.iter().all(|(now, then)| now != then));
    }
}

/// A whole log replayed into a session that waits for its first command, with every offset.
#[test]
fn a_replayed_log_drives_nothing() {
    let mut longest = 0;
    for start in 0..64 {
        let mut armed = Armed::new(Classical, code(0));
        let mut in_a_row = 0;
        for cycle in start..start + 2001 {
            let delivers = armed.status(&frame(Classical, code(1), cycle)).delivers();
            in_a_row = if delivers { in_a_row + 1 } else { 0 };
            longest = longest.max(in_a_row);
        }
    }
    // One roll-over may agree by chance; the next one does not.
    assert!(longest <= 15, "{longest} frames in a row");
}

proptest! {
    #![proptest_config(samples::config(300))]

    /// Up to 4 frames lost in a row, perhaps an old one after each frame, perhaps a plain one or
    /// one of the last session: every fresh frame is accepted once and nothing else ever.
    #[test]
    fn only_fresh_frames_of_the_session_pass(
        numbers in any::<(u32, u32)>(),
        others in any::<(u32, u32)>(),
        fd in any::<bool>(),
        cycles in prop::collection::vec(
            (0_u32..=4, prop::option::of(0_u32..3000), any::<u8>()),
            1..300,
        ),
    ) {
        let profile = if fd { Fd } else { Classical };
        let code = SessionCode::of(numbers.0, numbers.1);
        let other = SessionCode::of(others.0, others.1);
        let mut history = SessionHistory::default();
        history.remember(other);
        prop_assume!(history.allows(code));
        let mut armed = Armed::new(profile, code);
        let mut cycle = 0;
        for (lost, age, kind) in cycles {
            cycle += lost;
            prop_assert!(armed.status(&frame(profile, code, cycle)).delivers(), "{cycle}");
            if let Some(old) = age.and_then(|age| cycle.checked_sub(age)) {
                let status = armed.status(&frame(profile, code, old));
                prop_assert!(!status.delivers(), "{old} at {cycle}: {status}");
            }
            if kind % 3 == 0 {
                // In the cycle that is next in this session: never, whatever the codes.
                let foreign = frame(profile, other, cycle + 1);
                prop_assert!(!armed.status(&foreign).delivers());
            }
            cycle += 1;
        }
    }

    /// Any bytes under the id: no panic, and data only with a status that delivers.
    #[test]
    fn no_bytes_disturb_a_sealed_receiver(
        payloads in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..=64), 1..40),
        fd in any::<bool>(),
    ) {
        let profile = if fd { Fd } else { Classical };
        let mut armed = Armed::new(profile, code(0));
        let id = armed.receiver.message_id().raw();
        for payload in payloads {
            let reception = armed.receiver.accept(&mut armed.state, id, &payload).unwrap();
            prop_assert_eq!(reception.data.is_some(), reception.status.delivers());
        }
    }
}
