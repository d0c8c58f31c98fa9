//! Force that is read later than displacement.
//!
//! ```text
//! F_read(t) = F(t - t_d)
//! ```
//!
//! A filter, a demodulator or a converter of the force channel that is slower than the one of the
//! displacement. The phase grows in proportion to frequency. The force of the last 20 ms is kept in
//! the damper's state; at a constant step no reading is interpolated, at changing steps it is read
//! straight between the forces of two steps. Source: general knowledge of measuring chains.
//! Limits: a pure delay, no filter that rounds corners; a displacement that comes late would be a
//! negative delay, which an online model cannot have.

use super::draw::Draw;
use super::parameter::effect_parameters;
use super::{DamperEffect, Place};
use crate::damper::nominal::Nominal;

effect_parameters! {
    /// A force channel that comes late.
    SensorDelay {
        delay_s: Second in 0.0 to 0.02, typical 0.001, "How late the force is read, s.";
    }
}

impl DamperEffect for SensorDelay {
    const NAME: &'static str = "sensor_delay";
    const PLACE: Place = Place::Sensor;
    const EQUATION: &'static str = "F_read(t) = F(t - t_d)";
    const SHOWN_BY: &'static str = "A plain spring in place of the damper at two frequencies: phase in proportion to frequency.";
    const STARTS: &'static [&'static [f64]] = &[&[0.0003], &[0.003], &[0.01]];
    const STRONGEST: f64 = 0.02;
    const IN_HYDRAULIC_MODEL: bool = false;

    fn delay_s(&self) -> f64 {
        self.delay_s
    }

    fn drawn(strength: f64, _draw: &Draw) -> Self {
        Self { delay_s: strength }
    }

    fn in_service(_nominal: &Nominal, size: f64) -> Self {
        Self { delay_s: 0.0023 * size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    fn late(nominal: Nominal, delay_s: f64) -> Damper {
        Damper::new(nominal, &[SensorDelay { delay_s }.into()]).unwrap()
    }

    fn motion(time_s: f64) -> Motion {
        Motion::new(3.46e-3 * libm::sin(22.0 * time_s), 3.46e-3 * 22.0 * libm::cos(22.0 * time_s))
    }

    #[test]
    fn whole_steps_of_delay_repeat_the_earlier_forces() {
        let (plain, late) = (Damper::new(Nominal::NEW, &[]).unwrap(), late(Nominal::NEW, 4e-3));
        let (mut a, mut b) =
            (DamperState::starting(motion(0.0)), DamperState::starting(motion(0.0)));
        let forces: [f64; 400] =
            core::array::from_fn(|i| plain.advance(&mut a, motion(1e-3 * (i as f64 + 1.0)), 1e-3));
        for i in 0..400 {
            let read = late.advance(&mut b, motion(1e-3 * (i as f64 + 1.0)), 1e-3);
            let expected = if i < 4 { 0.0 } else { forces[i - 4] };
            assert!((read - expected).abs() < 1e-6, "{i}: {read} {expected}");
        }
    }

    #[test]
    fn spring_lags_by_its_phase_at_any_step() {
        // A locked dashpot: F = Ke x, so the reading is Ke X sin(w (t - t_d)).
        let nominal = Nominal {
            ce_n_s_per_m: 1e14,
            f_relief_n: f64::INFINITY,
            clearance_2a_m: 0.0,
            ..Nominal::NEW
        };
        for (step_s, most) in [(10e-6, 3e-5), (1e-4, 3e-5), (1e-3, 5e-5), (5e-3, 1.2e-3)] {
            for delay_s in [0.3e-3, 1.7e-3, 20e-3] {
                let damper = late(nominal, delay_s);
                let mut state = DamperState::starting(motion(0.0));
                for i in 1..=(0.3 / step_s) as u32 {
                    let t = f64::from(i) * step_s;
                    let read = damper.advance(&mut state, motion(t), step_s);
                    let expected = 12.5e6 * motion(t - delay_s).displacement_m;
                    let miss = (read - expected).abs() / 43e3;
                    assert!(t < delay_s || miss < most, "{step_s} {delay_s} {t}: {miss}");
                }
            }
        }
    }

    #[test]
    fn no_delay_changes_nothing() {
        let (plain, late) = (Damper::new(Nominal::NEW, &[]).unwrap(), late(Nominal::NEW, 0.0));
        let (mut a, mut b) = (DamperState::rest(), DamperState::rest());
        for i in 1..=300 {
            let motion = motion(1e-3 * f64::from(i));
            assert_eq!(plain.advance(&mut a, motion, 1e-3), late.advance(&mut b, motion, 1e-3));
        }
    }
}
