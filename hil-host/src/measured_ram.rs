//! How late the rams of rigs were measured to be.
//!
//! A delay belongs to a rig and to a motion: a servo rig is late by its load. So each has the rig
//! that it was measured on, and an open loop's the frequency of its test,
//!
//! ```text
//! f = rms(v) / (2 pi rms(x))      of the command, about its mean
//! ```
//! which is that of a sine, and that of the slow part of a triangle. What counts for a run are the
//! tests whose frequency is within [`NEAR`] of that of hunting. Limits: the stroke is not asked
//! for; where tests of several strokes are near, each of them counts.

use serde::{Deserialize, Serialize};

/// Factor by which the frequency of a test may differ from that of hunting.
const NEAR: f64 = 1.5;

/// A delay with its source. The delay is that of the measured displacement which arrives in a cycle
/// against the command that leaves in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredRam {
    /// The delay (s).
    pub delay_s: f64,
    /// Where it is from.
    pub source: String,
}

/// Whose delay it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Whose {
    /// That of every rig: somebody says so.
    Every,
    /// That of the rig with this node number.
    Node(u8),
    /// That of the rig in this place of a vehicle.
    Place(String),
}

/// A delay, and what it was measured on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RamTest {
    pub(crate) whose: Whose,
    /// Frequency of the test (Hz), no number where its file does not state it; none of a run, whose
    /// motion is the one in question.
    pub(crate) frequency_hz: Option<f64>,
    pub(crate) ram: MeasuredRam,
}

/// Everything that was measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeasuredRams(pub(crate) Vec<RamTest>);

impl MeasuredRams {
    /// A delay of every rig (s), from whoever says so.
    pub fn said(delay_s: f64, source: &str) -> Self {
        let ram = MeasuredRam { delay_s, source: source.to_owned() };
        Self(vec![RamTest { whose: Whose::Every, frequency_hz: None, ram }])
    }

    /// The delays that count for a rig under a vehicle that hunts at a frequency (Hz).
    ///
    /// ```
    /// use hil_host::MeasuredRams;
    /// let said = MeasuredRams::said(5.5e-3, "--delay-ms");
    /// assert_eq!(said.of_rig("front left", 1, 3.4)[0].delay_s, 5.5e-3);
    /// ```
    pub fn of_rig(&self, place: &str, node: u8, hunting_hz: f64) -> Vec<&MeasuredRam> {
        debug_assert!(hunting_hz > 0.0, "hunting at {hunting_hz} Hz");
        let is_near = |hz: f64| (hunting_hz / NEAR..=hunting_hz * NEAR).contains(&hz);
        let counts = |test: &&RamTest| {
            let is_its = match &test.whose {
                Whose::Every => true,
                Whose::Node(own) => *own == node,
                Whose::Place(own) => own == place,
            };
            is_its && test.frequency_hz.is_none_or(is_near)
        };
        self.0.iter().filter(counts).map(|test| &test.ram).collect()
    }

    /// What was measured, for a message: rigs and frequencies.
    pub fn found(&self) -> String {
        let all = self.0.iter().map(|test| {
            let of = match &test.whose {
                Whose::Every => "every rig".to_owned(),
                Whose::Node(node) => format!("node {node}"),
                Whose::Place(place) => place.clone(),
            };
            match test.frequency_hz {
                Some(hz) if hz.is_finite() => format!("{of} at {hz:.1} Hz"),
                Some(_) => format!("{of} at a frequency that is not stated"),
                None => of,
            }
        });
        let mut all: Vec<String> = all.collect();
        all.dedup();
        all.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_triangle_refused_a_compensation_that_was_right() {
        let of = |whose: Whose, frequency_hz, ms: f64| RamTest {
            whose,
            frequency_hz,
            ram: MeasuredRam { delay_s: 1e-3 * ms, source: String::new() },
        };
        let all = MeasuredRams(vec![
            of(Whose::Node(1), Some(0.4), 13.4),
            of(Whose::Node(1), Some(3.5), 5.9),
            of(Whose::Node(2), Some(3.5), 7.0),
            of(Whose::Place("rear left".to_owned()), None, 8.0),
        ]);
        let delays = |place: &str, node: u8| -> Vec<f64> {
            all.of_rig(place, node, 3.4).iter().map(|ram| 1e3 * ram.delay_s).collect()
        };
        assert_eq!(delays("front left", 1), [5.9]);
        assert_eq!(delays("rear left", 2), [7.0, 8.0]);
        assert!(delays("front right", 3).is_empty());
        assert_eq!(all.found(), "node 1 at 0.4 Hz, node 1 at 3.5 Hz, node 2 at 3.5 Hz, rear left");
        // A file of an earlier version.
        let earlier = MeasuredRams(vec![of(Whose::Node(1), Some(f64::NAN), 5.9)]);
        assert!(earlier.of_rig("front left", 1, 3.4).is_empty());
        assert_eq!(earlier.found(), "node 1 at a frequency that is not stated");
    }
}
