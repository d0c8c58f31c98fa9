//! What a damper is to a sine of one stroke and frequency.
//!
//! ```text
//! x = A sin(w t)      F = K A sin(w t) + w C A cos(w t) + harmonics
//! ```
//! K and C by the first harmonic of the force of the very damper, effects and all, once its motion
//! has settled. Linear studies put the pair in its place. Small strokes lie inside the clearance
//! and move no force at all, large ones open the relief valve: a single critical speed by
//! eigenvalues does not exist, only one for every stroke.

use firmware_core::damper::{Damper, DamperState, Motion};
use std::f64::consts::TAU;

/// Cycles that are let pass.
const SETTLING_CYCLES: usize = 6;
/// Samples of the cycle that is looked at.
const SAMPLES: usize = 2000;

/// What a damper does to a small motion of one frequency.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Impedance {
    /// Force in phase with the extension (N/m).
    pub stiffness_n_per_m: f64,
    /// Force in phase with its rate (N s/m).
    pub damping_n_s_per_m: f64,
}

impl Impedance {
    /// The same, its force late by so much (s) at a frequency (Hz).
    ///
    /// ```text
    /// K + i w C -> (K + i w C) exp(-i w tau)
    /// ```
    pub(crate) fn late_by(self, delay_s: f64, frequency_hz: f64) -> Self {
        debug_assert!(frequency_hz > 0.0, "{frequency_hz} Hz");
        let omega = TAU * frequency_hz;
        let (sin, cos) = libm::sincos(omega * delay_s);
        let (in_phase, ahead) = (self.stiffness_n_per_m, omega * self.damping_n_s_per_m);
        Self {
            stiffness_n_per_m: in_phase * cos + ahead * sin,
            damping_n_s_per_m: (ahead * cos - in_phase * sin) / omega,
        }
    }
}

/// Stiffness and damping of a damper at a stroke (m, half the travel) and a frequency (Hz).
pub(crate) fn impedance(damper: &Damper, stroke_m: f64, frequency_hz: f64) -> Impedance {
    debug_assert!(stroke_m > 0.0 && frequency_hz > 0.0, "{stroke_m} m at {frequency_hz} Hz");
    let step_s = 1.0 / (frequency_hz * SAMPLES as f64);
    let damper = damper.clone().prepared(step_s);
    let omega = TAU * frequency_hz;
    let motion = |sample: usize| {
        let phase = TAU * (sample % SAMPLES) as f64 / SAMPLES as f64;
        Motion::new(stroke_m * libm::sin(phase), stroke_m * omega * libm::cos(phase))
    };
    let mut state = DamperState::starting(motion(0));
    let (mut in_phase, mut ahead) = (0.0, 0.0);
    for sample in 1..=(SETTLING_CYCLES + 1) * SAMPLES {
        let force_n = damper.advance(&mut state, motion(sample), step_s);
        if sample > SETTLING_CYCLES * SAMPLES {
            let phase = TAU * (sample - SETTLING_CYCLES * SAMPLES) as f64 / SAMPLES as f64;
            in_phase += force_n * libm::sin(phase);
            ahead += force_n * libm::cos(phase);
        }
    }
    let scale = 2.0 / (SAMPLES as f64 * stroke_m);
    Impedance { stiffness_n_per_m: scale * in_phase, damping_n_s_per_m: scale * ahead / omega }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::damper::Nominal;

    #[test]
    fn inside_its_clearance_it_is_nothing() {
        let worn = Damper::new(Nominal { clearance_2a_m: 2e-3, ..Nominal::NEW }, &[]).unwrap();
        let found = impedance(&worn, 0.9e-3, 3.0);
        assert!(found.stiffness_n_per_m.abs() < 1e-6, "{found:?}");
        assert!(found.damping_n_s_per_m.abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn in_full_relief_it_is_a_friction_force() {
        // 4 F/(pi A w) = 198.5 kN s/m for 12 kN at 3.5 mm and 3.5 Hz.
        let friction = Nominal {
            ce_n_s_per_m: 1e8,
            ke_n_per_m: 1e12,
            clearance_2a_m: 0.0,
            f_relief_n: 12e3,
            c2_n_s_per_m: 0.0,
        };
        let found = impedance(&Damper::new(friction, &[]).unwrap(), 3.5e-3, 3.5);
        assert!((found.damping_n_s_per_m / 198.5e3 - 1.0).abs() < 0.005, "{found:?}");
        assert!(found.stiffness_n_per_m.abs() < 0.01 * 198.5e3 * TAU * 3.5, "{found:?}");
    }

    #[test]
    fn a_damper_without_clearance_below_its_relief_is_a_maxwell_element() {
        // Ce = 1 MN s/m in series with Ke = 12.5 MN/m.
        let maxwell = Nominal { clearance_2a_m: 0.0, f_relief_n: 1e9, ..Nominal::NEW };
        let (w, ce, ke) = (TAU * 3.0, 1.0e6, 12.5e6);
        let found = impedance(&Damper::new(maxwell, &[]).unwrap(), 1e-3, 3.0);
        let share = (w * ce / ke).powi(2);
        assert!((found.stiffness_n_per_m / (ke * share / (1.0 + share)) - 1.0).abs() < 1e-4);
        assert!((found.damping_n_s_per_m / (ce / (1.0 + share)) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_delay_costs_a_maxwell_element_the_damping_of_the_formula() {
        let maxwell = Nominal { clearance_2a_m: 0.0, f_relief_n: 1e9, ..Nominal::NEW };
        let own = impedance(&Damper::new(maxwell, &[]).unwrap(), 1e-3, 3.0);
        for delay_s in [-2e-3, 1e-3, 8e-3] {
            let lost = 1.0 - own.late_by(delay_s, 3.0).damping_n_s_per_m / own.damping_n_s_per_m;
            let relaxation_s = maxwell.ce_n_s_per_m / maxwell.ke_n_per_m;
            let formula =
                firmware_core::compensation::damping_energy_lost(delay_s, 3.0, relaxation_s);
            assert!((lost - formula).abs() < 1e-3, "{delay_s}: {lost} {formula}");
        }
    }
}
