//! Which kinds of cases there are, how many of each, and in which order they come.
//!
//! [`deck`] holds one whole campaign. It is shuffled by the seed, so that the first hundred cases
//! of a campaign are a fair sample of all; beyond its length it is dealt again.

use firmware_core::damper::effects::{CATALOGUE, EffectInfo};
use virtual_bench::bench_visit::random::Random;

/// Sizes of an effect: rms after the refit of the nominal damper, in multiples of the noise.
pub(super) const SIZES: [f64; 3] = [1.5, 3.0, 10.0];
/// Sizes of disturbances outside the catalogue.
pub(super) const OUTSIDE_SIZES: [f64; 2] = [3.0, 10.0];
/// Disturbances outside the catalogue.
pub(super) const OUTSIDE: [&str; 4] =
    ["speed_synchronous_ripple", "frame_resonance", "worn_band", "valve_flutter"];
/// Hydraulic dampers.
pub(super) const HYDRAULIC: [&str; 2] = ["bidirectional", "unidirectional"];
/// Exactly a lower Ke: the right answer is that nothing is missing.
pub(super) const HIDDEN: &str = "fixture_compliance";

/// The effects that this campaign draws: those of the catalogue when its results were committed. A
/// seed deals the same cases while this list stays as it is; a later effect belongs to a later
/// campaign.
pub(super) const COMMITTED: [&str; 21] = [
    "seal_friction",
    "quadratic_orifice",
    "orifice_leakage",
    "second_valve_stage",
    "asymmetric_damping",
    "position_dependent_damping",
    "temperature_fade",
    "gas_preload",
    "stiffening_attachment",
    "rubber_hysteresis",
    "entrained_air",
    "fixture_compliance",
    "stroke_dependent_stiffness",
    "aeration_memory",
    "clearance_growth",
    "cavitation",
    "clearance_impact",
    "moving_mass",
    "bump_stop",
    "force_offset",
    "sensor_delay",
];

const NOTHING: usize = 300;
const EACH_EFFECT: usize = 5;
const PAIRS: usize = 24;
const EACH_OUTSIDE: usize = 13;
const WRONG_DATASHEETS: usize = 20;
const EACH_HYDRAULIC: usize = 10;

/// What is wrong with the model of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Nothing; with coloured noise or without.
    Nothing {
        /// The noise of the force is coloured.
        coloured: bool,
    },
    /// One effect of the catalogue.
    Effect {
        /// Its place in the catalogue.
        effect: usize,
        /// Its size.
        size: f64,
    },
    /// Two effects of the catalogue, drawn with the case, each of this size.
    Pair {
        /// Size of each.
        size: f64,
    },
    /// A disturbance that the catalogue does not know.
    Outside {
        /// Its place in [`OUTSIDE`].
        which: usize,
        /// Its size.
        size: f64,
    },
    /// Nothing, or one effect of ten times the noise, with a datasheet that is up to 30 % wrong.
    WrongDatasheet {
        /// An effect is missing.
        with_effect: bool,
    },
    /// A hydraulic damper.
    Hydraulic {
        /// Its place in [`HYDRAULIC`].
        which: usize,
    },
}

impl Kind {
    /// In lines and tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Nothing { .. } => "nothing",
            Self::Effect { .. } => "effect",
            Self::Pair { .. } => "pair",
            Self::Outside { .. } => "outside",
            Self::WrongDatasheet { .. } => "wrong_datasheet",
            Self::Hydraulic { .. } => "hydraulic",
        }
    }
}

/// The effects that are drawn, with their places in the catalogue.
pub(super) fn effects() -> impl Iterator<Item = (usize, &'static EffectInfo)> {
    CATALOGUE.iter().enumerate().filter(|(_, info)| COMMITTED.contains(&info.name))
}

/// One whole campaign, in the order of this list.
pub(super) fn deck() -> Vec<Kind> {
    let mut deck: Vec<Kind> =
        (0..NOTHING).map(|i| Kind::Nothing { coloured: i % 2 == 1 }).collect();
    for (effect, info) in effects() {
        let sizes = if info.name == HIDDEN { &SIZES[2..] } else { &SIZES[..] };
        for &size in sizes {
            deck.extend([Kind::Effect { effect, size }; EACH_EFFECT]);
        }
    }
    deck.extend((0..PAIRS).map(|i| Kind::Pair { size: OUTSIDE_SIZES[i % 2] }));
    for which in 0..OUTSIDE.len() {
        for size in OUTSIDE_SIZES {
            deck.extend([Kind::Outside { which, size }; EACH_OUTSIDE]);
        }
    }
    deck.extend((0..WRONG_DATASHEETS).map(|i| Kind::WrongDatasheet { with_effect: i % 2 == 1 }));
    for which in 0..HYDRAULIC.len() {
        deck.extend([Kind::Hydraulic { which }; EACH_HYDRAULIC]);
    }
    deck
}

/// The deck in the order of a campaign (Fisher and Yates).
pub(super) fn shuffled(seed: u64) -> Vec<Kind> {
    let mut deck = deck();
    let mut random = Random::new(seed, 1);
    for last in (1..deck.len()).rev() {
        let other = (random.uniform() * (last + 1) as f64) as usize;
        deck.swap(last, other.min(last));
    }
    deck
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deck_holds_every_kind_as_often_as_stated() {
        // 300 without an effect, 20 effects at 3 sizes and a fixture, pairs, outside, datasheets,
        // hydraulic dampers.
        assert_eq!(deck().len(), 300 + 20 * 15 + 5 + 24 + 104 + 20 + 20);
    }

    #[test]
    fn a_shuffled_deck_has_the_same_cards() {
        let (plain, shuffled) = (deck(), shuffled(7));
        assert_ne!(plain, shuffled);
        for card in &plain {
            let count = |deck: &[Kind]| deck.iter().filter(|other| *other == card).count();
            assert_eq!(count(&plain), count(&shuffled));
        }
    }
}
