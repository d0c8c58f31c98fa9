//! The motion of an open-loop visit: one test after the other, with slow ways between them.
//!
//! ```text
//! where the ram stands -> way -> [wait or warm up] -> test 1 -> way -> test 2 -> ... -> way back
//! ```
//! Behind a test the ram brakes to rest. A way is a raised cosine in time,
//! `x = x_0 + (1 - cos(pi t / T)) / 2 (x_1 - x_0)`, and a short rest. Before each test the oil is
//! brought into its temperature window: a warm damper rests, a cold one is stroked slowly. Where
//! the window is not reached in time, the test is left out.
//!
//! A test counts from mid-stroke, or from where the ram stood at the start: with a rigid bar
//! between its eyes the ram has no other place. A sequence that does not return ends without the
//! way back.

use crate::control::{Motion, Seen};
use core::f64::consts::PI;
use firmware_core::command::{Command, STOP_DECELERATION_M_PER_S2};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::CYCLE_S;
use std::ops::RangeInclusive;

/// Highest speed on the way to a test (m/s).
const WAY_M_PER_S: f64 = 20e-3;
/// Shortest time of a way (s), and the rest behind it.
const WAY_LEAST_S: f64 = 0.5;
const REST_CYCLES: usize = 200;
/// Stroke and period of the strokes that warm the oil.
const WARM_UP_M: f64 = 10e-3;
const WARM_UP_CYCLES: usize = 1000;
/// Longest time to wait for the oil (cycles): half an hour.
const PATIENCE_CYCLES: u64 = 1_800_000;

/// What the displacements of a test count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Origin {
    /// Mid-stroke.
    #[default]
    MidStroke,
    /// Where the ram stood at the start.
    WhereItStands,
}

/// A sequence of prescribed motions of one rig.
#[derive(Debug)]
pub(super) struct Sequence {
    slot: usize,
    tests: Vec<Vec<Command>>,
    window_degc: Option<RangeInclusive<f64>>,
    origin: Origin,
    returns: bool,
    phase: Phase,
    /// First and last cycle of each test that was run.
    cycles: Vec<Option<(u64, u64)>>,
    home_m: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Not begun.
    Start,
    /// On the way to a test, or home behind the last.
    Way { test: usize, from_m: f64, to_m: f64, at: usize, of: usize },
    /// The oil is too warm or too cold for a test.
    Oil { test: usize, since: u64, stroke: Option<usize> },
    /// In a test.
    Test { test: usize, at: usize },
    /// Coming to rest behind a test.
    Braking { test: usize },
    /// Done.
    Over,
}

impl Sequence {
    /// A sequence of tests, each with a command per cycle.
    pub(super) fn new(
        slot: usize,
        tests: Vec<Vec<Command>>,
        window_degc: Option<RangeInclusive<f64>>,
    ) -> Self {
        debug_assert!(slot < DAMPER_SLOTS, "slot {slot}");
        let cycles = vec![None; tests.len()];
        let (origin, phase) = (Origin::MidStroke, Phase::Start);
        Self { slot, tests, window_degc, origin, returns: true, phase, cycles, home_m: None }
    }

    /// The same with tests that count from elsewhere.
    pub(super) fn counting_from(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// The same with or without the way back.
    pub(super) fn returning(self, returns: bool) -> Self {
        Self { returns, ..self }
    }

    /// First and last cycle of each test; none for one that was not run to its end.
    pub(super) fn cycles(&self) -> &[Option<(u64, u64)>] {
        &self.cycles
    }

    /// Cycles that the sequence takes without waiting for the oil, about.
    pub(super) fn expected_cycles(&self) -> u64 {
        let ways = self.tests.len() as u64 + 1;
        let tests: u64 = self.tests.iter().map(|test| test.len() as u64).sum();
        tests + ways * (REST_CYCLES as u64 + (WAY_LEAST_S / CYCLE_S) as u64)
    }

    /// Displacement of mid-stroke, or of where the ram stood, for a ram that stands at `ram_m` (m).
    fn origin_m(&self, ram_m: f64) -> f64 {
        match self.origin {
            Origin::MidStroke => 0.0,
            Origin::WhereItStands => self.home_m.unwrap_or(ram_m),
        }
    }

    /// The way from where the ram is to the begin of a test, or home.
    fn way_to(&self, test: usize, from_m: f64) -> Phase {
        if test >= self.tests.len() && !self.returns {
            return Phase::Over;
        }
        let home_m = self.home_m.unwrap_or(from_m);
        let first = self.tests.get(test).and_then(|test| test.first());
        let begins_m = first.map(|command| self.origin_m(from_m) + command.displacement_m);
        let to_m = begins_m.unwrap_or(home_m);
        let needed_s = PI * (to_m - from_m).abs() / (2.0 * WAY_M_PER_S);
        let of = (needed_s.max(WAY_LEAST_S) / CYCLE_S) as usize;
        Phase::Way { test, from_m, to_m, at: 0, of }
    }

    /// Whether the oil is where a test wants it; a rig without a thermometer cannot say.
    fn oil(&self, seen: &Seen) -> Oil {
        let measured = seen.temperature_degc.get(self.slot).copied().flatten();
        match (&self.window_degc, measured) {
            (Some(window), Some(degc)) if degc < *window.start() => Oil::Cold,
            (Some(window), Some(degc)) if degc > *window.end() => Oil::Warm,
            _ => Oil::Fit,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Oil {
    Cold,
    Fit,
    Warm,
}

impl Motion for Sequence {
    fn reach_m(&self, slot: usize, ram_m: f64) -> f64 {
        if slot != self.slot {
            return ram_m.abs();
        }
        let origin_m = self.origin_m(ram_m);
        let at = |command: &Command| origin_m + command.displacement_m;
        let strokes = self.window_degc.is_some();
        // Oil is warmed from where a test begins, or where the ram stands.
        let begins = self.tests.iter().map(|test| test.first().map_or(ram_m, at));
        let warmed = begins.filter(|_| strokes).map(|from_m| from_m + WARM_UP_M);
        let places = self.tests.iter().flatten().map(at).chain(warmed);
        places.fold(ram_m.abs(), |most, x_m| most.max(x_m.abs()))
    }

    fn next(&mut self, seen: &Seen) -> Option<[Command; DAMPER_SLOTS]> {
        let now = seen.commands.get(self.slot).copied().unwrap_or_default();
        let held = Command { velocity_m_per_s: 0.0, ..now };
        let command = loop {
            match self.phase {
                Phase::Start => {
                    self.home_m = Some(now.displacement_m);
                    self.phase = self.way_to(0, now.displacement_m);
                }
                Phase::Way { test, to_m, at, of, .. } if at >= of + REST_CYCLES => {
                    let is_home = test >= self.tests.len();
                    let (since, stroke) = (seen.cycle, None);
                    self.phase =
                        if is_home { Phase::Over } else { Phase::Oil { test, since, stroke } };
                    debug_assert!(to_m.is_finite());
                }
                Phase::Way { test, from_m, to_m, at, of } => {
                    self.phase = Phase::Way { test, from_m, to_m, at: at + 1, of };
                    break on_the_way(from_m, to_m, at + 1, of);
                }
                Phase::Oil { test, since, stroke: Some(at) } => {
                    let stroke = (at + 1 < WARM_UP_CYCLES).then_some(at + 1);
                    self.phase = Phase::Oil { test, since, stroke };
                    break stroked(now, at);
                }
                Phase::Oil { test, since, stroke: None } => match self.oil(seen) {
                    Oil::Fit => self.phase = Phase::Test { test, at: 0 },
                    _ if seen.cycle - since > PATIENCE_CYCLES => {
                        self.phase = self.way_to(test + 1, now.displacement_m);
                    }
                    Oil::Cold => self.phase = Phase::Oil { test, since, stroke: Some(0) },
                    Oil::Warm => break held,
                },
                Phase::Test { test, at } => {
                    let Some(command) = self.tests.get(test).and_then(|test| test.get(at)) else {
                        self.phase = Phase::Braking { test };
                        continue;
                    };
                    let is_last = self.tests.get(test).is_some_and(|test| at + 1 == test.len());
                    if let (true, Some(cycles)) = (is_last, self.cycles.get_mut(test)) {
                        *cycles = Some((seen.cycle - at as u64, seen.cycle));
                    }
                    let displacement_m = self.origin_m(now.displacement_m) + command.displacement_m;
                    let command = Command { displacement_m, ..*command };
                    self.phase = Phase::Test { test, at: at + 1 };
                    break command;
                }
                Phase::Braking { test } if now.velocity_m_per_s == 0.0 => {
                    self.phase = self.way_to(test + 1, now.displacement_m);
                }
                Phase::Braking { .. } => {
                    break now.stopping(CYCLE_S, STOP_DECELERATION_M_PER_S2);
                }
                Phase::Over => return None,
            }
        };
        let mut commands = [Command::default(); DAMPER_SLOTS];
        if let Some(own) = commands.get_mut(self.slot) {
            *own = command;
        }
        Some(commands)
    }
}

/// A cycle of a way from rest to rest, of so many: a raised cosine.
pub fn on_the_way(from_m: f64, to_m: f64, at: usize, of: usize) -> Command {
    let share = (at as f64 / of as f64).min(1.0);
    let (sin, cos) = libm::sincos(PI * share);
    let rate = if at < of { 0.5 * PI * sin / (of as f64 * CYCLE_S) } else { 0.0 };
    Command {
        displacement_m: from_m + 0.5 * (1.0 - cos) * (to_m - from_m),
        velocity_m_per_s: rate * (to_m - from_m),
    }
}

/// A cycle of a stroke that warms the oil: out and back, at rest at both ends. Only its difference
/// to the last cycle counts, so that it begins where the ram is.
fn stroked(now: Command, at: usize) -> Command {
    let angle = |cycle: usize| 2.0 * PI * cycle as f64 / WARM_UP_CYCLES as f64;
    let place = |cycle: usize| 0.5 * WARM_UP_M * (1.0 - libm::cos(angle(cycle)));
    let rate = PI / (WARM_UP_CYCLES as f64 * CYCLE_S);
    Command {
        displacement_m: now.displacement_m + place(at + 1) - place(at),
        velocity_m_per_s: WARM_UP_M * rate * libm::sin(angle(at + 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(cycle: u64, last: Command, degc: Option<f64>) -> Seen {
        let mut commands = [Command::default(); DAMPER_SLOTS];
        commands[0] = last;
        Seen { cycle, commands, temperature_degc: [degc; DAMPER_SLOTS] }
    }

    /// Plays a sequence with a temperature per cycle; the commands of its slot.
    fn played(sequence: &mut Sequence, degc: impl Fn(u64) -> Option<f64>) -> Vec<Command> {
        let start = Command { displacement_m: 3e-3, velocity_m_per_s: 0.0 };
        let mut commands = vec![start];
        for cycle in 1..100_000 {
            let last = commands[commands.len() - 1];
            match sequence.next(&seen(cycle, last, degc(cycle))) {
                Some(next) => commands.push(next[0]),
                None => break,
            }
        }
        commands
    }

    fn test(at_m: f64) -> Vec<Command> {
        let angle = |n: usize| 2.0 * PI * n as f64 / 500.0;
        let sine = |n| Command {
            displacement_m: at_m + 1e-3 * libm::sin(angle(n)),
            velocity_m_per_s: 1e-3 * 2.0 * PI / 0.5 * libm::cos(angle(n)),
        };
        (0..500).map(sine).collect()
    }

    #[test]
    fn tests_follow_each_other_without_a_step_and_end_where_the_ram_stood() {
        let mut sequence = Sequence::new(0, vec![test(0.0), test(-40e-3)], None);
        let commands = played(&mut sequence, |_| None);
        for pair in commands.windows(2) {
            let step_m = (pair[1].displacement_m - pair[0].displacement_m).abs();
            assert!(step_m <= 1.05 * WAY_M_PER_S * CYCLE_S, "{step_m}");
        }
        let last = commands[commands.len() - 1];
        assert!((last.displacement_m - 3e-3).abs() < 1e-12 && last.velocity_m_per_s == 0.0);
        // 3 mm need the shortest way, 40 mm more than three seconds.
        let [Some(first), Some(second)] = sequence.cycles()[..] else { panic!("{sequence:?}") };
        assert_eq!(first, (701, 1200));
        assert_eq!(second.1 - second.0, 499);
        assert!((3000..4000).contains(&(second.0 - first.1)), "{second:?}");
        assert_eq!(commands[first.0 as usize], test(0.0)[0]);
    }

    #[test]
    fn cold_oil_is_stroked_warm_oil_rests_and_what_never_fits_is_left_out() {
        let window = Some(20.0..=30.0);
        let mut sequence = Sequence::new(0, vec![test(0.0)], window.clone());
        let commands = played(&mut sequence, |cycle| Some(15.0 + 1e-3 * cycle as f64));
        let Some((begin, _)) = sequence.cycles()[0] else { panic!("{sequence:?}") };
        // 20 degrees after 5000 cycles, at the end of a stroke.
        assert_eq!((begin - 701) % WARM_UP_CYCLES as u64, 0);
        assert!((5000..6001).contains(&begin), "{begin}");
        let most = commands.iter().map(|c| c.displacement_m).fold(0.0_f64, f64::max);
        assert!((most - WARM_UP_M).abs() < 1e-5, "{most}");

        let mut sequence = Sequence::new(0, vec![test(0.0)], window);
        played(&mut sequence, |cycle| Some(32.0 - 1e-3 * cycle as f64));
        assert_eq!(sequence.cycles()[0].map(|(begin, _)| begin), Some(2000));
    }

    #[test]
    fn a_test_about_where_the_ram_stands_may_leave_it_there() {
        // From 3 mm on by 1 mm, in a tenth of a second.
        let angle = |n: usize| PI * n as f64 / 100.0;
        let way = |n| Command {
            displacement_m: 0.5e-3 * (1.0 - libm::cos(angle(n))),
            velocity_m_per_s: 0.5e-3 * PI / 0.1 * libm::sin(angle(n)),
        };
        let commands: Vec<Command> = (0..=100).map(way).collect();
        let about = |returns| {
            let sequence = Sequence::new(0, vec![commands.clone()], None);
            sequence.counting_from(Origin::WhereItStands).returning(returns)
        };
        for (returns, rests_m) in [(true, 3e-3), (false, 4e-3)] {
            let mut sequence = about(returns);
            assert!((sequence.reach_m(0, 3e-3) - 4e-3).abs() < 1e-12);
            assert!((sequence.reach_m(0, -3e-3) - 3e-3).abs() < 1e-12);
            let played = played(&mut sequence, |_| None);
            let last = played[played.len() - 1];
            assert!((last.displacement_m - rests_m).abs() < 1e-12, "{last:?}");
            for pair in played.windows(2) {
                let step_m = (pair[1].displacement_m - pair[0].displacement_m).abs();
                assert!(step_m <= WAY_M_PER_S * CYCLE_S, "{step_m}");
            }
        }
        // Strokes that warm the oil lead further than a test of 1 mm.
        let warmed = Sequence::new(0, vec![test(2e-3)], Some(20.0..=30.0));
        assert!((warmed.reach_m(0, 0.0) - 2e-3 - WARM_UP_M).abs() < 1e-12);
    }
}
