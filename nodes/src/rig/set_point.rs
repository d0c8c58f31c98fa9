//! The way to a servo controller: when its set-point may move a ram, and what stops it.
//!
//! A board gives the controller a set-point (a DAC) and reads the load cell and the displacement
//! (ADCs). Between the set-point and the ram is an enable line that an external watchdog holds
//! closed while it is fed, and opens by itself. So whatever stops the program opens it: reset,
//! brown-out, a fault, a debugger that halts. Nothing else is asked of the program than what
//! follows, in this order:
//!
//! | step | set-point | watchdog |
//! | --- | --- | --- |
//! | start, or after any stop | where the ram is measured, in every cycle | not fed |
//! | enabling, [`SETTLE_CYCLES`] | the same, while it changes by less than [`STILL_M`] | not fed |
//! | enabled | there, until a target comes; then within the speed | fed in every cycle |
//! | no measurement for [`BLIND_CYCLES`] | stays | opened |
//!
//! A controller that is enabled therefore finds its ram where it is asked to be. The watchdog has
//! to open within [`WATCHDOG_CYCLES`](crate::WATCHDOG_CYCLES) cycles, as the rig's own does.
//!
//! This is no safety function: emergency stop and pressure dump are hard-wired beside it.

use super::Limits;
use super::plant::{Reading, Reference, Target};
use super::ram::{Ram, RamState, bounded};

/// Cycles with a still ram and the set-point on it before the line may close.
pub const SETTLE_CYCLES: u32 = 20;

/// Change of the displacement in a cycle below which a ram counts as still (m).
pub const STILL_M: f64 = 10e-6;

/// Cycles in a row without a measurement after which the line is opened.
pub const BLIND_CYCLES: u32 = 3;

/// What the sensors show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Displacement of the ram (m).
    pub displacement_m: f64,
    /// Load cell, tension positive (N).
    pub force_n: f64,
}

/// The converters and the enable line of a servo controller.
pub trait ServoInterface {
    /// Both ADCs, at one instant; none where a converter or its supply is at fault.
    fn sense(&mut self) -> Option<Sensed>;

    /// The DAC of the set-point (m).
    fn write_set_point(&mut self, displacement_m: f64);

    /// Feeds the external watchdog, which holds the enable line closed for a few cycles.
    fn feed(&mut self);

    /// Opens the enable line at once.
    fn open(&mut self);
}

/// Where a set-point is on the way to motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// The line is open, and the set-point follows the ram, for so many still cycles.
    Open { still: u32 },
    /// The line is closed.
    Enabled,
}

/// The set-point of a servo controller, cycle by cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct SetPoint {
    stage: Stage,
    /// Where the set-point is, and how fast.
    reference: RamState,
    last: Option<Sensed>,
    blind_cycles: u32,
}

impl SetPoint {
    /// A set-point whose line is open.
    pub fn new() -> Self {
        Self {
            stage: Stage::Open { still: 0 },
            reference: RamState::default(),
            last: None,
            blind_cycles: 0,
        }
    }

    /// Whether the line is held closed.
    pub fn is_enabled(&self) -> bool {
        self.stage == Stage::Enabled
    }

    /// Whether it stands still.
    pub fn is_at_rest(&self) -> bool {
        self.reference.velocity_m_per_s == 0.0
    }

    /// One cycle, which is a substep of the ram; `wants_enable` while the rig is armed or moves.
    /// None without a measurement.
    pub fn cycle(
        &mut self,
        ram: &Ram,
        servo: &mut impl ServoInterface,
        wants_enable: bool,
        target: Target,
    ) -> Option<Reading> {
        let sensed = servo.sense();
        self.blind_cycles = if sensed.is_some() { 0 } else { self.blind_cycles.saturating_add(1) };
        if !wants_enable || self.blind_cycles >= BLIND_CYCLES {
            servo.open();
            self.stage = Stage::Open { still: 0 };
        }
        let limits = match (self.stage, sensed) {
            (Stage::Open { still }, Some(sensed)) => {
                self.wait_open(ram.stroke_m, servo, (still, sensed), wants_enable);
                Limits::default()
            }
            (Stage::Open { .. }, None) => {
                self.stage = Stage::Open { still: 0 };
                Limits::default()
            }
            (Stage::Enabled, _) => {
                let limits = ram.cycle(&mut self.reference, target, 1, |_| {});
                servo.write_set_point(self.reference.displacement_m);
                servo.feed();
                limits
            }
        };
        self.last = sensed.or(self.last);
        let Sensed { displacement_m, force_n } = sensed?;
        let behind_m = match target {
            Target::Follow(reference) => {
                let Reference { displacement_m: wanted_m, .. } = reference.after(ram.step_s());
                wanted_m - displacement_m
            }
            Target::Hold | Target::Centre => 0.0,
        };
        let ram_displacement_m = displacement_m;
        Some(Reading { force_n, displacement_m, ram_displacement_m, behind_m, limits })
    }

    /// With an open line the set-point follows the ram; closes it once the ram was still.
    fn wait_open(
        &mut self,
        stroke_m: f64,
        servo: &mut impl ServoInterface,
        (still, sensed): (u32, Sensed),
        wants_enable: bool,
    ) {
        let displacement_m = bounded(sensed.displacement_m, stroke_m);
        self.reference = RamState { displacement_m, velocity_m_per_s: 0.0 };
        servo.write_set_point(displacement_m);
        let moved_m = self
            .last
            .map_or(f64::INFINITY, |last| (sensed.displacement_m - last.displacement_m).abs());
        // A ram beyond the stroke is not where the set-point is.
        let is_still = moved_m < STILL_M && displacement_m == sensed.displacement_m;
        let still = if is_still { still + 1 } else { 0 };
        self.stage = if wants_enable && still >= SETTLE_CYCLES {
            servo.feed();
            Stage::Enabled
        } else {
            Stage::Open { still: still.min(SETTLE_CYCLES) }
        };
    }
}

impl Default for SetPoint {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::WATCHDOG_CYCLES;
    use std::vec::Vec;

    /// What a board does to a bench, in order.
    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Done {
        Sensed,
        Set(f64),
        Fed,
        Opened,
    }

    /// A bench whose controller moves the ram to the set-point only while its line is closed.
    struct Double {
        ram_m: f64,
        set_m: f64,
        /// Cycles for which the watchdog still holds the line closed.
        closed: u32,
        is_blind: bool,
        done: Vec<Done>,
    }

    impl Double {
        /// A ram at 7 mm, and a DAC that comes up with anything.
        fn new() -> Self {
            let (ram_m, set_m) = (7e-3, 80e-3);
            Self { ram_m, set_m, closed: 0, is_blind: false, done: Vec::new() }
        }

        /// A cycle passes, with or without the program.
        fn pass(&mut self) {
            if self.closed > 0 {
                self.closed -= 1;
                self.ram_m = self.set_m;
            }
        }
    }

    impl ServoInterface for Double {
        fn sense(&mut self) -> Option<Sensed> {
            self.done.push(Done::Sensed);
            (!self.is_blind).then_some(Sensed { displacement_m: self.ram_m, force_n: 12.0 })
        }
        fn write_set_point(&mut self, displacement_m: f64) {
            self.done.push(Done::Set(displacement_m));
            self.set_m = displacement_m;
        }
        fn feed(&mut self) {
            self.done.push(Done::Fed);
            self.closed = WATCHDOG_CYCLES;
        }
        fn open(&mut self) {
            self.done.push(Done::Opened);
            self.closed = 0;
        }
    }

    const FAR: Target = Target::Follow(Reference { displacement_m: 20e-3, velocity_m_per_s: 0.0 });

    fn ram() -> Ram {
        Ram::new(0.1, 1.0, 0.0, 1e-3)
    }

    /// Cycles until the line is closed; how many.
    fn enable(set_point: &mut SetPoint, bench: &mut Double, target: Target) -> u32 {
        let mut cycles = 0;
        while !set_point.is_enabled() {
            set_point.cycle(&ram(), bench, true, target);
            assert_eq!(bench.ram_m, 7e-3, "moved in cycle {cycles}");
            bench.pass();
            cycles += 1;
            assert!(cycles < 100);
        }
        cycles
    }

    #[test]
    fn a_bench_is_measured_then_set_there_then_enabled_and_only_then_moved() {
        let (mut set_point, mut bench) = (SetPoint::new(), Double::new());
        // Even a host that already wants it elsewhere waits.
        assert_eq!(enable(&mut set_point, &mut bench, FAR), SETTLE_CYCLES + 1);
        let fed = bench.done.iter().position(|done| *done == Done::Fed).unwrap();
        let before = &bench.done[..fed];
        assert_eq!(before[..2], [Done::Sensed, Done::Set(7e-3)]);
        assert!(before.iter().all(|done| matches!(done, Done::Sensed | Done::Set(7e-3))));
        assert_eq!(bench.ram_m, 7e-3);
        set_point.cycle(&ram(), &mut bench, true, FAR);
        bench.pass();
        // 1 m/s for a cycle.
        assert!((bench.ram_m - 8e-3).abs() < 1e-12, "{}", bench.ram_m);
    }

    #[test]
    fn a_program_that_is_gone_moves_nothing_and_one_that_comes_back_begins_anew() {
        let (mut first, mut bench) = (SetPoint::new(), Double::new());
        enable(&mut first, &mut bench, Target::Hold);
        // Reset, panic, brown-out or a debugger: the program just stops, and its DAC may jump.
        for _ in 0..WATCHDOG_CYCLES {
            bench.pass();
        }
        bench.set_m = -90e-3;
        bench.pass();
        assert_eq!((bench.closed, bench.ram_m), (0, 7e-3));
        enable(&mut SetPoint::new(), &mut bench, FAR);
        assert_eq!(bench.ram_m, 7e-3);
    }

    #[test]
    fn a_ram_that_is_not_seen_or_not_wanted_is_cut_off() {
        let (mut set_point, mut bench) = (SetPoint::new(), Double::new());
        enable(&mut set_point, &mut bench, Target::Hold);
        bench.is_blind = true;
        for cycle in 1..=BLIND_CYCLES {
            assert_eq!(set_point.cycle(&ram(), &mut bench, true, Target::Hold), None);
            assert_eq!(set_point.is_enabled(), cycle < BLIND_CYCLES, "{cycle}");
        }
        assert_eq!(bench.done.last(), Some(&Done::Opened));
        bench.is_blind = false;
        enable(&mut set_point, &mut bench, Target::Hold);
        set_point.cycle(&ram(), &mut bench, false, FAR);
        assert_eq!((set_point.is_enabled(), bench.closed), (false, 0));
    }

    #[test]
    fn a_ram_that_drifts_is_not_enabled() {
        let (mut set_point, mut bench) = (SetPoint::new(), Double::new());
        for _ in 0..200 {
            set_point.cycle(&ram(), &mut bench, true, Target::Hold);
            bench.ram_m += 2.0 * STILL_M;
        }
        assert!(!set_point.is_enabled());
    }
}
