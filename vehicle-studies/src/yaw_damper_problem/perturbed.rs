//! Rigs that differ from the nominal one.
//!
//! | parameter | standard deviation |
//! | --- | --- |
//! | gain of the controller | 5 % |
//! | feed-forward | 0.02 |
//! | natural frequency of the spool | 5 % |
//! | damping ratio of the spool | 10 % |
//! | bulk modulus of the oil | 10 % |
//! | leakage across the piston | 20 % |
//! | friction of the ram | 20 % |
//! | stiffness of the fixture | 10 % |
//!
//! Gaussian and independent; each factor is kept within three standard deviations, which also keeps
//! every part slow enough for the emulator. Rig `n` of a seed is the same whatever else is drawn.
//! The noise of the sensors is another one on every rig.

use scenario::rig::{Drive, RigSetup};
use signal::random::Random;

/// Rigs that are drawn.
pub(super) const RIGS: u64 = 20;
/// First stream of the drawing.
const STREAM: u64 = 3000;
/// Most standard deviations.
const MOST: f64 = 3.0;

/// Relative standard deviations, and that of the feed-forward, a share.
const GAIN: f64 = 0.05;
const FEED_FORWARD: f64 = 0.02;
const VALVE_HZ: f64 = 0.05;
const VALVE_DAMPING: f64 = 0.1;
const BULK_MODULUS: f64 = 0.1;
const LEAKAGE: f64 = 0.2;
const FRICTION: f64 = 0.2;
const FIXTURE: f64 = 0.1;

/// The nominal rig for 0, a perturbed one for every other number.
pub(super) fn rig(nominal: &RigSetup, seed: u64, number: u64) -> RigSetup {
    if number == 0 {
        return nominal.clone();
    }
    let mut random = Random::new(seed, STREAM + number);
    let mut drawn = |sigma: f64| sigma * random.gaussian().clamp(-MOST, MOST);
    let mut rig = nominal.clone();
    if let Drive::Servo(servo) = &mut rig.drive {
        servo.controller_gain_per_s *= 1.0 + drawn(GAIN);
        servo.feed_forward = (servo.feed_forward + drawn(FEED_FORWARD)).clamp(0.0, 1.0);
        servo.valve_hz *= 1.0 + drawn(VALVE_HZ);
        servo.valve_damping_ratio *= 1.0 + drawn(VALVE_DAMPING);
        servo.bulk_modulus_pa *= 1.0 + drawn(BULK_MODULUS);
        servo.leakage_m3_per_s_pa *= 1.0 + drawn(LEAKAGE);
        servo.friction_n_s_per_m *= 1.0 + drawn(FRICTION);
    }
    rig.fixture_m_per_n /= 1.0 + drawn(FIXTURE);
    rig.seed = Random::seed_of(seed, STREAM + number);
    rig
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::rig::RigFile;
    use scenario::source::Source;
    use std::path::Path;

    #[test]
    fn rigs_are_those_of_their_seed_and_number_and_differ_as_stated() {
        let source = Source::from_text(Path::new("rig.toml"), "kind = \"servo\"");
        let nominal = source.parse::<RigFile>().unwrap().build(&source).unwrap();
        assert_eq!(rig(&nominal, 1, 0), nominal);
        assert_eq!(rig(&nominal, 1, 3), rig(&nominal, 1, 3));
        assert_ne!(rig(&nominal, 1, 3), rig(&nominal, 2, 3));
        let gain = |rig: &RigSetup| match &rig.drive {
            Drive::Servo(servo) => servo.controller_gain_per_s,
            Drive::Ideal | Drive::RthsBenchmark => f64::NAN,
        };
        let ratios: Vec<f64> = (1..=400)
            .map(|number| gain(&rig(&nominal, 7, number)) / gain(&nominal) - 1.0)
            .collect();
        // Four standard deviations of each estimate.
        assert!(signal::statistics::mean(&ratios).abs() < 0.01);
        assert!((signal::statistics::rms(&ratios) / GAIN - 1.0).abs() < 0.15);
        assert!(ratios.iter().all(|ratio| ratio.abs() <= MOST * GAIN + 1e-12));
    }
}
