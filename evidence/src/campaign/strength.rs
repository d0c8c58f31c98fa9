//! One number for every effect of the catalogue, from vanishing (0) to strong.
//!
//! Which parameter grows with it, and how, is in the effect's own file
//! ([`DamperEffect::drawn`](firmware_core::damper::effects::DamperEffect::drawn)). Here the shape
//! is drawn, once per case, and the sizes of the tests are given.

use firmware_core::damper::effects::{CATALOGUE, Draw, EffectInfo, Scale};
use firmware_core::damper::{Effect, Nominal};
use virtual_bench::bench_visit::random::Random;

/// An effect of a drawn shape, whose strength is still open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strength {
    /// The effect.
    pub info: &'static EffectInfo,
    draw: Draw,
}

/// Greatest speed and stroke of sines, m/s and m, at a scale of one.
const FASTEST_M_PER_S: f64 = 0.176;
const STROKE_M: f64 = 8e-3;
/// Farthest positions of the tests, m: extension, compression.
const FARTHEST_M: [f64; 2] = [43.46e-3, 20e-3];

impl Strength {
    /// Draws the shape of an effect for a damper in tests of a scale.
    pub(super) fn draw(effect: usize, nominal: Nominal, scale: f64, random: &mut Random) -> Self {
        debug_assert!(effect < CATALOGUE.len(), "effect {effect} is not in the catalogue");
        let shape = [random.uniform(), random.uniform(), random.uniform()];
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let scale = Scale {
            force_n: nominal.f_relief_n,
            velocity_m_per_s: scale * FASTEST_M_PER_S,
            displacement_m: scale * STROKE_M,
            extension_m: scale * FARTHEST_M[0],
            compression_m: scale * FARTHEST_M[1],
        };
        let draw = Draw { nominal, scale, shape, sign };
        Self { info: &CATALOGUE[effect % CATALOGUE.len()], draw }
    }

    /// The largest strength that is still a damper.
    pub(super) fn strongest(&self) -> f64 {
        self.info.strongest
    }

    /// The effect at a strength, if there is such a one.
    pub(super) fn at(&self, strength: f64) -> Option<Effect> {
        Effect::drawn(self.info.name, strength, &self.draw).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::COMMITTED;
    use super::*;
    use firmware_core::damper::Damper;
    use firmware_core::fnv;

    #[test]
    fn every_effect_can_be_weak_and_strong() {
        for effect in 0..CATALOGUE.len() {
            for seed in 0..8 {
                let mut random = Random::new(seed, 0);
                let strength = Strength::draw(effect, Nominal::NEW, 1.0, &mut random);
                for share in [1e-6, 1e-3, 0.1, 1.0] {
                    let k = share * strength.strongest();
                    let effect = strength.at(k);
                    assert!(effect.is_some(), "{} {k}", strength.info.name);
                    let damper = Damper::new(Nominal::NEW, effect.as_slice());
                    assert!(damper.is_ok(), "{} {k} {damper:?}", strength.info.name);
                }
            }
        }
    }

    /// Every drawn value of these effects: a committed campaign can only be repeated while none of
    /// their bits changes.
    #[test]
    fn drawn_values_are_those_of_the_committed_campaign() {
        let mut hash = fnv::START;
        let committed = |info: &EffectInfo| COMMITTED.contains(&info.name);
        for (effect, info) in CATALOGUE.iter().enumerate().filter(|(_, info)| committed(info)) {
            hash = info.name.bytes().fold(hash, |hash, byte| fnv::add(hash, u64::from(byte)));
            for seed in 0..16 {
                let mut random = Random::new(2014 + seed, seed);
                let scale = random.between(0.5, 2.0);
                let nominal = Nominal { f_relief_n: random.between(8e3, 25e3), ..Nominal::NEW };
                let strength = Strength::draw(effect, nominal, scale, &mut random);
                hash = fnv::add(hash, strength.strongest().to_bits());
                for share in [1e-6, 1e-3, 0.03, 0.3, 0.9, 1.0, 1.7] {
                    let effect = strength.at(share * strength.strongest());
                    hash = fnv::add(hash, u64::from(effect.is_some()));
                    for value in effect.iter().flat_map(Effect::values) {
                        hash = fnv::add(hash, value.to_bits());
                    }
                }
            }
        }
        assert_eq!(hash, 15_116_144_641_858_836_781);
    }
}
