use super::*;
use core::f64::consts::TAU;

const PERIOD_S: f64 = 1e-3;

/// A lag of first order behind a gain and a transport delay of whole cycles.
struct Rig {
    gain: f64,
    lag_s: f64,
    cycles: usize,
    line: [f64; 32],
    x: f64,
}

impl Rig {
    fn new(gain: f64, lag_s: f64, cycles: usize) -> Self {
        Self { gain, lag_s, cycles, line: [0.0; 32], x: 0.0 }
    }

    /// The displacement now; the command acts from now on.
    fn answer(&mut self, command_m: f64) -> f64 {
        let answer = self.gain * self.x;
        self.line.rotate_right(1);
        self.line[0] = command_m;
        let goal = self.line[self.cycles];
        self.x += (goal - self.x) * (1.0 - libm::exp(-PERIOD_S / self.lag_s));
        answer
    }
}

/// Two sines that are faded in.
fn wanted(t: f64) -> Command {
    let mut sum = Command { displacement_m: 0.0, velocity_m_per_s: 0.0 };
    for (hz, amplitude_m) in [(1.3, 2e-3), (3.7, 3e-3)] {
        let omega = TAU * hz;
        let (sin, cos) = libm::sincos(omega * t);
        let (fade, rises) = (1.0 - libm::exp(-t * t), 2.0 * t * libm::exp(-t * t));
        sum.displacement_m += amplitude_m * fade * sin;
        sum.velocity_m_per_s += amplitude_m * (fade * omega * cos + rises * sin);
    }
    sum
}

/// Runs a compensator on a rig whose answers arrive so many cycles late; the rms error of the last
/// second relative to the motion, and the state.
fn track(
    compensator: &Compensator,
    rig: &mut Rig,
    late: u32,
    seconds: u32,
    arrives: impl Fn(u32) -> bool,
) -> (f64, CompensatorState) {
    let mut state = compensator.start();
    let mut answers = [0.0; 8];
    let (mut error, mut size) = (0.0, 0.0);
    let cycles = seconds * 1000;
    for k in 0..cycles {
        let motion = wanted(f64::from(k) * PERIOD_S);
        // Not yet known in this cycle: the rig answers the command that is computed now.
        let answer =
            Answer { displacement_m: answers[late as usize - 1], force_n: 0.0, age_cycles: late };
        let answer = (k > late && arrives(k)).then_some(answer);
        let command = compensator.step(&mut state, motion, answer, PERIOD_S);
        let measured = rig.answer(command.displacement_m);
        answers.rotate_right(1);
        answers[0] = measured;
        if k + 1000 >= cycles {
            error += (measured - motion.displacement_m) * (measured - motion.displacement_m);
            size += motion.displacement_m * motion.displacement_m;
        }
    }
    (crate::sqrt::sqrt(error / size), state)
}

#[test]
fn a_polynomial_is_exact_for_motions_of_its_degree() {
    let delay_s = 0.02;
    for order in 1..=3_u8 {
        let compensator = Compensator::Feedforward(Feedforward::polynomial(order, delay_s));
        let mut state = compensator.start();
        let n = i32::from(order);
        for k in 0..200_u32 {
            let t = f64::from(k) * PERIOD_S;
            let power = |t: f64| (0..n).fold(1.0, |product, _| product * t);
            let slope = |t: f64| f64::from(n) * (1..n).fold(1.0, |product, _| product * t);
            let now = Command { displacement_m: power(t), velocity_m_per_s: slope(t) };
            let command = compensator.step(&mut state, now, None, PERIOD_S);
            if k >= 2 {
                let error = command.displacement_m - power(t + delay_s);
                assert!(error.abs() < 1e-9, "order {order}, {t} s: {error}");
                let error = command.velocity_m_per_s - slope(t + delay_s);
                assert!(order == 3 || error.abs() < 1e-8, "order {order}, {t} s: {error} m/s");
            }
        }
    }
}

#[test]
fn the_inverse_of_a_lag_removes_it() {
    let (gain, lag_s) = (0.97, 0.012);
    // A command is held for a cycle: half of it is delay.
    let inverse = Feedforward::inverse([1.0 / gain, lag_s / gain, 0.0, 0.0]);
    let inverse = Compensator::Feedforward(inverse.with_known_delay(0.5 * PERIOD_S));
    let (error, _) = track(&inverse, &mut Rig::new(gain, lag_s, 0), 1, 6, |_| true);
    assert!(error < 1e-3, "{error}");
    let (error, _) = track(&Compensator::None, &mut Rig::new(gain, lag_s, 0), 1, 6, |_| true);
    assert!(error > 0.2, "{error}");
}

#[test]
fn a_compensator_starts_without_a_jump() {
    // In the midst of a motion, of which nothing before is known.
    let start = Series([1.0, 0.02, 2e-4, 1e-6]);
    for compensator in [
        Compensator::Feedforward(Feedforward::inverse(start.0)),
        Compensator::Adaptive(Adaptive::new(start, 60.0)),
    ] {
        let mut state = compensator.start();
        let mut last = None;
        for k in 0..20_u32 {
            let motion = wanted(10.0 + f64::from(k) * PERIOD_S);
            let command = compensator.step(&mut state, motion, None, PERIOD_S);
            if let Some(last_m) = last {
                let step_m: f64 = command.displacement_m - last_m;
                assert!(step_m.abs() < 1e-3, "cycle {k}: {step_m} m");
            }
            last = Some(command.displacement_m);
        }
    }
}

/// A start that is far from the rig, which has no mode and so leaves room for gain.
fn adaptive() -> Adaptive {
    Adaptive { gain_ratio: 2.0, ..Adaptive::new(Series([1.0, 0.01, 5e-5, 0.0]), 60.0) }
}

#[test]
fn an_adaptive_series_finds_a_lag_and_gain_it_was_not_started_with() {
    let (gain, lag_s, cycles) = (0.95, 0.008, 6);
    let fixed = Compensator::Feedforward(Feedforward::inverse(adaptive().start.0));
    let (before, _) = track(&fixed, &mut Rig::new(gain, lag_s, cycles), 1, 8, |_| true);
    for late in [1, 3] {
        let compensator = Compensator::Adaptive(adaptive());
        let mut rig = Rig::new(gain, lag_s, cycles);
        let (after, state) = track(&compensator, &mut rig, late, 8, |_| true);
        assert!(before > 0.1 && after < 0.01, "{late}: {before} without, {after} with");
        assert!(!state.has_run_away());
        let series = compensator.series(&state);
        let omega = TAU * 3.0;
        let true_delay_s = libm::atan(omega * lag_s) / omega + (cycles as f64 + 0.5) * PERIOD_S;
        assert!((series.delay_s(3.0) - true_delay_s).abs() < 2e-4, "{series:?} {true_delay_s}");
        let true_gain = libm::hypot(1.0, omega * lag_s) / gain;
        assert!((series.gain(3.0) / true_gain - 1.0).abs() < 0.01, "{series:?} {true_gain}");
    }
}

#[test]
fn lost_answers_do_not_disturb_an_adaptive_series() {
    let compensator = Compensator::Adaptive(adaptive());
    let all = track(&compensator, &mut Rig::new(0.95, 0.008, 6), 1, 8, |_| true).0;
    let some = |k: u32| !k.is_multiple_of(7) && k % 7 != 1 && !(4000..4020).contains(&k);
    let (few, state) = track(&compensator, &mut Rig::new(0.95, 0.008, 6), 1, 8, some);
    assert!(few < all + 2e-3 && !state.has_run_away(), "{few}, with all of them {all}");
}

#[test]
fn nonsense_makes_an_adaptive_series_fall_back_for_good() {
    let compensator = Compensator::Adaptive(adaptive());
    let start = adaptive().start;
    for (what, answer) in [
        ("wrong sign", (|_, command| -command) as fn(f64, f64) -> f64),
        ("another motion", |t, _| 3e-3 * libm::sin(TAU * 2.2 * t)),
        ("half of the motion", |_, command| 0.5 * command),
        ("overflow", |t, _| if t > 1.0 { 1e300 } else { 0.0 }),
    ] {
        let mut state = compensator.start();
        let mut fell_at_s = None;
        for k in 0..12_000_u32 {
            let t = f64::from(k) * PERIOD_S;
            let motion = wanted(t);
            let displacement_m = answer(t, motion.displacement_m);
            let answer = Some(Answer { displacement_m, force_n: 0.0, age_cycles: 0 });
            let command = compensator.step(&mut state, motion, answer, PERIOD_S);
            assert!(command.displacement_m.abs() < 0.02, "{what}: {command:?}");
            if state.has_run_away() {
                fell_at_s.get_or_insert(t);
            }
        }
        assert!(fell_at_s.is_some_and(|t| t > RUNAWAY_S && t < 8.0), "{what}: {fell_at_s:?}");
        assert_eq!(compensator.series(&state), start, "{what}");
    }
}

#[test]
fn without_motion_or_answers_the_coefficients_hold() {
    let compensator = Compensator::Adaptive(adaptive());
    let start = compensator.series(&compensator.start());
    let mut state = compensator.start();
    let mut random = 7_u64;
    for k in 0..5000_u32 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let noise_m = 4e-5 * ((random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        let motion = Command { displacement_m: 0.0, velocity_m_per_s: 0.0 };
        let answers = [
            Some(Answer { displacement_m: 0.01 + noise_m, force_n: 0.0, age_cycles: 1 }),
            Some(Answer { displacement_m: f64::NAN, force_n: f64::NAN, age_cycles: 1 }),
            Some(Answer { displacement_m: 0.01, force_n: 0.0, age_cycles: 1_000_000 }),
            None,
        ];
        let answer = answers[(k as usize / 1000) % answers.len()];
        compensator.step(&mut state, motion, answer, PERIOD_S);
    }
    assert_eq!(compensator.series(&state), start);
    assert!(!state.has_run_away());
}

#[test]
fn the_gain_at_the_mode_of_the_rig_is_bounded() {
    let parameters = Adaptive { reach: [1.0, 1.0, 1.0], ..adaptive() };
    let compensator = Compensator::Adaptive(parameters);
    let mut state = compensator.start();
    let most = parameters.gain_ratio * parameters.start.gain(60.0);
    let (mut highest, mut last_m) = (0.0_f64, 0.0);
    for k in 0..6000_u32 {
        let t = f64::from(k) * PERIOD_S;
        // A rig with a large second-order term: u = x + 0.01 x' + 3e-4 x''.
        let omega = TAU * 4.0;
        let (sin, cos) = libm::sincos(omega * t);
        let (slow, slow_cos) = libm::sincos(0.4 * omega * t);
        let x = 3e-3 * (sin + slow);
        let velocity = 3e-3 * omega * (cos + 0.4 * slow_cos);
        let bend = -3e-3 * omega * omega * (sin + 0.16 * slow);
        let u = x + 0.01 * velocity + 3e-4 * bend;
        let motion = Command { displacement_m: u, velocity_m_per_s: 0.0 };
        let answer = Some(Answer { displacement_m: last_m, force_n: 0.0, age_cycles: 1 });
        last_m = x;
        compensator.step(&mut state, motion, answer, PERIOD_S);
        // As if the command had been this one.
        state.sent(motion);
        highest = highest.max(compensator.series(&state).gain(60.0));
    }
    assert!(highest <= most * (1.0 + 1e-12), "{highest} of {most}");
    assert!(highest > 0.999 * most, "{highest} of {most}");
    assert!(!state.has_run_away());
}

#[test]
fn a_gain_at_its_bound_does_not_make_the_coefficients_jump() {
    // A start of first order has little gain: the first order reaches the bound too.
    let parameters = Adaptive::new(Series([1.0, 0.005, 0.0, 0.0]), 60.0);
    let compensator = Compensator::Adaptive(parameters);
    let (mut state, mut rig) = (compensator.start(), Rig::new(1.0, 0.007, 0));
    let mut measured_m = 0.0;
    let mut last = compensator.series(&state);
    for k in 0..6000_u32 {
        let answer = Some(Answer { displacement_m: measured_m, force_n: 0.0, age_cycles: 1 });
        let motion = wanted(f64::from(k) * PERIOD_S);
        let command = compensator.step(&mut state, motion, answer, PERIOD_S);
        measured_m = rig.answer(command.displacement_m);
        let series = compensator.series(&state);
        assert!(series.gain(60.0) <= 1.25 * parameters.start.gain(60.0) * (1.0 + 1e-12));
        let change = (series.0[1] - last.0[1]).abs();
        assert!(change <= parameters.rate_per_s[1] * PERIOD_S * 1.001, "cycle {k}: {change}");
        last = series;
    }
    assert!(last.0[1] > 0.0065, "{last:?}");
}

#[test]
fn a_wanted_motion_that_is_no_number_passes_and_leaves_no_trace() {
    let compensator = Compensator::Adaptive(adaptive());
    let mut state = compensator.start();
    for k in 0..3000_u32 {
        let mut motion = wanted(f64::from(k) * PERIOD_S);
        if k == 1500 {
            motion = Command { displacement_m: f64::NAN, velocity_m_per_s: f64::NAN };
        }
        let answer =
            Some(Answer { displacement_m: motion.displacement_m, force_n: 0.0, age_cycles: 0 });
        let command = compensator.step(&mut state, motion, answer, PERIOD_S);
        assert_eq!(command.displacement_m.is_nan(), k == 1500, "cycle {k}");
    }
    assert!(!compensator.series(&state).0.iter().any(|a| a.is_nan()));
}
