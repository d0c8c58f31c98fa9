//! Our compensators, from nothing but the data sheet of the nominal rig and its dead time.

use super::data_sheet::DataSheet;
use firmware_core::compensation::{Adaptive, Compensator, Feedforward, Series};
use firmware_core::line::KNOWN_DELAY_CYCLES;
use scenario::run::CYCLE_S;
use serde::Serialize;
use std::f64::consts::TAU;

/// Frequency at which the gain of an adaptive compensator is bounded (Hz), and its bound, as a
/// multiple of that of its start.
const GAIN_CHECK_HZ: f64 = 40.0;
const GAIN_RATIO: f64 = 2.0;

/// Cut-off of what an adaptive compensator learns from (Hz): a worn damper hunts at 3.7 Hz, and its
/// contacts make harmonics, of which a series of second order has no part.
const CUT_OFF_HZ: f64 = 15.0;
/// Frequency at which the second order may change the command by as much as the gain may (Hz). A
/// motion of one frequency shows nothing but `a0 - a2 w^2`: which of the two is off stays open.
const REACH_HZ: f64 = 5.0;

/// A compensator of ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ours {
    /// The command is the wanted motion.
    None,
    /// A Taylor polynomial of second order over the delay at the frequency of hunting.
    Polynomial,
    /// The inverse of the rig, to third order.
    Inverse,
    /// Starts as the inverse to second order, knows what the load takes, and follows the rig.
    Adaptive,
}

/// All of them.
pub const OURS: [Ours; 4] = [Ours::None, Ours::Polynomial, Ours::Inverse, Ours::Adaptive];

impl Ours {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Polynomial => "polynomial 2",
            Self::Inverse => "inverse",
            Self::Adaptive => "adaptive",
        }
    }

    /// The compensator for a rig with a dead time (s), of a vehicle that hunts at a frequency (Hz).
    /// The half cycle by which the force leads outside of the rig is known to all of them.
    pub fn compensator(self, sheet: &DataSheet, dead_time_s: f64, hunting_hz: f64) -> Compensator {
        let compensator = match self {
            Self::None => Compensator::None,
            Self::Polynomial => {
                let delay_s = sheet.delay_s(hunting_hz) + dead_time_s;
                Compensator::Feedforward(Feedforward::polynomial(2, delay_s))
            }
            Self::Inverse => {
                let Series(inverse) = sheet.inverse(3).with_delay(dead_time_s);
                Compensator::Feedforward(Feedforward::inverse(inverse))
            }
            Self::Adaptive => {
                let (free, load) = sheet.inverse_under_load();
                let Series([a0, a1, a2, _]) = free.with_delay(dead_time_s);
                let start = Series([a0, a1, a2, 0.0]);
                let usual = Adaptive::new(start, GAIN_CHECK_HZ);
                let [gain, delay, second] = usual.reach;
                let omega = TAU * REACH_HZ;
                Compensator::Adaptive(Adaptive {
                    load,
                    reach: [gain, delay, second + gain / (omega * omega)],
                    cut_off_hz: CUT_OFF_HZ,
                    gain_ratio: GAIN_RATIO,
                    ..usual
                })
            }
        };
        compensator.with_known_delay(KNOWN_DELAY_CYCLES * CYCLE_S)
    }
}
