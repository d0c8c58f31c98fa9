//! Which tests a visit makes.
//!
//! [`full`] is a visit with five minutes of records and a test for every effect that can be
//! distinguished on a bench: warm-up, static holds approached from both sides, slow triangles, an
//! amplitude sweep at the working frequency of a yaw damper, a frequency sweep at small amplitude,
//! repeats away from mid-stroke, relaxation after a ramp, the first sine again, and a random record
//! for testing only. [`short`] is what a campaign of many visits can afford. Strokes and speeds are
//! those of a yaw damper of the SS9's class; other lists come from a file ([`super::test_list`]).

use crate::excitation::{Excitation, Leg, Tone};
use signal::random::Random;

/// Time to speed up and slow down at every reversal of a triangle, s.
pub const ROUNDING_S: f64 = 0.05;

/// One test of a visit.
#[derive(Debug, Clone, PartialEq)]
pub struct Test {
    /// Its name, and that of its file.
    pub name: String,
    /// What the actuator does.
    pub excitation: Excitation,
    /// Position around which it does so, m.
    pub mean_m: f64,
    /// How long it is recorded, s.
    pub duration_s: f64,
    /// It is meant to test a model, not to fit it.
    pub test_only: bool,
}

impl Test {
    /// A test around mid-stroke, for fitting.
    pub fn new(name: impl Into<String>, excitation: Excitation, duration_s: f64) -> Self {
        Self { name: name.into(), excitation, mean_m: 0.0, duration_s, test_only: false }
    }

    /// Name of the CSV file of its record.
    pub fn csv_name(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// A test as long as its path.
    fn along(name: &str, excitation: Excitation) -> Self {
        let duration_s = excitation.end_s().unwrap_or(0.0);
        Self::new(name, excitation, duration_s)
    }

    /// A sine for at least `seconds` and four whole cycles after it has risen.
    fn sine(name: &str, amplitude_mm: f64, frequency_hz: f64, seconds: f64) -> Self {
        let cycles = libm::ceil((seconds * frequency_hz - 1.5).max(4.0)) + 1.5;
        let excitation = Excitation::sine(1e-3 * amplitude_mm, frequency_hz);
        Self::new(name, excitation, cycles / frequency_hz)
    }

    fn around(mut self, mean_m: f64) -> Self {
        self.mean_m = mean_m;
        self
    }

    fn test_only(mut self) -> Self {
        self.test_only = true;
        self
    }
}

/// The whole visit.
pub fn full() -> Vec<Test> {
    let mut tests = vec![
        Test::sine("warm-up", 10.0, 1.0, 4.5),
        Test::sine("sine-3.5hz-3.46mm", 3.46, 3.5, 6.0),
        Test::along("static-holds", static_holds(&[-40e-3, 0.0, 40e-3], 0.02, 5e-3, 3.0)),
        Test::along("triangle-2mm-s", Excitation::triangle(5e-3, 2e-3, 2, ROUNDING_S)),
        Test::along("triangle-5mm-s", Excitation::triangle(10e-3, 5e-3, 2, ROUNDING_S)),
        Test::along("triangle-20mm-s", Excitation::triangle(20e-3, 20e-3, 3, ROUNDING_S)),
    ];
    for amplitude_mm in [0.5, 0.8, 1.5, 2.5, 5.0, 8.0] {
        tests.push(Test::sine(&format!("sine-3.5hz-{amplitude_mm}mm"), amplitude_mm, 3.5, 6.0));
    }
    for frequency_hz in [0.5, 1.0, 2.0, 3.5, 6.0, 9.0, 12.0] {
        tests.push(Test::sine(&format!("sine-{frequency_hz}hz-1mm"), 1.0, frequency_hz, 6.0));
    }
    for (name, mean_m) in [("plus", 40e-3), ("minus", -40e-3)] {
        let test = Test::sine(&format!("sine-3.5hz-3.46mm-{name}-40mm"), 3.46, 3.5, 6.0);
        tests.push(test.around(mean_m));
    }
    let ramp = Leg { to_m: 5e-3, speed_m_per_s: 0.02, hold_s: 30.0 };
    tests.push(Test::along("relaxation", Excitation::path(&[ramp], ROUNDING_S)));
    tests.push(Test::sine("sine-3.5hz-3.46mm-repeated", 3.46, 3.5, 6.0));
    tests.push(Test::new("service", service(2e-3, 0.5, 12.0, 40, 2014), 20.0).test_only());
    tests
}

/// Ten tests in about a minute.
///
/// ```
/// let tests = virtual_bench::bench_visit::protocol::short();
/// assert_eq!(tests.len(), 10);
/// assert!(tests.iter().all(|test| (3.5..10.0).contains(&test.duration_s)));
/// ```
pub fn short() -> Vec<Test> {
    let leg = |to_m, hold_s| Leg { to_m, speed_m_per_s: 0.02, hold_s };
    let ramps = [leg(4e-3, 1.5), leg(-4e-3, 1.5), leg(4e-3, 1.5), leg(0.0, 1.5)];
    vec![
        Test::sine("sine-3.5hz-3.46mm", 3.46, 3.5, 5.0),
        Test::along("triangle-5mm-s", Excitation::triangle(5e-3, 5e-3, 2, ROUNDING_S)),
        Test::along("triangle-20mm-s", Excitation::triangle(20e-3, 20e-3, 2, ROUNDING_S)),
        Test::sine("sine-3.5hz-1mm", 1.0, 3.5, 5.0),
        Test::sine("sine-3.5hz-8mm", 8.0, 3.5, 5.0),
        Test::sine("sine-1hz-1.5mm", 1.5, 1.0, 7.5),
        Test::sine("sine-10hz-1mm", 1.0, 10.0, 4.0),
        Test::sine("sine-3.5hz-3.46mm-plus-40mm", 3.46, 3.5, 5.0).around(40e-3),
        Test::along("ramps", Excitation::path(&ramps, ROUNDING_S)),
        Test::new("service", service(2e-3, 0.5, 12.0, 24, 2014), 8.0).test_only(),
    ]
}

/// Holds at several rising positions, reached from below on the way up and from above on the way
/// down.
pub fn static_holds(
    positions_m: &[f64],
    speed_m_per_s: f64,
    approach_m: f64,
    hold_s: f64,
) -> Excitation {
    let leg = |to_m, hold_s| Leg { to_m, speed_m_per_s, hold_s };
    let mut legs = Vec::new();
    if let (Some(first), Some(last)) = (positions_m.first(), positions_m.last()) {
        legs.push(leg(first - approach_m, 0.0));
        legs.extend(positions_m.iter().map(|at_m| leg(*at_m, hold_s)));
        legs.push(leg(last + approach_m, 0.0));
        legs.extend(positions_m.iter().rev().map(|at_m| leg(*at_m, hold_s)));
    }
    Excitation::path(&legs, ROUNDING_S)
}

/// A random record as of service: tones evenly spread between two frequencies, of random phase,
/// whose amplitude falls as one over the frequency (a velocity of constant density), of this rms in
/// all.
pub fn service(rms_m: f64, lowest_hz: f64, highest_hz: f64, tones: usize, seed: u64) -> Excitation {
    let mut random = Random::new(seed, 0);
    let spacing_hz = (highest_hz - lowest_hz) / (tones.max(2) - 1) as f64;
    let mut tones: Vec<Tone> = (0..tones)
        .map(|index| {
            // Off the grid by up to a third of a spacing, so that the record has no short period.
            let off = if index == 0 { 0.0 } else { random.between(-0.33, 0.33) };
            let frequency_hz = lowest_hz + spacing_hz * (index as f64 + off);
            Tone { amplitude_m: 1.0 / frequency_hz, frequency_hz, phase_rad: random.phase() }
        })
        .collect();
    let square: f64 = tones.iter().map(|tone| 0.5 * tone.amplitude_m * tone.amplitude_m).sum();
    for tone in &mut tones {
        tone.amplitude_m *= rms_m / square.sqrt();
    }
    Excitation::Tones { tones, run_in_s: 1.0 }
}

/// Peak speed (m/s) and farthest position (m) of a list of tests; for tones upper bounds.
pub fn reach(tests: &[Test]) -> (f64, f64) {
    tests.iter().fold((0.0, 0.0), |(speed, way), test| {
        let (v, x) = test.excitation.reach();
        (v.max(speed), (x + test.mean_m.abs()).max(way))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use measurement::{Measurement, Series};
    use signal::statistics::rms;

    #[test]
    fn names_differ_and_a_visit_takes_minutes() {
        for (tests, least_s, most_s) in [(full(), 200.0, 420.0), (short(), 45.0, 75.0)] {
            let total: f64 = tests.iter().map(|test| test.duration_s).sum();
            assert!((least_s..most_s).contains(&total), "{total} s");
            for (index, test) in tests.iter().enumerate() {
                assert!(
                    tests[..index].iter().all(|other| other.name != test.name),
                    "{}",
                    test.name
                );
            }
            assert_eq!(tests.iter().filter(|test| test.test_only).count(), 1);
            for test in &tests {
                let count = (500.0 * test.duration_s) as usize;
                let x = (0..count).map(|n| test.excitation.displacement_m(n as f64 * 2e-3));
                let x: Vec<f64> = x.collect();
                // Any force will do: the record has to be fit to be read.
                let series = Series::sampled(&test.name, 500.0, x.clone(), x);
                let read = Measurement::from_series(series);
                assert!(read.is_ok(), "{}: {read:?}", test.name);
            }
            let (speed, way) = reach(&tests);
            assert!(speed < 1.0 && way < 0.1, "{speed} {way}");
        }
    }

    #[test]
    fn a_service_record_has_its_rms() {
        let record = service(2e-3, 0.5, 12.0, 40, 7);
        let x: Vec<f64> =
            (0..200_000).map(|n| record.displacement_m(1.0 + 1e-3 * f64::from(n))).collect();
        assert!((rms(&x) / 2e-3 - 1.0).abs() < 0.02, "{}", rms(&x));
    }

    #[test]
    fn holds_are_approached_from_both_sides() {
        let holds = static_holds(&[-10e-3, 10e-3], 0.02, 5e-3, 3.0);
        let end = holds.end_s().unwrap();
        assert_eq!(holds.at(end - 0.1), (-10e-3, 0.0));
        let (x, v) = holds.at(end - 3.1);
        assert!(x > -10e-3 && v < 0.0, "{x} {v}");
        // 15 mm down, 5 mm up.
        let (x, v) = holds.at(0.9);
        assert!(x < -10e-3 && v > 0.0, "{x} {v}");
    }
}
