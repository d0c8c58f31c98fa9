//! A test in open loop as it was measured, and how late the ram was in it.
//!
//! ```text
//! tau = -<e v> / <v^2>      e = x_measured - x_command      over blocks of a second
//! s^2 = n / (n - 1) sum w_k^2 (tau_k - tau)^2 / (sum w_k)^2     w_k = <v^2> of block k
//! ```
//! `tau` is the delay of a pure lag, `s` its standard error: blocks of a second are longer than
//! what a damper remembers, and count as independent. One block has no standard error.

use crate::record::{InputKind, Row};
use crate::statistics::Tracking;
use scenario::run::CYCLE_S;

/// A test that was run to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTest {
    /// Its name.
    pub name: String,
    /// Control cycle of each sample.
    pub cycles: Vec<u64>,
    /// Time since the begin of the test (s).
    pub time_s: Vec<f64>,
    /// Measured displacement (m).
    pub displacement_m: Vec<f64>,
    /// Measured force (N).
    pub force_n: Vec<f64>,
    /// Temperature that the rig reports, where it reports one (degrees Celsius).
    pub temperature_degc: Option<Vec<f64>>,
    /// Cycles without a fresh measurement.
    pub missing: u64,
    /// Frequency of a sine with the rms displacement and speed of the command (Hz); no number where
    /// nothing has moved.
    pub frequency_hz: f64,
    /// Delay of the measured displacement against the command of the cycle in which it arrives.
    pub delay: Delay,
    /// Rms of the difference over the rms of the command.
    pub tracking_nrmse: f64,
    /// Its largest value (m).
    pub tracking_most_m: f64,
    blocks: Vec<Block>,
}

/// A delay with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// The delay (s); no number where nothing has moved.
    pub mean_s: f64,
    /// Its standard error (s); none of fewer than two blocks.
    pub standard_error_s: Option<f64>,
}

/// Cycles of a block: a second.
const BLOCK_CYCLES: usize = 1000;

/// Sums of a block.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Block {
    /// Error times speed of the command.
    with_rate: f64,
    /// Speed of the command, squared.
    rate2: f64,
}

impl Delay {
    /// The delay over all blocks of these tests.
    pub fn over<'t>(tests: impl IntoIterator<Item = &'t MeasuredTest>) -> Self {
        let blocks = tests.into_iter().flat_map(|test| &test.blocks).copied();
        Self::of(&blocks.collect::<Vec<_>>())
    }

    fn of(blocks: &[Block]) -> Self {
        let moved = || blocks.iter().filter(|block| block.rate2 > 0.0);
        let whole: f64 = moved().map(|block| block.rate2).sum();
        let mean_s = -moved().map(|block| block.with_rate).sum::<f64>() / whole;
        let squares: f64 =
            moved().map(|block| (block.with_rate + mean_s * block.rate2).powi(2)).sum();
        let count = moved().count() as f64;
        let error_s = (count / (count - 1.0) * squares).sqrt() / whole;
        Self { mean_s, standard_error_s: (count >= 2.0).then_some(error_s) }
    }
}

/// The largest error of a ram that follows: that of a delay of a tenth of a period. A rig is tested
/// with motions of up to 10 Hz, and is late by 10 ms.
const FOLLOWS_NRMSE: f64 = 0.63;

/// What has been read of a test.
pub(super) struct Reading {
    test: MeasuredTest,
    slot: usize,
    tracking: Tracking,
    last_m: Option<f64>,
    in_block: usize,
    temperature_degc: Vec<f64>,
}

impl Reading {
    /// Nothing yet of a test of this name, in a slot.
    pub(super) fn new(name: &str, slot: usize) -> Self {
        let test = MeasuredTest {
            name: name.to_owned(),
            cycles: Vec::new(),
            time_s: Vec::new(),
            displacement_m: Vec::new(),
            force_n: Vec::new(),
            temperature_degc: None,
            missing: 0,
            frequency_hz: f64::NAN,
            delay: Delay { mean_s: f64::NAN, standard_error_s: None },
            tracking_nrmse: f64::NAN,
            tracking_most_m: f64::NAN,
            blocks: Vec::new(),
        };
        let (tracking, temperature_degc) = (Tracking::new(CYCLE_S), Vec::new());
        Self { test, slot, tracking, last_m: None, in_block: BLOCK_CYCLES, temperature_degc }
    }

    /// Takes a row of the test, which began in the cycle `first`.
    pub(super) fn take(&mut self, row: &Row, first: u64) {
        let slot = self.slot;
        let (displacement_m, force_n) = (row.measured_m[slot], row.measured_n[slot]);
        let is_fresh = row.input[slot] == InputKind::Fresh && displacement_m.is_finite();
        if !is_fresh || !force_n.is_finite() {
            self.test.missing += 1;
            return;
        }
        self.tracking.take(row.command_m[slot], displacement_m);
        self.take_delay(row.command_m[slot], displacement_m);
        self.test.cycles.push(row.cycle);
        self.test.time_s.push((row.cycle - first) as f64 * CYCLE_S);
        self.test.displacement_m.push(displacement_m);
        self.test.force_n.push(force_n);
        self.temperature_degc.push(row.temperature_degc[slot]);
    }

    fn take_delay(&mut self, command_m: f64, measured_m: f64) {
        let Some(before_m) = self.last_m.replace(command_m) else { return };
        if self.in_block >= BLOCK_CYCLES {
            self.test.blocks.push(Block::default());
            self.in_block = 0;
        }
        self.in_block += 1;
        if let Some(block) = self.test.blocks.last_mut() {
            let rate = (command_m - before_m) / CYCLE_S;
            block.with_rate += (measured_m - command_m) * rate;
            block.rate2 += rate * rate;
        }
    }

    /// The test.
    pub(super) fn test(self) -> MeasuredTest {
        let Self { mut test, tracking, temperature_degc, .. } = self;
        // A ram that does not follow has no delay.
        let follows = tracking.nrmse() <= FOLLOWS_NRMSE;
        if !follows {
            test.blocks.clear();
        }
        let is_known = temperature_degc.iter().all(|degc| degc.is_finite());
        MeasuredTest {
            temperature_degc: (is_known && !temperature_degc.is_empty())
                .then_some(temperature_degc),
            frequency_hz: tracking.frequency_hz(),
            delay: Delay::of(&test.blocks),
            tracking_nrmse: tracking.nrmse(),
            tracking_most_m: tracking.most_m(),
            ..test
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_delay_is_that_of_its_blocks() {
        let block = |delay_s: f64, rate2: f64| Block { with_rate: -delay_s * rate2, rate2 };
        // Four equal blocks: the standard error of the mean of 1, 2, 1, 2 ms.
        let four = [1e-3, 2e-3, 1e-3, 2e-3].map(|delay_s| block(delay_s, 0.3));
        let found = Delay::of(&four);
        assert!((found.mean_s - 1.5e-3).abs() < 1e-15, "{found:?}");
        let expected_s = 0.577_350_269e-3 / 2.0;
        assert!((found.standard_error_s.unwrap() - expected_s).abs() < 1e-11, "{found:?}");
        // A block that rests says nothing, and one alone has no error.
        let found = Delay::of(&[block(1e-3, 0.3), block(0.0, 0.0)]);
        assert_eq!(found.standard_error_s, None);
        assert!((found.mean_s - 1e-3).abs() < 1e-15, "{found:?}");
        // A block counts by the square of its speed.
        let found = Delay::of(&[block(1e-3, 3.0), block(2e-3, 1.0)]);
        assert!((found.mean_s - 1.25e-3).abs() < 1e-15, "{found:?}");
    }
}
