//! Random irregularity by the spectra of the SS9 study, from any place of the track on.
//!
//! Each cosine turns from sample to sample by a rotation, and is set anew from its phase at the
//! beginning of every block. A sample therefore depends on its place and the seed alone, to the
//! last bit: a track may be made in pieces that begin with a block.

use super::samples::Samples;
use firmware_core::track::IrregularitySample;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Distance between the samples made here (m).
pub const SAMPLE_STEP_M: f64 = 0.1;

/// What the random irregularity is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Seed of the phases.
    pub seed: u64,
    /// Shortest wavelength (m).
    pub shortest: f64,
    /// Longest wavelength (m).
    pub longest: f64,
    /// Factor on the amplitudes.
    pub scale: f64,
}

/// Random irregularity by the study's spectra.
pub fn aar6(band: &Band, from_m: f64, to_m: f64) -> Samples {
    let mut samples = Samples::default();
    let total = count(from_m, to_m);
    let made = make(band, (from_m, total), 0..total, &mut samples, &|| true);
    debug_assert!(made, "nothing stops it");
    samples
}

/// The same for a track of many kilometres; none once `stop` is set.
pub fn aar6_until(stop: &AtomicBool, band: &Band, from_m: f64, to_m: f64) -> Option<Samples> {
    let mut samples = Samples::default();
    let total = count(from_m, to_m);
    let goes_on = || !stop.load(Ordering::Relaxed);
    make(band, (from_m, total), 0..total, &mut samples, &goes_on).then_some(samples)
}

/// Samples that a track between two distances has (m).
pub(super) fn count(from_m: f64, to_m: f64) -> usize {
    debug_assert!(from_m <= to_m, "the track has a length");
    ((to_m - from_m) / SAMPLE_STEP_M).max(0.0) as usize + 4
}

/// Makes a piece of the track that begins at `first_m` and has `total` samples, in the place of
/// what `into` holds; false, and samples that are worth nothing, where `goes_on` became false.
pub(super) fn make(
    band: &Band,
    (first_m, total): (f64, usize),
    piece: Range<usize>,
    into: &mut Samples,
    goes_on: &dyn Fn() -> bool,
) -> bool {
    debug_assert!(band.shortest < band.longest, "a band of wavelengths");
    debug_assert!(piece.start.is_multiple_of(BLOCK), "a piece begins with a block");
    debug_assert!(piece.start <= piece.end && piece.end <= total, "{piece:?} of {total} samples");
    into.samples.resize(piece.len(), IrregularitySample::default());
    (into.before, into.behind) = (piece.start, total - piece.end);
    (into.first_m, into.step_m) = (first_m, SAMPLE_STEP_M);
    let channels: [_; 4] =
        std::array::from_fn(|channel| cosines(band, channel as u64, CHANNELS[channel].0));
    for (number, block) in into.samples.chunks_mut(BLOCK).enumerate() {
        if !goes_on() {
            return false;
        }
        let place = (piece.start + number * BLOCK) as f64;
        for (cosines, (_, set)) in channels.iter().zip(CHANNELS) {
            let mut values = [0.0; BLOCK];
            let (groups, rest) = cosines.as_chunks();
            debug_assert!(rest.is_empty(), "{} cosines in no group", rest.len());
            for group in groups {
                add(group, place, &mut values);
            }
            for (sample, value) in block.iter_mut().zip(values) {
                set(sample, value);
            }
        }
    }
    into.fade_in();
    true
}

type Channel = (fn(f64, f64) -> f64, fn(&mut IrregularitySample, f64));

/// The variance of each channel between two frequencies, and the place of its value.
pub(super) const CHANNELS: [Channel; 4] = [
    (vertical_variance_m2, |s, v| s.vertical_m = v),
    (vertical_variance_m2, |s, v| s.alignment_m = v),
    (cross_variance_m2, |s, v| s.cross_level_m = v),
    (cross_variance_m2, |s, v| s.gauge_m = v),
];

const OMEGA_C2: f64 = 0.6798;
const OMEGA_S2: f64 = 0.1918;

/// Variance of equation (1) between two spatial frequencies (rad/m), in m2.
///
/// ```
/// // Wavelengths 1 to 100 m: sigma 3.46 mm.
/// let tau = std::f64::consts::TAU;
/// let sigma = scenario::irregularity::vertical_variance_m2(tau / 100.0, tau).sqrt();
/// assert!((sigma - 3.46e-3).abs() < 0.02e-3);
/// ```
pub fn vertical_variance_m2(from: f64, to: f64) -> f64 {
    let corner = OMEGA_C2.sqrt();
    let integral = |w: f64| (-1.0 / w - libm::atan(w / corner) / corner) / OMEGA_C2;
    5.7613e-3 * 1e-4 * (integral(to) - integral(from))
}

/// Variance of equation (2) between two spatial frequencies (rad/m), in m2.
pub fn cross_variance_m2(from: f64, to: f64) -> f64 {
    let (c, s) = (OMEGA_C2.sqrt(), OMEGA_S2.sqrt());
    let integral = |w: f64| (libm::atan(w / s) / s - libm::atan(w / c) / c) / (OMEGA_C2 - OMEGA_S2);
    2.3045e-2 * 1e-4 * (integral(to) - integral(from))
}

/// Number of cosines per channel.
const COSINES: usize = 600;

/// Cosines that turn side by side: one alone waits for each of its own rotations.
const GROUP: usize = 4;

/// A cosine is set anew from its phase after this many samples, so that rounding does not grow.
pub(super) const BLOCK: usize = 256;

/// A cosine of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cosine {
    amplitude_m: f64,
    /// Angle at the first sample of the track (rad).
    phase: f64,
    /// Angle from one sample to the next (rad).
    turn: f64,
    /// Sine and cosine of it.
    rotation: (f64, f64),
}

fn cosines(band: &Band, channel: u64, variance_m2: fn(f64, f64) -> f64) -> Vec<Cosine> {
    let mut random = ChaCha8Rng::seed_from_u64(band.seed);
    random.set_stream(channel);
    let tau = core::f64::consts::TAU;
    let ratio = libm::pow(band.longest / band.shortest, 1.0 / COSINES as f64);
    let mut from = tau / band.longest;
    let next = |_| {
        let to = from * ratio;
        let frequency = (from * to).sqrt();
        let amplitude_m = band.scale * (2.0 * variance_m2(from, to)).sqrt();
        // 53 random bits of a turn.
        let phase = tau * ((random.next_u64() >> 11) as f64 / (1u64 << 53) as f64);
        from = to;
        let turn = frequency * SAMPLE_STEP_M;
        Cosine { amplitude_m, phase, turn, rotation: libm::sincos(turn) }
    };
    (0..COSINES).map(next).collect()
}

/// Adds cosines, one after the other, to the values of the block that begins at a place.
fn add(cosines: &[Cosine; GROUP], place: f64, values: &mut [f64; BLOCK]) {
    let amplitude_m = cosines.map(|cosine| cosine.amplitude_m);
    let (turn_sin, turn_cos) = (cosines.map(|c| c.rotation.0), cosines.map(|c| c.rotation.1));
    let start = cosines.map(|cosine| libm::sincos(cosine.phase + cosine.turn * place));
    let (mut sin, mut cos) = (start.map(|start| start.0), start.map(|start| start.1));
    for value in values {
        for lane in 0..GROUP {
            *value += amplitude_m[lane] * cos[lane];
            (cos[lane], sin[lane]) = (
                cos[lane] * turn_cos[lane] - sin[lane] * turn_sin[lane],
                sin[lane] * turn_cos[lane] + cos[lane] * turn_sin[lane],
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::PERFECT_M;
    use super::*;

    const BAND: Band = Band { seed: 7, shortest: 1.0, longest: 100.0, scale: 1.0 };

    #[test]
    fn the_irregularity_grows_out_of_perfect_track() {
        let track = aar6(&BAND, 0.0, 200.0);
        let perfect = (PERFECT_M / SAMPLE_STEP_M) as usize;
        assert!(track.samples[..=perfect].iter().all(|s| *s == IrregularitySample::default()));
    }

    #[test]
    fn channels_are_independent_and_seeds_repeat() {
        let track = aar6(&BAND, 0.0, 5_000.0);
        assert_eq!(track, aar6(&BAND, 0.0, 5_000.0));
        assert_ne!(track, aar6(&Band { seed: 8, ..BAND }, 0.0, 5_000.0));
        let (mut product, mut square) = (0.0, 0.0);
        for sample in &track.samples {
            product += sample.vertical_m * sample.alignment_m;
            square += sample.vertical_m * sample.vertical_m;
        }
        assert!((product / square).abs() < 0.25, "{}", product / square);
    }

    /// A cosine after the other over the whole track, as the samples were made before there were
    /// stretches and groups.
    fn one_by_one(band: &Band, channel: usize, total: usize) -> Vec<f64> {
        let mut values = vec![0.0; total];
        for cosine in cosines(band, channel as u64, CHANNELS[channel].0) {
            let (turn_sin, turn_cos) = cosine.rotation;
            for (number, block) in values.chunks_mut(BLOCK).enumerate() {
                let start = cosine.phase + cosine.turn * (number * BLOCK) as f64;
                let (mut sin, mut cos) = libm::sincos(start);
                for value in block {
                    *value += cosine.amplitude_m * cos;
                    (cos, sin) = (cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin);
                }
            }
        }
        values
    }

    #[test]
    fn groups_of_cosines_have_the_bits_of_one_cosine_after_the_other() {
        let track = aar6(&BAND, 0.0, 200.0);
        let of: [fn(&IrregularitySample) -> f64; 4] =
            [|s| s.vertical_m, |s| s.alignment_m, |s| s.cross_level_m, |s| s.gauge_m];
        for (channel, of) in of.iter().enumerate() {
            let alone = one_by_one(&BAND, channel, track.samples.len());
            // Behind the fade, which multiplies by exactly one.
            let pairs = track.samples.iter().map(of).zip(alone).skip(600);
            assert!(pairs.into_iter().all(|(made, alone)| made.to_bits() == alone.to_bits()));
        }
    }

    #[test]
    fn a_track_that_is_stopped_is_none() {
        assert_eq!(aar6_until(&AtomicBool::new(true), &BAND, 0.0, 200.0), None);
    }
}
