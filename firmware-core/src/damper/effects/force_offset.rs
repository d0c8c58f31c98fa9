//! A load cell that does not read zero without load.
//!
//! ```text
//! F_read = F + b
//! ```
//!
//! The same at every speed, amplitude and frequency. Source: general knowledge of load cells.
//! Limit: a drift of the zero is not in it; a gain of the load cell is not either, for it equals a
//! scaling of all nominal forces.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Memory, Place};
use crate::damper::Done;
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// A constant error of the measured force.
    ForceOffset {
        offset_n: Newton in -100.0 to 100.0, typical 0.01, "Force that is read without load, N.";
    }
}

impl DamperEffect for ForceOffset {
    const NAME: &'static str = "force_offset";
    const PLACE: Place = Place::Sensor;
    const EQUATION: &'static str = "F_read = F + b";
    const SHOWN_BY: &'static str =
        "A reading with the damper taken off; mounted, static holds approached from either side.";
    const STRONGEST: f64 = 0.5;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn output(&self, _memory: &mut Memory, _done: &Done, force_n: f64) -> f64 {
        force_n + self.offset_n
    }

    fn drawn(strength: f64, draw: &Draw) -> Self {
        Self { offset_n: draw.sign * strength * draw.scale.force_n }
    }

    fn in_service(nominal: &Nominal, size: f64) -> Self {
        Self { offset_n: 0.01 * size * nominal.f_relief_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    #[test]
    fn reading_is_the_force_and_the_offset() {
        let plain = Damper::new(Nominal::NEW, &[]).unwrap();
        let cell = Damper::new(Nominal::NEW, &[ForceOffset { offset_n: -137.0 }.into()]).unwrap();
        let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
        for i in 1..=500 {
            let t = 1e-3 * f64::from(i);
            let motion = Motion::new(3e-3 * libm::sin(22.0 * t), 66e-3 * libm::cos(22.0 * t));
            let force = plain.advance(&mut a, motion, 1e-3);
            assert_eq!(cell.advance(&mut b, motion, 1e-3), force - 137.0);
            assert_eq!(b.chain_force_n(), force);
        }
    }

    #[test]
    fn open_joint_reads_the_offset_alone() {
        let cell = Damper::new(Nominal::NEW, &[ForceOffset { offset_n: 42.0 }.into()]).unwrap();
        let mut state = DamperState::rest();
        assert_eq!(cell.advance(&mut state, Motion::new(0.05e-3, 0.0), 1e-3), 42.0);
    }
}
