//! The ideal rig: a ram with a lag, a rigid or a springy fixture, the damper.
//!
//! ```text
//! command -> ram x_r --[ fixture, compliance C ]-- eyes x_e --[ damper F ]-- ground
//! x_e = x_r - C F(x_e)
//! ```
//!
//! One cycle has [`SUBSTEPS`] substeps: the ram moves ([`Ram`]), then the force is found at which
//! fixture and damper agree. A damper's force never falls with its displacement, so
//! `F = D(x_r - C F)` has one solution, enclosed from the start by the last force and the force at
//! it; a bounded false-position search finds it. That holds for a fixture softer than the damper as
//! well, where feeding back the last force would blow up.
//!
//! Limits: the lag and the rate are numbers, whatever the load is. Inertia of the fixture, friction
//! of the bearings and oil are not modelled; `servo` has them.

use crate::mechanics::Mechanics;
use crate::specimen::Specimen;
use firmware_core::damper::Motion;
use nodes::rig::{Limits, Ram, Target};
use scenario::rig::RigSetup;

/// Substeps of a cycle.
const SUBSTEPS: u32 = 4;

/// Most evaluations of the damper in the search of one substep.
const SEARCH_STEPS: u32 = 12;

/// An ideal rig for one length of cycle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ideal {
    ram: Ram,
    specimen: Specimen,
    fixture_m_per_n: f64,
    step_s: f64,
}

impl Ideal {
    /// The ideal rig for cycles of `period_s`.
    pub(crate) fn new(setup: &RigSetup, period_s: f64) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        Self {
            ram: Ram::new(setup.stroke_m, setup.rate_m_per_s, setup.lag_s, step_s),
            specimen: Specimen::of(setup).prepared(step_s),
            fixture_m_per_n: setup.fixture_m_per_n,
            step_s,
        }
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub(crate) fn with_period(self, period_s: f64) -> Self {
        let step_s = period_s / f64::from(SUBSTEPS);
        let Ram { stroke_m, rate_m_per_s, lag_s, .. } = self.ram;
        Self {
            ram: Ram::new(stroke_m, rate_m_per_s, lag_s, step_s),
            specimen: self.specimen.prepared(step_s),
            step_s,
            ..self
        }
    }

    /// One cycle; the limits that changed the motion.
    pub(crate) fn cycle(&self, at: &mut Mechanics, target: Target) -> Limits {
        let mut ram = at.ram;
        self.ram.cycle(&mut ram, target, SUBSTEPS, |ram| {
            at.ram = ram;
            self.settle(at);
            at.load_cell_n = at.force_n;
        })
    }

    /// Finds the force at which fixture and damper agree, and moves the damper there.
    fn settle(&self, at: &mut Mechanics) {
        let (ram, before) = (at.ram, at.force_n);
        if self.fixture_m_per_n == 0.0 {
            // Nothing to agree on: no trial, and no copy of the damper's state.
            let motion = Motion::new(ram.displacement_m, ram.velocity_m_per_s);
            at.force_n = self.specimen.advance(&mut at.mounting, motion, self.step_s);
            at.eyes_m = ram.displacement_m;
            return;
        }
        let start = at.mounting;
        let per_step = 1.0 / self.step_s;
        let damper_at = |force_n: f64| {
            let motion = Motion::new(
                ram.displacement_m - self.fixture_m_per_n * force_n,
                ram.velocity_m_per_s - self.fixture_m_per_n * (force_n - before) * per_step,
            );
            let mut mounting = start;
            let answer_n = self.specimen.advance(&mut mounting, motion, self.step_s);
            (answer_n, mounting, motion.displacement_m)
        };
        let mut found = damper_at(before);
        // Force on the fixture and how far the damper's answer is off: two ends of a bracket.
        let (mut low, mut high) = (before, found.0);
        let mut low_off = found.0 - low;
        found = damper_at(high);
        let mut high_off = found.0 - high;
        for _ in 0..SEARCH_STEPS {
            if high_off.abs() <= 1e-9 * high.abs().max(1.0) || low_off == high_off {
                break;
            }
            let next = high - high_off * (high - low) / (high_off - low_off);
            found = damper_at(next);
            let off = found.0 - next;
            if (off > 0.0) == (high_off > 0.0) {
                // The far end stays where it is: give it half its weight (Illinois).
                low_off *= 0.5;
            } else {
                (low, low_off) = (high, high_off);
            }
            (high, high_off) = (next, off);
        }
        (at.force_n, at.mounting, at.eyes_m) = found;
    }
}
