//! A bench behind a servo controller, as a double: converters, enable line, watchdog, ram, damper.
//!
//! ```text
//! set-point (16 bit) -> controller and ram (first-order lag, speed, stroke) -> damper
//! readings (16 bit) <- displacement over the stroke, force over 100 kN to either side
//! ```
//! The ram follows the set-point only while the watchdog holds the line closed; with an open line
//! its valve is shut. One reading is one cycle of the bench, so that a set-point acts in the cycle
//! after it was written. An image without a bench runs it in the place of one.

use super::ServoInterface;
use super::model::SUBSTEPS;
use super::plant::{Reference, Target};
use super::ram::{Ram, RamState, bounded};
use super::set_point::Sensed;
use crate::WATCHDOG_CYCLES;
use firmware_core::damper::{Damper, DamperState, Motion};

/// Codes of a converter to either side.
const CODES: f64 = 32_767.0;

/// Range of the load cell to either side (N).
const FORCE_RANGE_N: f64 = 100e3;

/// The bench.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoBench<'a> {
    damper: &'a Damper,
    drive: Ram,
    step_s: f64,
    ram: RamState,
    damper_state: DamperState,
    force_n: f64,
    set_point_m: f64,
    /// Cycles for which the watchdog still holds the line closed.
    closed_cycles: u32,
    cycles: u64,
    blind_from: Option<u64>,
}

impl<'a> ServoBench<'a> {
    /// A bench with an open line, its ram at rest at `ram_m`, in cycles of `period_s`. The drive
    /// has a stroke (m), a speed (m/s) and the time constant of a lag (s); the damper is prepared
    /// for [`SUBSTEPS`] in a cycle.
    pub fn new(
        damper: &'a Damper,
        [stroke_m, rate_m_per_s, lag_s]: [f64; 3],
        ram_m: f64,
        period_s: f64,
    ) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        let displacement_m = bounded(ram_m, stroke_m);
        Self {
            damper,
            drive: Ram::new(stroke_m, rate_m_per_s, lag_s, step_s),
            step_s,
            ram: RamState { displacement_m, velocity_m_per_s: 0.0 },
            damper_state: DamperState::starting(Motion::new(displacement_m, 0.0)),
            force_n: 0.0,
            set_point_m: 0.0,
            closed_cycles: 0,
            cycles: 0,
            blind_from: None,
        }
    }

    /// The same bench, whose converters fail in a cycle and do not come back.
    #[must_use]
    pub fn blind_from(self, cycle: u64) -> Self {
        Self { blind_from: Some(cycle), ..self }
    }

    /// Whether the line is closed.
    pub fn is_closed(&self) -> bool {
        self.closed_cycles > 0
    }

    /// Where the ram is (m).
    pub fn ram_m(&self) -> f64 {
        self.ram.displacement_m
    }

    /// A cycle passes.
    fn pass(&mut self) {
        let reference = Reference { displacement_m: self.set_point_m, velocity_m_per_s: 0.0 };
        let target = if self.is_closed() { Target::Follow(reference) } else { Target::Hold };
        let (damper, step_s) = (self.damper, self.step_s);
        let Self { drive, ram, damper_state, force_n, .. } = self;
        drive.cycle(ram, target, SUBSTEPS, |ram| {
            let motion = Motion::new(ram.displacement_m, ram.velocity_m_per_s);
            *force_n = damper.advance(damper_state, motion, step_s);
        });
        self.closed_cycles = self.closed_cycles.saturating_sub(1);
        self.cycles += 1;
    }
}

impl ServoInterface for ServoBench<'_> {
    fn sense(&mut self) -> Option<Sensed> {
        self.pass();
        let displacement_m = converted(self.ram.displacement_m, self.drive.stroke_m);
        let force_n = converted(self.force_n, FORCE_RANGE_N);
        let is_blind = self.blind_from.is_some_and(|cycle| self.cycles >= cycle);
        (!is_blind).then_some(Sensed { displacement_m, force_n })
    }

    fn write_set_point(&mut self, displacement_m: f64) {
        self.set_point_m = converted(displacement_m, self.drive.stroke_m);
    }

    fn feed(&mut self) {
        self.closed_cycles = WATCHDOG_CYCLES;
    }

    fn open(&mut self) {
        self.closed_cycles = 0;
    }
}

/// What is left of a value behind a converter with this range to either side.
fn converted(value: f64, range: f64) -> f64 {
    debug_assert!(range > 0.0, "range {range}");
    libm::round(bounded(value / range, 1.0) * CODES) / CODES * range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_converter_rounds_to_its_codes_and_ends_at_its_range() {
        let code_m = 0.1 / CODES;
        assert_eq!(converted(0.4 * code_m, 0.1), 0.0);
        assert!((converted(0.6 * code_m, 0.1) - code_m).abs() < 1e-18);
        assert_eq!((converted(0.3, 0.1), converted(-0.3, 0.1)), (0.1, -0.1));
    }
}
