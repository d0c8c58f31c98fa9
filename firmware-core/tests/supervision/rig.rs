//! A rig that answers every command: a dashpot behind a clearance, with the noise of its sensors.

use firmware_core::command::Command;
use firmware_core::guard::ForceInput;
use firmware_core::supervision::{Arrival, Belief, Cause, Checks, Measured};

pub(crate) const CYCLE_S: f64 = 1e-3;
/// Range of the 4-bit counter.
pub(crate) const MODULUS: u8 = 15;
/// Cycle in which faults begin.
pub(crate) const FAULT: u32 = 3000;

/// A bench that runs: a locomotive that hunts, a rig, and what is believed of it.
pub(crate) struct Bench {
    pub(crate) checks: Checks,
    pub(crate) belief: Belief,
    /// Half the clearance, m.
    pub(crate) play_m: f64,
    pub(crate) amplitude_m: f64,
    random: u64,
}

impl Bench {
    pub(crate) fn new(play_m: f64) -> Self {
        let checks = Checks::usual(MODULUS, CYCLE_S, 40e3);
        Self { checks, belief: Belief::default(), play_m, amplitude_m: 3.46e-3, random: 11 }
    }

    /// The command of a cycle: 3.5 Hz.
    pub(crate) fn command(&self, cycle: u32) -> Command {
        let w = std::f64::consts::TAU * 3.5;
        let phase = w * f64::from(cycle) * CYCLE_S;
        Command {
            displacement_m: self.amplitude_m * libm::sin(phase),
            velocity_m_per_s: self.amplitude_m * w * libm::cos(phase),
        }
    }

    /// What the rig measures after a command.
    pub(crate) fn measured(&mut self, cycle: u32) -> Measured {
        let command = self.command(cycle);
        let inside = command.displacement_m.abs() < self.play_m;
        let force_n = if inside { 0.0 } else { 200e3 * command.velocity_m_per_s };
        let flicker = |random: &mut u64| {
            *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (*random >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let counter = (cycle % u32::from(MODULUS)) as u8;
        Measured {
            counter,
            echo: Some(counter),
            displacement_m: Some(rounded(
                command.displacement_m + 4e-6 * flicker(&mut self.random),
                0.2e-6,
            )),
            force_n: Some(rounded(force_n + 20.0 * flicker(&mut self.random), 0.2)),
            is_valid: true,
            runs: true,
        }
    }

    /// Runs for so many cycles under a fault that changes what arrives; the first cause, with the
    /// cycle in which it comes.
    pub(crate) fn run(
        &mut self,
        cycles: u32,
        fault: impl FnMut(u32, Measured) -> Arrival,
    ) -> Option<(u32, Cause)> {
        self.cycles(cycles, fault).1
    }

    /// The same, with the largest force that reached the vehicle, N.
    pub(crate) fn cycles(
        &mut self,
        cycles: u32,
        mut fault: impl FnMut(u32, Measured) -> Arrival,
    ) -> (f64, Option<(u32, Cause)>) {
        let mut largest_n = 0.0_f64;
        for cycle in 0..cycles {
            self.belief.sent(self.command(cycle));
            let measured = self.measured(cycle);
            let arrival = fault(cycle, measured);
            let sent = (cycle % u32::from(MODULUS)) as u8;
            if let ForceInput::Fresh(force_n) = self.belief.take(&self.checks, arrival, Some(sent))
            {
                largest_n = largest_n.max(force_n.abs());
            }
            if let Some(cause) = self.belief.cause() {
                return (largest_n, Some((cycle, cause)));
            }
        }
        (largest_n, None)
    }
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}
