//! Nothing but a whole exchange with this rig arms it: no single frame, no old log, no reboot.
use crate::support::exchange::{
    BOOT, CONFIGURATION, HOST_NUMBER, Host, LIMITS, NODE, RIG_NUMBER, Rig, armed, exchange,
    heartbeat, plan, request, run,
};
use crate::support::samples;
use can_protocol::arming::{HostArming, HostOutcome, Limits, Refusal};
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Frame, MessageId, Node, RunState, Sender, SessionCode,
    SessionHistory,
};
use proptest::prelude::*;

/// A recorded exchange that armed, of other numbers than any that the tests use later.
fn recorded() -> Vec<Frame> {
    let (outcome, _, frames) = exchange(plan(0x0001_0001), Rig::new(0x0002_0002));
    armed(outcome);
    frames
}

#[test]
fn a_rig_that_rebooted_in_between_does_not_arm() {
    let whole = exchange(plan(HOST_NUMBER), Rig::quiet(RIG_NUMBER)).2;
    for first_after in whole.iter().step_by(2).skip(1) {
        let first_after = ArmMessage::decode(first_after.id(), first_after.data()).unwrap().item;
        let (mut rig, mut rebooted) = (Rig::quiet(RIG_NUMBER), Rig::quiet(0x0BAD_0000));
        let mut host = Host::new(plan(HOST_NUMBER));
        for _ in 0..1000 {
            host.quiet.cycle();
            host.quiet.hear(0x701, heartbeat(Sender::Rig(NODE), BOOT).data());
            let Some(question) = host.arming.cycle(&host.quiet) else { continue };
            let is_rebooted = question.item >= first_after;
            let answers = if is_rebooted { &mut rebooted } else { &mut rig };
            if let Some(answer) = answers.hear(&question.encode().0) {
                host.hear(&answer);
            }
        }
        let refusal = Refusal::ByRig(ArmItem::RigNumber);
        assert_eq!(host.arming.outcome(), HostOutcome::Refused(refusal), "{first_after}");
        assert!(!rebooted.is_armed() && !rig.is_armed());
    }
}

#[test]
fn no_single_frame_arms() {
    for item in ArmItem::ALL {
        for value in [0, 1, RIG_NUMBER, HOST_NUMBER, CONFIGURATION.hash(), u32::MAX] {
            let mut rig = Rig::quiet(RIG_NUMBER);
            rig.hear(&request(*item, value));
            assert!(!rig.is_armed() && rig.events.is_empty(), "{item} {value:#x}");
        }
    }
}

#[test]
fn a_wrong_number_costs_the_exchange_so_that_none_can_be_guessed() {
    let mut rig = Rig::quiet(RIG_NUMBER);
    let arm = RIG_NUMBER ^ CONFIGURATION.hash();
    rig.hear(&request(ArmItem::HostNumber, HOST_NUMBER));
    for item in Limits::ITEMS {
        rig.hear(&request(item, LIMITS.get(item).unwrap()));
    }
    rig.hear(&request(ArmItem::Arm, arm ^ 1));
    rig.hear(&request(ArmItem::Arm, arm));
    assert!(!rig.is_armed());
}

#[test]
fn a_repeated_arm_is_answered_again_and_changes_nothing() {
    let (outcome, mut rig, frames) = exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER));
    let [.., arm, confirmed] = &frames[..] else { panic!() };
    let again = rig.hear(arm).unwrap();
    assert_eq!(again.data()[2..], confirmed.data()[2..]);
    assert_eq!(rig.events.len(), 1);
    // Nothing else of the exchange does anything to an armed rig.
    for frame in frames.iter().step_by(2).rev().skip(1) {
        rig.hear(frame);
        assert_eq!(rig.arming.session(), Some(&armed(outcome)));
    }
    // The session over, the same ARM is a stranger's.
    rig.arming.end_session();
    rig.hear(arm);
    assert!(!rig.is_armed());
}

#[test]
fn a_rig_never_repeats_one_of_its_last_16_codes() {
    let mut rig = Rig::quiet(0);
    let mut codes: Vec<u8> = Vec::new();
    for session in 0..60 {
        // The source starts over each time, and the host has one number only.
        rig.next_number = 0;
        let mut host = Host::new(plan(HOST_NUMBER));
        run(&mut host, &mut rig, |_| true);
        let code = (armed(host.arming.outcome()).code().bits() & 0xFF) as u8;
        assert_ne!(code, 0);
        let recent = &codes[codes.len().saturating_sub(16)..];
        assert!(!recent.contains(&code), "session {session}");
        codes.push(code);
        rig.arming.end_session();
    }
    // A source that is stuck gives no number at all.
    let stuck = ArmMessage {
        side: ArmSide::Host,
        node: NODE,
        counter: 0,
        state: RunState::Standby,
        item: ArmItem::HostNumber,
        value: HOST_NUMBER,
    };
    let last = rig.next_number - 1;
    let (answer, _) = rig.arming.receive(&stuck, &rig.status, &mut rig.quiet, || last);
    let answer = answer.unwrap();
    assert_eq!((answer.item, answer.value), (ArmItem::Refused, ArmItem::RigNumber.code().into()));
}

#[test]
fn a_host_refuses_a_code_that_it_used_before() {
    let mut history = SessionHistory::default();
    history.remember(SessionCode::of(HOST_NUMBER, RIG_NUMBER));
    let mut host = Host::new(plan(HOST_NUMBER));
    host.arming = HostArming::new(plan(HOST_NUMBER), history);
    run(&mut host, &mut Rig::new(RIG_NUMBER), |_| true);
    let HostOutcome::Refused(refusal) = host.arming.outcome() else { panic!() };
    assert_eq!(refusal.to_string(), "RIG_NUMBER 0xdeadbeef repeats an earlier session code");
}

#[test]
fn messages_of_other_nodes_and_of_the_own_side_are_not_answered() {
    let mut rig = Rig::quiet(RIG_NUMBER);
    let mut message = ArmMessage::decode(0x601, request(ArmItem::HostNumber, 1).data()).unwrap();
    message.node = Node::ALL[1];
    assert!(rig.hear(&message.encode().0).is_none());
    (message.node, message.side) = (NODE, ArmSide::Rig);
    assert!(rig.hear(&message.encode().0).is_none());
    assert_eq!(message.encode().0.id(), MessageId::ArmAnswer(NODE).raw());
}

proptest! {
    #![proptest_config(samples::config(2000))]

    /// Frames of a recorded exchange, any of them, in any order, as often as one likes, to a rig
    /// with other numbers.
    #[test]
    fn no_old_log_arms(
        first_number in any::<u32>(),
        order in prop::collection::vec(any::<prop::sample::Index>(), 1..200),
    ) {
        let log = recorded();
        prop_assume!(first_number.abs_diff(0x0002_0002) > 1000);
        let mut rig = Rig::quiet(first_number);
        for index in order {
            rig.hear(index.get(&log));
            (0..400).for_each(|_| rig.quiet.cycle());
            prop_assert!(!rig.is_armed() && rig.events.is_empty());
        }
    }

    /// The same in the order of the log, several times: what `canplayer` does.
    #[test]
    fn no_replay_in_order_arms(first_number in any::<u32>(), times in 1_usize..4) {
        prop_assume!(first_number.abs_diff(0x0002_0002) > 1000);
        let mut rig = Rig::quiet(first_number);
        for frame in std::iter::repeat_n(recorded(), times).flatten() {
            rig.hear(&frame);
            (0..400).for_each(|_| rig.quiet.cycle());
        }
        prop_assert!(!rig.is_armed() && rig.events.is_empty());
    }

    /// A host that hears an old log instead of a rig, or next to one: it arms with the rig that it
    /// asked, or not at all.
    #[test]
    fn a_host_is_never_fooled_by_an_old_log(
        order in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>()), 1..400),
    ) {
        let log = recorded();
        let mut host = Host::new(plan(HOST_NUMBER));
        let mut rig = Rig::quiet(RIG_NUMBER);
        for cycle in 0..600 {
            host.quiet.cycle();
            host.quiet.hear(0x701, heartbeat(Sender::Rig(NODE), BOOT).data());
            let (index, answers) = &order[cycle % order.len()];
            if let Some(question) = host.arming.cycle(&host.quiet)
                && *answers
                && let Some(answer) = rig.hear(&question.encode().0)
            {
                host.hear(&answer);
            }
            // Answers only: a request of the log is another host, of which Quiet has its own test.
            let replayed = index.get(&log);
            let message = ArmMessage::decode(replayed.id(), replayed.data()).unwrap();
            if message.side == ArmSide::Rig {
                host.hear(replayed);
            }
        }
        if let HostOutcome::Armed(agreement) = host.arming.outcome() {
            prop_assert_eq!(rig.arming.session(), Some(&agreement));
        }
    }

    /// Random messages: nothing arms, nothing panics.
    #[test]
    fn random_messages_do_not_arm(
        messages in prop::collection::vec(
            (prop::sample::select(ArmItem::ALL), any::<u32>()),
            1..100,
        ),
        states in prop::sample::select(RunState::ALL.to_vec()),
    ) {
        let mut rig = Rig::quiet(RIG_NUMBER);
        rig.status.state = states;
        for (item, value) in messages {
            prop_assume!(value != RIG_NUMBER);
            rig.hear(&request(item, value));
        }
        prop_assert!(!rig.is_armed() && rig.events.is_empty());
    }
}
