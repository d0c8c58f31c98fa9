//! The work that a damper takes from the motion, cycle by cycle of the motion.
//!
//! ```text
//! W = closed integral of F dx,   positive for a damper        x, F of one instant
//! ```
//!
//! A passive damper cannot give work back over a whole cycle. A force with the wrong sign gives
//! back as much as the damper should take, in the first cycle; a wrong phase gives back a little in
//! every cycle. So two sums are judged, each as a share of what force and stroke could do at most,
//! `|F| |x|` over the same cycles:
//!
//! ```text
//! one cycle       W < -1/3 of the most           sign
//! ten cycles      sum W < -1/10 of the most      phase
//! ```
//!
//! A cycle of the motion begins where the displacement comes up through its slow mean, once it was
//! below by the least amplitude. Cycles of less than 0.5 mm amplitude do not count, nor those with
//! a mean force of less than 500 N, such as within a clearance: there noise and zero errors decide.

/// Amplitude of a cycle from which its work counts, m.
pub const LEAST_AMPLITUDE_M: f64 = 0.5e-3;
/// Mean force of a cycle from which its work counts, N.
pub const LEAST_FORCE_N: f64 = 500.0;
/// Cycles of the longer sum.
pub const SUMMED: usize = 10;
/// Share by which the slow mean follows the displacement, per cycle of control: 3 s at 1 kHz.
const SLOW: f64 = 1.0 / 3000.0;

/// Shares of the most possible work that may be given back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorkLimits {
    /// In one cycle of the motion: beyond it the sign is wrong.
    pub one_cycle: f64,
    /// In ten cycles of the motion: beyond it the phase is wrong.
    pub ten_cycles: f64,
}

impl WorkLimits {
    /// Those of the formulas above.
    pub const USUAL: Self = Self { one_cycle: 1.0 / 3.0, ten_cycles: 0.1 };
}

/// What the work says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WorkVerdict {
    /// No whole cycle yet, or nothing wrong.
    Passive,
    /// Ten cycles together give work back.
    GivesBack,
    /// A single cycle gives back a third of the most that it could, or more.
    WrongSign,
}

/// What the detector remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Work {
    last: Option<(f64, f64)>,
    slow_m: f64,
    was_below: bool,
    begun: bool,
    /// Work and most work of the cycle so far, J, and its range, m.
    taken_j: f64,
    most_j: f64,
    low_m: f64,
    high_m: f64,
    /// Work of the last cycles that count, and the most that they could have, J.
    cycles_j: [f64; SUMMED],
    mosts_j: [f64; SUMMED],
    counted: u32,
    next: usize,
    /// What the cycle has shown that has ended in this cycle of control.
    ended: Option<Ended>,
    verdict: Option<WorkVerdict>,
}

/// What a cycle of the motion has shown.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ended {
    sign_is_wrong: bool,
    phase_is_wrong: bool,
}

impl Work {
    /// Takes displacement (m) and force (N) of one instant, tension positive; the worst so far.
    ///
    /// ```
    /// use firmware_core::supervision::{Work, WorkLimits, WorkVerdict};
    /// let mut work = Work::default();
    /// let wave = |n: u32| 0.022 * f64::from(n);
    /// for n in 0..3000 {
    ///     // A dashpot: force along the velocity.
    ///     work.take(&WorkLimits::USUAL, 3e-3 * wave(n).sin(), 16e3 * wave(n).cos());
    /// }
    /// assert_eq!(work.verdict(), WorkVerdict::Passive);
    /// assert!((work.last_cycle_j() - 151.0).abs() < 1.0);
    /// ```
    pub fn take(&mut self, limits: &WorkLimits, displacement_m: f64, force_n: f64) -> WorkVerdict {
        self.ended = None;
        let Some((x_m, f_n)) = self.last.replace((displacement_m, force_n)) else {
            self.slow_m = displacement_m;
            (self.low_m, self.high_m) = (displacement_m, displacement_m);
            return self.verdict();
        };
        let step_m = displacement_m - x_m;
        let mean_n = 0.5 * (force_n + f_n);
        self.taken_j += mean_n * step_m;
        self.most_j += (mean_n * step_m).abs();
        self.low_m = self.low_m.min(displacement_m);
        self.high_m = self.high_m.max(displacement_m);
        self.slow_m += SLOW * (displacement_m - self.slow_m);
        let below = displacement_m < self.slow_m - LEAST_AMPLITUDE_M;
        let comes_up = x_m < self.slow_m && displacement_m >= self.slow_m;
        if comes_up && self.was_below {
            self.end_cycle(limits);
            self.was_below = false;
        } else {
            self.was_below |= below;
        }
        self.verdict()
    }

    /// The verdict; the worst so far.
    pub fn verdict(&self) -> WorkVerdict {
        self.verdict.unwrap_or(WorkVerdict::Passive)
    }

    /// Whether a cycle of the motion that has just ended has the wrong sign.
    pub(super) fn has_wrong_sign(&self) -> bool {
        self.ended.is_some_and(|ended| ended.sign_is_wrong)
    }

    /// Whether ten cycles of the motion that have just ended give work back.
    pub(super) fn has_wrong_phase(&self) -> bool {
        self.ended.is_some_and(|ended| ended.phase_is_wrong)
    }

    /// Work of the last whole cycle, J.
    pub fn last_cycle_j(&self) -> f64 {
        let last = (self.next + SUMMED - 1) % SUMMED;
        self.cycles_j.get(last).copied().unwrap_or(0.0)
    }

    fn end_cycle(&mut self, limits: &WorkLimits) {
        let range_m = self.high_m - self.low_m;
        let is_large =
            range_m >= 2.0 * LEAST_AMPLITUDE_M && self.most_j >= 2.0 * range_m * LEAST_FORCE_N;
        // The first mark begins a cycle and ends none.
        if self.begun && is_large {
            if let Some(place) = self.cycles_j.get_mut(self.next) {
                *place = self.taken_j;
            }
            if let Some(place) = self.mosts_j.get_mut(self.next) {
                *place = self.most_j;
            }
            self.next = (self.next + 1) % SUMMED;
            self.counted = self.counted.saturating_add(1);
            let (sum_j, most_j): (f64, f64) =
                (self.cycles_j.iter().sum(), self.mosts_j.iter().sum());
            let sign_is_wrong = self.taken_j < -limits.one_cycle * self.most_j;
            let phase_is_wrong =
                self.counted as usize >= SUMMED && sum_j < -limits.ten_cycles * most_j;
            let now = match (sign_is_wrong, phase_is_wrong) {
                (true, _) => WorkVerdict::WrongSign,
                (false, true) => WorkVerdict::GivesBack,
                (false, false) => WorkVerdict::Passive,
            };
            self.ended = Some(Ended { sign_is_wrong, phase_is_wrong });
            self.verdict = Some(self.verdict().max(now));
        }
        self.begun = true;
        (self.taken_j, self.most_j) = (0.0, 0.0);
        (self.low_m, self.high_m) = (f64::INFINITY, f64::NEG_INFINITY);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Control cycle of a verdict, of a motion of an amplitude at 3.5 Hz and a force of 16 kN that
    /// leads the displacement by a phase.
    fn cycle_of(
        verdict: WorkVerdict,
        amplitude_m: f64,
        lead_rad: impl Fn(u32) -> f64,
    ) -> Option<u32> {
        let mut work = Work::default();
        let phase = |n: u32| core::f64::consts::TAU * 3.5e-3 * f64::from(n);
        (0..20_000).find(|n| {
            let x = amplitude_m * libm::sin(phase(*n));
            work.take(&WorkLimits::USUAL, x, 16e3 * libm::sin(phase(*n) + lead_rad(*n))) == verdict
        })
    }

    const QUARTER: f64 = core::f64::consts::FRAC_PI_2;

    #[test]
    fn a_force_with_the_wrong_sign_is_found_within_a_cycle_of_the_motion() {
        // Row 13 of the faults that were tried: the run ended as completed.
        let flipped =
            cycle_of(
                WorkVerdict::WrongSign,
                3.46e-3,
                |n| if n < 10_000 { QUARTER } else { -QUARTER },
            );
        assert!(flipped.is_some_and(|n| (10_000..10_000 + 2 * 286).contains(&n)), "{flipped:?}");
        let from_the_start = cycle_of(WorkVerdict::WrongSign, 3.46e-3, |_| -QUARTER);
        assert!(from_the_start.is_some_and(|n| n < 3 * 286), "{from_the_start:?}");
    }

    #[test]
    fn a_damper_behind_its_spring_is_passive_and_a_late_one_gives_back() {
        // A stiff damper: the force leads by a tenth of a radian only.
        assert_eq!(cycle_of(WorkVerdict::WrongSign, 3.46e-3, |_| 0.1), None);
        assert_eq!(cycle_of(WorkVerdict::GivesBack, 3.46e-3, |_| 0.1), None);
        let late = cycle_of(WorkVerdict::GivesBack, 3.46e-3, |_| -0.1);
        assert!(late.is_some_and(|n| n < 13 * 286), "{late:?}");
    }

    #[test]
    fn a_motion_of_less_than_half_a_millimetre_decides_nothing() {
        assert_eq!(cycle_of(WorkVerdict::WrongSign, 0.4e-3, |_| -QUARTER), None);
    }
}
