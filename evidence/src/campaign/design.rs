//! The design of the campaign: which combinations of motion, truth and noise there are, how many of
//! each, and in which order they come.
//!
//! Every single truth meets every motion and every noise at least three times, and so does every
//! motion every noise: a truth of number `t` takes the motions in turn, and the noises in turn
//! from number `t` on; as there are six motions and five noises, thirty cases pass before a
//! combination comes again. [`deck`] holds one whole campaign. It is shuffled by the seed, so that
//! the first cases of a campaign are a fair sample of all; beyond its length it is dealt again.

use firmware_core::damper::effects::CATALOGUE;
use signal::random::Random;
use virtual_bench::series_model::neighbour::NEIGHBOURS;

/// Disturbances outside the catalogue.
pub(super) const OUTSIDE: [&str; 4] =
    ["speed_synchronous_ripple", "frame_resonance", "worn_band", "valve_flutter"];
/// Hydraulic dampers.
pub(super) const HYDRAULIC: [&str; 2] = ["bidirectional", "unidirectional"];
/// Exactly a lower Ke: the right answer is that nothing is missing.
pub(super) const AS_LOWER_KE: &str = "fixture_compliance";

/// Cases without any effect: ten for each motion with each noise.
const NOTHING: usize = 300;
/// Cases of each effect and each neighbour: three for each motion.
const EACH_EFFECT: usize = 18;
/// Cases of each disturbance outside the catalogue and each hidden input.
const EACH_UNKNOWN: usize = 44;
/// Pairs of effects: one for each motion with each noise.
const PAIRS: usize = 30;
const WRONG_DATASHEETS: usize = 20;
const EACH_HYDRAULIC: usize = 10;

/// Sizes of an effect: rms after the refit of the nominal damper, in multiples of the noise; for
/// the first, second and third case of each motion, the last by turns.
const FIRST_SIZES: [f64; 2] = [3.0, 10.0];
const THIRD_SIZES: [f64; 3] = [1.5, 3.0, 10.0];

/// How the actuator moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Motion {
    /// Sines of several amplitudes and frequencies, and a triangle.
    Sines,
    /// Sines that grow and fade.
    Tapered,
    /// Three to five cycles between rests.
    Short,
    /// Random motion within a band.
    Random,
    /// Sines of rising or falling frequency.
    Sweep,
    /// Filtered noise under an envelope.
    Earthquake,
}

impl Motion {
    /// All of them.
    pub(super) const ALL: [Self; 6] =
        [Self::Sines, Self::Tapered, Self::Short, Self::Random, Self::Sweep, Self::Earthquake];

    /// In lines and tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sines => "sines",
            Self::Tapered => "tapered",
            Self::Short => "short",
            Self::Random => "random",
            Self::Sweep => "sweep",
            Self::Earthquake => "earthquake",
        }
    }
}

/// What noise the records have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Noise {
    /// White.
    White,
    /// White, and the recorder passes low frequencies only.
    Filtered,
    /// White, and the recorder stores moving averages.
    Averaged,
    /// A little white noise on a slow drift.
    Drifting,
    /// White, and coloured noise of half to twice its size.
    Coloured,
}

impl Noise {
    /// All of them.
    pub(super) const ALL: [Self; 5] =
        [Self::White, Self::Filtered, Self::Averaged, Self::Drifting, Self::Coloured];

    /// In lines and tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Filtered => "filtered",
            Self::Averaged => "averaged",
            Self::Drifting => "drifting",
            Self::Coloured => "coloured",
        }
    }
}

/// What is missing in the nominal damper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Truth {
    /// Nothing.
    Nothing,
    /// One effect, by its place in the catalogue.
    Effect(usize),
    /// A part near an effect, or a hidden input, by its place among the neighbours.
    Neighbour(usize),
    /// Two effects of the catalogue, drawn with the case.
    Pair,
    /// A disturbance that the catalogue does not know, by its place in [`OUTSIDE`].
    Outside(usize),
    /// Nothing, or one effect of ten times the noise, with a datasheet that is up to 30 % wrong.
    WrongDatasheet {
        /// An effect is missing.
        with_effect: bool,
    },
    /// A hydraulic damper, by its place in [`HYDRAULIC`].
    Hydraulic(usize),
}

impl Truth {
    /// Its kind, in lines and tables.
    pub(super) const fn kind(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Effect(_) => "effect",
            Self::Neighbour(which) => match NEIGHBOURS[which].near {
                Some(_) => "neighbour",
                None => "hidden",
            },
            Self::Pair => "pair",
            Self::Outside(_) => "outside",
            Self::WrongDatasheet { .. } => "wrong_datasheet",
            Self::Hydraulic(_) => "hydraulic",
        }
    }
}

/// One combination of the design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Combination {
    /// How the actuator moves.
    pub motion: Motion,
    /// What noise the records have.
    pub noise: Noise,
    /// What is missing.
    pub truth: Truth,
    /// The wanted size of what is missing, in multiples of the noise.
    pub size: f64,
}

/// One whole campaign, in the order of this list.
pub(super) fn deck() -> Vec<Combination> {
    let is_hidden = |which: &usize| NEIGHBOURS[*which].near.is_none();
    let (hidden, near): (Vec<usize>, Vec<usize>) = (0..NEIGHBOURS.len()).partition(is_hidden);
    let single = (0..CATALOGUE.len()).map(Truth::Effect);
    let single = single.chain(near.into_iter().map(Truth::Neighbour));
    let unknown = (0..OUTSIDE.len()).map(Truth::Outside);
    let unknown = unknown.chain(hidden.into_iter().map(Truth::Neighbour));
    let sheet = |case: usize| Truth::WrongDatasheet { with_effect: case % 2 == 1 };
    let mut deck = Vec::new();
    deck.extend(combinations(0, NOTHING, |_| Truth::Nothing, |_, _| 0.0));
    for (number, truth) in single.enumerate() {
        deck.extend(combinations(number, EACH_EFFECT, |_| truth, size_of_effect));
    }
    for (number, truth) in unknown.enumerate() {
        deck.extend(combinations(number, EACH_UNKNOWN, |_| truth, large));
    }
    deck.extend(combinations(0, PAIRS, |_| Truth::Pair, large));
    let of_effect = |_, case| if case % 2 == 1 { 10.0 } else { 0.0 };
    deck.extend(combinations(0, WRONG_DATASHEETS, sheet, of_effect));
    for which in 0..HYDRAULIC.len() {
        deck.extend(combinations(which, EACH_HYDRAULIC, |_| Truth::Hydraulic(which), |_, _| 0.0));
    }
    deck
}

/// The cases of the truth of a number: motions and noises in turn. `size` gets the number of the
/// truth and that of the case.
fn combinations(
    number: usize,
    cases: usize,
    truth: impl Fn(usize) -> Truth,
    size: impl Fn(usize, usize) -> f64,
) -> Vec<Combination> {
    let combination = |case: usize| Combination {
        motion: Motion::ALL[case % Motion::ALL.len()],
        noise: Noise::ALL[(number + case) % Noise::ALL.len()],
        truth: truth(case),
        size: size(number, case),
    };
    (0..cases).map(combination).collect()
}

fn size_of_effect(number: usize, case: usize) -> f64 {
    let (motion, round) = (case % Motion::ALL.len(), case / Motion::ALL.len());
    FIRST_SIZES.get(round).copied().unwrap_or(THIRD_SIZES[(number + motion) % THIRD_SIZES.len()])
}

fn large(number: usize, case: usize) -> f64 {
    let round = case / Motion::ALL.len();
    FIRST_SIZES[(number + case + round) % FIRST_SIZES.len()]
}

/// The deck in the order of a campaign (Fisher and Yates).
pub(super) fn shuffled(seed: u64) -> Vec<Combination> {
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

    /// Fewest cases of a pair of levels.
    const LEAST: usize = 3;

    fn count(deck: &[Combination], of: impl Fn(&Combination) -> bool) -> usize {
        deck.iter().filter(|one| of(one)).count()
    }

    #[test]
    fn every_pair_of_levels_is_there_at_least_three_times() {
        let deck = deck();
        let effects = (0..CATALOGUE.len()).map(Truth::Effect);
        let neighbours = (0..NEIGHBOURS.len()).map(Truth::Neighbour);
        let outside = (0..OUTSIDE.len()).map(Truth::Outside);
        let single: Vec<Truth> =
            [Truth::Nothing, Truth::Pair].into_iter().chain(effects).chain(neighbours).collect();
        for truth in single.into_iter().chain(outside) {
            for motion in Motion::ALL {
                let cases = count(&deck, |one| one.truth == truth && one.motion == motion);
                assert!(cases >= LEAST, "{truth:?} with {motion:?}: {cases}");
            }
            for noise in Noise::ALL {
                let cases = count(&deck, |one| one.truth == truth && one.noise == noise);
                assert!(cases >= LEAST, "{truth:?} with {noise:?}: {cases}");
            }
        }
        for motion in Motion::ALL {
            for noise in Noise::ALL {
                let cases = count(&deck, |one| one.motion == motion && one.noise == noise);
                assert!(cases >= LEAST, "{motion:?} with {noise:?}: {cases}");
            }
        }
    }

    #[test]
    fn the_deck_has_the_size_that_the_documentation_states() {
        let deck = deck();
        let of = |kind: &str| count(&deck, |one| one.truth.kind() == kind);
        assert_eq!(of("nothing"), 300);
        assert_eq!(of("effect"), 18 * CATALOGUE.len());
        assert_eq!((of("neighbour"), of("pair")), (162, 30));
        assert_eq!((of("outside"), of("hidden")), (176, 132));
        assert_eq!((of("wrong_datasheet"), of("hydraulic")), (20, 20));
        assert_eq!(deck.len(), 840 + 18 * CATALOGUE.len());
        assert!((1200..=1500).contains(&deck.len()), "{}", deck.len());
    }

    #[test]
    fn most_effects_have_three_or_ten_times_the_noise_with_every_motion() {
        let deck = deck();
        let effects = |size: f64| {
            count(&deck, |one| matches!(one.truth, Truth::Effect(_)) && one.size == size)
        };
        assert_eq!(effects(1.5) + effects(3.0) + effects(10.0), 18 * CATALOGUE.len());
        assert!(effects(1.5) * 7 < effects(3.0) + effects(10.0));
        for which in 0..OUTSIDE.len() {
            for (motion, size) in Motion::ALL.into_iter().flat_map(|m| [(m, 3.0), (m, 10.0)]) {
                let truth = Truth::Outside(which);
                let cases = count(&deck, |one| {
                    one.truth == truth && one.motion == motion && one.size == size
                });
                assert!(cases >= LEAST, "{truth:?} of {size} with {motion:?}: {cases}");
            }
        }
    }

    #[test]
    fn a_shuffled_deck_has_the_same_cards() {
        let (plain, shuffled) = (deck(), shuffled(7));
        assert_ne!(plain, shuffled);
        for card in &plain {
            assert_eq!(count(&plain, |one| one == card), count(&shuffled, |one| one == card));
        }
    }
}
