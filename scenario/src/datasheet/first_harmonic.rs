//! Ke from a table of dynamic stiffness, by the first harmonic of the simulated nominal damper.
//!
//! At each frequency and amplitude the damper is driven by a sine until its first harmonic
//! ```text
//! F1 = 2/T integral F(t) e^(-i w t) dt        K* = F1 / X = K e^(i delta)
//! ```
//! repeats from cycle to cycle within 1e-4. Ke is the one with the least sum of
//! `|ln(K*_simulated / K*_table)|^2`: errors of stiffness as shares and errors of phase as angles,
//! where the table gives them. It is searched on a logarithmic grid from 0.2 to 1000 times the
//! largest stiffness of the table, then by golden section. The same damper as everywhere gives the
//! answer, with its clearance and relief; Maxwell's closed form would be wrong above relief.

use firmware_core::damper::{Damper, DamperState, Motion, Nominal};
use std::f64::consts::TAU;

/// One row of a dynamic table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the displacement, m.
    pub amplitude_m: f64,
    /// First harmonic of force over displacement, N/m.
    pub stiffness_n_per_m: f64,
    /// Phase of force before displacement, degrees.
    pub phase_deg: Option<f64>,
}

/// A first harmonic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// Force over displacement, N/m.
    pub stiffness_n_per_m: f64,
    /// Phase of force before displacement, degrees.
    pub phase_deg: f64,
}

/// Ke that meets a table best.
#[derive(Debug, Clone, PartialEq)]
pub struct KeFit {
    /// Stiffness, N/m.
    pub ke_n_per_m: f64,
    /// The search found it inside its bounds.
    pub bounded: bool,
    /// What the simulated damper then has at each point.
    pub found: Vec<Harmonic>,
}

const STEPS_PER_CYCLE: u32 = 256;
const CYCLES_MOST: u32 = 200;

impl Point {
    fn error(&self, found: &Harmonic) -> f64 {
        let size = libm::log((found.stiffness_n_per_m / self.stiffness_n_per_m).max(1e-12));
        let angle = self.phase_deg.map_or(0.0, |phase| (found.phase_deg - phase).to_radians());
        size * size + angle * angle
    }

    /// More than 10 % or 6 degrees apart.
    pub fn differs(&self, found: &Harmonic) -> bool {
        let phase = self.phase_deg.is_some_and(|phase| (found.phase_deg - phase).abs() > 6.0);
        phase || (found.stiffness_n_per_m / self.stiffness_n_per_m - 1.0).abs() > 0.1
    }

    /// The two side by side.
    pub fn compared_with(&self, found: &Harmonic) -> String {
        let phase = self.phase_deg.map_or_else(|| "-".to_owned(), |phase| format!("{phase:.1}"));
        format!(
            "at {} Hz, {} m: {:.4e} N/m and {:.1} deg, the table says {:.4e} N/m and {phase} deg",
            self.frequency_hz,
            self.amplitude_m,
            found.stiffness_n_per_m,
            found.phase_deg,
            self.stiffness_n_per_m
        )
    }
}

/// The first harmonic of a damper under a sine, once it repeats.
///
/// ```
/// use firmware_core::damper::{Damper, Nominal};
/// use scenario::datasheet::first_harmonic::{Point, harmonic};
/// // Maxwell at w Ce / Ke = 1: Ke / sqrt 2 at 45 degrees.
/// let nominal = Nominal { clearance_2a_m: 0.0, f_relief_n: f64::INFINITY, ..Nominal::NEW };
/// let at = Point {
///     frequency_hz: 12.5 / std::f64::consts::TAU,
///     amplitude_m: 1e-3,
///     stiffness_n_per_m: 1.0,
///     phase_deg: None,
/// };
/// let found = harmonic(&Damper::new(nominal, &[])?, &at);
/// assert!((found.stiffness_n_per_m / 8.8388e6 - 1.0).abs() < 1e-4);
/// assert!((found.phase_deg - 45.0).abs() < 0.01);
/// # Ok::<(), firmware_core::damper::DamperError>(())
/// ```
pub fn harmonic(damper: &Damper, point: &Point) -> Harmonic {
    let turn = TAU / f64::from(STEPS_PER_CYCLE);
    let step_s = 1.0 / (point.frequency_hz * f64::from(STEPS_PER_CYCLE));
    let damper = damper.clone().prepared(step_s);
    let (x, v) = (point.amplitude_m, point.amplitude_m * TAU * point.frequency_hz);
    let mut state = DamperState::starting(Motion::new(0.0, v));
    let mut before = (0.0, 0.0);
    for _ in 0..CYCLES_MOST {
        let (mut in_phase, mut ahead) = (0.0, 0.0);
        for step in 1..=STEPS_PER_CYCLE {
            let angle = turn * f64::from(step);
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let force = damper.advance(&mut state, Motion::new(x * sine, v * cosine), step_s);
            in_phase += force * sine;
            ahead += force * cosine;
        }
        let now = (in_phase, ahead);
        let change = (now.0 - before.0).abs() + (now.1 - before.1).abs();
        before = now;
        if change <= 1e-4 * (now.0.abs() + now.1.abs()) {
            break;
        }
    }
    let scale = 2.0 / (f64::from(STEPS_PER_CYCLE) * x);
    Harmonic {
        stiffness_n_per_m: scale * libm::hypot(before.0, before.1),
        phase_deg: libm::atan2(before.1, before.0).to_degrees(),
    }
}

/// The Ke that meets the points best, all else as in `nominal`; `None` without points.
pub fn fit_ke(nominal: &Nominal, points: &[Point]) -> Option<KeFit> {
    let largest = points.iter().map(|point| point.stiffness_n_per_m).fold(0.0, f64::max);
    if largest <= 0.0 {
        return None;
    }
    let found = |log_ke: f64| -> Option<Vec<Harmonic>> {
        let trial = Nominal { ke_n_per_m: libm::exp(log_ke), ..*nominal };
        let damper = Damper::new(trial, &[]).ok()?;
        Some(points.iter().map(|point| harmonic(&damper, point)).collect())
    };
    let error = |log_ke: f64| {
        found(log_ke).map_or(f64::MAX, |found| {
            points.iter().zip(&found).map(|(point, found)| point.error(found)).sum()
        })
    };
    let (low, high) = (libm::log(0.2 * largest), libm::log(1000.0 * largest));
    let grid = 60;
    let at = |place: i32| low + (high - low) * f64::from(place) / f64::from(grid);
    let errors: Vec<f64> = (0..=grid).map(|place| error(at(place))).collect();
    let (place, least) =
        (0..=grid).zip(&errors).min_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or((0, &f64::MAX));
    let (mut from, mut to) = (at((place - 1).max(0)), at((place + 1).min(grid)));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..40 {
        let (one, other) = (to - golden * (to - from), from + golden * (to - from));
        if error(one) <= error(other) { to = other } else { from = one }
    }
    let log_ke = 0.5 * (from + to);
    // A damper that is all dashpot at these points has the same error for any stiff spring.
    let stiffest = errors.last().copied().unwrap_or(f64::MAX);
    let bounded = place > 0 && stiffest - least > 1e-4 * points.len() as f64;
    Some(KeFit { ke_n_per_m: libm::exp(log_ke), bounded, found: found(log_ke)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_working_point_of_the_study_has_its_first_harmonic() {
        // 15 kN relief, 60 kN s/m beyond, 3.5 Hz and 3.46 mm: the table that goes with the
        // reference.
        for (clearance_2a_m, first_kn, phase_deg) in
            [(0.2e-3, 20.29, 50.4), (1e-3, 19.00, 42.8), (2e-3, 17.07, 33.8), (4e-3, 11.80, 14.4)]
        {
            let nominal =
                Nominal { clearance_2a_m, f_relief_n: 15e3, c2_n_s_per_m: 60e3, ..Nominal::NEW };
            let point = Point {
                frequency_hz: 3.5,
                amplitude_m: 3.46e-3,
                stiffness_n_per_m: 1.0,
                phase_deg: None,
            };
            let found = harmonic(&Damper::new(nominal, &[]).unwrap(), &point);
            let force_kn = found.stiffness_n_per_m * 3.46e-6;
            assert!((force_kn / first_kn - 1.0).abs() < 2e-3, "{force_kn} {first_kn}");
            assert!((found.phase_deg - phase_deg).abs() < 0.2, "{} {phase_deg}", found.phase_deg);
        }
    }

    #[test]
    fn ke_is_found_again_with_relief_and_clearance() {
        for ke_n_per_m in [3e6, 12.5e6, 60e6] {
            let nominal = Nominal { ke_n_per_m, ..Nominal::NEW };
            let damper = Damper::new(nominal, &[]).unwrap();
            let mut points = Vec::new();
            for (frequency_hz, amplitude_m) in [(1.0, 2e-3), (3.0, 1e-3), (8.0, 0.5e-3)] {
                let mut point =
                    Point { frequency_hz, amplitude_m, stiffness_n_per_m: 1.0, phase_deg: None };
                let found = harmonic(&damper, &point);
                point.stiffness_n_per_m = found.stiffness_n_per_m;
                points.push(point);
                point.phase_deg = Some(found.phase_deg);
                points.push(point);
            }
            let fit = fit_ke(&Nominal { ke_n_per_m: 1.0, ..nominal }, &points).unwrap();
            assert!((fit.ke_n_per_m / ke_n_per_m - 1.0).abs() < 1e-4, "{fit:?}");
            assert!(fit.bounded);
            assert!(points.iter().zip(&fit.found).all(|(point, found)| !point.differs(found)));
        }
    }

    #[test]
    fn a_dashpot_does_not_tell_its_spring() {
        let nominal = Nominal {
            ce_n_s_per_m: 1e4,
            ke_n_per_m: 1e12,
            clearance_2a_m: 0.0,
            f_relief_n: f64::INFINITY,
            c2_n_s_per_m: 0.0,
        };
        let point = Point {
            frequency_hz: 1.0,
            amplitude_m: 0.01,
            stiffness_n_per_m: TAU * 1e4,
            phase_deg: Some(90.0),
        };
        assert!(!fit_ke(&nominal, &[point]).unwrap().bounded);
        assert_eq!(fit_ke(&nominal, &[]), None);
    }
}
