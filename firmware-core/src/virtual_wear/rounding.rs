//! Contacts rounded to what a ram can do.
//!
//! Where a gap closes, the motion of the damper has a kink: its speed jumps by `v`. A mean over an
//! odd number of cycles makes an acceleration of it,
//!
//! ```text
//! y_k = (w_(k-m) + ... + w_(k+m)) / n        n = 2 m + 1        a = v / (n T)
//! ```
//! It looks `m` cycles further ahead, so that it is not late: it begins before the contact and ends
//! after it, and its gain at hunting is one (0.05 % less over 5 ms at 3.5 Hz).

use crate::ring::Ring;

/// Most cycles on either side of a contact.
pub const MOST_ROUNDING_CYCLES: u8 = 15;

/// Places of the ring, one more than the longest mean.
const KEPT: usize = 2 * MOST_ROUNDING_CYCLES as usize + 2;

/// The last targets (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounding(Ring<f64, KEPT>);

impl Rounding {
    /// Nothing has happened yet.
    pub(super) const NEW: Self = Self(Ring::filled(0.0));
}

/// Cycles on either side with which a jump of the speed (m/s) keeps an acceleration (m/s2).
pub(super) fn rounding_cycles(speed_m_per_s: f64, acceleration_m_per_s2: f64, cycle_s: f64) -> u8 {
    debug_assert!(acceleration_m_per_s2 > 0.0 && cycle_s > 0.0);
    let cycles = libm::ceil(0.5 * (speed_m_per_s / (acceleration_m_per_s2 * cycle_s) - 1.0));
    cycles.max(0.0).min(f64::from(MOST_ROUNDING_CYCLES)) as u8
}

impl Rounding {
    /// Takes a target; the mean and its rate per cycle.
    pub(super) fn take(&mut self, target_m: f64, half_cycles: u8) -> (f64, f64) {
        debug_assert!(half_cycles <= MOST_ROUNDING_CYCLES, "{half_cycles} cycles on either side");
        self.0.keep(target_m);
        let count = (2 * usize::from(half_cycles) + 1).min(KEPT - 1);
        let sum: f64 = (0..count).map(|age| self.ago_m(age)).sum();
        let rate = (target_m - self.ago_m(count)) / count as f64;
        (sum / count as f64, rate)
    }

    fn ago_m(&self, cycles: usize) -> f64 {
        self.0.ago(cycles).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kink_becomes_a_constant_acceleration_around_it() {
        // 76 mm/s at 16 m/s2: five cycles.
        let half = rounding_cycles(0.076, 16.0, 1e-3);
        assert_eq!(half, 2);
        let mut rounding = Rounding::NEW;
        let mut last = 0.0;
        for cycle in -20..20 {
            // Seen two cycles ahead.
            let target_m = 76e-6 * f64::from((cycle + i32::from(half)).max(0));
            let (mean_m, rate_m) = rounding.take(target_m, half);
            let change = (rate_m - last) / 1e-6;
            assert!((-1e-9..=16.0).contains(&change), "{cycle}: {change} m/s2");
            let kink_m = 76e-6 * f64::from(cycle.max(0));
            assert!((mean_m - kink_m).abs() <= 76e-6 * 5.0 / 8.0, "{cycle}: {mean_m}, {kink_m}");
            if cycle.abs() > 2 {
                assert!((mean_m - kink_m).abs() < 1e-15, "{cycle}: {mean_m}, {kink_m}");
            }
            last = rate_m;
        }
    }

    #[test]
    fn a_slow_ram_takes_as_long_as_the_ring() {
        assert_eq!(rounding_cycles(0.076, 0.5, 1e-3), MOST_ROUNDING_CYCLES);
        assert_eq!(rounding_cycles(0.076, 1e3, 1e-3), 0);
    }
}
