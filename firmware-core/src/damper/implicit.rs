//! Implicit steps: the fallback, and the coupling of attachments that creep.
//!
//! **Backward Euler** on a piecewise-linear law has a closed form: the left side of
//! e1 + h v(e1) = e0 + h V rises with e1, so the segment that holds the solution is found by
//! walking the knots. It is unconditionally stable, first order, works with a hard cap and with no
//! clearance, and cannot fail.
//!
//! **Creep.** A viscoelastic attachment adds a deflection d that follows the force with a memory of
//! its own. Over a step its end value is a rising line in the force at the end, d1 = c0 + c1 F1,
//! exact for a force that is linear in the step. The chain sees it as a change D = (d1 - d0)/h of
//! its driving velocity, so that F1 is the root of
//!
//! ```text
//! chain(V - (c0 + c1 F1 - d0)/h) - F1 = 0
//! ```
//!
//! which falls with slope -1 or steeper: one root, bracketed by any guess and its answer. Newton's
//! step from the slope of the last segment finds it at once while no knot is crossed, false
//! position (Illinois) otherwise. Second order, and for a fast creep d1 is F1 times its compliance
//! with no memory left: L-stable. Knots of the law stay exact.

use super::chain::{Arrival, Drive};
use super::segment::Segment;

/// Most evaluations of the chain in one coupled step.
pub(super) const MAX_COUPLING: u32 = 20;

/// End deflection of one backward Euler step with the driving velocity at its end.
pub(super) fn backward_euler(
    segments: &[Segment],
    start_m: f64,
    velocity_m_per_s: f64,
    step_s: f64,
) -> f64 {
    debug_assert!(!segments.is_empty(), "a chain without a law");
    // No number where forces have overflowed.
    debug_assert!(step_s >= 0.0 || step_s.is_nan(), "step of {step_s} s");
    let aim = start_m + step_s * velocity_m_per_s;
    for segment in segments {
        if aim > segment.to_m + step_s * segment.velocity_to {
            continue;
        }
        if aim < segment.from_m + step_s * segment.velocity_from {
            return segment.from_m;
        }
        let anchor = &segment.anchor;
        let beyond = aim - anchor.deflection_m - step_s * anchor.velocity_m_per_s;
        return anchor.deflection_m + beyond / (1.0 + step_s * segment.rate_per_s);
    }
    segments.last().map_or(aim, |last| last.to_m)
}

/// Creep of the whole attachment over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Creep {
    /// Creep at the beginning, m.
    pub start_m: f64,
    /// Creep at the end if the force ends at zero, m.
    pub end_without_force_m: f64,
    /// Further creep at the end per force at the end, m/N, zero or more.
    pub compliance_m_per_n: f64,
}

impl Creep {
    /// None.
    pub const NONE: Self = Self { start_m: 0.0, end_without_force_m: 0.0, compliance_m_per_n: 0.0 };

    /// Parts in series creep together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            start_m: self.start_m + other.start_m,
            end_without_force_m: self.end_without_force_m + other.end_without_force_m,
            compliance_m_per_n: self.compliance_m_per_n + other.compliance_m_per_n,
        }
    }

    /// Creep at the end of the step, m.
    pub fn end_m(&self, force_n: f64) -> f64 {
        self.end_without_force_m + self.compliance_m_per_n * force_n
    }
}

/// Moves a chain whose attachment creeps through one step. `chain` is the step without creep, under
/// a drive; `guess_n` is any force near the end's.
///
/// # Errors
/// What `chain` has none of its own for.
pub(super) fn advance_with_creep<E>(
    drive: Drive,
    step_s: f64,
    creep: Creep,
    guess_n: f64,
    chain: impl Fn(Drive) -> Result<Arrival, E>,
) -> Result<Arrival, E> {
    debug_assert!(step_s > 0.0, "step of {step_s} s");
    let per_step = 1.0 / step_s;
    let mut force_n = guess_n;
    // Guesses on both sides of the root, with what is missing at each.
    let (mut low, mut high): (Option<Guess>, Option<Guess>) = (None, None);
    let mut last_rising = None;
    let mut tries = 0;
    loop {
        let rate = (creep.end_m(force_n) - creep.start_m) * per_step;
        let velocity_m_per_s = drive.velocity_m_per_s - rate;
        let arrival = chain(Drive { velocity_m_per_s, ..drive })?;
        tries += 1;
        let miss_n = arrival.force_n - force_n;
        let close = miss_n.abs() <= 1e-9 * arrival.force_n.abs().max(force_n.abs());
        if close || tries == MAX_COUPLING {
            return Ok(arrival);
        }
        let rising = miss_n > 0.0;
        let (side, other) = if rising { (&mut low, &mut high) } else { (&mut high, &mut low) };
        if let Some(stale) = other
            && last_rising == Some(rising)
        {
            // Twice on the same side: without this the other end would never move.
            stale.miss_n *= 0.5;
        }
        *side = Some(Guess { force_n, miss_n });
        last_rising = Some(rising);
        force_n = if let (Some(low), Some(high)) = (low, high) {
            // From the nearer one, so that mirrored motion gives mirrored bits.
            let (near, far) =
                if low.miss_n.abs() <= high.miss_n.abs() { (low, high) } else { (high, low) };
            let share = near.miss_n / (near.miss_n - far.miss_n);
            near.force_n + share * (far.force_n - near.force_n)
        } else {
            let slope = 1.0 + arrival.sensitivity_n_s_per_m * creep.compliance_m_per_n * per_step;
            force_n + miss_n / slope
        };
    }
}

/// A force tried for the end of the step, and how far the chain's answer was from it.
#[derive(Clone, Copy)]
struct Guess {
    force_n: f64,
    miss_n: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damper::chain::Stand;
    use crate::damper::curve::Curve;
    use crate::damper::law::Law;
    use crate::damper::nominal::Nominal;
    use crate::damper::parts::{Body, Factors, Parts};
    use crate::damper::series::advance;
    use core::convert::Infallible;

    /// The damper of the published step-size table.
    fn table_damper(c2_n_s_per_m: f64) -> Nominal {
        Nominal {
            ce_n_s_per_m: 1e6,
            ke_n_per_m: 12.5e6,
            clearance_2a_m: 1e-3,
            f_relief_n: 15e3,
            c2_n_s_per_m,
        }
    }

    fn law_of(nominal: &Nominal) -> Law {
        let (hydraulic, attachment) = (nominal.hydraulic(), nominal.attachment());
        let mut law = Law::empty();
        let parts = Parts { hydraulic, dry: Curve::ZERO, attachment };
        law.join(&parts, &Body::nominal(&parts), &Factors::NONE);
        law
    }

    fn displacement_m(time_s: f64) -> f64 {
        3.46e-3 * libm::sin(2.0 * core::f64::consts::PI * 3.5 * time_s)
    }

    /// Backward Euler as it is written for this damper: two closed forms and a dead zone.
    fn written_backward_euler(nominal: &Nominal, e: f64, h: f64) -> (f64, f64) {
        let Nominal { ce_n_s_per_m: ce, ke_n_per_m: ke, c2_n_s_per_m: c2, f_relief_n: fr, .. } =
            *nominal;
        let beyond = e.abs() - 0.5 * nominal.clearance_2a_m;
        if beyond <= 0.0 {
            return (e, 0.0);
        }
        let mut force = ke * beyond / (1.0 + ke * h / ce);
        if force > fr {
            let opened = c2 * ke * (beyond - h * nominal.v_relief_m_per_s());
            force = (opened + ke * h * fr) / (c2 + ke * h);
        }
        (e - e.signum() * (beyond - force / ke), e.signum() * force)
    }

    /// Error of backward Euler over rms force, in percent, against a step of 1 microsecond.
    fn error_percent(c2_n_s_per_m: f64, step_us: u32) -> f64 {
        let nominal = table_damper(c2_n_s_per_m);
        let law = law_of(&nominal);
        let (mut coarse, mut fine) = (0.0, 0.0);
        let (mut miss, mut size) = (0.0, 0.0);
        let h = f64::from(step_us) * 1e-6;
        for step in 0..(857_140 / step_us) {
            let start = f64::from(step * step_us);
            for i in 0..step_us {
                let t = (start + f64::from(i)) * 1e-6;
                fine += displacement_m(t + 1e-6) - displacement_m(t);
                let (end, _) = written_backward_euler(&nominal, fine, 1e-6);
                fine = end;
            }
            let velocity = (displacement_m(start * 1e-6 + h) - displacement_m(start * 1e-6)) / h;
            let (written, force) = written_backward_euler(&nominal, coarse + h * velocity, h);
            coarse = backward_euler(&law.sliding, coarse, velocity, h);
            assert!((coarse - written).abs() < 1e-15, "{coarse} {written}");
            let exact = nominal.ke_n_per_m
                * fine.signum()
                * (fine.abs() - 0.5 * nominal.clearance_2a_m).max(0.0);
            miss += (force - exact) * (force - exact);
            size += exact * exact;
        }
        100.0 * crate::sqrt::sqrt(miss / size)
    }

    #[test]
    fn backward_euler_has_the_published_errors() {
        let published = [
            (60e3, 5000, 3.02),
            (60e3, 2000, 1.21),
            (60e3, 1000, 0.61),
            (60e3, 500, 0.31),
            (60e3, 100, 0.061),
            (5e3, 5000, 2.04),
            (5e3, 2000, 0.80),
            (5e3, 1000, 0.40),
            (5e3, 500, 0.20),
            (5e3, 100, 0.040),
        ];
        for (c2, step_us, expected) in published {
            let error = error_percent(c2, step_us);
            assert!((error / expected - 1.0).abs() < 0.06, "{c2} {step_us}: {error} {expected}");
        }
    }

    #[test]
    fn backward_euler_holds_a_hard_cap_at_any_step() {
        let nominal = Nominal { clearance_2a_m: 0.0, ..table_damper(0.0) };
        let law = law_of(&nominal);
        for step_s in [1e-4, 1e-2, 1.0, 1e3] {
            let end = backward_euler(&law.sliding, 0.0, 1.0, step_s);
            let cap = nominal.f_relief_n / nominal.ke_n_per_m;
            assert!(end <= cap * (1.0 + 1e-15) && end > 0.0, "{step_s}: {end}");
        }
    }

    #[test]
    fn coupling_meets_its_equation_for_any_creep() {
        let law = law_of(&table_damper(5e3));
        let drive = Drive { velocity_m_per_s: 0.3, acceleration_m_per_s2: -20.0 };
        for deflection_m in [-2e-3, -0.6e-3, 0.0, 0.499e-3, 1.69e-3] {
            let stand = Stand { deflection_m, resting: false };
            // The softest is twenty times Ke: the bound of the rubber.
            for compliance_m_per_n in [0.0, 1e-10, 1e-8, 1e-7, 1.6e-6] {
                let creep = Creep { start_m: 2e-5, end_without_force_m: 1e-5, compliance_m_per_n };
                let step_s = 1e-3;
                let chain = |drive| Ok::<_, Infallible>(advance(&law, stand, drive, step_s));
                let Ok(end) = advance_with_creep(drive, step_s, creep, -2e4, chain);
                let rate = (creep.end_m(end.force_n) - creep.start_m) / step_s;
                let velocity_m_per_s = drive.velocity_m_per_s - rate;
                let again = advance(&law, stand, Drive { velocity_m_per_s, ..drive }, step_s);
                let miss = (again.force_n - end.force_n).abs();
                assert!(miss < 1e-3, "{deflection_m} {compliance_m_per_n}: {miss} N");
            }
        }
    }
}
