//! One number for every effect of the catalogue, from vanishing (0) to strong.
//!
//! Which parameter grows with it, and how, is in the effect's own file
//! ([`DamperEffect::drawn`](firmware_core::damper::effects::DamperEffect::drawn)). Here the shape
//! is drawn, once per case, and the sizes of the tests are given.

use super::motion::Extent;
use firmware_core::damper::effects::{CATALOGUE, Draw, EffectInfo, Scale};
use firmware_core::damper::{Effect, Nominal};
use signal::random::Random;

/// An effect of a drawn shape, whose strength is still open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strength {
    /// The effect.
    pub info: &'static EffectInfo,
    draw: Draw,
}

impl Strength {
    /// Draws the shape of an effect for a damper in tests that go this far.
    pub(super) fn draw(
        effect: usize,
        nominal: Nominal,
        extent: &Extent,
        random: &mut Random,
    ) -> Self {
        debug_assert!(effect < CATALOGUE.len(), "effect {effect} is not in the catalogue");
        let shape = [random.uniform(), random.uniform(), random.uniform()];
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        let scale = Scale {
            force_n: nominal.f_relief_n,
            velocity_m_per_s: extent.speed_m_per_s,
            displacement_m: extent.stroke_m,
            extension_m: extent.extension_m,
            compression_m: extent.compression_m,
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
    use super::*;
    use firmware_core::damper::Damper;

    const EXTENT: Extent = Extent {
        speed_m_per_s: 0.176,
        stroke_m: 8e-3,
        extension_m: 43.46e-3,
        compression_m: 20e-3,
    };

    #[test]
    fn every_effect_can_be_weak_and_strong() {
        for effect in 0..CATALOGUE.len() {
            for seed in 0..8 {
                let mut random = Random::new(seed, 0);
                let strength = Strength::draw(effect, Nominal::NEW, &EXTENT, &mut random);
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
}
