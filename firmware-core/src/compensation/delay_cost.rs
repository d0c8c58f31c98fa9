//! What a residual delay costs.

use core::f64::consts::TAU;

/// The share of the damping energy that a delay removes, for a damper and its attachments in
/// series.
///
/// A damper `Ce` in series with a stiffness `Ke` has the dynamic stiffness
/// `K = i w Ce / (1 + i w lambda)` with `lambda = Ce / Ke`. A delay `tau` multiplies it by
/// `exp(-i w tau)`, and the imaginary part, to which the energy per cycle is proportional, falls by
///
/// ```text
/// 1 - cos(w tau) + w lambda sin(w tau)
/// ```
///
/// Over 1 the damper drives the vehicle. A negative delay (a lead) has a negative cost: the damper
/// then takes more energy than it should, which is as wrong. The cost is linear: relief and
/// clearance are not in it.
///
/// ```
/// use firmware_core::compensation::damping_energy_lost;
/// // Ke = 11 MN/m at 3.8 Hz: w lambda = 2.17, and a millisecond costs 5.2 %.
/// let relaxation_s = 2.17 / (core::f64::consts::TAU * 3.8);
/// let lost = damping_energy_lost(1e-3, 3.8, relaxation_s);
/// assert!((lost - 0.052).abs() < 5e-4);
/// assert_eq!(damping_energy_lost(0.0, 3.8, relaxation_s), 0.0);
/// ```
pub fn damping_energy_lost(delay_s: f64, frequency_hz: f64, relaxation_s: f64) -> f64 {
    let omega = TAU * frequency_hz;
    let (sin, cos) = libm::sincos(omega * delay_s);
    1.0 - cos + omega * relaxation_s * sin
}

/// The delay at which [`damping_energy_lost`] first reaches a share, s; a negative share gives the
/// lead. Infinite where no delay, or no lead, costs as much.
///
/// With `R = sqrt(1 + (w lambda)^2)` and `phi = atan(1 / (w lambda))` the loss is
/// `1 + R sin(w tau - phi)`, and so `w tau = phi + asin((share - 1) / R)`.
///
/// ```
/// use firmware_core::compensation::{damping_energy_lost, delay_that_costs};
/// let (hz, relaxation_s) = (3.5, 0.08);
/// let delay_s = delay_that_costs(0.05, hz, relaxation_s);
/// assert!((damping_energy_lost(delay_s, hz, relaxation_s) - 0.05).abs() < 1e-12);
/// assert!((delay_s - 1.282e-3).abs() < 1e-6);
/// assert!(delay_that_costs(-0.05, hz, relaxation_s) < 0.0);
/// ```
pub fn delay_that_costs(share: f64, frequency_hz: f64, relaxation_s: f64) -> f64 {
    debug_assert!(frequency_hz > 0.0 && relaxation_s >= 0.0, "{frequency_hz} Hz, {relaxation_s} s");
    let omega = TAU * frequency_hz;
    let slope = omega * relaxation_s;
    let height = libm::hypot(1.0, slope);
    let sine = (share - 1.0) / height;
    if sine.abs() > 1.0 {
        return libm::copysign(f64::INFINITY, share);
    }
    (libm::atan2(1.0, slope) + libm::asin(sine)) / omega
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::{Damper, DamperState, Motion, Nominal};

    #[test]
    fn the_published_table_of_costs_is_met() {
        // w lambda, Hz, delay in ms, per cent.
        for (w_lambda, hz, delay_ms, percent, tolerance) in [
            (7.96, 3.8, 0.1, 1.9, 0.05),
            (7.96, 3.8, 1.0, 19.0, 0.5),
            (7.96, 3.8, 5.0, 95.0, 0.6),
            (1.83, 3.2, 2.0, 7.4, 0.05),
            (2.17, 3.8, 5.0, 26.6, 0.4),
            (5.71, 10.0, 1.0, 36.0, 0.5),
            (1.59, 3.8, 1.0, 3.8, 0.05),
        ] {
            let lost = 100.0 * damping_energy_lost(delay_ms * 1e-3, hz, w_lambda / (TAU * hz));
            assert!((lost - percent).abs() <= tolerance, "{w_lambda} {hz} {delay_ms}: {lost}");
        }
    }

    #[test]
    fn the_delay_that_costs_a_share_costs_it() {
        for relaxation_s in [0.0, 0.01, 0.08, 0.33] {
            assert!(delay_that_costs(0.0, 3.5, relaxation_s).abs() < 1e-15);
            for share in [-0.05, -0.01, 0.02, 0.05, 0.5] {
                let delay_s = delay_that_costs(share, 3.5, relaxation_s);
                if delay_s.is_infinite() {
                    // A pure dashpot loses at every delay and at every lead.
                    assert!(relaxation_s < 0.02 && share < 0.0, "{relaxation_s} {share}");
                    continue;
                }
                let lost = damping_energy_lost(delay_s, 3.5, relaxation_s);
                assert!((lost - share).abs() < 1e-12, "{relaxation_s} {share}: {lost}");
            }
        }
    }

    #[test]
    fn a_delayed_damper_of_the_core_loses_that_much_energy() {
        let nominal = Nominal { clearance_2a_m: 0.0, ..Nominal::NEW };
        let relaxation_s = nominal.ce_n_s_per_m / nominal.ke_n_per_m;
        let damper = Damper::new(nominal, &[]).unwrap();
        // Small enough for the relief valve to stay shut.
        let (hz, step_s, amplitude_m) = (3.8, 1e-4, 1e-4);
        let omega = TAU * hz;
        let period = libm::round(1.0 / (hz * step_s)) as u32;
        let work = |delay_s: f64| {
            let (mut state, mut work) = (DamperState::rest(), 0.0);
            for k in 0..6 * period {
                let t = f64::from(k) * step_s;
                let (sin, cos) = libm::sincos(omega * (t - delay_s));
                let motion = Motion::new(amplitude_m * sin, amplitude_m * omega * cos);
                let force = damper.advance(&mut state, motion, step_s);
                if k >= 3 * period {
                    work += force * libm::cos(omega * t);
                }
            }
            work
        };
        for delay_s in [1e-3, 5e-3, -1e-3] {
            let lost = 1.0 - work(delay_s) / work(0.0);
            let expected = damping_energy_lost(delay_s, hz, relaxation_s);
            assert!((lost - expected).abs() < 0.01, "{delay_s}: {lost}, {expected}");
        }
    }
}
