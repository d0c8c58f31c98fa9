//! Track irregularity: random samples by the spectra of the SS9 study, or a measured file.
//!
//! The study's equations (1) and (2) (American class 6) are one-sided densities over spatial
//! frequency in rad/m:
//! ```text
//! Sv = Sa = 5.7613e-3 / (W^2 (W^2 + 0.6798))                  cm2/(rad/m)   vertical, alignment
//! Sc = Sg = 2.3045e-2 / ((W^2 + 0.6798) (W^2 + 0.1918))       cm2/(rad/m)   cross level, gauge
//! ```
//! Each channel is a sum of 600 cosines with random phase, one per band of equal ratio between the
//! longest and the shortest wavelength; a band's variance is the closed integral of the density, so
//! the variance is exact whatever the number of bands (`evidence/src/validation/irregularity.rs`).
//! The four channels are independent, from one seed. Either kind grows out of perfect track, on
//! which the vehicle starts in equilibrium.

use crate::error::{Place, ScenarioError};
use crate::inputs::Inputs;
use crate::quantity::Quantity;
use crate::source::{self, Source};
use files::quote::message;
use files::{Limit, did_you_mean, number, quoted};
use firmware_core::track::IrregularitySample;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Distance between the samples made here (m).
pub const SAMPLE_STEP_M: f64 = 0.1;

/// Up to here the track is perfect (m): there the vehicle starts, in equilibrium, on all its
/// wheels.
pub const PERFECT_M: f64 = 30.0;

/// Over this distance behind it, or behind the first sample, the irregularity fades in (m).
pub const FADE_IN_M: f64 = 30.0;

/// Irregularity in a scenario file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IrregularityFile {
    /// Random, American class 6 by the study's spectra.
    Aar6 {
        /// Seed of the phases.
        seed: u64,
        /// Shortest wavelength.
        shortest_m: Quantity,
        /// Longest wavelength.
        longest_m: Quantity,
        /// Factor on all amplitudes.
        scale: Option<Quantity>,
    },
    /// Measured: a CSV with `distance_m` and any of `vertical_m`, `alignment_m`, `cross_level_m`,
    /// `gauge_m`.
    Csv {
        /// The file, relative to the scenario.
        path: String,
    },
}

/// Samples along the track.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Samples {
    /// The samples.
    pub samples: Vec<IrregularitySample>,
    /// Distance of the first one (m).
    pub first_m: f64,
    /// Distance between them (m).
    pub step_m: f64,
}

impl IrregularityFile {
    /// Makes or reads the samples between two distances.
    ///
    /// # Errors
    /// A band that is empty, or a file that does not fit.
    pub(crate) fn samples(
        &self,
        source: &Source,
        (from_m, to_m): (f64, f64),
        inputs: &mut Inputs,
    ) -> Result<Samples, ScenarioError> {
        if let Some(band) = self.band(source)? {
            return Ok(aar6(&band, from_m, to_m));
        }
        let Self::Csv { path } = self else { return Ok(Samples::default()) };
        let path = source.sibling(path);
        let samples = read_csv(&path, inputs)?;
        covers(&path, &samples, from_m + PERFECT_M, to_m)?;
        Ok(samples)
    }

    /// What random irregularity is made from; none for a measured one.
    ///
    /// # Errors
    /// A band that is empty.
    pub fn band(&self, source: &Source) -> Result<Option<Band>, ScenarioError> {
        let Self::Aar6 { seed, shortest_m, longest_m, scale } = self else { return Ok(None) };
        let shortest = shortest_m.within(source, "shortest_m", 0.5, 500.0, "0.5 to 500 m")?;
        let longest = longest_m.within(
            source,
            "longest_m",
            1.001 * shortest,
            1000.0,
            "more than shortest_m and at most 1000 m",
        )?;
        let scale = match scale {
            Some(scale) => scale.not_negative(source, "scale")?,
            None => 1.0,
        };
        Ok(Some(Band { seed: *seed, shortest, longest, scale }))
    }
}

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
    aar6_while(&|| true, band, from_m, to_m)
}

/// The same for a track of many kilometres; none once `stop` is set.
pub fn aar6_until(stop: &AtomicBool, band: &Band, from_m: f64, to_m: f64) -> Option<Samples> {
    let goes_on = || !stop.load(Ordering::Relaxed);
    let samples = aar6_while(&goes_on, band, from_m, to_m);
    goes_on().then_some(samples)
}

/// The irregularity, of which cosines are missing where `goes_on` becomes false.
fn aar6_while(goes_on: &dyn Fn() -> bool, band: &Band, from_m: f64, to_m: f64) -> Samples {
    debug_assert!(from_m <= to_m, "the track has a length");
    debug_assert!(band.shortest < band.longest, "a band of wavelengths");
    let count = (((to_m - from_m) / SAMPLE_STEP_M).max(0.0) as usize) + 4;
    let mut samples = vec![IrregularitySample::default(); count];
    for (channel, (variance, set)) in CHANNELS.iter().enumerate() {
        let values = channel_values(goes_on, band, channel as u64, *variance, count);
        for (sample, value) in samples.iter_mut().zip(values) {
            set(sample, value);
        }
    }
    Samples { samples, first_m: from_m, step_m: SAMPLE_STEP_M }.faded_in()
}

impl Samples {
    /// Lets the irregularity grow smoothly out of perfect track: a wheel that started on a rail
    /// some millimetres off would be thrown by its contact.
    fn faded_in(self) -> Self {
        let from_m = self.first_m.max(PERFECT_M);
        self.weighted(|distance_m| {
            let t = ((distance_m - from_m) / FADE_IN_M).clamp(0.0, 1.0);
            t * t * t * (10.0 + t * (6.0 * t - 15.0))
        })
    }

    /// All channels times a weight that depends on distance (m).
    #[must_use]
    pub fn weighted(mut self, weight: impl Fn(f64) -> f64) -> Self {
        for (index, sample) in self.samples.iter_mut().enumerate() {
            let weight = weight(self.first_m + index as f64 * self.step_m);
            sample.vertical_m *= weight;
            sample.alignment_m *= weight;
            sample.cross_level_m *= weight;
            sample.gauge_m *= weight;
        }
        self
    }
}

type Channel = (fn(f64, f64) -> f64, fn(&mut IrregularitySample, f64));

const CHANNELS: [Channel; 4] = [
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

/// An oscillator is set anew from its phase after this many samples, so that rounding does not
/// grow.
const ANCHOR_EVERY: usize = 256;

fn channel_values(
    goes_on: &dyn Fn() -> bool,
    band: &Band,
    channel: u64,
    variance_m2: fn(f64, f64) -> f64,
    count: usize,
) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(band.seed);
    random.set_stream(channel);
    let tau = core::f64::consts::TAU;
    let lowest = tau / band.longest;
    let ratio = libm::pow(band.longest / band.shortest, 1.0 / COSINES as f64);
    let mut values = vec![0.0; count];
    let mut from = lowest;
    for _ in 0..COSINES {
        if !goes_on() {
            break;
        }
        let to = from * ratio;
        let frequency = (from * to).sqrt();
        let amplitude = band.scale * (2.0 * variance_m2(from, to)).sqrt();
        // 53 random bits of a turn.
        let phase = tau * ((random.next_u64() >> 11) as f64 / (1u64 << 53) as f64);
        add_cosine(&mut values, amplitude, frequency * SAMPLE_STEP_M, phase);
        from = to;
    }
    values
}

fn add_cosine(values: &mut [f64], amplitude: f64, turn: f64, phase: f64) {
    let (turn_sin, turn_cos) = libm::sincos(turn);
    for (block, chunk) in values.chunks_mut(ANCHOR_EVERY).enumerate() {
        let start = phase + turn * (block * ANCHOR_EVERY) as f64;
        let (mut sin, mut cos) = libm::sincos(start);
        for value in chunk {
            *value += amplitude * cos;
            (cos, sin) = (cos * turn_cos - sin * turn_sin, sin * turn_cos + cos * turn_sin);
        }
    }
}

/// Measured samples must reach over the whole run, finely enough, with believable sizes.
fn covers(path: &Path, samples: &Samples, from_m: f64, to_m: f64) -> Result<(), ScenarioError> {
    let last_m = samples.first_m + samples.step_m * samples.samples.len().saturating_sub(1) as f64;
    let fail = |message: String| Err(ScenarioError::mismatch(path, message));
    if samples.first_m > from_m || last_m < to_m {
        return fail(format!(
            "covers {} to {} m, but the run needs {} to {to_m:.0} m",
            number(samples.first_m),
            number(last_m),
            number(from_m)
        ));
    }
    if samples.step_m > 1.0 {
        return fail(format!("steps of {} m, expected at most 1 m", number(samples.step_m)));
    }
    let largest = samples.samples.iter().fold(0.0, |most: f64, sample| {
        let sizes = [sample.vertical_m, sample.alignment_m, sample.cross_level_m, sample.gauge_m];
        sizes.iter().fold(most, |most, size| most.max(size.abs()))
    });
    if largest > 0.2 {
        let largest = number(largest);
        return fail(format!("a value of {largest} m, expected at most 0.2 m: are these metres?"));
    }
    Ok(())
}

/// Reads measured irregularity at even distances.
fn read_csv(path: &Path, inputs: &mut Inputs) -> Result<Samples, ScenarioError> {
    let fail = |line: Option<usize>, message: String| {
        let at = Place { line, ..Place::whole(path) };
        ScenarioError::Mismatch { at, message }
    };
    let (text, hash) = source::read_hashed(path, Limit::Table)?;
    inputs.note("measured track", hash);
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let headers =
        reader.headers().map_err(|error| fail(Some(1), message(&error.to_string())))?.clone();
    let known = ["distance_m", "vertical_m", "alignment_m", "cross_level_m", "gauge_m"];
    if let Some(unknown) = headers.iter().find(|name| !known.contains(name)) {
        return Err(fail(
            Some(1),
            format!(
                "unknown column `{}`, expected {}{}",
                quoted(unknown),
                known.join(", "),
                did_you_mean(unknown, known)
            ),
        ));
    }
    let column = |name: &str| headers.iter().position(|header| header == name);
    let Some(distance) = column("distance_m") else {
        return Err(fail(Some(1), "column `distance_m` is missing".to_owned()));
    };
    let columns =
        [column("vertical_m"), column("alignment_m"), column("cross_level_m"), column("gauge_m")];
    let (mut places, mut samples) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| {
            fail(error.position().map(|p| p.line() as usize), message(&error.to_string()))
        })?;
        let line = record.position().map(|p| p.line() as usize);
        let number = |index: usize| -> Result<f64, ScenarioError> {
            let text = record.get(index).unwrap_or("");
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(fail(
                    line,
                    format!(
                        "column `{}`: found \"{}\", expected a number",
                        headers.get(index).unwrap_or(""),
                        quoted(text)
                    ),
                )),
            }
        };
        places.push((number(distance)?, line));
        let mut sample = IrregularitySample::default();
        for (index, (_, set)) in columns.iter().zip(CHANNELS) {
            if let Some(index) = index {
                set(&mut sample, number(*index)?);
            }
        }
        samples.push(sample);
    }
    let [(first_m, _), (second_m, _), ..] = places.as_slice() else {
        return Err(fail(None, format!("{} rows, expected at least 4", places.len())));
    };
    let (first_m, step_m) = (*first_m, second_m - first_m);
    if places.len() < 4 || step_m <= 0.0 {
        return Err(fail(None, "expected at least 4 rows at rising distance".to_owned()));
    }
    for (index, (place, line)) in places.iter().enumerate() {
        let expected = first_m + step_m * index as f64;
        if (place - expected).abs() > 0.01 * step_m {
            return Err(fail(
                *line,
                format!(
                    "column `distance_m`: found {}, expected {} (even steps of {} m)",
                    number(*place),
                    number(expected),
                    number(step_m)
                ),
            ));
        }
    }
    Ok(Samples { samples, first_m, step_m }.faded_in())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAND: Band = Band { seed: 7, shortest: 1.0, longest: 100.0, scale: 1.0 };

    #[test]
    fn the_irregularity_grows_out_of_perfect_track() {
        let track = aar6(&BAND, 0.0, 200.0);
        let perfect = (PERFECT_M / SAMPLE_STEP_M) as usize;
        assert!(track.samples[..=perfect].iter().all(|s| *s == IrregularitySample::default()));
        // A measured record that begins far out fades in from its first sample on.
        let far = Samples {
            samples: vec![IrregularitySample { gauge_m: 1e-3, ..Default::default() }; 101],
            first_m: 500.0,
            step_m: 0.5,
        }
        .faded_in();
        assert_eq!(far.samples[0].gauge_m, 0.0);
        assert!((far.samples[30].gauge_m - 0.5e-3).abs() < 1e-15);
        assert_eq!(far.samples[60].gauge_m, 1e-3);
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
}
