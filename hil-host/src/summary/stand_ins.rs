//! Dampers for which the rig of another slot stood, and how far they were from moving as it did.

use crate::statistics::Sums;
use scenario::run::{Run, SlotForce, StandsFor};
use serde::Serialize;

/// Share of the stroke of a rig from which on what it stood for is warned of, %.
const APART_PERCENT: f64 = 10.0;

/// What stood for a damper, and how exact that was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StandInSummary {
    /// Place of the damper whose rig stood for it.
    pub of: String,
    /// Whether the sign of the measured force was reversed.
    pub is_reversed: bool,
    /// Until when it did, s: that rig was lost, and the model of this place acted from then on.
    /// Null where it stood to the end.
    pub until_s: Option<f64>,
    /// Rms of what the two strokes differ by, the sign of one reversed where that of the force is,
    /// m: zero in pure yaw for dampers of one bogie.
    pub stroke_difference_rms_m: f64,
    /// The same over the rms of the stroke of the rig's slot, %; null without motion.
    pub stroke_difference_percent: Option<f64>,
    /// Rms of the force that acted less that of the slot's own model on its own motion, N.
    pub force_less_model_rms_n: f64,
}

impl StandInSummary {
    /// That of a slot; none of one for which no other rig stood.
    pub(super) fn of(run: &Run, slot: usize, sums: &Sums, until_s: Option<f64>) -> Option<Self> {
        let SlotForce::StandIn { of, is_reversed, .. } = run.slots.get(slot)?.force else {
            return None;
        };
        let rms_m = sums.pairs.rms_m([slot, of], is_reversed);
        let percent = 100.0 * rms_m / sums.slots.get(of)?.stroke.rms();
        Some(Self {
            of: run.slots.get(of)?.place.clone(),
            is_reversed,
            until_s,
            stroke_difference_rms_m: rms_m,
            stroke_difference_percent: percent.is_finite().then_some(percent),
            force_less_model_rms_n: sums.slots.get(slot)?.residual.rms(),
        })
    }

    /// The same as a warning, where the damper did not move as the rig did.
    pub fn warning(&self) -> Option<String> {
        // The drop-out of a rig has a message of its own.
        let stood = self.stroke_difference_percent.filter(|_| self.until_s.is_none());
        let is_apart = stood.is_some_and(|apart| apart > APART_PERCENT);
        let says = || format!("{}: it did not feel the force of a rig of its own", self.in_words());
        is_apart.then(says)
    }

    /// In words.
    pub fn in_words(&self) -> String {
        let Self { of, is_reversed, stroke_difference_percent, .. } = self;
        if let Some(until_s) = self.until_s {
            let sign = if *is_reversed { ", its sign reversed," } else { "" };
            return format!(
                "the force of the rig of {of}{sign} until {until_s:.3} s, then its own model"
            );
        }
        let apart = match stroke_difference_percent {
            Some(percent) => format!("{} % rms", report::significant(*percent, 3)),
            None => "by an unknown share".to_owned(),
        };
        let (sign, motion) = if *is_reversed {
            (", its sign reversed", "moving oppositely")
        } else {
            ("", "moving alike")
        };
        format!(
            "the force of the rig of {of}{sign}; the strokes were {apart} away from {motion}, \
             the force {} N rms from the model of this place",
            report::significant(self.force_less_model_rms_n, 3)
        )
    }
}

/// One line for each measured force that acted on several bogies.
pub(crate) fn labels(run: &Run) -> Vec<String> {
    // For which dampers the rig of a slot stands.
    let stands_for = |slot: usize| -> Vec<StandsFor> {
        let of_slot = run.slots.iter().filter_map(|other| match other.force {
            SlotForce::StandIn { of, stands_for, .. } if of == slot => Some(stands_for),
            _ => None,
        });
        of_slot.collect()
    };
    let several =
        (0..run.slots.len()).filter(|slot| stands_for(*slot).contains(&StandsFor::OtherBogie));
    several
        .map(|slot| {
            let times = match stands_for(slot).len() + 1 {
                2 => "twice",
                3 => "three times",
                _ => "four times",
            };
            format!("one measured force used {times}: that of {}", run.slots[slot].place)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damper_on_its_own_model_was_said_to_have_the_force_of_a_rig() {
        let stood = StandInSummary {
            of: "front left".to_owned(),
            is_reversed: true,
            until_s: None,
            stroke_difference_rms_m: 1e-3,
            stroke_difference_percent: Some(80.0),
            force_less_model_rms_n: 0.0,
        };
        assert!(stood.warning().is_some_and(|said| said.contains("80.0 % rms away")));
        let lost = StandInSummary { until_s: Some(0.095), ..stood };
        assert_eq!(lost.warning(), None);
        let expected = "the force of the rig of front left, its sign reversed, until 0.095 s, then its own model";
        assert_eq!(lost.in_words(), expected);
    }
}
