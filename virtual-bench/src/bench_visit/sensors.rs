//! What sensors and amplifier read of displacement and force.
//!
//! ```text
//! reading  = quantised( processed( low-pass(value) at the sampling instants + noises ) )
//! noises   = white + coloured + drift, the last two on the force alone
//! coloured : n_k = rho^(dt/1 ms) n_(k-1) + sqrt(1 - rho^(2 dt/1 ms)) sigma w_k
//! drift    : the same with a correlation that falls to 1/e over 1/(2 pi corner)
//! ```
//!
//! Both channels pass the same anti-alias filter (four poles, Butterworth) before the same sampling
//! instants, so that it delays them equally and the record holds no false damping. The quantiser
//! holds at the ends of its range. Defaults are a usual laboratory, estimated: load cell with 0.1 %
//! of its range rms and 16 bit, displacement with 1 µm rms and 24 bit, 1 kHz.

use signal::guiding_force::{low_pass, sliding_mean};
use signal::random::Random;

/// Coloured noise on the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coloured {
    /// Its standard deviation, N.
    pub level_n: f64,
    /// Correlation of two values 1 ms apart, 0 to 1.
    pub rho_per_ms: f64,
}

/// One channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Largest reading of either sign, in the unit of the channel.
    pub range: f64,
    /// White noise, standard deviation.
    pub noise: f64,
    /// Bits of the quantiser over the whole range; 0 for none.
    pub bits: u32,
}

/// A slow drift of the force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Its standard deviation, N.
    pub level_n: f64,
    /// Frequency above which its spectrum falls, Hz.
    pub corner_hz: f64,
}

/// What a recorder does to both channels, noise included, before it stores them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Processing {
    /// Nothing.
    AsSampled,
    /// A low-pass of four poles (Butterworth).
    LowPass {
        /// Its corner, Hz.
        corner_hz: f64,
    },
    /// The mean of the last samples.
    Mean {
        /// How many.
        samples: usize,
    },
}

/// The measuring chain of a bench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Sampling rate, Hz.
    pub rate_hz: f64,
    /// Displacement, m.
    pub displacement: Channel,
    /// Force, N.
    pub force: Channel,
    /// Coloured noise on the force.
    pub coloured: Option<Coloured>,
    /// Drift of the force.
    pub drift: Option<Drift>,
    /// What the recorder does before it stores.
    pub processing: Processing,
    /// Corner of the anti-alias filter of both channels, Hz; `None` for none.
    pub anti_alias_hz: Option<f64>,
    /// Noise of the oil temperature, K; `None` where it is not measured.
    pub temperature_noise_k: Option<f64>,
}

impl Sensors {
    /// A usual laboratory with a load cell and a displacement sensor of these ranges.
    ///
    /// ```
    /// use virtual_bench::bench_visit::sensors::Sensors;
    /// let sensors = Sensors::of_range(50e3, 0.1);
    /// assert_eq!((sensors.rate_hz, sensors.force.noise), (1000.0, 50.0));
    /// ```
    pub fn of_range(force_n: f64, displacement_m: f64) -> Self {
        Self {
            rate_hz: 1000.0,
            displacement: Channel { range: displacement_m, noise: 1e-6, bits: 24 },
            force: Channel { range: force_n, noise: 1e-3 * force_n, bits: 16 },
            coloured: None,
            drift: None,
            processing: Processing::AsSampled,
            anti_alias_hz: Some(400.0),
            temperature_noise_k: None,
        }
    }

    /// A usual laboratory that chooses its sensors for these greatest values: the next range of 1,
    /// 2, 5, 10 with a quarter in reserve.
    ///
    /// ```
    /// use virtual_bench::bench_visit::sensors::Sensors;
    /// let sensors = Sensors::for_peaks(18.6e3, 8e-3);
    /// assert_eq!((sensors.force.range, sensors.displacement.range), (50e3, 10e-3));
    /// ```
    pub fn for_peaks(force_n: f64, displacement_m: f64) -> Self {
        Self::of_range(next_range(1.25 * force_n), next_range(1.25 * displacement_m))
    }

    /// Exact sensors at this rate.
    pub fn exact(rate_hz: f64) -> Self {
        let exact = Channel { range: f64::INFINITY, noise: 0.0, bits: 0 };
        Self {
            rate_hz,
            displacement: exact,
            force: exact,
            coloured: None,
            drift: None,
            processing: Processing::AsSampled,
            anti_alias_hz: None,
            temperature_noise_k: None,
        }
    }

    /// Samples a signal given `substeps` times per sample.
    pub(super) fn sample(&self, fine: &[f64], substeps: usize) -> Vec<f64> {
        debug_assert!(substeps > 0, "a sample takes at least one step");
        let fine_hz = self.rate_hz * substeps as f64;
        let passed = self.anti_alias_hz.and_then(|corner| low_pass(fine, fine_hz, corner).ok());
        let passed = passed.as_deref().unwrap_or(fine);
        passed.iter().step_by(substeps).copied().collect()
    }

    /// Adds the noise of the displacement and quantises.
    pub(super) fn read_displacement(&self, values_m: &mut Vec<f64>, seed: u64) {
        self.displacement.add_noise(values_m, &mut Random::new(seed, 1));
        self.process(values_m);
        self.displacement.quantise(values_m);
    }

    /// Adds the noises of the force and quantises.
    pub(super) fn read_force(&self, values_n: &mut Vec<f64>, seed: u64) {
        if let Some(Coloured { level_n, rho_per_ms }) = self.coloured {
            let keep = libm::pow(rho_per_ms, 1e3 / self.rate_hz);
            add_correlated(values_n, level_n, keep, &mut Random::new(seed, 3));
        }
        if let Some(Drift { level_n, corner_hz }) = self.drift {
            let keep = libm::exp(-std::f64::consts::TAU * corner_hz / self.rate_hz);
            add_correlated(values_n, level_n, keep, &mut Random::new(seed, 9));
        }
        self.force.add_noise(values_n, &mut Random::new(seed, 2));
        self.process(values_n);
        self.force.quantise(values_n);
    }

    fn process(&self, values: &mut Vec<f64>) {
        match self.processing {
            Processing::AsSampled => {}
            Processing::LowPass { corner_hz } => {
                let passed = low_pass(values, self.rate_hz, corner_hz);
                debug_assert!(passed.is_ok(), "a corner of {corner_hz} Hz: {passed:?}");
                if let Ok(passed) = passed {
                    *values = passed;
                }
            }
            Processing::Mean { samples } => *values = sliding_mean(values, samples),
        }
    }

    /// Adds the noise of the thermometer.
    pub(super) fn read_temperature(noise_k: f64, values_degc: &mut [f64], seed: u64) {
        // A hundredth of a kelvin is what a display shows.
        let channel = Channel { range: 1000.0, noise: noise_k, bits: 0 };
        channel.add_noise(values_degc, &mut Random::new(seed, 4));
        for value in values_degc {
            *value = 0.01 * libm::rint(100.0 * *value);
        }
    }
}

impl Channel {
    fn add_noise(&self, values: &mut [f64], random: &mut Random) {
        for value in values {
            *value += self.noise * random.gaussian();
        }
    }

    fn quantise(&self, values: &mut [f64]) {
        let step =
            if self.bits == 0 { 0.0 } else { 2.0 * self.range / libm::exp2(f64::from(self.bits)) };
        for value in values {
            if step > 0.0 {
                *value = step * libm::rint(*value / step);
            }
            *value = value.clamp(-self.range, self.range);
        }
    }
}

/// Adds noise whose neighbouring values have the correlation `keep`.
fn add_correlated(values: &mut [f64], level: f64, keep: f64, random: &mut Random) {
    let fresh = (1.0 - keep * keep).sqrt();
    let mut noise = random.gaussian();
    for value in values {
        *value += level * noise;
        noise = keep * noise + fresh * random.gaussian();
    }
}

/// The next of 1, 2, 5 times a power of ten.
fn next_range(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let decade = libm::pow(10.0, libm::floor(libm::log10(least)));
    let found = [1.0, 2.0, 5.0].into_iter().find(|step| step * decade >= least);
    found.unwrap_or(10.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::statistics::{mean, rms};

    #[test]
    fn noise_has_its_level_and_its_colour() {
        let mut sensors = Sensors::of_range(50e3, 0.1);
        sensors.coloured = Some(Coloured { level_n: 200.0, rho_per_ms: 0.9 });
        let mut force = vec![1000.0; 100_000];
        sensors.read_force(&mut force, 5);
        let noise: Vec<f64> = force.iter().map(|f| f - 1000.0).collect();
        let expected = (200.0f64 * 200.0 + 50.0 * 50.0).sqrt();
        assert!((rms(&noise) / expected - 1.0).abs() < 0.05, "{}", rms(&noise));
        assert!(mean(&noise).abs() < 12.0, "{}", mean(&noise));
        let lagged: f64 =
            noise.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / noise.len() as f64;
        assert!((lagged / (0.9 * 200.0 * 200.0) - 1.0).abs() < 0.05, "{lagged}");
        let mut again = vec![1000.0; 100_000];
        sensors.read_force(&mut again, 5);
        assert!(force == again);
    }

    #[test]
    fn a_drift_is_slow_and_a_recorder_processes_the_noise_too() {
        let mut sensors = Sensors { drift: None, ..Sensors::of_range(50e3, 0.1) };
        sensors.drift = Some(Drift { level_n: 300.0, corner_hz: 0.2 });
        sensors.force.noise = 0.0;
        let mut force = vec![0.0; 2_000_000];
        sensors.read_force(&mut force, 5);
        assert!((rms(&force) / 300.0 - 1.0).abs() < 0.1, "{}", rms(&force));
        let steps: Vec<f64> = force.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(rms(&steps) < 20.0, "{}", rms(&steps));
        for (processing, share) in [
            (Processing::Mean { samples: 16 }, 0.25),
            // The noise bandwidth of four poles is 1.026 times the corner.
            (Processing::LowPass { corner_hz: 50.0 }, (2.0 * 1.026 * 0.05_f64).sqrt()),
        ] {
            let sensors = Sensors { processing, ..Sensors::of_range(50e3, 0.1) };
            let mut force = vec![0.0; 200_000];
            sensors.read_force(&mut force, 5);
            assert!((rms(&force) / 50.0 / share - 1.0).abs() < 0.03, "{processing:?}");
        }
    }

    #[test]
    fn a_quantiser_has_steps_and_ends() {
        let channel = Channel { range: 8.0, noise: 0.0, bits: 4 };
        let mut values = [0.4, 0.6, -7.7, 9.0, -30.0];
        channel.quantise(&mut values);
        assert_eq!(values, [0.0, 1.0, -8.0, 8.0, -8.0]);
    }

    #[test]
    fn both_channels_are_delayed_alike() {
        let sensors = Sensors::of_range(1e3, 1.0);
        let fine: Vec<f64> = (0..50_000).map(|n| libm::sin(1e-3 * f64::from(n))).collect();
        let double: Vec<f64> = fine.iter().map(|v| 2.0 * v).collect();
        let (one, two) = (sensors.sample(&fine, 50), sensors.sample(&double, 50));
        assert_eq!(one.len(), 1000);
        assert!(one.iter().zip(&two).all(|(a, b)| (2.0 * a - b).abs() < 1e-12));
        // Four poles at 400 Hz delay by 2.61/(2 pi 400 Hz).
        let delay_s = 2.613 / (std::f64::consts::TAU * 400.0);
        let expected = libm::sin(1e-3 * (500.0 * 50.0 - delay_s * 50e3));
        assert!((one[500] - expected).abs() < 1e-3, "{} {expected}", one[500]);
    }
}
