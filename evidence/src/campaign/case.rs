//! One case, drawn from the seed of the campaign and its number; nothing else decides it.
//!
//! Dampers are of a yaw damper's size, and one in five of 1.5 kN with a stroke of its own, by
//! scaling force and stroke. Sensors are those of a laboratory: 0.02 to 0.1 % of the range as white
//! noise, 14 to 18 bit, 0.3 to 2 µm, 500 or 1000 samples per second, a thermometer in three of ten.
//! In half of the cases without an effect, and in a third of the others, the force has coloured
//! noise of half to twice the white one, with a correlation of 0.9 to 0.98 over a millisecond.

use super::plan::{self, HIDDEN, Kind, shuffled};
use firmware_core::damper::Nominal;
use firmware_core::damper::effects::CATALOGUE;
use virtual_bench::bench_visit::protocol::{self, Test};
use virtual_bench::bench_visit::random::Random;
use virtual_bench::bench_visit::scaled;
use virtual_bench::bench_visit::sensors::{Channel, Coloured, Sensors};
use virtual_bench::series_model::SeriesModel;

/// Share of small dampers.
const SMALL: f64 = 0.2;
/// Share of benches with a thermometer.
const THERMOMETERS: f64 = 0.3;
/// Largest error of a wrong datasheet.
const WRONG: f64 = 0.3;

/// A case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Case {
    /// Its number in the campaign.
    pub index: usize,
    /// Seed of everything random in it.
    pub seed: u64,
    /// What is wrong with the model.
    pub kind: Kind,
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
    /// The tests: training tests and the hold-out.
    pub tests: Vec<Test>,
    /// A datasheet, where there is one.
    pub datasheet: Option<Nominal>,
}

impl Case {
    /// The case of a number. `brief` ones have fewer and shorter tests.
    pub(super) fn draw(campaign_seed: u64, index: usize, brief: bool) -> Self {
        let deck = shuffled(campaign_seed);
        debug_assert!(!deck.is_empty());
        Self::of_kind(deck[index % deck.len()], campaign_seed, index, brief)
    }

    /// The same with a kind of one's own.
    pub(super) fn of_kind(kind: Kind, campaign_seed: u64, index: usize, brief: bool) -> Self {
        let seed = Random::seed_of(Random::seed_of(campaign_seed, 2), index as u64);
        let mut random = Random::new(seed, 0);
        let hydraulic = matches!(kind, Kind::Hydraulic { .. });
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
        let effects = effects(kind, &mut random);
        let tests = if brief { scaled::brief(scale) } else { scaled::whole(scale) };
        let (fastest_m_per_s, farthest_m) = protocol::reach(&tests);
        let peak_n = nominal.f_relief_n + nominal.c2_n_s_per_m * fastest_m_per_s;
        let mut sensors = sensors(peak_n, farthest_m, &mut random);
        let impact = effects.iter().any(|effect| CATALOGUE[*effect].needs_rate_hz > 1000.0);
        if impact {
            (sensors.rate_hz, sensors.anti_alias_hz) = (5000.0, Some(2000.0));
        }
        let coloured = match kind {
            Kind::Nothing { coloured } => coloured,
            _ => random.uniform() < 1.0 / 3.0,
        };
        let level_n = sensors.force.noise * random.between(0.5, 2.0);
        let rho_per_ms = random.between(0.9, 0.98);
        sensors.coloured = coloured.then_some(Coloured { level_n, rho_per_ms });
        let mut wrong = |value: f64| value * random.between(1.0 - WRONG, 1.0 + WRONG);
        let sheet = Nominal {
            ce_n_s_per_m: wrong(nominal.ce_n_s_per_m),
            ke_n_per_m: wrong(nominal.ke_n_per_m),
            clearance_2a_m: wrong(nominal.clearance_2a_m),
            f_relief_n: wrong(nominal.f_relief_n),
            c2_n_s_per_m: wrong(nominal.c2_n_s_per_m),
        };
        let datasheet = matches!(kind, Kind::WrongDatasheet { .. }).then_some(sheet);
        let class = if small { "small" } else { "yaw" };
        Self { index, seed, kind, class, nominal, scale, effects, sensors, tests, datasheet }
    }

    /// Wanted size of its effects, in multiples of the noise.
    pub(super) fn size(&self) -> f64 {
        match self.kind {
            Kind::Effect { size, .. } | Kind::Pair { size } | Kind::Outside { size, .. } => size,
            Kind::WrongDatasheet { with_effect: true } => 10.0,
            Kind::Nothing { .. } | Kind::WrongDatasheet { .. } | Kind::Hydraulic { .. } => 0.0,
        }
    }

    /// rms that the noise of both sensors leaves on the force of the true damper, N; that of the
    /// displacement as if the attachment passed all of it.
    pub(super) fn noise_n(&self) -> f64 {
        let Sensors { force, displacement, coloured, .. } = &self.sensors;
        let level_n = coloured.map_or(0.0, |coloured| coloured.level_n);
        let step_n = 2.0 * force.range / libm::exp2(f64::from(force.bits));
        let moved_n = self.nominal.ke_n_per_m * displacement.noise;
        let squares = force.noise * force.noise + level_n * level_n + step_n * step_n / 12.0;
        (squares + moved_n * moved_n).sqrt()
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

fn effects(kind: Kind, random: &mut Random) -> Vec<usize> {
    // Those that a record of 1 kHz can hold and that are not hidden.
    let open: Vec<usize> = plan::effects()
        .filter(|(_, info)| info.name != HIDDEN && info.needs_rate_hz <= 1000.0)
        .map(|(effect, _)| effect)
        .collect();
    let mut any = |from: &[usize]| {
        let at = (random.uniform() * from.len() as f64) as usize;
        from[at.min(from.len() - 1)]
    };
    match kind {
        Kind::Effect { effect, .. } => vec![effect],
        Kind::Pair { .. } => {
            let first = any(&open);
            let rest: Vec<usize> = open.iter().copied().filter(|other| *other != first).collect();
            vec![first, any(&rest)]
        }
        Kind::WrongDatasheet { with_effect: true } => vec![any(&open)],
        Kind::Nothing { .. }
        | Kind::Outside { .. }
        | Kind::WrongDatasheet { .. }
        | Kind::Hydraulic { .. } => Vec::new(),
    }
}

fn sensors(peak_n: f64, farthest_m: f64, random: &mut Random) -> Sensors {
    let usual = Sensors::for_peaks(peak_n, farthest_m);
    let rate_hz = if random.uniform() < 0.25 { 500.0 } else { 1000.0 };
    let noise = random.between(2e-4, 1e-3) * usual.force.range;
    let bits = 14 + (random.uniform() * 5.0).min(4.0) as u32;
    // A small damper gets a displacement sensor of its stroke.
    let noise_m = random.between(0.3e-6, 2e-6) * usual.displacement.range / 0.1;
    let thermometer = random.uniform() < THERMOMETERS;
    Sensors {
        rate_hz,
        displacement: Channel { noise: noise_m, ..usual.displacement },
        force: Channel { noise, bits, ..usual.force },
        coloured: None,
        anti_alias_hz: Some(0.4 * rate_hz),
        temperature_noise_k: thermometer.then_some(0.1),
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

    #[test]
    fn half_of_the_cases_without_effect_have_coloured_noise() {
        let cases = (0..800).map(|index| Case::draw(3, index, true));
        let nothing = cases.filter(|case| matches!(case.kind, Kind::Nothing { .. }));
        let (plain, coloured): (Vec<Case>, Vec<Case>) =
            nothing.partition(|case| case.sensors.coloured.is_none());
        assert!(plain.len().abs_diff(coloured.len()) <= 3 && plain.len() >= 149);
        for case in coloured {
            let noise = case.sensors.coloured.unwrap();
            assert!((0.9..=0.98).contains(&noise.rho_per_ms));
        }
    }
}
