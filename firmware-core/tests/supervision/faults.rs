use crate::rig::{Bench, FAULT, MODULUS};
use firmware_core::supervision::{Action, Arrival, Measured, Signal};

const PLAYS_M: [f64; 5] = [0.0, 0.5e-3, 1e-3, 2e-3, 4e-3];

/// What a fault leads to: the signal, the cycles since it began, and the action.
fn found(fault: impl FnMut(u32, Measured) -> Arrival) -> Option<(Signal, u32, Action)> {
    let (cycle, cause) = Bench::new(0.5e-3).run(FAULT + 20_000, fault)?;
    Some((cause.signal, cycle + 1 - FAULT, cause.action))
}

/// A measurement that a fault changes once it has begun.
fn changed(change: impl Fn(u32, &mut Measured)) -> impl FnMut(u32, Measured) -> Arrival {
    move |cycle, mut measured| {
        if cycle >= FAULT {
            change(cycle - FAULT, &mut measured);
        }
        Arrival::Frame(measured)
    }
}

/// Frames that come late by a number of cycles.
fn delayed(delay: impl Fn(u32) -> u32) -> impl FnMut(u32, Measured) -> Arrival {
    let mut sent: Vec<Measured> = Vec::new();
    move |cycle, measured| {
        sent.push(measured);
        let since = cycle.saturating_sub(FAULT);
        let delay = if cycle < FAULT { 0 } else { delay(since) };
        Arrival::Frame(sent[(cycle - delay) as usize])
    }
}

#[test]
fn nothing_is_found_in_ten_minutes_of_a_sound_rig() {
    for play_m in PLAYS_M {
        let cause = Bench::new(play_m).run(600_000, |_, measured| Arrival::Frame(measured));
        assert_eq!(cause, None, "play {play_m}");
    }
}

#[test]
fn row_1_one_lost_frame_is_held() {
    assert_eq!(found(|n, m| if n == FAULT { Arrival::Nothing } else { Arrival::Frame(m) }), None);
}

#[test]
fn row_3_a_burst_of_four_is_held_and_of_five_stops() {
    let burst = |length: u32| {
        found(move |n, m| {
            if (FAULT..FAULT + length).contains(&n) { Arrival::Nothing } else { Arrival::Frame(m) }
        })
    };
    assert_eq!(burst(4), None);
    assert_eq!(burst(5), Some((Signal::LostMeasurements, 5, Action::Stop)));
}

#[test]
fn row_2_four_of_every_five_lost_ended_as_completed() {
    let cause =
        found(|n, m| if n >= FAULT && n % 5 != 0 { Arrival::Nothing } else { Arrival::Frame(m) });
    assert_eq!(cause, Some((Signal::LostMeasurements, 12, Action::RampOut)));
}

#[test]
fn row_2_lost_commands_are_seen_by_their_echo() {
    // The rig misses every other command, answers in time and echoes the last one it has.
    let cause = found(changed(|since, measured| {
        if since % 2 == 1 {
            measured.echo = measured.echo.map(|echo| (echo + MODULUS - 1) % MODULUS);
        }
    }));
    assert_eq!(cause, Some((Signal::LostCommands, 18, Action::RampOut)));
}

#[test]
fn row_4_a_delay_of_ten_cycles_stops_and_a_delay_of_three_is_held() {
    assert_eq!(found(delayed(|_| 3)), None);
    assert_eq!(found(delayed(|_| 10)), Some((Signal::OldMeasurements, 5, Action::Stop)));
    // A creep is seen once the oldest that is believed has passed.
    let creep = found(delayed(|since| since / 100)).map(|(signal, cycles, _)| (signal, cycles));
    assert_eq!(creep, Some((Signal::OldMeasurements, 605)));
}

#[test]
fn row_7_a_frame_ten_cycles_old_was_taken_for_new() {
    let mut bench = Bench::new(0.5e-3);
    let mut late = delayed(|since| if since % 50 == 0 { 10 } else { 0 });
    let mut accepted = 0;
    let cause = bench.run(FAULT + 400, |cycle, measured| {
        let arrival = late(cycle, measured);
        accepted += u32::from(matches!(arrival, Arrival::Frame(_)));
        arrival
    });
    assert_eq!(cause, None);
    assert_eq!(bench.belief.losses().0.total(), 8, "every one of the eight counts as lost");
}

#[test]
fn row_10_a_frozen_force_is_found_after_twenty_cycles() {
    let cause = found(changed(|_, measured| measured.force_n = Some(8123.4)));
    assert_eq!(cause, Some((Signal::StuckForce, 20, Action::RampOut)));
    // Frozen at zero, as a broken wire reads: the flicker is lost.
    let cause = found(changed(|_, measured| measured.force_n = Some(0.0)));
    assert_eq!(cause, Some((Signal::StuckForce, 20, Action::RampOut)));
}

#[test]
fn row_10_a_frozen_displacement_asks_for_power_off() {
    let mut held = None;
    let cause = found(move |cycle, mut measured| {
        if cycle >= FAULT {
            measured.displacement_m = *held.get_or_insert(measured.displacement_m);
        }
        Arrival::Frame(measured)
    });
    assert_eq!(cause, Some((Signal::StuckDisplacement, 20, Action::PowerOff)));
}

#[test]
fn row_12_an_invalid_force_is_held_four_times_and_stops_the_fifth() {
    let for_cycles =
        |length: u32| found(changed(move |since, measured| measured.is_valid = since >= length));
    assert_eq!(for_cycles(4), None);
    assert_eq!(for_cycles(5), Some((Signal::InvalidForce, 5, Action::Stop)));
}

#[test]
fn row_12_one_spike_never_reaches_the_vehicle_and_two_in_a_row_stop() {
    let spikes = |length: u32| {
        Bench::new(0.5e-3).cycles(
            FAULT + 1000,
            changed(move |since, measured| {
                if since < length {
                    measured.force_n = Some(99e3);
                }
            }),
        )
    };
    let (largest_n, cause) = spikes(1);
    assert!(largest_n < 20e3 && cause.is_none(), "{largest_n} N, {cause:?}");
    let (largest_n, cause) = spikes(2);
    let (cycle, cause) = cause.unwrap();
    assert_eq!((cause.signal, cycle + 1 - FAULT, cause.action), (Signal::Force, 2, Action::Stop));
    assert!(largest_n < 20e3 && cause.value == 99e3 && cause.limit == 40e3, "{cause:?}");
}

#[test]
fn row_12_a_spike_in_every_other_cycle_ends_the_run() {
    let cause = found(changed(|since, measured| {
        if since % 2 == 0 {
            measured.force_n = Some(99e3);
        }
    }));
    assert_eq!(cause, Some((Signal::LostMeasurements, 17, Action::RampOut)));
}

#[test]
fn row_12_a_rate_that_no_damper_has_is_found_within_the_force_limit() {
    let cause = found(changed(|since, measured| {
        measured.force_n = Some(if since % 2 == 0 { 30e3 } else { -30e3 });
    }));
    assert_eq!(cause.map(|(signal, ..)| signal), Some(Signal::ForceRate));
}

#[test]
fn row_12_a_displacement_that_is_missing_asks_for_power_off() {
    let cause = found(changed(|_, measured| measured.displacement_m = None));
    assert_eq!(cause, Some((Signal::InvalidDisplacement, 5, Action::PowerOff)));
}

#[test]
fn row_13_a_reversed_force_is_found_within_two_cycles_of_the_motion() {
    let cause = found(changed(|_, measured| measured.force_n = measured.force_n.map(|n| -n)));
    let (signal, cycles, action) = cause.unwrap();
    assert_eq!((signal, action), (Signal::Work, Action::RampOut));
    assert!(cycles < 2 * 286, "{cycles}");
}

#[test]
fn row_13_a_tenfold_force_is_found_in_two_cycles() {
    let cause = found(changed(|_, measured| measured.force_n = measured.force_n.map(|n| 10.0 * n)));
    let (signal, cycles, _) = cause.unwrap();
    assert!(
        matches!(signal, Signal::Force | Signal::ForceRate) && cycles < 60,
        "{signal:?} {cycles}"
    );
}

#[test]
fn row_14_a_step_of_the_displacement_is_found_at_once() {
    let cause = found(changed(|_, m| m.displacement_m = m.displacement_m.map(|x| x + 1e-3)));
    assert_eq!(cause, Some((Signal::Velocity, 1, Action::PowerOff)));
}

#[test]
fn row_14_a_displacement_that_runs_away_asks_for_power_off() {
    let cause = found(changed(|since, m| {
        m.displacement_m = m.displacement_m.map(|x| x + 50e-6 * f64::from(since));
    }));
    let (signal, cycles, action) = cause.unwrap();
    assert_eq!((signal, action), (Signal::Tracking, Action::PowerOff));
    assert!((100..106).contains(&cycles), "{cycles}");
}

#[test]
fn row_18_a_rig_that_starts_anew_is_out_of_step() {
    let cause = found(changed(|since, measured| {
        measured.counter = (since % u32::from(MODULUS)) as u8;
        measured.echo = None;
    }));
    // It answers nothing until it has a command: the cycles count as lost.
    assert_eq!(cause.map(|(_, cycles, action)| (cycles, action)), Some((5, Action::Stop)));
}

#[test]
fn a_damaged_frame_is_held_and_five_in_a_row_stop() {
    let cause = found(|n, m| if n >= FAULT { Arrival::Damaged } else { Arrival::Frame(m) });
    assert_eq!(cause, Some((Signal::WrongSeal, 5, Action::Stop)));
    // One that is lost among them, and they count as lost.
    let cause = found(|n, m| match n {
        n if n == FAULT + 1 => Arrival::Nothing,
        n if n >= FAULT => Arrival::Damaged,
        _ => Arrival::Frame(m),
    });
    assert_eq!(cause, Some((Signal::LostMeasurements, 5, Action::Stop)));
}
