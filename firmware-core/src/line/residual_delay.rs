//! The delay of the force that compensation has left, and what it costs.
//!
//! ```text
//! tau_x = -<e v> / <v^2>      e = x_measured - x_wanted      over a block of a second
//! tau   = tau_x - T / 2       the force is held over a cycle, from its beginning
//! tau   = mean +- t s / sqrt(n)                               over n blocks, 95 %
//! ```
//! `x_wanted` is the vehicle's motion with wear and fades, before compensation and limits, and `v`
//! its rate. `x_measured` is what arrives in the cycle in which `x_wanted` leaves; so what is older
//! on a clock is part of the delay. Blocks of a second are longer than what a damper remembers, and
//! their means count as independent; `t` is Student's quantile of `n - 1` degrees of freedom.
//!
//! The cost is the share of the damping at the hunting frequency that such a delay removes
//! ([`damping_energy_lost`]): of the mean, and the larger one of both ends of the interval. It is
//! linear, with `lambda = Ce / Ke` of the slot's model.

use super::KNOWN_DELAY_CYCLES;
use crate::compensation::damping_energy_lost;
use crate::damper::Damper;

/// Length of a block (s).
pub const BLOCK_S: f64 = 1.0;
/// Fewest blocks of an interval.
pub const FEWEST_BLOCKS: u32 = 4;

/// The delay of one rig, block by block.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DelayBlocks {
    last_m: Option<f64>,
    cycles: u32,
    with_rate: f64,
    rate2: f64,
    blocks: u32,
    mean_s: f64,
    squares_s2: f64,
}

/// The delay of the force with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualDelay {
    /// Mean over the blocks, s; negative for a lead.
    pub mean_s: f64,
    /// Half of the interval of 95 %, s.
    pub half_width_s: f64,
    /// Blocks of a second.
    pub blocks: u32,
}

/// What a damper makes of a delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Frequency of hunting, Hz.
    pub frequency_hz: f64,
    /// `Ce / Ke`, s.
    pub relaxation_s: f64,
}

impl DelayBlocks {
    /// Takes the wanted displacement that leaves in a cycle and the measured one that has arrived
    /// in it, m; one that is no number is left out. A cycle takes `cycle_s`.
    pub fn take(&mut self, wanted_m: f64, measured_m: f64, cycle_s: f64) {
        let Some(before_m) = self.last_m.replace(wanted_m) else { return };
        let (error, rate) = (measured_m - wanted_m, (wanted_m - before_m) / cycle_s);
        if error.is_finite() {
            self.with_rate += error * rate;
            self.rate2 += rate * rate;
        }
        self.cycles += 1;
        if self.cycles >= block_cycles(cycle_s) {
            self.end_block();
        }
    }

    fn end_block(&mut self) {
        let delay_s = -self.with_rate / self.rate2;
        (self.cycles, self.with_rate, self.rate2) = (0, 0.0, 0.0);
        // A block without motion says nothing.
        if !delay_s.is_finite() {
            return;
        }
        self.blocks += 1;
        let step_s = delay_s - self.mean_s;
        self.mean_s += step_s / f64::from(self.blocks);
        self.squares_s2 += step_s * (delay_s - self.mean_s);
        debug_assert!(self.squares_s2 >= 0.0, "a sum of squares of {} s2", self.squares_s2);
    }

    /// The delay of the force in cycles of `cycle_s`; none of fewer than four blocks.
    pub fn residual(&self, cycle_s: f64) -> Option<ResidualDelay> {
        if self.blocks < FEWEST_BLOCKS {
            return None;
        }
        let freedom = f64::from(self.blocks - 1);
        let deviation_s = crate::sqrt::sqrt(self.squares_s2 / freedom / f64::from(self.blocks));
        Some(ResidualDelay {
            mean_s: self.mean_s + KNOWN_DELAY_CYCLES * cycle_s,
            half_width_s: student(self.blocks - 1) * deviation_s,
            blocks: self.blocks,
        })
    }
}

/// Cycles of a block: 1000 at 1 kHz.
pub fn block_cycles(cycle_s: f64) -> u32 {
    debug_assert!(cycle_s > 0.0 && cycle_s <= BLOCK_S, "a cycle of {cycle_s} s");
    libm::round(BLOCK_S / cycle_s) as u32
}

impl ResidualDelay {
    /// The share of the damping that the mean costs; negative where the damper takes too much.
    pub fn cost(&self, sensitivity: Sensitivity) -> f64 {
        sensitivity.cost(self.mean_s)
    }

    /// The end of the interval that costs more, s.
    pub fn worst_s(&self, sensitivity: Sensitivity) -> f64 {
        let ends = [self.mean_s - self.half_width_s, self.mean_s + self.half_width_s];
        let [low, high] = ends.map(|end_s| sensitivity.cost(end_s).abs());
        if low > high { ends[0] } else { ends[1] }
    }

    /// The size of its cost.
    pub fn worst_cost(&self, sensitivity: Sensitivity) -> f64 {
        sensitivity.cost(self.worst_s(sensitivity)).abs()
    }
}

impl Sensitivity {
    /// That of a damper, for a vehicle that hunts at a frequency (Hz).
    pub fn of(damper: &Damper, frequency_hz: f64) -> Self {
        let nominal = damper.nominal();
        Self { frequency_hz, relaxation_s: nominal.ce_n_s_per_m / nominal.ke_n_per_m }
    }

    /// The share of the damping that a delay costs.
    pub fn cost(self, delay_s: f64) -> f64 {
        damping_energy_lost(delay_s, self.frequency_hz, self.relaxation_s)
    }
}

/// Student's quantile of 97.5 % for at least three degrees of freedom: a table, then the expansion
/// of Cornish and Fisher about the normal one, which is off by less than 0.2 %.
fn student(freedom: u32) -> f64 {
    const TABLE: [f64; 7] = [3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262];
    debug_assert!(freedom >= FEWEST_BLOCKS - 1, "{freedom} degrees of freedom");
    if let Some(quantile) = TABLE.get(freedom.saturating_sub(3) as usize) {
        return *quantile;
    }
    let (z, n) = (1.959_964_f64, f64::from(freedom));
    let cube = z * z * z;
    let (first, second) = (cube + z, 5.0 * cube * z * z + 16.0 * cube + 3.0 * z);
    z + first / (4.0 * n) + second / (96.0 * n * n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    const CYCLE_S: f64 = 1e-3;
    const BLOCK_CYCLES: u32 = 1000;

    /// A motion of 3.5 Hz and 3.46 mm, measured so many cycles late.
    fn late(cycles: f64, seconds: u32, jitter: impl Fn(u32) -> f64) -> DelayBlocks {
        let at = |n: f64| 3.46e-3 * libm::sin(TAU * 3.5 * n * CYCLE_S);
        let mut blocks = DelayBlocks::default();
        for n in 0..=seconds * BLOCK_CYCLES {
            blocks.take(at(f64::from(n)), at(f64::from(n) - cycles - jitter(n)), CYCLE_S);
        }
        blocks
    }

    #[test]
    fn two_cycles_late_is_a_delay_of_one_and_a_half() {
        let found = late(2.0, 5, |_| 0.0).residual(CYCLE_S).unwrap();
        assert_eq!(found.blocks, 5);
        assert!((found.mean_s - 1.5e-3).abs() < 2e-6, "{found:?}");
        assert!(found.half_width_s < 2e-6, "{found:?}");
        assert_eq!(late(2.0, 3, |_| 0.0).residual(CYCLE_S), None);
    }

    #[test]
    fn the_interval_is_that_of_student() {
        // Blocks late by 1, 2, 1, 2 cycles: mean 1.5, deviation 0.577, three degrees of freedom.
        let found = late(1.0, 4, |n| f64::from((n.saturating_sub(1) / BLOCK_CYCLES) % 2));
        let found = found.residual(CYCLE_S).unwrap();
        assert!((found.mean_s - 1e-3).abs() < 5e-6, "{found:?}");
        let expected_s = 3.182 * 0.577_35e-3 / 2.0;
        assert!((found.half_width_s - expected_s).abs() < 0.01 * expected_s, "{found:?}");
        for (freedom, quantile) in [(3, 3.182), (9, 2.262), (10, 2.228), (30, 2.042), (300, 1.968)]
        {
            assert!((student(freedom) / quantile - 1.0).abs() < 2e-3, "{freedom}");
        }
    }

    #[test]
    fn the_worse_end_of_the_interval_is_judged() {
        let sensitivity = Sensitivity { frequency_hz: 3.5, relaxation_s: 0.08 };
        let delay = ResidualDelay { mean_s: 0.0, half_width_s: 1e-3, blocks: 5 };
        assert_eq!(delay.cost(sensitivity), 0.0);
        // 3.9 % late, 3.8 % early: 1 - cos(w tau) adds on one side.
        assert_eq!(delay.worst_s(sensitivity), 1e-3);
        assert!((delay.worst_cost(sensitivity) - 0.0389).abs() < 1e-4, "{delay:?}");
        let early = ResidualDelay { mean_s: -0.5e-3, ..delay };
        assert_eq!(early.worst_s(sensitivity), -1.5e-3);
    }

    #[test]
    fn a_block_is_a_second_at_every_rate() {
        assert_eq!([1e-3, 0.5e-3, 0.25e-3].map(block_cycles), [1000, 2000, 4000]);
        // 2 ms late in steps of a quarter of a millisecond, for five seconds.
        let at = |t_s: f64| 3.46e-3 * libm::sin(TAU * 3.5 * t_s);
        let mut blocks = DelayBlocks::default();
        for t_s in (0..=20_000).map(|n| f64::from(n) * 0.25e-3) {
            blocks.take(at(t_s), at(t_s - 2e-3), 0.25e-3);
        }
        let found = blocks.residual(0.25e-3).unwrap();
        assert_eq!(found.blocks, 5);
        assert!((found.mean_s - (2e-3 - 0.125e-3)).abs() < 2e-6, "{found:?}");
    }

    #[test]
    fn a_motion_that_rests_says_nothing() {
        let mut blocks = DelayBlocks::default();
        (0..10 * BLOCK_CYCLES).for_each(|_| blocks.take(1e-3, 1e-3, CYCLE_S));
        assert_eq!(blocks.residual(CYCLE_S), None);
    }
}
