//! What is tried before a rig is armed: that it runs, and that it stops by itself.
//!
//! A rig whose map declares a time-out is moved a little and then left without commands. If its ram
//! goes on, it is not armed.
//!
//! ```text
//!  position       ____________  moves by itself: refused
//!     |       ___/.............  held: armed
//!     |  ____/   |         |          |
//!        noise  creep   time-out    watch    then back to where it stood
//! ```
//!
//! The ram creeps at 5 mm/s towards mid-stroke for 120 cycles, 0.55 mm. After the declared time and
//! 20 cycles its place is averaged over two halves of 200 cycles; a ram that runs on has moved by
//! 0.5 mm between them. It is held where the means differ by no more than the measured noise, the
//! resolution of the signal and 20 um. A part with too few measurements, of a rig or a host that
//! stood still for a moment, is repeated, three times at most.
//!
//! Limits: a rig that follows positions and holds the last one passes without any clock of its own,
//! and rightly so: it stops. That it also drops its pressure or its enable is not seen.

use super::codec::RigState;
use firmware_core::command::Command;
use std::fmt;
use std::time::Duration;

/// Speed of the creep (m/s), and cycles in which it is reached.
const CREEP_M_PER_S: f64 = 5e-3;
const RISE_CYCLES: u32 = 20;

/// Cycles of the parts.
const ENABLE_CYCLES: u32 = 20;
const NOISE_CYCLES: u32 = 100;
const CREEP_CYCLES: u32 = 120;
const SETTLE_CYCLES: u32 = 20;
const WATCH_CYCLES: u32 = 200;

/// Cycles within which a rig has to run, or its ram to be back.
const PATIENCE_CYCLES: u32 = 700;

/// Fewest measurements of each half of a part that is judged, and how often a part that has fewer
/// is repeated.
const FEWEST: u32 = 10;
const MOST_REPEATS: u32 = 3;

/// Displacement that counts as none beyond noise and resolution (m).
const HELD_M: f64 = 20e-6;

/// More noise than this hides what is looked for (m).
const MOST_NOISE_M: f64 = 0.1e-3;

/// Why a rig is not ready.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unready {
    /// It gives no displacement.
    NoMeasurement,
    /// It does not say that it runs.
    NotRunning,
    /// Its displacement is too noisy for the trial of its time-out: spread (m).
    Noisy(f64),
    /// Its ram has not followed the creep: how far it came (m).
    DoesNotFollow(f64),
    /// Its ram goes on without commands: how far it went within 100 cycles (m).
    RunsOn(f64),
    /// It does not run again after its time-out.
    StaysStopped,
    /// Somebody else sends commands to it.
    SecondSender,
}

impl fmt::Display for Unready {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMeasurement => {
                f.write_str("found no displacement in its measurements, expected one per cycle")
            }
            Self::NotRunning => {
                f.write_str("found no state \"running\" after it was enabled, expected one")
            }
            Self::Noisy(spread_m) => write!(
                f,
                "found a noise of {:.3} mm of its ram at rest, expected at most 0.1 mm, to try its \
                 time-out",
                spread_m * 1e3
            ),
            Self::DoesNotFollow(moved_m) => write!(
                f,
                "found its ram moved by {:.3} mm, expected at least half of a creep of 0.55 mm, to \
                 try its time-out",
                moved_m * 1e3
            ),
            Self::RunsOn(moved_m) => write!(
                f,
                "found its ram moving on by {:.3} mm after its declared time-out, expected it to \
                 stop",
                moved_m * 1e3
            ),
            Self::StaysStopped => f.write_str(
                "found it stopped after the trial of its time-out, expected it to run again",
            ),
            Self::SecondSender => {
                f.write_str("found commands of another node, expected those of this host alone")
            }
        }
    }
}

/// What the gateway is to do in a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order {
    /// Send nothing.
    Nothing,
    /// Send a command, with the rig enabled or not.
    Say(Command, bool),
}

/// Where the preparation stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Preparation {
    /// Not begun.
    Idle,
    Going(Trial),
    /// The rig runs and holds here (m).
    Ready(f64),
    Refused(Unready),
}

/// What a rig has to offer for its preparation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Offer {
    /// Declared time-out, in cycles; none without one.
    pub(super) time_out_cycles: Option<u32>,
    /// Whether the rig says its state.
    pub(super) has_state: bool,
    /// Resolution of its displacement (m).
    pub(super) resolution_m: f64,
}

/// A preparation that goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trial {
    offer: Offer,
    part: Part,
    /// Cycles of this part so far.
    cycles: u32,
    /// Time at its beginning, once it has had a cycle, and now.
    began: Option<Duration>,
    now: Duration,
    /// Where the ram stood at the start, once it is known (m).
    start_m: Option<f64>,
    reference: Command,
    noise_m: f64,
    seen: Seen,
    /// How often this part was begun again for want of measurements.
    repeats: u32,
    last_m: Option<f64>,
    /// Whether the rig is stopped once, to be enabled again.
    is_again: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Enable,
    Noise,
    Creep,
    Silence,
    Watch,
    Stop,
    Return,
}

/// Measured displacements of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    low_m: f64,
    high_m: f64,
    /// Sum and number, by halves of the part.
    halves: [(f64, u32); 2],
}

impl Default for Seen {
    fn default() -> Self {
        Self { low_m: f64::INFINITY, high_m: f64::NEG_INFINITY, halves: [(0.0, 0); 2] }
    }
}

impl Seen {
    fn take(&mut self, is_late: bool, displacement_m: f64) {
        self.low_m = self.low_m.min(displacement_m);
        self.high_m = self.high_m.max(displacement_m);
        let [early, late] = &mut self.halves;
        let (sum, count) = if is_late { late } else { early };
        *sum += displacement_m;
        *count += 1;
    }

    /// Difference of the means of both halves; `None` with too few measurements.
    fn drift_m(&self) -> Option<f64> {
        let [(early, first), (late, second)] = self.halves;
        let is_enough = first >= FEWEST && second >= FEWEST;
        is_enough.then(|| late / f64::from(second) - early / f64::from(first))
    }
}

impl Preparation {
    /// Begins.
    pub(super) fn begin(offer: Offer) -> Self {
        debug_assert!(offer.time_out_cycles != Some(0), "a time-out of no cycle");
        Self::Going(Trial {
            offer,
            part: Part::Enable,
            cycles: 0,
            began: None,
            now: Duration::ZERO,
            start_m: None,
            reference: Command::default(),
            noise_m: 0.0,
            seen: Seen::default(),
            repeats: 0,
            last_m: None,
            is_again: false,
        })
    }

    /// Takes in a displacement that the rig has measured (m).
    pub(super) fn measured(&mut self, displacement_m: f64) {
        if let Self::Going(trial) = self {
            trial.measured(displacement_m);
        }
    }

    /// One cycle, with what the rig has said of its state last.
    /// `now` is the time of the rig: cycles of a host that was late may follow each other faster.
    pub(super) fn cycle(&mut self, state: Option<RigState>, now: Duration) -> Order {
        match self {
            Self::Idle | Self::Refused(_) => Order::Nothing,
            Self::Going(trial) => match trial.cycle(state, now) {
                Ok(None) => trial.order(),
                Ok(Some(at_m)) => {
                    *self = Self::Ready(at_m);
                    Order::Say(Command { displacement_m: at_m, velocity_m_per_s: 0.0 }, true)
                }
                Err(why) => {
                    let at_m = trial.last_m.unwrap_or_default();
                    *self = Self::Refused(why);
                    Order::Say(Command { displacement_m: at_m, velocity_m_per_s: 0.0 }, false)
                }
            },
            Self::Ready(at_m) => {
                Order::Say(Command { displacement_m: *at_m, velocity_m_per_s: 0.0 }, true)
            }
        }
    }
}

impl Trial {
    fn measured(&mut self, displacement_m: f64) {
        self.last_m = Some(displacement_m);
        let is_late = self.has_lasted(self.length() / 2);
        self.seen.take(is_late, displacement_m);
        if self.start_m.is_none() {
            self.start_m = Some(displacement_m);
            self.reference.displacement_m = displacement_m;
        }
    }

    /// Cycles of the part that it is in.
    fn length(&self) -> u32 {
        match self.part {
            Part::Enable | Part::Stop => ENABLE_CYCLES,
            Part::Noise => NOISE_CYCLES,
            Part::Creep => CREEP_CYCLES,
            Part::Silence => self.offer.time_out_cycles.unwrap_or(0) + SETTLE_CYCLES,
            Part::Watch => WATCH_CYCLES,
            Part::Return => PATIENCE_CYCLES,
        }
    }

    /// Whether so many cycles of this part have passed, and as much time.
    fn has_lasted(&self, cycles: u32) -> bool {
        let since = self.now.saturating_sub(self.began.unwrap_or(self.now));
        self.cycles >= cycles
            && since.as_secs_f64() >= f64::from(cycles.saturating_sub(1)) * CYCLE_S
    }

    /// What is sent in this cycle.
    fn order(&self) -> Order {
        match self.part {
            // Where the ram stands is not known yet.
            Part::Enable if self.start_m.is_none() => Order::Nothing,
            Part::Silence | Part::Watch => Order::Nothing,
            Part::Stop => Order::Say(self.reference, false),
            Part::Enable | Part::Noise | Part::Creep | Part::Return => {
                Order::Say(self.reference, true)
            }
        }
    }

    fn go_on(&mut self, part: Part) {
        (self.part, self.cycles, self.began) = (part, 0, None);
        (self.seen, self.repeats) = (Seen::default(), 0);
    }

    /// Repeats a part that has too few measurements.
    fn repeat(&mut self) -> Result<(), Unready> {
        if self.repeats == MOST_REPEATS {
            return Err(Unready::NoMeasurement);
        }
        let repeats = self.repeats + 1;
        self.go_on(self.part);
        self.repeats = repeats;
        Ok(())
    }

    /// One cycle; where the rig is ready, the place where it holds.
    fn cycle(&mut self, state: Option<RigState>, now: Duration) -> Result<Option<f64>, Unready> {
        self.cycles += 1;
        self.now = now;
        self.began.get_or_insert(now);
        match self.part {
            Part::Enable => return self.enable(state),
            Part::Noise if self.has_lasted(NOISE_CYCLES) => {
                if self.seen.drift_m().is_none() {
                    self.repeat()?;
                    return Ok(None);
                }
                self.noise_m = self.seen.high_m - self.seen.low_m;
                if self.noise_m > MOST_NOISE_M {
                    return Err(Unready::Noisy(self.noise_m));
                }
                self.go_on(Part::Creep);
            }
            Part::Creep => return self.creep(),
            Part::Silence if self.has_lasted(self.length()) => self.go_on(Part::Watch),
            Part::Watch if self.has_lasted(WATCH_CYCLES) => return self.judge(),
            Part::Stop if self.cycles >= ENABLE_CYCLES => {
                self.is_again = true;
                self.go_on(Part::Enable);
            }
            Part::Return => return self.come_back(),
            Part::Noise | Part::Silence | Part::Watch | Part::Stop => {}
        }
        Ok(None)
    }

    fn enable(&mut self, state: Option<RigState>) -> Result<Option<f64>, Unready> {
        let runs = !self.offer.has_state || state == Some(RigState::Running);
        if let (true, Some(at_m)) = (runs && self.cycles >= ENABLE_CYCLES, self.start_m) {
            match (self.is_again, self.offer.time_out_cycles) {
                (true, _) => self.go_on(Part::Return),
                (false, Some(_)) => self.go_on(Part::Noise),
                (false, None) => return Ok(Some(at_m)),
            }
        } else if self.has_lasted(PATIENCE_CYCLES) {
            return Err(match (self.start_m, self.is_again) {
                (None, _) => Unready::NoMeasurement,
                (_, true) => Unready::StaysStopped,
                (_, false) => Unready::NotRunning,
            });
        }
        Ok(None)
    }

    fn creep(&mut self) -> Result<Option<f64>, Unready> {
        let start_m = self.start_m.unwrap_or_default();
        if self.cycles >= CREEP_CYCLES {
            let moved_m = (self.last_m.unwrap_or(start_m) - start_m).abs();
            let asked_m = (self.reference.displacement_m - start_m).abs();
            if moved_m < 0.5 * asked_m {
                return Err(Unready::DoesNotFollow(moved_m));
            }
            self.go_on(Part::Silence);
            return Ok(None);
        }
        let rise = f64::from(self.cycles.min(RISE_CYCLES)) / f64::from(RISE_CYCLES);
        // Towards mid-stroke: away from the nearer end.
        let velocity_m_per_s = libm::copysign(CREEP_M_PER_S * rise, -start_m);
        self.reference.displacement_m += velocity_m_per_s * CYCLE_S;
        self.reference.velocity_m_per_s = velocity_m_per_s;
        Ok(None)
    }

    fn judge(&mut self) -> Result<Option<f64>, Unready> {
        let Some(drift_m) = self.seen.drift_m() else {
            self.repeat()?;
            return Ok(None);
        };
        if drift_m.abs() > self.noise_m + self.offer.resolution_m + HELD_M {
            return Err(Unready::RunsOn(drift_m.abs()));
        }
        // Goes on from where it stands.
        let at_m = self.last_m.unwrap_or(self.reference.displacement_m);
        self.reference = Command { displacement_m: at_m, velocity_m_per_s: 0.0 };
        self.go_on(Part::Stop);
        Ok(None)
    }

    /// Leads the ram back to where it stood, at the speed of the creep.
    fn come_back(&mut self) -> Result<Option<f64>, Unready> {
        let start_m = self.start_m.unwrap_or_default();
        let left_m = start_m - self.reference.displacement_m;
        let step_m = CREEP_M_PER_S * CYCLE_S;
        if left_m.abs() <= step_m {
            return Ok(Some(start_m));
        }
        let velocity_m_per_s = libm::copysign(CREEP_M_PER_S, left_m);
        self.reference.displacement_m += velocity_m_per_s * CYCLE_S;
        self.reference.velocity_m_per_s = velocity_m_per_s;
        if self.has_lasted(PATIENCE_CYCLES) { Err(Unready::StaysStopped) } else { Ok(None) }
    }
}

/// Length of a cycle before the session (s).
const CYCLE_S: f64 = scenario::run::CYCLE_S;

#[cfg(test)]
mod tests {
    use super::*;

    const OFFER: Offer = Offer { time_out_cycles: None, has_state: true, resolution_m: 1e-6 };

    #[test]
    fn a_host_that_was_late_gives_its_rig_time_to_run() {
        let mut preparation = Preparation::begin(OFFER);
        preparation.measured(0.0);
        for _ in 0..10 * PATIENCE_CYCLES {
            preparation.cycle(None, Duration::from_secs(5));
        }
        assert!(matches!(preparation, Preparation::Going(_)), "{preparation:?}");
        preparation.cycle(None, Duration::from_millis(5000 + u64::from(PATIENCE_CYCLES)));
        assert_eq!(preparation, Preparation::Refused(Unready::NotRunning));
    }

    /// A ram that runs on at 5 mm/s, of a rig that says nothing in the cycles of `is_silent`; what
    /// comes of its preparation.
    fn prepared(is_silent: impl Fn(u64) -> bool) -> Preparation {
        let offer = Offer { time_out_cycles: Some(100), has_state: false, resolution_m: 1e-6 };
        let mut preparation = Preparation::begin(offer);
        for cycle in 0..5000 {
            if !is_silent(cycle) {
                preparation.measured(-10e-3 + cycle.saturating_sub(120) as f64 * 5e-6);
            }
            preparation.cycle(None, Duration::from_millis(cycle));
            if !matches!(preparation, Preparation::Going(_)) {
                return preparation;
            }
        }
        preparation
    }

    #[test]
    fn a_rig_that_stood_still_for_a_moment_is_watched_again() {
        // The noise is taken from cycle 20 to 120, the ram is watched from 360 to 560.
        for silent in [30..110, 380..460, 380..700, 500..600] {
            let found = prepared(|cycle| silent.contains(&cycle));
            assert!(matches!(found, Preparation::Refused(Unready::RunsOn(_))), "{found:?}");
        }
        let found = prepared(|cycle| cycle > 380);
        assert_eq!(found, Preparation::Refused(Unready::NoMeasurement));
    }
}
