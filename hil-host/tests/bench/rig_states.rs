//! The rig's states: arming, watchdog, latch, handshake. In virtual time, to the cycle.

use crate::support::host::{Host, setup};
use crate::support::rig::{FedRig, answers, arm, armed, give, measured, pass, quiet};
use can_protocol::arming::{HostArming, HostOutcome, Refusal};
use can_protocol::{
    ArmItem, FaultCode, Frame, HeartbeatFlags, Message, Mode, Pace, Profile, RunState,
    SessionHistory,
};
use core::num::NonZeroU16;
use hil_host::bus::WireFrame;
use hil_host::rig::{RigNode, WATCHDOG_CYCLES};

/// A rig in clock pace that has followed for 20 cycles.
fn running() -> (FedRig, Host) {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::Clock);
    for _ in 0..20 {
        give(&mut rig, &host.run());
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Run);
    }
    (rig, host)
}

fn faults(messages: &[Message]) -> Vec<(FaultCode, u16, RunState)> {
    messages
        .iter()
        .filter_map(|message| match message {
            Message::Fault(fault) => Some((fault.code, fault.detail, fault.state)),
            _ => None,
        })
        .collect()
}

fn states(messages: &[Message]) -> Vec<RunState> {
    messages
        .iter()
        .filter_map(|message| match message {
            Message::Measurement(measurement) => Some(measurement.state),
            _ => None,
        })
        .collect()
}

#[test]
fn before_a_command_the_rig_is_in_init_and_answers_a_sync_at_once() {
    let host = Host::new(Profile::Classical);
    let mut rig = FedRig::from(RigNode::new(&setup(), host.node, host.profile));
    for _ in 0..100 {
        rig.cycle();
    }
    let idle = answers(&mut rig);
    assert!(idle.iter().all(|m| matches!(m, Message::Heartbeat(_) | Message::Telemetry(_))));
    give(&mut rig, &host.sync_message(Pace::LockStep).encode());
    let [Message::Heartbeat(heartbeat)] = answers(&mut rig)[..] else { panic!("no heartbeat") };
    assert_eq!((heartbeat.state, heartbeat.boot), (RunState::Standby, rig.boot()));
    assert_eq!(rig.pace(), Pace::LockStep);
}

#[test]
fn the_watchdog_trips_in_the_fifth_cycle_and_reports_once() {
    let (mut rig, _) = running();
    for silent in 1..WATCHDOG_CYCLES {
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Run, "after {silent} silent cycles");
    }
    rig.cycle();
    let fifth = answers(&mut rig);
    assert_eq!(faults(&fifth), [(FaultCode::PeerSilent, 5, RunState::Safe)]);
    assert_eq!(states(&fifth), [RunState::Safe]);
    for _ in 0..100 {
        rig.cycle();
        let later = answers(&mut rig);
        assert_eq!(states(&later), [RunState::Safe]);
        assert!(faults(&later).is_empty());
    }
    assert_eq!(rig.safe_events(), 1);
    assert!(rig.is_at_rest());
}

#[test]
fn four_silent_cycles_in_a_row_are_forgiven_any_number_of_times() {
    let (mut rig, mut host) = running();
    for _ in 0..10 {
        for _ in 1..WATCHDOG_CYCLES {
            rig.cycle();
            assert_eq!(measured(&mut rig).state, RunState::Run);
            host.cycle += 1;
        }
        give(&mut rig, &host.run());
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Run);
    }
    assert_eq!(rig.safe_events(), 0);
}

#[test]
fn a_command_that_steps_too_far_is_not_followed_and_two_in_a_row_are_safe() {
    let (mut rig, mut host) = running();
    // 76 um in a cycle; the agreed speed allows 500 um.
    let jump =
        |host: &mut Host| host.say(RunState::Run, Mode::FollowWithVelocity, Some(20e-3), Some(0.0));
    let before_m = rig.physics().ram().displacement_m;
    give(&mut rig, &jump(&mut host));
    rig.cycle();
    assert_eq!(measured(&mut rig).state, RunState::Run);
    let moved_m = rig.physics().ram().displacement_m - before_m;
    assert!((0.0..80e-6).contains(&moved_m), "it runs on: {moved_m}");
    // The host goes on where it was; one such command alone does nothing, however often.
    for _ in 0..10 {
        give(&mut rig, &host.run());
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Run);
        give(&mut rig, &jump(&mut host));
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Run);
    }
    assert_eq!(rig.frames().too_far, 11);
    give(&mut rig, &jump(&mut host));
    rig.cycle();
    let second = answers(&mut rig);
    let [(FaultCode::VelocityLimit, per_mille, RunState::Safe)] = faults(&second)[..] else {
        panic!("{second:?}")
    };
    assert!(per_mille > 5000, "{per_mille}");
    assert_eq!(states(&second), [RunState::Safe]);
    assert_eq!((rig.frames().too_far, rig.safe_events()), (12, 1));
    assert!(rig.physics().ram().displacement_m.abs() < 5e-3);
}

#[test]
fn a_first_command_far_from_the_ram_does_not_move_it() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::Clock);
    for expected in [RunState::Armed, RunState::Safe] {
        give(&mut rig, &host.say(RunState::Run, Mode::Follow, Some(20e-3), None));
        rig.cycle();
        assert_eq!(measured_state(&mut rig), expected);
    }
    assert_eq!(rig.physics().ram().displacement_m, 0.0);
}

/// The state in the one measurement among the rig's answers.
fn measured_state(rig: &mut FedRig) -> RunState {
    let [state] = states(&answers(rig))[..] else { panic!("one measurement") };
    state
}

#[test]
fn safe_is_latched_until_it_is_reset_at_the_rig() {
    let (mut rig, mut host) = running();
    for _ in 0..WATCHDOG_CYCLES {
        rig.cycle();
    }
    answers(&mut rig);
    for _ in 0..50 {
        give(&mut rig, &host.run());
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Safe);
    }
    assert!(rig.physics().ram().displacement_m.abs() > 1e-4, "it holds where it came to rest");
    for _ in 0..500 {
        rig.cycle();
        answers(&mut rig);
    }
    // Neither a state nor a sync of the next run releases it.
    for state in [RunState::Standby, RunState::Armed, RunState::Init] {
        give(&mut rig, &host.state(state));
        rig.cycle();
        assert_eq!(measured(&mut rig).state, RunState::Safe);
    }
    let sync = host.sync_message(Pace::Clock);
    give(&mut rig, &sync.encode());
    let [Message::Heartbeat(heartbeat)] = answers(&mut rig)[..] else { panic!("no heartbeat") };
    assert_eq!(heartbeat.state, RunState::Safe);
    assert!(heartbeat.flags.contains(HeartbeatFlags::LATCHED));
    let exchange = HostArming::new(host.plan(&sync), SessionHistory::default());
    let refused = Host::exchange(exchange, |question| pass_latched(&mut rig, question));
    assert_eq!(refused, HostOutcome::Refused(Refusal::ByRig(ArmItem::State)));
    assert!(rig.reset());
    let released = answers(&mut rig);
    assert_eq!(faults(&released), [(FaultCode::Cleared, 0, RunState::Init)]);
    host.cycle = 0;
    give(&mut rig, &sync.encode());
    arm(&mut rig, &mut host, &sync);
    give(&mut rig, &host.run());
    rig.cycle();
    assert_eq!(measured(&mut rig).state, RunState::Run);
    assert_eq!((rig.runs(), rig.physics().cycle()), (2, 1), "coupled anew: noise from cycle 0");
}

/// Lets the force of the damper fade, without commands.
fn relax(rig: &mut FedRig) {
    for _ in 0..500 {
        rig.idle();
        answers(rig);
    }
}

/// A cycle of a rig that is latched: by its own clock.
fn pass_latched(rig: &mut FedRig, frame: Option<Frame>) -> Vec<WireFrame> {
    rig.cycle();
    pass(rig, frame)
}

#[test]
fn a_run_command_without_displacement_is_answered_and_does_not_feed_the_watchdog() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::LockStep);
    give(&mut rig, &host.run());
    answers(&mut rig);
    for number in 1..=WATCHDOG_CYCLES {
        give(&mut rig, &host.say(RunState::Run, Mode::Follow, None, Some(0.1)));
        let expected = if number < WATCHDOG_CYCLES { RunState::Run } else { RunState::Safe };
        let answer = measured(&mut rig);
        assert_eq!((answer.state, answer.echo), (expected, Some(number as u8)));
    }
    // Holding and centring need none.
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::LockStep);
    for mode in [Mode::Hold, Mode::Centre].repeat(10) {
        give(&mut rig, &host.say(RunState::Run, mode, None, None));
        assert_eq!(measured(&mut rig).state, RunState::Run);
    }
}

/// Frames that must change nothing but a counter, in an order that never builds a new sequence.
#[test]
fn bad_frames_change_a_counter_and_nothing_else() {
    for pace in [Pace::LockStep, Pace::Clock] {
        let mut host = Host::new(Profile::Classical);
        let mut clean = armed(&setup(), &mut host, pace);
        let mut dirty = clean.clone();
        let (mut crc, mut repeated, mut sequence) = (0, 0, 0);
        for number in 0..300_usize {
            let frame = host.run();
            give(&mut clean, &frame);
            give(&mut dirty, &frame);
            // Seldom enough to be no second sender, which three of ten cycles would be.
            let bad = match number % 16 {
                0 => {
                    let mut data = frame.data().to_vec();
                    data[number % 8] ^= 1 << (number % 7);
                    crc += 1;
                    WireFrame::new(frame.id(), false, &data)
                }
                1 | 5 | 9 | 13 => {
                    repeated += 1;
                    Some(WireFrame::from(&frame))
                }
                2 | 6 | 10 | 14 => {
                    let mut earlier = host.clone();
                    // The counter of two frames ago: 13 steps forward.
                    earlier.sent = host.sent - 3;
                    sequence += 1;
                    Some(WireFrame::from(&earlier.run()))
                }
                7 => {
                    crc += 1;
                    WireFrame::new(frame.id(), number % 32 == 7, &frame.data()[..number % 11 % 8])
                }
                _ => None,
            };
            if let Some(bad) = &bad {
                dirty.on_frame(bad);
            }
            // Another node's command, a foreign id, a sync with a wrong checksum.
            for id in [frame.id() + 1, 0x6AB, 0x080] {
                dirty.on_frame(&WireFrame::new(id, false, frame.data()).unwrap());
            }
            if pace == Pace::Clock {
                clean.cycle();
                dirty.cycle();
            }
            assert_eq!(answers(&mut dirty), answers(&mut clean), "frame {number} in {pace:?}");
        }
        assert_eq!(dirty.physics(), clean.physics());
        let (clean, dirty) = (clean.frames(), dirty.frames());
        assert_eq!(
            (clean.received, clean.crc_errors + clean.repeated + clean.wrong_sequence),
            (300, 0)
        );
        assert_eq!(dirty.received, 300);
        assert_eq!((dirty.crc_errors, dirty.repeated), (crc, repeated));
        assert_eq!(dirty.wrong_sequence, sequence);
    }
}

#[test]
fn lost_commands_are_counted_by_their_counters() {
    let (mut rig, mut host) = running();
    for lost in 1..=4 {
        for _ in 0..lost {
            host.run();
            rig.cycle();
        }
        give(&mut rig, &host.run());
        rig.cycle();
    }
    assert_eq!((rig.frames().received, rig.frames().lost), (24, 10));
    assert_eq!(rig.run_state(), RunState::Run);
}

#[test]
fn a_foreign_version_is_refused_with_one_fault_and_never_runs() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = FedRig::from(RigNode::new(&quiet(), host.node, host.profile));
    let foreign = can_protocol::Sync { version: 9, ..host.sync_message(Pace::LockStep) };
    for round in 0..3 {
        give(&mut rig, &foreign.encode());
        let expected: &[_] = match round {
            0 => &[(FaultCode::ConfigurationMismatch, 9, RunState::Init)],
            _ => &[],
        };
        let heard = answers(&mut rig);
        assert_eq!(faults(&heard), expected);
        assert_eq!(heard.len(), expected.len(), "no heartbeat for it");
    }
    give(&mut rig, &host.run());
    rig.cycle();
    assert_eq!((rig.run_state(), rig.runs()), (RunState::Init, 0));
    let sync = host.sync_message(Pace::LockStep);
    give(&mut rig, &sync.encode());
    arm(&mut rig, &mut host, &sync);
    give(&mut rig, &host.run());
    assert_eq!((rig.run_state(), rig.runs()), (RunState::Run, 1));
}

#[test]
fn the_timing_of_a_coupled_rig_stays_as_it_is() {
    let (mut rig, mut host) = running();
    let mut untold = rig.clone();
    let before = rig.timing();
    let mut other = host.sync_message(Pace::LockStep);
    other.period_us = NonZeroU16::new(500).unwrap();
    give(&mut rig, &other.encode());
    assert_eq!(faults(&answers(&mut rig)).len(), 1);
    assert_eq!((rig.timing(), rig.run_state()), (before, RunState::Run));
    for _ in 0..300 {
        let frame = host.run();
        for rig in [&mut rig, &mut untold] {
            give(rig, &frame);
            rig.cycle();
        }
        assert_eq!(answers(&mut rig), answers(&mut untold), "it follows as if nothing had come");
    }
}

#[test]
fn a_lock_step_host_that_starts_anew_was_given_a_rig_in_motion() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::LockStep);
    for cycle in 0..250 {
        if cycle % 100 == 1 {
            give(&mut rig, &host.sync_message(Pace::LockStep).encode());
            assert_eq!(rig.run_state(), RunState::Run, "a sync of the same host changes nothing");
        }
        give(&mut rig, &host.run());
        answers(&mut rig);
    }
    // Killed and started again within the second after which the rig would go safe.
    let mut host = Host::new(Profile::Classical);
    let sync = host.sync_message(Pace::LockStep);
    give(&mut rig, &sync.encode());
    assert_eq!(rig.run_state(), RunState::Safe);
    assert_eq!(faults(&answers(&mut rig)), [(FaultCode::PeerSilent, 0, RunState::Safe)]);
    // The next run does not release it; its key does, once the ram stands.
    assert!(!rig.reset(), "the ram still moves");
    for _ in 0..20 {
        rig.cycle();
        answers(&mut rig);
    }
    assert!(rig.reset());
    relax(&mut rig);
    give(&mut rig, &sync.encode());
    arm(&mut rig, &mut host, &sync);
    give(&mut rig, &host.run());
    let first = measured(&mut rig);
    assert_eq!((first.state, first.echo), (RunState::Run, Some(0)));
    assert_eq!((rig.runs(), rig.physics().cycle()), (2, 1));
    assert_eq!(rig.frames().received, 251, "counts go on");
}

#[test]
fn a_lock_step_rig_goes_safe_when_its_owner_gives_the_host_up() {
    let mut host = Host::new(Profile::Classical);
    let mut rig = armed(&quiet(), &mut host, Pace::LockStep);
    rig.host_is_silent(1000);
    assert_eq!(rig.run_state(), RunState::Armed, "there was no host to lose");
    for _ in 0..20 {
        give(&mut rig, &host.run());
        answers(&mut rig);
    }
    rig.host_is_silent(1000);
    assert_eq!(faults(&answers(&mut rig)), [(FaultCode::PeerSilent, 1000, RunState::Safe)]);
    give(&mut rig, &host.run());
    assert_eq!(measured(&mut rig).state, RunState::Safe);
}

#[test]
fn slow_messages_come_as_often_as_the_protocol_says() {
    for (period_us, profile) in [(1000, Profile::Classical), (500, Profile::Fd), (250, Profile::Fd)]
    {
        let host = Host::new(profile);
        let mut rig = FedRig::from(RigNode::new(&quiet(), host.node, profile));
        let mut sync = host.sync_message(Pace::Clock);
        sync.period_us = NonZeroU16::new(period_us).unwrap();
        give(&mut rig, &sync.encode());
        answers(&mut rig);
        let (mut heartbeats, mut telemetry) = (0, 0);
        for _ in 0..1_000_000 / u32::from(period_us) {
            rig.cycle();
            for message in answers(&mut rig) {
                heartbeats += u32::from(matches!(message, Message::Heartbeat(_)));
                telemetry += u32::from(matches!(message, Message::Telemetry(_)));
            }
        }
        assert_eq!((heartbeats, telemetry), (50, 20), "{period_us} us");
    }
}

#[test]
fn the_host_chooses_profile_and_period() {
    let mut host = Host::new(Profile::Fd);
    let mut rig = FedRig::from(RigNode::new(&quiet(), host.node, Profile::Classical));
    let mut sync = host.sync_message(Pace::LockStep);
    sync.period_us = NonZeroU16::new(500).unwrap();
    give(&mut rig, &sync.encode());
    arm(&mut rig, &mut host, &sync);
    let idle_cycles = rig.cycles() as u32;
    for cycle in 0..600_u32 {
        give(&mut rig, &host.run());
        let frames: Vec<_> = std::iter::from_fn(|| rig.take_frame()).collect();
        // Slow messages go out first.
        let (frame, slow) = frames.split_last().unwrap();
        assert!(slow.iter().all(|frame| !frame.is_fd()));
        assert!(frame.is_fd() && frame.id() == 0x211);
        let Message::Measurement(answer) = rig.open(frame) else { panic!("no measurement") };
        assert_eq!(u32::from(answer.counter), cycle % 255);
        assert_eq!(answer.time_us, Some(500 * (idle_cycles + cycle + 1)));
    }
}
