//! One case, drawn from the seed of the campaign and its number; nothing else decides it.
//!
//! Dampers are of a yaw damper's size, and one in five of 1.5 kN with a stroke of its own, by
//! scaling force and stroke. What is missing, the motion and the noise come from the design.

use super::design::{AS_LOWER_KE, Combination, Truth, shuffled};
use super::motion::{Extent, Tests};
use super::noise::{recorded, sensors};
use firmware_core::damper::Nominal;
use firmware_core::damper::effects::CATALOGUE;
use signal::random::Random;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::series_model::SeriesModel;

/// Share of small dampers.
const SMALL: f64 = 0.2;
/// Largest error of a wrong datasheet.
const WRONG: f64 = 0.3;
/// Sampling rate above which a record is one of impacts, Hz.
const USUAL_HZ: f64 = 1000.0;

/// A case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Case {
    /// Its number in the campaign.
    pub index: usize,
    /// Seed of everything random in it.
    pub seed: u64,
    /// Its motion, noise, truth and size.
    pub of: Combination,
    /// `yaw` or `small`.
    pub class: &'static str,
    /// The damper.
    pub nominal: Nominal,
    /// Its stroke over that of a yaw damper.
    pub scale: f64,
    /// Effects of the catalogue that it has, by their place there.
    pub effects: Vec<usize>,
    /// The measuring chain.
    pub sensors: Sensors,
    /// The three sets of tests.
    pub tests: Tests,
    /// How far the tests to fit go.
    pub extent: Extent,
    /// A datasheet, where there is one.
    pub datasheet: Option<Nominal>,
}

impl Case {
    /// The case of a number. `brief` ones have fewer tests.
    pub(super) fn draw(campaign_seed: u64, index: usize, brief: bool) -> Self {
        let deck = shuffled(campaign_seed);
        debug_assert!(!deck.is_empty());
        Self::of(deck[index % deck.len()], campaign_seed, index, brief)
    }

    /// The same with a combination of one's own.
    pub(super) fn of(of: Combination, campaign_seed: u64, index: usize, brief: bool) -> Self {
        let seed = Random::seed_of(Random::seed_of(campaign_seed, 2), index as u64);
        let mut random = Random::new(seed, 0);
        let hydraulic = matches!(of.truth, Truth::Hydraulic(_));
        let small = random.uniform() < SMALL && !hydraulic;
        let (force, scale) =
            if small { (random.between(0.08, 0.14), random.between(0.5, 2.0)) } else { (1.0, 1.0) };
        let ce = random.between(0.6e6, 1.4e6) * force / scale;
        let nominal = Nominal {
            ce_n_s_per_m: ce,
            ke_n_per_m: random.between(5e6, 14e6) * force / scale,
            clearance_2a_m: random.between(0.1e-3, 1.5e-3) * scale,
            f_relief_n: random.between(10e3, 18e3) * force,
            c2_n_s_per_m: random.between(0.03, 0.09) * ce,
        };
        // A hydraulic damper is not drawn from these; they choose its sensors.
        let nominal = if hydraulic { Nominal::NEW } else { nominal };
        let effects = effects(of.truth, &mut random);
        let tests = Tests::draw(of.motion, scale, brief, &mut random);
        let (whole, extent) = (Extent::of(&tests.all()), Extent::of(&tests.train));
        let peak_n = nominal.f_relief_n + nominal.c2_n_s_per_m * whole.speed_m_per_s;
        let farthest_m = whole.extension_m.max(whole.compression_m);
        let impacts = effects.iter().any(|effect| CATALOGUE[*effect].needs_rate_hz > USUAL_HZ);
        let sensors = sensors(of.noise, peak_n, farthest_m, impacts, &mut random);
        let mut wrong = |value: f64| value * random.between(1.0 - WRONG, 1.0 + WRONG);
        let sheet = Nominal {
            ce_n_s_per_m: wrong(nominal.ce_n_s_per_m),
            ke_n_per_m: wrong(nominal.ke_n_per_m),
            clearance_2a_m: wrong(nominal.clearance_2a_m),
            f_relief_n: wrong(nominal.f_relief_n),
            c2_n_s_per_m: wrong(nominal.c2_n_s_per_m),
        };
        let datasheet = matches!(of.truth, Truth::WrongDatasheet { .. }).then_some(sheet);
        let class = if small { "small" } else { "yaw" };
        Self { index, seed, of, class, nominal, scale, effects, sensors, tests, extent, datasheet }
    }

    /// rms that the noise of both channels leaves on the force of the true damper, N; that of the
    /// displacement as if the attachment passed all of it.
    pub(super) fn noise_n(&self) -> f64 {
        let (force_n, displacement_m) = recorded(&self.sensors);
        let moved_n = self.nominal.ke_n_per_m * displacement_m;
        (force_n * force_n + moved_n * moved_n).sqrt()
    }

    /// Its damper for the integration that the core does not know.
    pub(super) fn series_model(&self) -> SeriesModel {
        SeriesModel {
            ce_n_s_per_m: self.nominal.ce_n_s_per_m,
            ke_n_per_m: self.nominal.ke_n_per_m,
            clearance_2a_m: self.nominal.clearance_2a_m,
            f_relief_n: self.nominal.f_relief_n,
            c2_n_s_per_m: self.nominal.c2_n_s_per_m,
        }
    }
}

fn effects(truth: Truth, random: &mut Random) -> Vec<usize> {
    // Those that a record of 1 kHz can hold and that the nominal damper cannot.
    let open: Vec<usize> = CATALOGUE
        .iter()
        .enumerate()
        .filter(|(_, info)| info.name != AS_LOWER_KE && info.needs_rate_hz <= USUAL_HZ)
        .map(|(effect, _)| effect)
        .collect();
    let mut any = |from: &[usize]| {
        let at = (random.uniform() * from.len() as f64) as usize;
        from[at.min(from.len() - 1)]
    };
    match truth {
        Truth::Effect(effect) => vec![effect],
        Truth::Pair => {
            let first = any(&open);
            let rest: Vec<usize> = open.iter().copied().filter(|other| *other != first).collect();
            vec![first, any(&rest)]
        }
        Truth::WrongDatasheet { with_effect: true } => vec![any(&open)],
        Truth::Nothing
        | Truth::Neighbour(_)
        | Truth::Outside(_)
        | Truth::WrongDatasheet { .. }
        | Truth::Hydraulic(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_depends_on_seed_and_number_alone() {
        let case = Case::draw(11, 5, false);
        assert_eq!(case, Case::draw(11, 5, false));
        assert_ne!(case.nominal, Case::draw(11, 6, false).nominal);
        assert_ne!(case.nominal, Case::draw(12, 5, false).nominal);
    }
}
