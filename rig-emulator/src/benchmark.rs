//! The benchmark rig: the plant of the virtual benchmark as the drive of a damper rig.
//!
//! ```text
//! reference -> BenchmarkPlant -> ram x_r = eyes -> damper F(x_r)
//! ```
//!
//! The displacement follows the command as that of the benchmark does: 25 ms late at 1 Hz, 16 ms at
//! 16 Hz, with less than half of the amplitude there. The force is that of the rig's own damper at
//! this displacement. It does not act back on the plant, which carries the specimen of the
//! benchmark: the plant was published as a whole, and a damper of 18 kN would stall its 9 kN. It is
//! the most unfavourable rig for a compensator whose delay is known exactly.
//!
//! It stops and centres by its reference, and comes to rest as late as it follows. Its reference
//! ends where the ram would stand at the end of the stroke; the ram may overshoot it by a few per
//! cent. A fixture is not modelled.

use crate::actuator::{Limits, Ram, RamState};
use crate::benchmark_plant::{BenchmarkPlant, PlantState};
use crate::cycle::Target;
use crate::integration::runge_kutta;
use crate::mechanics::Mechanics;
use firmware_core::damper::{Damper, Motion};
use scenario::rig::RigSetup;

/// Longest substep (s): the benchmark's own is 1/4096 s.
const LONGEST_STEP_S: f64 = 0.125e-3;

/// A benchmark rig for one length of cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Benchmark {
    plant: BenchmarkPlant,
    damper: Damper,
    /// What stops and centres the reference, within its own stroke.
    guide: Ram,
    stroke_m: f64,
    substeps: u32,
    step_s: f64,
}

/// What it remembers besides its mechanics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BenchmarkState {
    reference: RamState,
    plant: PlantState,
}

impl BenchmarkState {
    /// What the plant is asked to follow.
    pub(crate) fn reference(&self) -> RamState {
        self.reference
    }
}

impl Benchmark {
    /// The benchmark rig for cycles of `period_s`.
    pub(crate) fn new(setup: &RigSetup, period_s: f64) -> Self {
        let plant = BenchmarkPlant::nominal();
        let guide = Ram::new(setup.stroke_m / plant.static_gain(), setup.rate_m_per_s, 0.0, 0.0);
        let damper = setup.damper.clone();
        let stroke_m = setup.stroke_m;
        Self { plant, damper, guide, stroke_m, substeps: 1, step_s: 0.0 }.with_period(period_s)
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub(crate) fn with_period(self, period_s: f64) -> Self {
        let substeps = libm::ceil(period_s / LONGEST_STEP_S - 1e-9).max(1.0) as u32;
        let step_s = period_s / f64::from(substeps);
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.guide;
        let guide = Ram::new(stroke_m, rate_m_per_s, lag_s, step_s);
        Self { damper: self.damper.prepared(step_s), guide, substeps, step_s, ..self }
    }

    /// Its memory with the ram at rest at a displacement (m).
    pub(crate) fn resting_at(&self, ram_m: f64) -> BenchmarkState {
        let displacement_m = ram_m / self.plant.static_gain();
        BenchmarkState {
            reference: RamState { displacement_m, ..RamState::default() },
            plant: self.plant.resting_under(displacement_m),
        }
    }

    /// One cycle; the limits that changed the motion.
    pub(crate) fn cycle(
        &self,
        at: &mut Mechanics,
        own: &mut BenchmarkState,
        target: Target,
    ) -> Limits {
        let mut limits = Limits::default();
        for substep in 0..self.substeps {
            let from_m = own.reference.displacement_m;
            match target {
                Target::Follow(reference) => {
                    let until = reference.after(f64::from(substep + 1) * self.step_s);
                    limits.stroke |= until.displacement_m.abs() > self.guide.stroke_m;
                    own.reference = self.guide.kept_within(until);
                }
                Target::Hold => self.guide.stop(&mut own.reference),
                Target::Centre => self.guide.centre(&mut own.reference),
            }
            self.move_plant(at, own, from_m);
        }
        limits.rate |= at.ram.velocity_m_per_s.abs() > self.guide.rate_m_per_s;
        limits.stroke |= at.ram.displacement_m.abs() > self.stroke_m;
        limits
    }

    /// Plant and damper over a substep in which the reference comes straight from `from_m`.
    fn move_plant(&self, at: &mut Mechanics, own: &mut BenchmarkState, from_m: f64) {
        let slope_m_per_s = (own.reference.displacement_m - from_m) / self.step_s;
        own.plant = runge_kutta(&own.plant, self.step_s, |state, since_s| {
            self.plant.slope(state, from_m + slope_m_per_s * since_s)
        });
        let [displacement_m, velocity_m_per_s, ..] =
            own.plant.map(|value| self.plant.output_gain * value);
        at.ram = RamState { displacement_m, velocity_m_per_s };
        at.eyes_m = displacement_m;
        let motion = Motion::new(displacement_m, velocity_m_per_s);
        at.force_n = self.damper.advance(&mut at.damper, motion, self.step_s);
        at.load_cell_n = at.force_n;
    }
}
