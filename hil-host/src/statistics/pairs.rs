//! How far two dampers are from moving oppositely, or alike.
//!
//! ```text
//! rms(x_i + x_j)        zero where both move oppositely: pure yaw of their bogie
//! rms(x_i - x_j)        zero where both move alike
//! ```

use super::power::Power;
use firmware_core::vehicle::DAMPER_SLOTS;

/// Sums and differences of the strokes of every two slots.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pairs {
    sums: [[Power; DAMPER_SLOTS]; DAMPER_SLOTS],
    differences: [[Power; DAMPER_SLOTS]; DAMPER_SLOTS],
}

impl Pairs {
    pub(super) fn take(&mut self, strokes_m: [f64; DAMPER_SLOTS]) {
        for first in 0..DAMPER_SLOTS {
            for second in first + 1..DAMPER_SLOTS {
                let (x, y) = (strokes_m[first], strokes_m[second]);
                self.sums[first][second].take(x + y);
                self.differences[first][second].take(x - y);
            }
        }
    }

    /// Rms of what is left of the stroke of one slot beyond that of another (m), whose sign is
    /// reversed or not.
    pub(crate) fn rms_m(&self, slots: [usize; 2], is_reversed: bool) -> f64 {
        let [first, second] = [slots[0].min(slots[1]), slots[0].max(slots[1])];
        debug_assert!(first < second && second < DAMPER_SLOTS, "{slots:?} is no pair");
        let pairs = if is_reversed { &self.sums } else { &self.differences };
        pairs[first][second].rms()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_strokes_have_no_sum_and_equal_ones_no_difference() {
        let mut pairs = Pairs::default();
        for n in 0..100 {
            let x = libm::sin(0.1 * f64::from(n));
            pairs.take([x, -x, x, 0.1 * x]);
        }
        assert_eq!((pairs.rms_m([1, 0], true), pairs.rms_m([0, 2], false)), (0.0, 0.0));
        let x = pairs.rms_m([0, 2], true) / 2.0;
        assert!((pairs.rms_m([0, 1], false) - 2.0 * x).abs() < 1e-12);
        assert!((pairs.rms_m([3, 2], false) - 0.9 * x).abs() < 1e-12);
    }
}
