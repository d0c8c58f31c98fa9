//! Whether a rig stays stable for every delay that it may have.
//!
//! ```text
//! L(s) = H(s) K(s) R(s) exp(-s tau)          1 + L = 0 at the poles of the coupled vehicle
//! K(s) = s Ce / (1 + s Ce / Ke)              the damper of the slot's model
//! H(s) = G / (1 - G K)                       the vehicle without it; G has all its dampers
//! R(s) = S(s) exp(-s a1 / a0)                the compensator on a rig of the delay it is made for
//! ```
//! `S` is the series of the compensator, half a cycle of lead included, and `tau` what is left. The
//! rig is taken as a pure delay, whose gain is one at all frequencies: what a series amplifies is
//! amplified in the loop.
//!
//! Stability does not fall steadily with the delay: a loop may be stable, unstable and stable again
//! while the delay grows. So every delay of a grid is asked up to the largest one. Beyond
//! [`BEYOND_HUNTING`] times the hunting frequency `|L|` may be half at most where `L` crosses the
//! negative real axis: a gain margin of two. The hunting pair itself is followed by Newton steps
//! from its pole without a residual delay; its damping is reported and never refused.
//!
//! Where a rig stands for other dampers too, `H` is that of the group (`crate::force_group`).
//!
//! Limits: linear, one rig at a time; the other rigs are dampers without delay.

pub use crate::force_group::ForceGroup;

use crate::linear_vehicle::{LinearMode, LinearVehicle};
use firmware_core::compensation::Series;
use firmware_core::damper::Nominal;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Where the gain margin is asked for, in multiples of the hunting frequency.
pub const BEYOND_HUNTING: f64 = 3.0;
/// The least gain margin.
pub const LEAST_MARGIN: f64 = 2.0;

/// Step of the delays, s.
const DELAY_STEP_S: f64 = 0.05e-3;
/// Highest frequency: the half of a cycle's rate, Hz.
const HIGHEST_HZ: f64 = 500.0;
/// Frequencies of the grid, in equal ratios.
const FREQUENCIES: usize = 1200;
/// Newton steps at each delay.
const NEWTON_STEPS: usize = 12;
/// Width of the difference in a Newton step, over the pole.
const WIDTH: f64 = 1e-6;

/// The loop of one rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigLoop<'a> {
    /// The vehicle's poles, all dampers in place.
    pub modes: &'a [LinearMode],
    /// The slot of the rig, and those for which it stands.
    pub group: ForceGroup,
    /// Damping of the slot's model, N s/m.
    pub ce_n_s_per_m: f64,
    /// Its compliance `1 / Ke`, m/N.
    pub compliance_m_per_n: f64,
    /// The series of the compensator, with what is known outside of the rig.
    pub series: Series,
}

/// What holds for all delays up to the largest one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// The largest delay that was asked, s.
    pub delay_s: f64,
    /// Delays up to here have the margin, s.
    pub safe_delay_s: f64,
    /// The least gain margin of all delays; infinite where the loop crosses nowhere.
    pub margin: f64,
    /// Its frequency, Hz.
    pub margin_hz: f64,
    /// Damping ratio of the hunting pair without a residual delay, and at the largest one.
    pub hunting_damping: [f64; 2],
}

impl Stability {
    /// Whether every delay has the margin.
    pub fn holds(&self) -> bool {
        self.margin >= LEAST_MARGIN
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let [first, last] = self.hunting_damping;
        let margin = if self.margin.is_finite() {
            format!("the least gain margin is {:.1} at {:.0} Hz", self.margin, self.margin_hz)
        } else {
            "the loop crosses the negative real axis nowhere".to_owned()
        };
        format!(
            "stable for delays up to {:.2} of {:.2} ms with a gain margin of {LEAST_MARGIN:.0}; \
             {margin}; damping ratio of hunting {first:.3} to {last:.3}",
            1e3 * self.safe_delay_s,
            1e3 * self.delay_s
        )
    }
}

impl<'a> RigLoop<'a> {
    /// The loop of a rig with this damper and the compensator of this series.
    pub fn new(
        vehicle: &'a LinearVehicle,
        group: ForceGroup,
        model: &Nominal,
        series: Series,
    ) -> Self {
        Self {
            modes: &vehicle.modes,
            group,
            ce_n_s_per_m: model.ce_n_s_per_m,
            compliance_m_per_n: 1.0 / model.ke_n_per_m,
            series,
        }
    }

    /// Asks every delay up to the largest one (s), beyond so many times the hunting frequency (Hz);
    /// `hunting` is the pole of the pair, 1/s.
    pub fn check(&self, delay_s: f64, from_hz: f64, hunting: Complex64) -> Stability {
        debug_assert!(from_hz > 0.0 && from_hz < HIGHEST_HZ, "{from_hz} Hz");
        debug_assert!(delay_s >= 0.0, "{delay_s} s");
        let ratio = HIGHEST_HZ / from_hz;
        let of_grid = |number: usize| {
            let hz = from_hz * libm::pow(ratio, number as f64 / (FREQUENCIES - 1) as f64);
            (TAU * hz, self.gain(Complex64::new(0.0, TAU * hz)))
        };
        let grid: Vec<(f64, Complex64)> = (0..FREQUENCIES).map(of_grid).collect();
        let mut found = Stability {
            delay_s,
            safe_delay_s: delay_s,
            margin: f64::INFINITY,
            margin_hz: f64::NAN,
            hunting_damping: [0.0; 2],
        };
        let mut is_safe = true;
        let mut pole = self.pole_near(hunting, 0.0);
        let damping = |pole: Complex64| -pole.re / pole.norm();
        found.hunting_damping = [damping(pole); 2];
        let steps = libm::ceil(delay_s / DELAY_STEP_S - 1e-9) as u32;
        for step in 0..=steps {
            let tau_s = (f64::from(step) * DELAY_STEP_S).min(delay_s);
            let (largest, omega) = crossing(&grid, tau_s);
            if 1.0 / largest < found.margin {
                (found.margin, found.margin_hz) = (1.0 / largest, omega / TAU);
            }
            if is_safe && 1.0 / largest < LEAST_MARGIN {
                is_safe = false;
                found.safe_delay_s = (tau_s - DELAY_STEP_S).max(0.0);
            }
            pole = self.pole_near(pole, tau_s);
        }
        found.hunting_damping[1] = damping(pole);
        found
    }

    /// The loop without a residual delay.
    fn gain(&self, s: Complex64) -> Complex64 {
        let damper = self.damper(s);
        if !self.group.is_alone() {
            return self.group.receptance(self.modes, s, damper) * damper * self.residual(s);
        }
        let with = self.receptance(s);
        with * damper * self.residual(s) / (Complex64::ONE - with * damper)
    }

    /// The vehicle with all its dampers.
    fn receptance(&self, s: Complex64) -> Complex64 {
        let of = |mode: &LinearMode| mode.of(mode.residues[self.group.rig], s);
        self.modes.iter().map(of).sum()
    }

    /// The damper of the slot's model.
    fn damper(&self, s: Complex64) -> Complex64 {
        let damped = s * self.ce_n_s_per_m;
        damped / (damped * self.compliance_m_per_n + 1.0)
    }

    /// The compensator on a rig of the delay that it is made for.
    fn residual(&self, s: Complex64) -> Complex64 {
        let Series([a0, a1, a2, a3]) = self.series;
        (((s * a3 + a2) * s + a1) * s + a0) * (-s * (a1 / a0)).exp()
    }

    /// The pole of the coupled vehicle near another, by Newton steps: `1 + L = 0` in the form
    /// `1 / G = K (1 - R exp(-s tau))`, which holds at the poles of `G` too.
    fn pole_near(&self, start: Complex64, tau_s: f64) -> Complex64 {
        let characteristic = |s: Complex64| {
            let late = self.residual(s) * (-s * tau_s).exp();
            if !self.group.is_alone() {
                return self.group.characteristic(self.modes, s, self.damper(s), late);
            }
            Complex64::ONE / self.receptance(s) - self.damper(s) * (Complex64::ONE - late)
        };
        // A pole of G itself is no number.
        let mut s = start * (1.0 + 1e-9);
        for _ in 0..NEWTON_STEPS {
            let width = WIDTH * s.norm();
            let slope = (characteristic(s + width) - characteristic(s - width)) / (2.0 * width);
            let step = characteristic(s) / slope;
            if !step.is_finite() || step.norm() < 1e-12 * s.norm() {
                break;
            }
            // Far steps lead to another pole.
            s -= step * (0.1 * s.norm() / step.norm()).min(1.0);
        }
        s
    }
}

/// The largest gain where the loop with a delay crosses the negative real axis, and the angular
/// frequency there; no gain where it does not.
fn crossing(grid: &[(f64, Complex64)], tau_s: f64) -> (f64, f64) {
    let mut largest = (0.0, f64::NAN);
    let mut last: Option<(f64, Complex64)> = None;
    for (omega, gain) in grid {
        let turned = gain * Complex64::from_polar(1.0, -omega * tau_s);
        if let Some((omega_before, before)) = last.replace((*omega, turned))
            && (before.im > 0.0) != (turned.im > 0.0)
        {
            let share = before.im / (before.im - turned.im);
            let real = before.re + share * (turned.re - before.re);
            if real < 0.0 && -real > largest.0 {
                largest = (-real, omega_before + share * (omega - omega_before));
            }
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::compensation::damping_energy_lost;

    /// A mass on a spring and a dashpot (kg, N/m, N s/m) as modes: `1 / (m s^2 + c s + k)`.
    fn oscillator(mass: f64, stiffness: f64, damping: f64) -> Vec<LinearMode> {
        let (half, square) = (damping / (2.0 * mass), stiffness / mass);
        let root = Complex64::new(half * half - square, 0.0).sqrt();
        let mode = |sign: f64| {
            let pole = root * sign - half;
            let residue = Complex64::ONE / (root * sign * 2.0 * mass);
            LinearMode { pole, residues: [residue; 4], cross: [[residue; 4]; 4] }
        };
        if root.im == 0.0 { vec![mode(1.0), mode(-1.0)] } else { vec![mode(1.0)] }
    }

    /// The loop of a dashpot on it, with further damping of its own.
    fn looped(modes: &[LinearMode], damping: f64) -> RigLoop<'_> {
        RigLoop {
            modes,
            group: ForceGroup::alone(0),
            ce_n_s_per_m: damping,
            compliance_m_per_n: 0.0,
            series: Series::IDENTITY,
        }
    }

    /// Least margin at one delay, from 0.05 Hz on.
    fn margin(rig: &RigLoop<'_>, tau_s: f64) -> f64 {
        let grid: Vec<(f64, Complex64)> = (0..20_000)
            .map(|n| 0.05 * TAU * libm::pow(1e4, f64::from(n) / 2e4))
            .map(|omega| (omega, rig.gain(Complex64::new(0.0, omega))))
            .collect();
        1.0 / crossing(&grid, tau_s).0
    }

    #[test]
    fn a_viscous_specimen_is_lost_at_the_delay_of_the_closed_form() {
        for mass in [2e3, 5e3, 10e3, 20e3] {
            for hz in [1.0, 3.8] {
                let (damping, omega) = (1e6, TAU * hz);
                let modes = oscillator(mass, mass * omega * omega, damping);
                let rig = looped(&modes, damping);
                let ratio = damping / (2.0 * mass * omega);
                let critical_s = 0.25 * TAU / (omega * (ratio + libm::sqrt(1.0 + ratio * ratio)));
                let (before, behind) =
                    (margin(&rig, 0.995 * critical_s), margin(&rig, 1.005 * critical_s));
                assert!(
                    before > 1.0 && behind < 1.0,
                    "{mass} {hz}: {critical_s} {before} {behind}"
                );
            }
        }
        // The smallest of them: 2 t at 3.8 Hz, 3.1 ms.
        let modes = oscillator(2e3, 2e3 * 23.876 * 23.876, 1e6);
        assert!(margin(&looped(&modes, 1e6), 3.05e-3) > 1.0);
        assert!(margin(&looped(&modes, 1e6), 3.15e-3) < 1.0);
    }

    #[test]
    fn a_loop_may_be_stable_again_beyond_a_window_of_delays() {
        // A dashpot of 1.1 times the own damping, delayed: |L| > 1 near the resonance alone.
        let (mass, own, omega) = (10e3, 2e4, TAU * 3.0);
        let modes = oscillator(mass, mass * omega * omega, 2.1 * own);
        let rig = looped(&modes, 1.1 * own);
        let unstable: Vec<bool> =
            (0..400).map(|n| margin(&rig, f64::from(n) * 1e-3) < 1.0).collect();
        let edges = unstable.windows(2).filter(|pair| pair[0] != pair[1]).count();
        // Around half a period, and again around one and a half: 167 and 500 ms.
        assert!(!unstable[0] && edges == 2 && !unstable[330], "{edges}");
        let first = unstable.iter().position(|lost| *lost).unwrap();
        // |L| = 1 where (k - m w^2)^2 = (1.1^2 - 1) (c w)^2; the phase there gives the delay.
        let half = 0.5 * libm::sqrt(0.21) * own / mass;
        let edge = half + libm::sqrt(half * half + omega * omega);
        let phase = libm::atan2(mass * (omega * omega - edge * edge), own * edge);
        let begin_s = (0.5 * TAU + phase) / edge;
        assert!((first as f64 * 1e-3 - begin_s).abs() < 1.5e-3, "{first} {begin_s}");
    }

    #[test]
    fn the_hunting_pair_loses_damping_as_the_energy_of_its_damper_does() {
        // A damper so weak that its delay adds hardly any stiffness: w lambda = 1.47. Its place in
        // `G` is taken by a dashpot, which has 1 + (w lambda)^2 times its damping.
        let (mass, hz, ce, ke) = (20e3, 3.5, 2e3, 3e4);
        let omega = TAU * hz;
        let modes = oscillator(mass, mass * omega * omega, ce);
        let rig = RigLoop { compliance_m_per_n: 1.0 / ke, ..looped(&modes, ce) };
        let found = rig.check(5e-3, BEYOND_HUNTING * hz, modes[0].pole);
        let [first, last] = found.hunting_damping;
        let lost = 1.0 - last / first;
        let (share, slope) = (damping_energy_lost(5e-3, hz, ce / ke), omega * ce / ke);
        let expected = share / (1.0 + slope * slope);
        assert!((lost - expected).abs() < 0.01 * expected, "{lost}, expected {expected}");
        assert!(found.holds() && found.safe_delay_s == 5e-3, "{found:?}");
    }
}
