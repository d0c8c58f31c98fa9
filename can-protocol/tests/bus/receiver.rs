//! The receiver's status table, every transition by an explicit sequence of real frames.
use can_protocol::{
    Counts, Cyclic, Error, Frame, Measurement, MeasurementFlags, Node, Profile, Receiver,
    ReceiverState, RunState, Status,
};
use proptest::prelude::*;

use Status::{Initial, NoNewData, Ok as Accepted, Repeated, SomeLost, WrongCrc, WrongSequence};

/// What happens in one cycle.
#[derive(Clone, Copy, Debug)]
enum Event {
    Frame(u8),
    Corrupt(u8),
    Nothing,
}
use Event::{Corrupt, Frame as Seen, Nothing};

fn frame(profile: Profile, counter: u8) -> Frame {
    let measurement = Measurement {
        node: Node::ALL[0],
        counter,
        state: RunState::Run,
        flags: MeasurementFlags::empty(),
        echo: Some(0),
        force_n: Some(f64::from(counter)),
        displacement_m: Some(0.0),
        time_us: None,
    };
    measurement.encode(profile).0
}

fn status(
    receiver: &Receiver<Measurement>,
    state: &mut ReceiverState,
    profile: Profile,
    event: Event,
) -> Status {
    let (counter, corrupt) = match event {
        Seen(counter) => (counter, false),
        Corrupt(counter) => (counter, true),
        Nothing => return receiver.no_frame(state),
    };
    let frame = frame(profile, counter);
    let mut data = frame.data().to_vec();
    data[5] ^= u8::from(corrupt);
    let reception = receiver.accept(state, frame.id(), &data).expect("our own id");
    // Data come exactly with the statuses that deliver, and are this very frame's.
    let force = reception.data.map(|data| data.force_n);
    assert_eq!(force, reception.status.delivers().then_some(Some(f64::from(counter))));
    assert_eq!(reception.error.is_some(), reception.status == WrongCrc);
    reception.status
}

fn check(profile: Profile, max_delta: u8, sequence: &[(Event, Status)]) -> ReceiverState {
    let receiver = Receiver::new(profile, Node::ALL[0], max_delta).expect("max_delta");
    let mut state = ReceiverState::default();
    for (index, (event, expected)) in sequence.iter().enumerate() {
        let found = status(&receiver, &mut state, profile, *event);
        assert_eq!(found, *expected, "step {index} of {sequence:?}");
    }
    state
}

#[test]
fn in_order_over_the_wrap() {
    for (profile, last) in [(Profile::Classical, 14), (Profile::Fd, 254)] {
        let state = check(
            profile,
            3,
            &[(Seen(last - 1), Initial), (Seen(last), Accepted), (Seen(0), Accepted)],
        );
        assert_eq!(state.echo(), Some(0));
    }
}

#[test]
fn nothing_accepted_yet() {
    let state = check(
        Profile::Classical,
        3,
        &[(Nothing, NoNewData), (Corrupt(4), WrongCrc), (Nothing, NoNewData)],
    );
    assert_eq!(state.echo(), None);
    check(Profile::Classical, 3, &[(Corrupt(4), WrongCrc), (Seen(9), Initial)]);
}

#[test]
fn losses_up_to_max_delta_are_some_lost() {
    let state = check(
        Profile::Classical,
        3,
        &[
            (Seen(13), Initial),
            (Nothing, NoNewData),
            (Seen(0), SomeLost), // 14 is missing
            (Nothing, NoNewData),
            (Nothing, NoNewData),
            (Seen(3), SomeLost), // 1 and 2
            (Seen(4), Accepted),
            (Seen(8), WrongSequence), // a step of 4
            (Seen(5), Accepted),
        ],
    );
    assert_eq!(state.counts().lost_frames, 3);
}

#[test]
fn repeated_frames_and_old_frames_change_only_a_count() {
    let state = check(
        Profile::Classical,
        5,
        &[
            (Seen(7), Initial),
            (Seen(7), Repeated),
            (Seen(8), Accepted),
            (Seen(7), WrongSequence),
            (Seen(8), Repeated),
            (Seen(9), Accepted),
            (Seen(6), WrongSequence),
            (Seen(10), Accepted),
            (Seen(7), WrongSequence), // follows the old 6, but 10 was accepted in between
            (Corrupt(11), WrongCrc),
            (Seen(11), Accepted),
        ],
    );
    let expected = Counts {
        initial: 1,
        ok: 4,
        repeated: 2,
        wrong_sequence: 3,
        wrong_crc: 1,
        ..Counts::default()
    };
    assert_eq!(*state.counts(), expected);
}

#[test]
fn swapped_frames_cost_one_frame() {
    check(
        Profile::Fd,
        3,
        &[(Seen(4), Initial), (Seen(6), SomeLost), (Seen(5), WrongSequence), (Seen(7), Accepted)],
    );
}

#[test]
fn a_restarted_sender_is_taken_up_with_its_second_frame() {
    check(
        Profile::Fd,
        3,
        &[
            (Seen(100), Initial),
            (Nothing, NoNewData),
            (Seen(0), WrongSequence),
            (Corrupt(1), WrongCrc),
            (Nothing, NoNewData),
            (Seen(1), Initial),
            (Seen(2), Accepted),
            (Seen(101), WrongSequence), // the old sequence is the wrong one now
        ],
    );
    // Not when the two do not follow each other.
    check(
        Profile::Fd,
        3,
        &[
            (Seen(100), Initial),
            (Seen(0), WrongSequence),
            (Seen(2), WrongSequence),
            (Seen(2), WrongSequence),
            (Seen(3), Initial),
        ],
    );
}

#[test]
fn only_valid_and_new_frames_feed_a_watchdog() {
    let fed = [Initial, Accepted, SomeLost];
    for status in [Initial, Accepted, SomeLost, Repeated, WrongSequence, WrongCrc, NoNewData] {
        assert_eq!(status.delivers(), fed.contains(&status));
        assert_eq!(status.feeds_watchdog(), fed.contains(&status));
    }
}

#[test]
fn the_statuses_have_their_names() {
    let all = [Initial, Accepted, Repeated, SomeLost, WrongSequence, WrongCrc, NoNewData];
    assert_eq!(
        all.map(|status| status.to_string()),
        ["INITIAL", "OK", "REPEATED", "SOME_LOST", "WRONG_SEQUENCE", "WRONG_CRC", "NO_NEW_DATA"]
    );
}

#[test]
fn frames_of_others_change_nothing() {
    let receiver = Receiver::<Measurement>::new(Profile::Classical, Node::ALL[1], 3).unwrap();
    let mut state = ReceiverState::default();
    let of_node_1 = frame(Profile::Classical, 3);
    assert!(receiver.accept(&mut state, of_node_1.id(), of_node_1.data()).is_none());
    assert_eq!(state, ReceiverState::default());
    // The same bytes under node 2's id fail: the id is in the CRC.
    let masquerade = receiver.accept(&mut state, 0x202, of_node_1.data()).unwrap();
    assert!(matches!(masquerade.error, Some(Error::Checksum { id: 0x202, .. })));
}

#[test]
fn a_wrong_length_and_a_reserved_state_are_wrong_crc() {
    let receiver = Receiver::<Measurement>::new(Profile::Classical, Node::ALL[0], 3).unwrap();
    let mut state = ReceiverState::default();
    for length in (0..=64).filter(|length| *length != 8) {
        let reception = receiver.accept(&mut state, 0x201, &vec![0; length]).unwrap();
        assert_eq!(reception.status, WrongCrc);
    }
    let mut data = frame(Profile::Classical, 3).data().to_vec();
    data[1] |= 0x80; // state 12
    let id = Measurement::message_id(Profile::Classical, Node::ALL[0]);
    data[0] = can_protocol::protection::checksum(id, &data) as u8;
    let reception = receiver.accept(&mut state, 0x201, &data).unwrap();
    assert_eq!(reception.error, Some(Error::ReservedCode { id: 0x201, field: "state", code: 12 }));
}

#[test]
fn max_delta_stays_below_half_the_range() {
    for (profile, upper) in [(Profile::Classical, 7), (Profile::Fd, 127)] {
        for value in 0..=255 {
            let receiver = Receiver::<Measurement>::new(profile, Node::ALL[0], value);
            assert_eq!(receiver.is_ok(), (1..=upper).contains(&value));
        }
    }
}

proptest! {
    /// Up to 4 frames lost in a row, and after each frame that arrives perhaps an old one: every
    /// fresh frame is accepted once, in order, and no old one ever.
    #[test]
    fn fresh_frames_pass_and_old_ones_do_not(
        cycles in prop::collection::vec((0_u64..=4, prop::option::of(0_u64..=9)), 1..200),
    ) {
        let receiver = Receiver::<Measurement>::new(Profile::Classical, Node::ALL[0], 5).unwrap();
        let mut state = ReceiverState::default();
        let mut receive = |number: u64| {
            let frame = frame(Profile::Classical, (number % 15) as u8);
            receiver.accept(&mut state, frame.id(), frame.data()).unwrap().data.is_some()
        };
        let mut sent = 100;
        for (lost, age) in cycles {
            sent += 1 + lost;
            prop_assert!(receive(sent), "frame {sent} after {lost} lost");
            if let Some(age) = age {
                prop_assert!(!receive(sent - age), "frame {sent} again {age} later");
            }
        }
    }
}
