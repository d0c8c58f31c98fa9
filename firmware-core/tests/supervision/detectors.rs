//! What a cause says, what is only logged or held, and the detectors beside the belief in a rig.

use crate::rig::{Bench, CYCLE_S, FAULT, MODULUS};
use firmware_core::command::Command;
use firmware_core::guard::ForceInput;
use firmware_core::supervision::{
    Action, Arrival, Belief, Cause, Checks, Condition, Frames, Growth, Measured, Rule,
    SecondSender, Signal,
};
use std::collections::VecDeque;

/// The first cause under a fault, with the cycles since it began.
fn cause(fault: impl FnMut(u32, Measured) -> Arrival) -> Option<(u32, Cause)> {
    let (cycle, cause) = Bench::new(0.5e-3).run(FAULT + 20_000, fault)?;
    Some((cycle + 1 - FAULT, cause))
}

/// Losses by a rule over the cycles since the fault began.
fn lost(is_lost: impl Fn(u32) -> bool) -> impl FnMut(u32, Measured) -> Arrival {
    move |cycle, measured| match cycle.checked_sub(FAULT) {
        Some(since) if is_lost(since) => Arrival::Nothing,
        _ => Arrival::Frame(measured),
    }
}

#[test]
fn a_cause_of_losses_names_the_window_that_was_full() {
    let of = |signal, value, limit, action| Cause { signal, value, limit, action };
    let signal = Signal::LostMeasurements;
    let (_, row) = cause(lost(|_| true)).unwrap();
    assert_eq!(row, of(signal, 5.0, 5.0, Action::Stop));
    let (cycles, short) = cause(lost(|since| since % 3 != 0)).unwrap();
    assert_eq!((cycles, short), (14, of(signal, 9.0, 8.0, Action::RampOut)));
    let (cycles, long) = cause(lost(|since| since % 10 == 0)).unwrap();
    assert_eq!((cycles, long), (181, of(signal, 19.0, 18.0, Action::RampOut)));
}

#[test]
fn commands_that_are_never_confirmed_stop_and_a_few_are_held() {
    // The rig answers in time and echoes one command for ever, until that is too old.
    let stuck_echo = |length: u32| {
        cause(move |cycle, mut measured: Measured| {
            let since = cycle.saturating_sub(FAULT);
            if cycle >= FAULT && since < length {
                measured.echo = measured.echo.map(|echo| {
                    let behind = (since + 1).min(u32::from(MODULUS) - 1) as u8;
                    (echo + MODULUS - behind) % MODULUS
                });
            }
            Arrival::Frame(measured)
        })
    };
    assert_eq!(stuck_echo(4), None);
    let (cycles, found) = stuck_echo(1000).unwrap();
    let (signal, action) = (Signal::LostCommands, Action::Stop);
    assert_eq!((cycles, found.signal, found.value, found.action), (5, signal, 5.0, action));
}

#[test]
fn the_gravest_action_follows_the_first_cause() {
    // The force freezes, and asks to ramp out; then nothing comes any more.
    let mut bench = Bench::new(0.5e-3);
    let frozen = |_: u32, mut measured: Measured| {
        measured.force_n = Some(8123.4);
        Arrival::Frame(measured)
    };
    bench.run(FAULT, |_, measured| Arrival::Frame(measured));
    let (cycle, found) = bench.run(1000, frozen).unwrap();
    assert_eq!((found.signal, bench.belief.action()), (Signal::StuckForce, Some(Action::RampOut)));
    for sent in 1..=5 {
        bench.belief.sent(bench.command(cycle));
        let sent = (cycle + sent) % u32::from(MODULUS);
        bench.belief.take(&bench.checks, Arrival::Nothing, Some(sent as u8));
    }
    assert_eq!(bench.belief.action(), Some(Action::Stop));
    assert_eq!(bench.belief.cause(), Some(found));
}

#[test]
fn what_is_only_logged_or_held_ends_nothing() {
    for action in [Action::Log, Action::Hold] {
        let mut bench = Bench::new(0.5e-3);
        let rule = |limit| Rule { limit, debounce_cycles: 1, action };
        bench.checks = Checks {
            velocity: rule(1e-3),
            tracking: rule(1e-9),
            stuck_force: Condition { action, ..bench.checks.stuck_force },
            stuck_displacement: Condition { action, ..bench.checks.stuck_displacement },
            wrong_sign: action,
            wrong_phase: action,
            ..bench.checks
        };
        let reversed = |_: u32, mut measured: Measured| {
            measured.force_n = measured.force_n.map(|force_n| -force_n);
            Arrival::Frame(measured)
        };
        assert_eq!(bench.run(3000, reversed), None, "{action:?}");
        assert_eq!(bench.belief.action(), None);
    }
}

#[test]
fn a_force_that_is_late_ramps_out_after_ten_cycles_of_the_motion() {
    // 10 kN that lag the displacement by 0.15 rad give back a quarter of the most.
    let (cycles, found) = cause(|cycle, mut measured: Measured| {
        let phase = std::f64::consts::TAU * 3.5e-3 * f64::from(cycle);
        if cycle >= FAULT {
            measured.force_n = Some(10e3 * libm::sin(phase - 0.15));
        }
        Arrival::Frame(measured)
    })
    .unwrap();
    assert_eq!((found.signal, found.action), (Signal::Work, Action::RampOut));
    // The sums hold cycles of the sound damper first.
    assert!((5 * 286..11 * 286).contains(&cycles), "{cycles}");
    assert!(found.value < found.limit && found.limit < 0.0, "{found:?}");
}

#[test]
fn a_force_beyond_its_limit_or_its_step_is_held_over_at_once() {
    // 40 kN are the limit, 25 kN the largest change in a cycle.
    for (jump_n, is_believed) in [(24e3, true), (26e3, false)] {
        let mut bench = Bench::new(0.5e-3);
        let still = Measured { force_n: Some(-5e3), ..bench.measured(0) };
        let taken = |bench: &mut Bench, cycle: u8, force_n| {
            bench.belief.sent(bench.command(u32::from(cycle)));
            let counters = (cycle % MODULUS, Some(cycle % MODULUS));
            let measured =
                Measured { counter: counters.0, echo: counters.1, force_n: Some(force_n), ..still };
            bench.belief.take(&bench.checks, Arrival::Frame(measured), counters.1)
        };
        assert_eq!(taken(&mut bench, 0, -5e3), ForceInput::Fresh(-5e3));
        let next = taken(&mut bench, 1, -5e3 + jump_n);
        let expected =
            if is_believed { ForceInput::Fresh(-5e3 + jump_n) } else { ForceInput::Invalid };
        assert_eq!(next, expected);
        // A force that creeps over its limit.
        if is_believed {
            assert_eq!(taken(&mut bench, 2, 39.9e3), ForceInput::Fresh(39.9e3));
            assert_eq!(taken(&mut bench, 3, 40.1e3), ForceInput::Invalid);
        }
    }
}

#[test]
fn a_measurement_of_any_age_is_compared_with_the_command_of_its_cycle() {
    for age in 0..=5 {
        let mut bench = Bench::new(0.5e-3);
        // In a cycle, the command goes on by up to 76 um.
        bench.checks.tracking = Rule { limit: 20e-6, ..bench.checks.tracking };
        let mut on_the_way = VecDeque::new();
        let late = |_: u32, measured: Measured| {
            on_the_way.push_back(measured);
            let is_due = on_the_way.len() > age;
            let come = is_due.then(|| on_the_way.pop_front()).flatten();
            come.map_or(Arrival::Nothing, Arrival::Frame)
        };
        assert_eq!(bench.run(1000, late), None, "{age}");
    }
}

#[test]
fn before_the_first_command_nothing_is_judged() {
    let mut bench = Bench::new(0.5e-3);
    let measured = bench.measured(0);
    let frame = Arrival::Frame(measured);
    for _ in 0..100 {
        assert_eq!(bench.belief.take(&bench.checks, frame, None), ForceInput::Missing);
        let silent = bench.belief.take(&bench.checks, Arrival::Nothing, None);
        assert_eq!(silent, ForceInput::Missing);
    }
    let unanswered = Arrival::Frame(Measured { echo: None, ..measured });
    assert_eq!(bench.belief.take(&bench.checks, unanswered, Some(0)), ForceInput::Missing);
    let idle = Arrival::Frame(Measured { runs: false, ..measured });
    assert_eq!(bench.belief.take(&bench.checks, idle, Some(0)), ForceInput::Invalid);
    assert_eq!((bench.belief.cause(), bench.belief.age_cycles()), (None, None));
    let first = bench.belief.take(&bench.checks, frame, Some(0));
    assert!(matches!(first, ForceInput::Fresh(_)), "{first:?}");
    assert_eq!(bench.belief.age_cycles(), Some(0));
}

/// A rig whose ram rests somewhere and answers the command of three cycles ago.
fn resting_at(at_m: f64, begun_at_m: f64) -> Option<Cause> {
    let checks = Checks::usual(MODULUS, CYCLE_S, 40e3);
    let mut belief = Belief::default();
    let at = |displacement_m| Command { displacement_m, velocity_m_per_s: 0.0 };
    belief.begin(at(begun_at_m));
    for cycle in 3..103_u32 {
        belief.sent(at(at_m));
        let counter = |cycle: u32| (cycle % u32::from(MODULUS)) as u8;
        let measured = Measured {
            counter: counter(cycle),
            echo: Some(counter(cycle - 3)),
            displacement_m: Some(at_m),
            force_n: Some(0.0),
            is_valid: true,
            runs: true,
        };
        belief.take(&checks, Arrival::Frame(measured), Some(counter(cycle)));
    }
    belief.cause()
}

#[test]
fn a_measurement_is_compared_with_the_command_that_it_answers() {
    assert_eq!(resting_at(20e-3, 20e-3), None);
    // What was commanded before the first command is where the ram stood.
    let found = resting_at(20e-3, 0.0).unwrap();
    assert_eq!((found.signal, found.value, found.limit), (Signal::Tracking, 20e-3, 5e-3));
}

#[test]
fn the_speed_is_that_over_the_cycles_since_the_last_displacement() {
    // 2.4 mm in four cycles are 0.6 m/s, and 3.6 mm are 0.9 m/s.
    let jump = |by_m: f64, lost: bool| {
        cause(move |cycle, mut measured: Measured| {
            if lost && (FAULT..FAULT + 3).contains(&cycle) {
                return Arrival::Nothing;
            }
            if cycle >= FAULT + 3 {
                measured.displacement_m = measured.displacement_m.map(|at_m| at_m + by_m);
            }
            Arrival::Frame(measured)
        })
        .map(|(_, cause)| cause.signal)
    };
    assert_eq!(jump(2.4e-3, true), None);
    assert_eq!(jump(2.4e-3, false), Some(Signal::Velocity));
    assert_eq!(jump(3.6e-3, true), Some(Signal::Velocity));
}

#[test]
fn a_host_that_misses_slots_does_not_lose_its_rig() {
    // The rig goes on in the missed cycles: its counter, and its ram.
    let missed = |slots: u32| {
        let mut bench = Bench::new(0.5e-3);
        let mut skipped = 0;
        for cycle in 0..6000 {
            if cycle >= 2000 && cycle % 100 == 0 {
                skipped += slots;
                bench.belief.skip(slots);
            }
            let ahead = cycle + skipped;
            bench.belief.sent(bench.command(ahead));
            let measured = bench.measured(ahead);
            let sent = (cycle % u32::from(MODULUS)) as u8;
            let frame = Arrival::Frame(Measured { echo: Some(sent), ..measured });
            bench.belief.take(&bench.checks, frame, Some(sent));
        }
        bench.belief.cause()
    };
    for slots in 1..=4 {
        assert_eq!(missed(slots), None, "{slots}");
    }
}

#[test]
fn a_vehicle_that_runs_away_is_found_before_the_end_of_the_stroke() {
    let mut growth = Growth::default();
    let limit_m = 50e-3;
    let size_m = |t: f64| 3e-3 * libm::exp(0.7 * t);
    let found = (0..10_000).find_map(|n| {
        let t = f64::from(n) * CYCLE_S;
        let at_m = size_m(t) * libm::sin(std::f64::consts::TAU * 3.5 * t);
        growth.take(at_m, limit_m).map(|found_m| (t, found_m))
    });
    let (t, found_m) = found.unwrap();
    assert!(found_m > 0.6 * limit_m && size_m(t) < limit_m, "{t} s, {found_m} m");
}

#[test]
fn a_second_sender_is_found_in_the_third_cycle_at_the_latest() {
    let found = |frames: Frames| {
        let mut judge = SecondSender::default();
        (1..=10).find(|_| judge.take(frames))
    };
    let good = Frames { good: true, ..Frames::default() };
    assert_eq!(found(good), None);
    assert_eq!(found(Frames { bad: true, ..good }), Some(3));
    assert_eq!(found(Frames { conflict: true, ..good }), Some(1));
    assert_eq!(found(Frames { foreign: true, ..good }), Some(1));
}
