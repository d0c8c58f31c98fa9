//! The measuring chain of a case: sensors of a laboratory and a noise of the design.
//!
//! Force 0.02 to 0.1 % of the range (0.1 to 0.25 % where the recorder filters or averages), 14 to
//! 18 bit, displacement 0.3 to 2 µm, 500 or 1000 samples per second, a thermometer in three of ten.
//! The recorder that filters or averages does so to both channels. That rounds the corners of the
//! force, which no damper model explains: its noise is larger, so that the rounding (5 to 40 N rms
//! of a yaw damper) stays below it.
//!
//! | noise | force |
//! | --- | --- |
//! | white | white |
//! | filtered | white, then four poles at 100 to 125 Hz |
//! | averaged | white, then the mean over 3 to 5 ms |
//! | drifting | a tenth of the power white, the rest drifts below 0.05 to 0.3 Hz |
//! | coloured | white, and AR(1) of half to twice its size, correlation 0.9 to 0.98 over 1 ms |

use super::design::Noise;
use signal::random::Random;
use virtual_bench::bench_visit::sensors::{Channel, Coloured, Drift, Processing, Sensors};

/// Share of benches with a thermometer, and of those with 500 samples per second.
const THERMOMETERS: f64 = 0.3;
const SLOW: f64 = 0.5;
/// Noise of the force in the record, as a share of the range.
const AS_SAMPLED: [f64; 2] = [2e-4, 1e-3];
const PROCESSED: [f64; 2] = [1e-3, 2.5e-3];
/// Sampling rate and anti-alias corner of a record of impacts, Hz.
const IMPACT_HZ: [f64; 2] = [5000.0, 2000.0];
/// Share of the power of a drifting noise that is white.
const WHITE_SHARE: f64 = 0.1;
/// Noise bandwidth of four poles over their corner (Butterworth).
const NOISE_BANDWIDTH: f64 = 1.026;

/// A measuring chain for forces and positions up to these.
pub(super) fn sensors(
    noise: Noise,
    peak_n: f64,
    farthest_m: f64,
    has_impacts: bool,
    random: &mut Random,
) -> Sensors {
    let usual = Sensors::for_peaks(peak_n, farthest_m);
    let slow = random.uniform() < SLOW;
    let [least, most] = match noise {
        Noise::Filtered | Noise::Averaged => PROCESSED,
        Noise::White | Noise::Drifting | Noise::Coloured => AS_SAMPLED,
    };
    let level_n = random.between(least, most) * usual.force.range;
    let bits = 14 + (random.uniform() * 5.0).min(4.0) as u32;
    // A small damper gets a displacement sensor of its stroke.
    let level_m = random.between(0.3e-6, 2e-6) * usual.displacement.range / 0.1;
    let thermometer = random.uniform() < THERMOMETERS;
    let (shape, other) = (random.uniform(), random.uniform());
    let rate_hz = if slow { 500.0 } else { 1000.0 };
    let [rate_hz, anti_alias_hz] = if has_impacts { IMPACT_HZ } else { [rate_hz, 0.4 * rate_hz] };
    let processing = match noise {
        Noise::Filtered => Processing::LowPass { corner_hz: between(shape, 100.0, 125.0) },
        Noise::Averaged => {
            let samples = libm::rint(between(shape, 3e-3, 5e-3) * rate_hz);
            Processing::Mean { samples: samples as usize }
        }
        Noise::White | Noise::Drifting | Noise::Coloured => Processing::AsSampled,
    };
    let raw = 1.0 / passed(processing, rate_hz);
    let mut sensors = Sensors {
        rate_hz,
        displacement: Channel { noise: raw * level_m, ..usual.displacement },
        force: Channel { noise: raw * level_n, bits, ..usual.force },
        coloured: None,
        drift: None,
        processing,
        anti_alias_hz: Some(anti_alias_hz),
        temperature_noise_k: thermometer.then_some(0.1),
    };
    match noise {
        Noise::Coloured => {
            let level_n = level_n * between(shape, 0.5, 2.0);
            let rho_per_ms = between(other, 0.9, 0.98);
            sensors.coloured = Some(Coloured { level_n, rho_per_ms });
        }
        Noise::Drifting => {
            sensors.force.noise = WHITE_SHARE.sqrt() * level_n;
            let level_n = (1.0 - WHITE_SHARE).sqrt() * level_n;
            sensors.drift = Some(Drift { level_n, corner_hz: between(shape, 0.05, 0.3) });
        }
        Noise::White | Noise::Filtered | Noise::Averaged => {}
    }
    sensors
}

/// rms of the noise of the records of a chain: that of the force, N, and that of the displacement,
/// m.
pub(super) fn recorded(sensors: &Sensors) -> (f64, f64) {
    let share = passed(sensors.processing, sensors.rate_hz);
    let step_n = 2.0 * sensors.force.range / libm::exp2(f64::from(sensors.force.bits));
    let coloured_n = sensors.coloured.map_or(0.0, |coloured| coloured.level_n);
    let drift_n = sensors.drift.map_or(0.0, |drift| drift.level_n);
    let white_n = share * sensors.force.noise;
    let squares = [white_n, coloured_n, drift_n].map(|level| level * level).iter().sum::<f64>();
    let force_n = (squares + step_n * step_n / 12.0).sqrt();
    (force_n, share * sensors.displacement.noise)
}

/// The same chain without noise.
pub(super) fn silent(sensors: &Sensors) -> Sensors {
    let exact = Channel { range: f64::INFINITY, noise: 0.0, bits: 0 };
    Sensors {
        displacement: exact,
        force: exact,
        coloured: None,
        drift: None,
        temperature_noise_k: sensors.temperature_noise_k.map(|_| 0.0),
        ..*sensors
    }
}

/// rms of white noise in the record over that of the sensor.
fn passed(processing: Processing, rate_hz: f64) -> f64 {
    match processing {
        Processing::AsSampled => 1.0,
        Processing::LowPass { corner_hz } => (2.0 * NOISE_BANDWIDTH * corner_hz / rate_hz).sqrt(),
        Processing::Mean { samples } => 1.0 / (samples.max(1) as f64).sqrt(),
    }
}

fn between(share: f64, from: f64, to: f64) -> f64 {
    from + share * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::statistics::rms;
    use virtual_bench::bench_visit::protocol::Test;
    use virtual_bench::bench_visit::record;
    use virtual_bench::excitation::Excitation;
    use virtual_bench::series_model::{NullGenerator, SeriesModel};

    #[test]
    fn the_noise_of_a_record_is_the_stated_one() {
        let model = SeriesModel {
            ce_n_s_per_m: 1e6,
            ke_n_per_m: 12.5e6,
            clearance_2a_m: 1e-3,
            f_relief_n: 15e3,
            c2_n_s_per_m: 60e3,
        };
        let specimen = NullGenerator { model, outside: Vec::new() };
        let test = Test::new("sine", Excitation::sine(3e-3, 2.0), 8.0);
        for noise in Noise::ALL {
            let (mut found, mut stated) = (0.0, 0.0);
            for seed in 0..12 {
                let chain = sensors(noise, 20e3, 8e-3, false, &mut Random::new(seed, 0));
                let noisy = record(&specimen, &test, &chain, seed);
                let exact = record(&specimen, &test, &silent(&chain), seed);
                let pairs = noisy.force_n.iter().zip(&exact.force_n);
                let difference: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
                found += rms(&difference).powi(2);
                stated += recorded(&chain).0.powi(2);
            }
            let ratio = (found / stated).sqrt();
            // A drift is slow: the average over few records is not that of all.
            let allowed = if noise == Noise::Drifting { 0.25 } else { 0.05 };
            assert!((ratio - 1.0).abs() < allowed, "{noise:?}: {ratio}");
        }
    }
}
