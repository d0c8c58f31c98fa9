//! The arming exchange over frames: what arms, and what is refused by name.
use crate::support::exchange::{
    BOOT, CONFIGURATION, HOST_NUMBER, Host, LIMITS, NODE, RIG_NUMBER, Rig, armed, exchange,
    heartbeat, plan, refused, request, run, status,
};
use crate::support::samples;
use can_protocol::arming::{
    Configuration, Foreign, HostArming, HostOutcome, HostPlan, Limits, Quiet, Readiness, Refusal,
    RigArming, RigEvent, RigStatus, Shortfall,
};
use can_protocol::{ArmItem, ArmMessage, Message, Pace, RunState, Sender, SessionCode};
use proptest::prelude::*;

#[test]
fn both_sides_arm_on_one_agreement() {
    let (outcome, rig, frames) = exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER));
    let agreement = armed(outcome);
    assert_eq!(rig.arming.session(), Some(&agreement));
    assert_eq!(rig.events, [RigEvent::Armed(agreement)]);
    assert_eq!(agreement.code(), SessionCode::of(HOST_NUMBER, RIG_NUMBER));
    assert_eq!(agreement.configuration, CONFIGURATION);
    assert_eq!(frames.len(), 28, "14 questions, each with its answer");
}

#[test]
fn the_worked_exchange_of_the_docs_is_what_the_machines_send() {
    let docs = include_str!("../../src/arming/mod.rs");
    let (_, _, frames) = exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER));
    for frame in frames {
        let line = Message::decode(frame.id(), frame.data()).unwrap();
        let Message::Arm(ArmMessage { item, value, .. }) = line else { panic!("{line}") };
        let row = format!("//! {frame} {item} {value:#010x}\n");
        assert!(docs.contains(&row), "{row}");
    }
}

#[test]
fn the_tighter_limits_hold_on_both_sides() {
    let mut rig = Rig::new(RIG_NUMBER);
    let own = Limits { force_n: 25_000, stroke_um: 90_000, ..LIMITS };
    rig.status.configuration.limits = own;
    let agreement = armed(exchange(plan(HOST_NUMBER), rig).0);
    assert_eq!(agreement.configuration.limits, Limits { force_n: 25_000, ..LIMITS });
}

#[test]
fn limits_tighter_than_the_run_needs_are_refused_by_name() {
    for item in Limits::ITEMS {
        let half = LIMITS.get(item).unwrap() / 2;
        let mut limits = LIMITS;
        match item {
            ArmItem::Stroke => limits.stroke_um = half,
            ArmItem::Velocity => limits.velocity_um_per_s = half,
            ArmItem::Acceleration => limits.acceleration_mm_per_s2 = half,
            _ => limits.force_n = half,
        }
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status.configuration.limits = limits;
        let needed = plan(0).needed.get(item).unwrap();
        let refusal = refused(plan(HOST_NUMBER), rig);
        assert_eq!(refusal, Refusal::ByHost(Shortfall { item, found: half, needed }));
        assert_eq!(refusal.to_string(), format!("{item} is {half}, must be at least {needed}"));
    }
}

#[test]
fn each_item_of_readiness_is_refused_by_name_on_either_side() {
    let ready = status().readiness;
    for (readiness, item, line) in [
        (
            Readiness { enabled: false, ..ready },
            ArmItem::Enabled,
            "ENABLED is 0, must be at least 1",
        ),
        (
            Readiness { zero_age_s: Some(3601), ..ready },
            ArmItem::ZeroAge,
            "ZERO_AGE_S is 3601, must be at most 3600",
        ),
        (
            Readiness { zero_age_s: None, ..ready },
            ArmItem::ZeroAge,
            "ZERO_AGE_S is unknown, must be at most 3600",
        ),
        (
            Readiness { shunt_passed: false, ..ready },
            ArmItem::ShuntCheck,
            "SHUNT_CHECK is 0, must be at least 1",
        ),
        (
            Readiness { force_at_rest_n: Some(900), ..ready },
            ArmItem::ForceAtRest,
            "FORCE_AT_REST_N is 900, must be at most 200",
        ),
        (
            Readiness { stroke_out_um: 4000, ..ready },
            ArmItem::StrokeOut,
            "STROKE_LEFT_OUT_UM is 4000, must be at least 5000",
        ),
        (
            Readiness { stroke_in_um: 0, ..ready },
            ArmItem::StrokeIn,
            "STROKE_LEFT_IN_UM is 0, must be at least 5000",
        ),
    ] {
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status.readiness = readiness;
        assert_eq!(refused(plan(HOST_NUMBER), rig).to_string(), line);
        // A host that requires nothing: the rig itself refuses.
        let mut careless = plan(HOST_NUMBER);
        careless.requirements.enabled = false;
        careless.requirements.shunt_passed = false;
        careless.requirements.zero_age_s = u32::MAX - 1;
        careless.requirements.force_at_rest_n = u32::MAX - 1;
        careless.requirements.stroke_um = 0;
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status.readiness = readiness;
        if readiness.zero_age_s.is_some() {
            assert_eq!(refused(careless, rig), Refusal::ByRig(item));
        }
    }
}

#[test]
fn a_configuration_that_differs_in_any_field_is_refused() {
    let own = CONFIGURATION;
    for configuration in [
        Configuration { pace: Pace::LockStep, ..own },
        Configuration { profile: can_protocol::Profile::Fd, ..own },
        Configuration { period_us: 500.try_into().unwrap(), ..own },
        Configuration { slow_down: 2.try_into().unwrap(), ..own },
        Configuration { watchdog_cycles: 6, ..own },
    ] {
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status.configuration = configuration;
        let refusal = refused(plan(HOST_NUMBER), rig);
        assert_eq!(refusal, Refusal::ByRig(ArmItem::Configuration));
        assert_eq!(refusal.to_string(), "the rig refused: CONFIGURATION_HASH");
    }
}

#[test]
fn a_rig_arms_from_standby_only() {
    for state in RunState::ALL.into_iter().filter(|state| *state != RunState::Standby) {
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status.state = state;
        assert_eq!(refused(plan(HOST_NUMBER), rig), Refusal::ByRig(ArmItem::State), "{state}");
    }
}

#[test]
fn every_single_loss_is_survived() {
    let whole = exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER)).2.len();
    for lost in 0..whole {
        let (mut host, mut rig) = (Host::new(plan(HOST_NUMBER)), Rig::new(RIG_NUMBER));
        let frames = run(&mut host, &mut rig, |number| number != lost);
        let agreement = armed(host.arming.outcome());
        assert_eq!(rig.arming.session(), Some(&agreement), "frame {lost}");
        assert_eq!(rig.events.len(), 1, "armed once");
        assert!(frames.len() > whole);
    }
}

#[test]
fn a_silent_rig_is_named_with_the_item_that_it_did_not_answer() {
    let whole = exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER)).2;
    for (step, question) in whole.iter().step_by(2).enumerate() {
        let (mut host, mut rig) = (Host::new(plan(HOST_NUMBER)), Rig::new(RIG_NUMBER));
        run(&mut host, &mut rig, |number| number < 2 * step);
        let item = ArmMessage::decode(question.id(), question.data()).unwrap().item;
        let refusal = Refusal::Unanswered { item, attempts: 10 };
        assert_eq!(host.arming.outcome(), HostOutcome::Refused(refusal));
        assert_eq!(refusal.to_string(), format!("the rig did not answer {item} in 10 attempts"));
    }
}

#[test]
fn the_host_waits_for_300_quiet_cycles_and_names_who_disturbs_them() {
    let mut host = Host::new(plan(HOST_NUMBER));
    let mut rig = Rig::quiet(RIG_NUMBER);
    let frames = run(&mut host, &mut rig, |_| true);
    assert!(matches!(host.arming.outcome(), HostOutcome::Armed(_)) && frames.len() == 28);
    // Another host's heartbeat every 250 cycles.
    let mut host = Host::new(plan(HOST_NUMBER));
    let mut rig = Rig::quiet(RIG_NUMBER);
    for cycle in 0..10_000 {
        host.quiet.cycle();
        if cycle % 250 == 0 {
            host.hear(&heartbeat(Sender::Host, 99));
        }
        let question = host.arming.cycle(&host.quiet).map(|request| request.encode().0);
        if let Some(answer) = question.and_then(|question| rig.hear(&question)) {
            host.hear(&answer);
        }
    }
    let HostOutcome::Refused(refusal) = host.arming.outcome() else { panic!() };
    assert_eq!(refusal.to_string(), "the bus is not quiet: HEARTBEAT_HOST of another host");
    assert!(!rig.is_armed());
}

#[test]
fn a_rig_that_heard_another_host_makes_the_host_wait() {
    let mut rig = Rig::quiet(RIG_NUMBER);
    // Between the first questions of this exchange, a number of somebody else.
    rig.hear(&request(ArmItem::HostNumber, 5));
    let mut host = Host::new(plan(HOST_NUMBER));
    (0..Quiet::CYCLES).for_each(|_| host.quiet.cycle());
    host.quiet.hear(0x701, heartbeat(Sender::Rig(NODE), BOOT).data());
    let frames = run(&mut host, &mut rig, |_| true);
    assert_eq!(rig.quiet.heard().map(|heard| heard.who), Some(Foreign::AnotherHost));
    armed(host.arming.outcome());
    let items = frames.iter().map(|frame| ArmMessage::decode(frame.id(), frame.data()).unwrap());
    let waits: Vec<u32> = items
        .filter(|message| message.item == ArmItem::Quiet)
        .map(|message| message.value)
        .collect();
    assert!(matches!(waits[..], [cycles] if (200..300).contains(&cycles)), "{waits:?}");
}

#[test]
fn a_heartbeat_of_another_rig_than_the_one_that_answers_is_refused() {
    let mut rig = Rig::quiet(RIG_NUMBER);
    rig.status.readiness.boot = BOOT + 1;
    let refusal = refused(plan(HOST_NUMBER), rig);
    assert_eq!(refusal.to_string(), "ALIVE is 0x0000b007, must be 0x0000b008");
}

#[test]
fn a_latched_rig_is_reset_by_its_fresh_number_only() {
    for (state, may_reset, expected) in [
        (RunState::Safe, true, HostOutcome::Reset),
        (RunState::Fault, true, HostOutcome::Reset),
        (RunState::Fault, false, HostOutcome::Refused(Refusal::ByRig(ArmItem::Reset))),
        (RunState::Standby, true, HostOutcome::Refused(Refusal::ByRig(ArmItem::State))),
        (RunState::Run, true, HostOutcome::Refused(Refusal::ByRig(ArmItem::State))),
    ] {
        let mut rig = Rig::new(RIG_NUMBER);
        rig.status = RigStatus { state, may_reset, ..status() };
        let mut host = Host::new(plan(HOST_NUMBER));
        host.arming = HostArming::reset(plan(HOST_NUMBER));
        let frames = run(&mut host, &mut rig, |_| true);
        assert_eq!(host.arming.outcome(), expected, "{state} {may_reset}");
        let event = (expected == HostOutcome::Reset).then_some(RigEvent::Reset);
        assert_eq!(rig.events, Vec::from_iter(event));
        // The recorded reset does nothing to the rig once more.
        rig.events.clear();
        for frame in &frames {
            rig.hear(frame);
        }
        assert!(rig.events.is_empty() && !rig.is_armed());
    }
}

#[test]
fn an_armed_rig_without_a_command_goes_back_to_standby() {
    let armed = || exchange(plan(HOST_NUMBER), Rig::new(RIG_NUMBER)).1;
    // One cycle passed since ARM.
    let last = RigArming::FIRST_COMMAND_CYCLES - 1;
    let mut rig = armed();
    assert!((0..last).all(|_| rig.arming.cycle().is_none()));
    assert_eq!(rig.arming.cycle(), Some(RigEvent::Lapsed));
    assert!(!rig.is_armed());
    // Given up by the host, whose ARMED was lost.
    let mut rig = armed();
    rig.hear(&request(ArmItem::Refused, 0));
    assert!(!rig.is_armed());
    assert_eq!(rig.events.last(), Some(&RigEvent::Lapsed));
    // A first command, and neither ends the session.
    let mut rig = armed();
    rig.arming.commanded();
    assert!((0..=last).all(|_| rig.arming.cycle().is_none()));
    rig.hear(&request(ArmItem::Refused, 0));
    assert!(rig.is_armed());
}

#[test]
fn a_silent_exchange_is_forgotten() {
    for (cycles, expected) in [
        (RigArming::SILENT_CYCLES, ArmItem::Stroke),
        (RigArming::SILENT_CYCLES + 1, ArmItem::Refused),
    ] {
        let mut rig = Rig::quiet(RIG_NUMBER);
        rig.hear(&request(ArmItem::HostNumber, HOST_NUMBER));
        assert!((0..cycles).all(|_| rig.arming.cycle().is_none()));
        let answer = rig.hear(&request(ArmItem::Stroke, 1)).unwrap();
        assert_eq!(ArmMessage::decode(answer.id(), answer.data()).unwrap().item, expected);
    }
}

proptest! {
    #![proptest_config(samples::config(2000))]

    /// One frame in four lost: the sides agree, or neither is armed for the host.
    #[test]
    fn losses_end_in_an_agreement_or_a_named_refusal(lost in prop::collection::vec(0_u8..4, 64)) {
        let mut host = Host::new(plan(HOST_NUMBER));
        let mut rig = Rig::new(RIG_NUMBER);
        run(&mut host, &mut rig, |number| lost[number % lost.len()] != 0);
        match host.arming.outcome() {
            HostOutcome::Armed(agreement) => {
                prop_assert_eq!(rig.arming.session(), Some(&agreement));
            }
            HostOutcome::Refused(Refusal::Unanswered { attempts, .. }) => {
                prop_assert_eq!(attempts, 10);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }

    /// Random limits on both sides: the tighter ones, or the first one that does not do.
    #[test]
    fn limits_are_agreed_or_named(
        own in (1_u32..100_000, 1_u32..1_000_000, 1_u32..20_000, 1_u32..60_000),
        number in any::<(u32, u32)>(),
    ) {
        let limits = Limits {
            stroke_um: own.0,
            velocity_um_per_s: own.1,
            acceleration_mm_per_s2: own.2,
            force_n: own.3,
        };
        let plan = HostPlan {
            needed: Limits {
                stroke_um: 10_000,
                velocity_um_per_s: 0,
                acceleration_mm_per_s2: 4500,
                force_n: 9000,
            },
            ..plan(number.0)
        };
        let mut rig = Rig::new(number.1);
        rig.status.configuration.limits = limits;
        let tighter = limits.tighter(plan.asked);
        match exchange(plan, rig).0 {
            HostOutcome::Armed(agreement) => {
                prop_assert_eq!(agreement.configuration.limits, tighter);
                prop_assert_eq!(tighter.shortfall(&plan.needed), None);
            }
            HostOutcome::Refused(Refusal::ByHost(shortfall)) => {
                prop_assert_eq!(Some(shortfall), tighter.shortfall(&plan.needed));
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }
}
