//! Every check of the table by its own limit, debounce and action.

use crate::rig::{Bench, CYCLE_S, FAULT};
use firmware_core::supervision::{
    Action, Arrival, Belief, Checks, Condition, Measured, RESIDUAL_SHARE, Signal,
};

/// Runs into a change of the measurements from [`FAULT`] on, under changed checks: the signal, the
/// cycles since then and the action of the first cause.
fn found(
    checks: impl Fn(&mut Checks),
    change: impl Fn(u32, &mut Measured),
) -> Option<(Signal, u32, Action)> {
    let (cycle, cause) = run(&mut bench(checks), change)?;
    Some((cause.signal, cycle + 1 - FAULT, cause.action))
}

fn bench(checks: impl Fn(&mut Checks)) -> Bench {
    let mut bench = Bench::new(0.5e-3);
    checks(&mut bench.checks);
    bench
}

fn run(
    bench: &mut Bench,
    change: impl Fn(u32, &mut Measured),
) -> Option<(u32, firmware_core::supervision::Cause)> {
    bench.run(FAULT + 5000, |cycle, mut measured| {
        if cycle >= FAULT {
            change(cycle - FAULT, &mut measured);
        }
        Arrival::Frame(measured)
    })
}

/// Moves the measured displacement.
fn moved(change: impl Fn(u32) -> f64) -> impl Fn(u32, &mut Measured) {
    move |since, measured| {
        measured.displacement_m = measured.displacement_m.map(|x| x + change(since));
    }
}

#[test]
fn a_displacement_beyond_the_stroke_stops_in_its_second_cycle() {
    // It creeps there, and tracking says nothing.
    let creep = moved(|since| 20e-6 * f64::from(since));
    let found = found(
        |checks| {
            checks.displacement.limit = 10e-3;
            checks.tracking.limit = 1.0;
        },
        creep,
    );
    let (signal, cycles, action) = found.unwrap();
    assert_eq!((signal, action), (Signal::Displacement, Action::Stop));
    // 3.46 mm of motion, the rest of creep: between 327 and 500 cycles, and the second one.
    assert!((327..=502).contains(&cycles), "{cycles}");
}

#[test]
fn a_displacement_that_rattles_by_a_fifth_of_a_millimetre_asks_for_power_off() {
    // 0.4 m/s and 800 m/s2: neither speed nor tracking finds it.
    let rattle = |since: u32| if since.is_multiple_of(2) { 0.2e-3 } else { -0.2e-3 };
    let cause = found(|_| {}, moved(rattle));
    assert_eq!(cause, Some((Signal::Acceleration, 5, Action::PowerOff)));
    assert_eq!(found(|checks| checks.acceleration.limit = 1e4, moved(rattle)), None);
}

#[test]
fn a_clock_that_slips_by_a_period_is_no_acceleration() {
    // At the highest speed of a command the ram is a period ahead for one cycle.
    let slip = |since: u32| if since == 500 { 0.5e-3 } else { 0.0 };
    let wide = |checks: &mut Checks| checks.velocity.limit = 1.0;
    assert_eq!(found(wide, moved(slip)), None);
}

#[test]
fn noise_of_the_laboratory_rig_stays_far_below_the_limit_of_the_acceleration() {
    let mut state = 5_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    // Twelve uniform numbers are a normal one; steps of 0.2 um. A tenth of an hour.
    let mut reading = || {
        let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        (normal * 0.2e-6 / 0.2e-6).round() * 0.2e-6
    };
    let mut last = [reading(), reading()];
    let (mut largest, mut square) = (0.0_f64, 0.0_f64);
    for _ in 0..360_000 {
        let x = reading();
        let a = (x - 2.0 * last[1] + last[0]) / (CYCLE_S * CYCLE_S);
        (largest, square) = (largest.max(a.abs()), square + a * a);
        last = [last[1], x];
    }
    let rms = (square / 360_000.0).sqrt();
    assert!((0.49..0.53).contains(&rms) && largest < 3.6, "{rms} {largest}");
}

#[test]
fn a_temperature_ramps_out_after_its_debounce() {
    let checks = Bench::new(0.5e-3).checks;
    let mut belief = Belief::default();
    for cycle in 1..200 {
        belief.temperature(&checks, 101.0);
        assert_eq!(belief.cause().is_some(), cycle >= 100, "{cycle}");
    }
    let cause = belief.cause().unwrap();
    assert_eq!((cause.signal, cause.action), (Signal::Temperature, Action::RampOut));
}

#[test]
fn a_residual_only_logs_and_may_end_a_run_by_choice() {
    let judged = |action| {
        let mut checks = Bench::new(0.5e-3).checks;
        (checks.residual.limit, checks.residual.action) = (5e3, action);
        let mut belief = Belief::default();
        for _ in 0..2000 {
            belief.residual(&checks, 8e3);
        }
        belief
    };
    let usual = Bench::new(0.5e-3).checks.residual;
    assert_eq!((usual.limit, usual.action), (40e3 * RESIDUAL_SHARE, Action::Log));
    let logged = judged(Action::Log);
    assert_eq!(logged.cause(), None);
    let noted: Vec<_> = logged.noted().collect();
    assert_eq!(noted.len(), 1);
    // 8 kN (1 - exp(-t))^(1/2) passes 5 kN after 0.496 s.
    assert_eq!((noted[0].first.signal, noted[0].times), (Signal::Residual, 2000 - 495));
    let cause = judged(Action::RampOut).cause().unwrap();
    assert_eq!((cause.signal, cause.limit), (Signal::Residual, 5e3));
}

#[test]
fn what_is_logged_is_believed_and_ends_nothing() {
    let mut bench = bench(|checks| {
        checks.force.action = Action::Log;
        checks.force_rate.action = Action::Log;
    });
    let (largest_n, cause) = bench.cycles(FAULT + 1000, |cycle, mut measured| {
        if (FAULT..FAULT + 3).contains(&cycle) {
            measured.force_n = Some(99e3);
        }
        Arrival::Frame(measured)
    });
    assert_eq!((largest_n, cause), (99e3, None));
    let noted: Vec<_> =
        bench.belief.noted().map(|n| (n.first.signal, n.times, n.largest)).collect();
    // Two cycles of debounce.
    assert_eq!(noted, [(Signal::Force, 2, 99e3)]);
}

#[test]
fn what_is_held_is_not_believed_and_ends_nothing() {
    let mut bench = bench(|checks| {
        checks.force.action = Action::Hold;
        checks.force_rate.action = Action::Hold;
    });
    let (largest_n, cause) = bench.cycles(FAULT + 1000, |cycle, mut measured| {
        if (FAULT..FAULT + 500).contains(&cycle) {
            measured.force_n = Some(99e3);
        }
        Arrival::Frame(measured)
    });
    // A force that stays the same is stuck after 20 cycles, whatever is held.
    assert!(
        largest_n < 20e3
            && cause.is_some_and(|(n, c)| { c.signal == Signal::StuckForce && n == FAULT + 19 })
    );
    bench.checks.stuck_force.action = Action::Log;
    bench.belief = Belief::default();
    let (largest_n, cause) = bench.cycles(FAULT + 1000, |cycle, mut measured| {
        if (FAULT..FAULT + 500).contains(&cycle) {
            measured.force_n = Some(99e3);
        }
        Arrival::Frame(measured)
    });
    assert!(largest_n < 20e3 && cause.is_none(), "{largest_n} {cause:?}");
    let held = bench.belief.noted().find(|noted| noted.first.signal == Signal::Force).unwrap();
    assert_eq!((held.first_cycle, held.times), (u64::from(FAULT), 500));
    assert_eq!(bench.belief.losses().0.total(), 0, "what is held is not lost");
}

#[test]
fn a_tighter_age_is_kept() {
    let late = |limit: f64| {
        let mut sent: Vec<Measured> = Vec::new();
        let mut bench = bench(|checks| checks.age.limit = limit);
        bench.run(FAULT + 1000, |cycle, measured| {
            sent.push(measured);
            Arrival::Frame(sent[(cycle - if cycle < FAULT { 0 } else { 3 }) as usize])
        })
    };
    assert_eq!(late(3.0), None);
    assert!(late(2.0).is_some_and(|(_, cause)| cause.signal == Signal::OldMeasurements));
}

#[test]
fn a_tighter_number_of_losses_in_a_row_is_kept() {
    let lost = |in_a_row| {
        let mut bench = bench(|checks| checks.lost.in_a_row = in_a_row);
        bench.run(FAULT + 1000, |cycle, measured| {
            if (FAULT..FAULT + 3).contains(&cycle) {
                Arrival::Nothing
            } else {
                Arrival::Frame(measured)
            }
        })
    };
    assert_eq!(lost(4), None);
    assert!(lost(3).is_some_and(|(cycle, _)| cycle == FAULT + 2));
}

#[test]
fn conditions_take_their_own_number_of_cycles_and_action() {
    let stuck = Condition { cycles: 50, action: Action::Stop };
    let frozen = |_: u32, measured: &mut Measured| measured.force_n = Some(8123.4);
    let cause = found(|checks| checks.stuck_force = stuck, frozen);
    assert_eq!(cause, Some((Signal::StuckForce, 50, Action::Stop)));
    let invalid = Condition { cycles: 2, action: Action::RampOut };
    let without = |_: u32, measured: &mut Measured| measured.is_valid = false;
    let cause = found(|checks| checks.invalid_force = invalid, without);
    assert_eq!(cause, Some((Signal::InvalidForce, 2, Action::RampOut)));
    let reversed = |_: u32, measured: &mut Measured| {
        measured.force_n = measured.force_n.map(|n| -n);
    };
    let cause = found(|checks| checks.wrong_sign = Action::Stop, reversed);
    assert!(
        cause.is_some_and(|(signal, _, action)| {
            (signal, action) == (Signal::Work, Action::Stop)
        })
    );
}
