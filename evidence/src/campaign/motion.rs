//! The tests of a case: those to fit, those held out, and a third set that neither the search nor
//! the gate sees.
//!
//! Every motion has six tests to fit (sines seven), two to hold out and two of the third set, of a
//! yaw damper's size, with an amplitude and a frequency that the case draws. One test to fit is
//! about another middle, except for earthquakes. The third set ends with a test of another motion,
//! made small enough to stay within the speed and the stroke of the tests to fit.

use super::design::Motion;
use signal::random::Random;
use virtual_bench::bench_visit::protocol::{ROUNDING_S, Test, service};
use virtual_bench::excitation::{Excitation, Stretch, Sweep, Tone};

/// Middle of the test away from mid-stroke, mm.
const OFF_MIDDLE_MM: f64 = 40.0;
/// Share of the range of the tests to fit that the test of another motion uses.
const WITHIN: f64 = 0.95;
/// Sampling in which ranges are looked at, s.
const STEP_S: f64 = 2e-3;
/// Steps of the table that a motion of many tones is read from, s.
const TABLE_S: f64 = 1e-3;
/// Tones of random motion and of an earthquake.
const TONES: usize = 32;
/// Length of a random test and of a sweep, s.
const RANDOM_S: f64 = 4.8;
/// Tests to fit of a brief case.
const BRIEF_TESTS: usize = 5;

/// The tests of a case in the order of the visit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tests {
    /// To fit.
    pub train: Vec<Test>,
    /// Held out: the gate sees them.
    pub holdout: Vec<Test>,
    /// For the score alone.
    pub third: Vec<Test>,
}

/// How far tests go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Greatest speed, m/s.
    pub speed_m_per_s: f64,
    /// Greatest distance from the middle of a test, m.
    pub stroke_m: f64,
    /// Farthest position in extension, m.
    pub extension_m: f64,
    /// Farthest position in compression, m.
    pub compression_m: f64,
}

impl Extent {
    /// That of some tests.
    pub(super) fn of(tests: &[Test]) -> Self {
        let mut extent =
            Self { speed_m_per_s: 0.0, stroke_m: 0.0, extension_m: 0.0, compression_m: 0.0 };
        for test in tests {
            for step in 0..(test.duration_s / STEP_S) as usize {
                let (x, v) = test.excitation.at(step as f64 * STEP_S);
                extent.speed_m_per_s = extent.speed_m_per_s.max(v.abs());
                extent.stroke_m = extent.stroke_m.max(x.abs());
                extent.extension_m = extent.extension_m.max(test.mean_m + x);
                extent.compression_m = extent.compression_m.max(-test.mean_m - x);
            }
        }
        extent
    }
}

/// Sizes that a case draws.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    /// A millimetre of the list of tests, m.
    mm: f64,
    /// A hertz of the list of tests, Hz.
    hz: f64,
    /// Seed of random motions.
    seed: u64,
}

impl Tests {
    /// The tests of a motion for a damper of a scale.
    pub(super) fn draw(motion: Motion, scale: f64, brief: bool, random: &mut Random) -> Self {
        let (stretch, hz) = (random.between(0.8, 1.25), random.between(0.9, 1.1));
        let seed = (random.uniform() * 1e9) as u64;
        let sizes = Sizes { mm: 1e-3 * scale * stretch, hz, seed };
        let others: Vec<Motion> =
            Motion::ALL.into_iter().filter(|other| *other != motion).collect();
        let other = (random.uniform() * others.len() as f64) as usize;
        let other = others[other.min(others.len() - 1)];
        let [mut train, mut holdout, mut third] = lists(motion, sizes);
        if brief {
            // The first one and those at the end, of which one is away from mid-stroke.
            train.drain(1..=train.len() - BRIEF_TESTS);
        }
        for test in &mut holdout {
            test.test_only = true;
        }
        third.extend(within(&Extent::of(&train), other, sizes));
        for test in &mut third {
            test.test_only = true;
        }
        Self { train, holdout, third }
    }

    /// All of them in the order of the visit.
    pub(super) fn all(&self) -> Vec<Test> {
        [&self.train[..], &self.holdout, &self.third].concat()
    }
}

/// A test of another motion within an extent.
fn within(extent: &Extent, other: Motion, sizes: Sizes) -> Option<Test> {
    let first = |sizes: Sizes| lists(other, sizes)[2].first().cloned();
    let own = Extent::of(&[first(sizes)?]);
    let room =
        (extent.speed_m_per_s / own.speed_m_per_s).min(extent.stroke_m / own.stroke_m).min(1.0);
    let mut test = first(Sizes { mm: WITHIN * room * sizes.mm, ..sizes })?;
    test.name = format!("other-{}", test.name);
    Some(test)
}

/// The three lists of a motion.
fn lists(motion: Motion, sizes: Sizes) -> [Vec<Test>; 3] {
    match motion {
        Motion::Sines => {
            let mut train: Vec<Test> = [
                (3.46, 3.5, 12.5),
                (1.0, 3.5, 11.5),
                (8.0, 3.5, 12.5),
                (1.5, 1.0, 4.5),
                (1.0, 10.0, 25.5),
            ]
            .map(|of| sine(of, sizes))
            .into();
            train.push(off_middle(sine((3.46, 3.5, 11.5), sizes), sizes));
            let (stroke_m, speed) = (5.0 * sizes.mm, 15.0 * sizes.mm * sizes.hz);
            let triangle = Excitation::triangle(stroke_m, speed, 2, ROUNDING_S);
            train.push(along("triangle", triangle));
            let holdout = [(5.0, 3.5, 11.5), (2.0, 2.0, 7.5)].map(|of| sine(of, sizes));
            let third = [(2.2, 5.0, 16.5), (6.0, 2.5, 8.5)].map(|of| sine(of, sizes));
            [train, holdout.into(), third.into()]
        }
        Motion::Tapered => {
            let mut train: Vec<Test> = [
                (3.46, 2.0, [2, 3, 2]),
                (8.0, 2.5, [3, 3, 3]),
                (15.0, 1.2, [2, 2, 2]),
                (1.5, 4.0, [5, 5, 5]),
                (1.0, 8.0, [9, 8, 9]),
            ]
            .map(|of| tapered(of, sizes))
            .into();
            train.push(off_middle(tapered((3.46, 2.0, [2, 3, 2]), sizes), sizes));
            let holdout =
                [(5.0, 2.0, [2, 3, 2]), (2.0, 3.0, [3, 4, 3])].map(|of| tapered(of, sizes));
            let third =
                [(2.5, 2.5, [3, 4, 3]), (10.0, 1.4, [2, 2, 2])].map(|of| tapered(of, sizes));
            [train, holdout.into(), third.into()]
        }
        Motion::Short => {
            let mut train: Vec<Test> = [
                (3.46, 3.5, [5, 4]),
                (1.0, 3.5, [4, 3]),
                (8.0, 3.5, [4, 3]),
                (2.0, 2.0, [3, 3]),
                (1.0, 8.0, [5, 5]),
            ]
            .map(|of| short(of, sizes))
            .into();
            train.push(off_middle(short((3.46, 3.5, [4, 4]), sizes), sizes));
            let holdout = [(5.0, 3.0, [4, 3]), (2.0, 2.5, [4, 3])].map(|of| short(of, sizes));
            let third = [(2.5, 4.0, [5, 3]), (6.0, 2.5, [3, 4])].map(|of| short(of, sizes));
            [train, holdout.into(), third.into()]
        }
        Motion::Random => {
            let mut train: Vec<Test> = [
                (2.0, 0.5, 12.0),
                (1.0, 0.5, 12.0),
                (3.5, 0.3, 6.0),
                (0.7, 1.0, 20.0),
                (2.0, 0.5, 8.0),
            ]
            .into_iter()
            .enumerate()
            .map(|(index, of)| random(index, of, sizes))
            .collect();
            train.push(off_middle(random(5, (2.0, 0.5, 8.0), sizes), sizes));
            let holdout =
                vec![random(6, (1.5, 0.5, 10.0), sizes), random(7, (2.5, 0.4, 8.0), sizes)];
            let third = vec![random(8, (1.2, 0.5, 12.0), sizes), random(9, (3.0, 0.4, 7.0), sizes)];
            [train, holdout, third]
        }
        Motion::Sweep => {
            let mut train: Vec<Test> = [
                (8.0, 0.5, 10.0),
                (3.0, 0.6, 14.0),
                (1.2, 0.8, 20.0),
                (12.0, 0.4, 6.0),
                (4.0, 12.0, 0.6),
            ]
            .map(|of| sweep(of, sizes))
            .into();
            train.push(off_middle(sweep((4.0, 0.6, 10.0), sizes), sizes));
            let holdout = [(6.0, 0.5, 12.0), (2.0, 10.0, 0.7)].map(|of| sweep(of, sizes));
            let third = [(5.0, 0.5, 12.0), (2.5, 12.0, 0.6)].map(|of| sweep(of, sizes));
            [train, holdout.into(), third.into()]
        }
        Motion::Earthquake => {
            let of = |first: usize, peaks_mm: &[f64]| -> Vec<Test> {
                let each = peaks_mm.iter().enumerate();
                each.map(|(index, peak)| earthquake(first + index, *peak, sizes)).collect()
            };
            [of(0, &[8.0, 14.0, 3.0, 22.0, 5.0, 10.0]), of(6, &[11.0, 4.0]), of(8, &[6.0, 16.0])]
        }
    }
}

fn along(name: &str, excitation: Excitation) -> Test {
    let duration_s = excitation.end_s().unwrap_or(0.0);
    Test::new(name, excitation, duration_s)
}

fn off_middle(mut test: Test, sizes: Sizes) -> Test {
    test.mean_m = OFF_MIDDLE_MM * sizes.mm;
    test.name.push_str("-off-middle");
    test
}

fn sine((amplitude, hz, cycles): (f64, f64, f64), Sizes { mm, hz: unit_hz, .. }: Sizes) -> Test {
    let frequency_hz = hz * unit_hz;
    let excitation = Excitation::sine(mm * amplitude, frequency_hz);
    Test::new(format!("sine-{amplitude}mm-{hz}hz"), excitation, cycles / frequency_hz)
}

/// One tone that starts at rest in its middle.
fn tone(amplitude_m: f64, frequency_hz: f64) -> Vec<Tone> {
    vec![Tone { amplitude_m, frequency_hz, phase_rad: 0.0 }]
}

/// Cycles that grow, stay and fade.
fn tapered((amplitude, hz, cycles): (f64, f64, [usize; 3]), sizes: Sizes) -> Test {
    let frequency_hz = hz * sizes.hz;
    let [rise_s, stay_s, fall_s] = cycles.map(|cycles| cycles as f64 / frequency_hz);
    let envelope = vec![Stretch { start_s: 0.0, rise_s, stay_s, fall_s, level: 1.0 }];
    let excitation =
        Excitation::Enveloped { tones: tone(sizes.mm * amplitude, frequency_hz), envelope };
    along(&format!("tapered-{amplitude}mm-{hz}hz"), excitation)
}

/// Bursts of whole cycles that rise and fall within half a cycle, each with a level of its own,
/// between rests of whole cycles of at least half a second.
fn short((amplitude, hz, bursts): (f64, f64, [usize; 2]), sizes: Sizes) -> Test {
    let frequency_hz = hz * sizes.hz;
    let period_s = 1.0 / frequency_hz;
    let rest_s = libm::ceil(0.5 * frequency_hz) * period_s;
    let mut envelope: Vec<Stretch> = Vec::new();
    let mut start_s = rest_s;
    let levels = [1.0, 0.5];
    for (cycles, level) in bursts.into_iter().zip(levels) {
        let half_s = 0.5 * period_s;
        let stay_s = cycles as f64 * period_s;
        let burst = Stretch { start_s, rise_s: half_s, stay_s, fall_s: half_s, level };
        start_s = burst.end_s() + rest_s;
        envelope.push(burst);
    }
    let excitation =
        Excitation::Enveloped { tones: tone(sizes.mm * amplitude, frequency_hz), envelope };
    Test::new(format!("short-{amplitude}mm-{hz}hz"), excitation, start_s)
}

fn random(index: usize, (rms, lowest, highest): (f64, f64, f64), sizes: Sizes) -> Test {
    let seed = sizes.seed.wrapping_add(index as u64);
    let (lowest_hz, highest_hz) = (lowest * sizes.hz, highest * sizes.hz);
    let excitation = service(sizes.mm * rms, lowest_hz, highest_hz, TONES, seed);
    let excitation = excitation.sampled(RANDOM_S, TABLE_S);
    Test::new(format!("random-{index}"), excitation, RANDOM_S)
}

fn sweep((amplitude, from, to): (f64, f64, f64), sizes: Sizes) -> Test {
    let sweep = Sweep {
        amplitude_m: sizes.mm * amplitude,
        from_hz: from * sizes.hz,
        to_hz: to * sizes.hz,
        corner_hz: 2.0,
        duration_s: RANDOM_S,
    };
    along(&format!("sweep-{amplitude}mm-{from}hz-{to}hz"), Excitation::Sweep(sweep))
}

/// Ground motion filtered by soil (Kanai and Tajimi), without its slowest part, under an envelope
/// that rises quickly and fades slowly; amplitudes and phases are those of Gaussian noise.
fn earthquake(index: usize, peak_mm: f64, sizes: Sizes) -> Test {
    let mut random = Random::new(sizes.seed.wrapping_add(index as u64), 4);
    let (soil_hz, damping) = (sizes.hz * random.between(1.8, 3.2), random.between(0.4, 0.7));
    let (lowest_hz, highest_hz, slow_hz) = (0.25, 9.0, 0.6);
    let spacing_hz = (highest_hz - lowest_hz) / TONES as f64;
    let tones = (0..TONES).map(|line| {
        let frequency_hz = lowest_hz + spacing_hz * (line as f64 + random.uniform());
        let (soil, slow) = (frequency_hz / soil_hz, frequency_hz / slow_hz);
        let damped = 4.0 * damping * damping * soil * soil;
        let resonance = (1.0 - soil * soil) * (1.0 - soil * soil) + damped;
        let density = (1.0 + damped) / resonance * (slow * slow) / (1.0 + slow * slow);
        // An amplitude of Gaussian noise, of the displacement.
        let amplitude = (-2.0 * libm::log(random.uniform())).sqrt() * density.sqrt();
        Tone {
            amplitude_m: amplitude / (frequency_hz * frequency_hz),
            frequency_hz,
            phase_rad: random.phase(),
        }
    });
    let mut tones: Vec<Tone> = tones.collect();
    let stretch = Stretch { start_s: 0.0, rise_s: 0.8, stay_s: 1.4, fall_s: 3.0, level: 1.0 };
    let envelope = vec![stretch];
    let motion = |tones: &[Tone]| Excitation::Enveloped {
        tones: tones.to_vec(),
        envelope: envelope.clone(),
    };
    let name = format!("earthquake-{index}");
    let peak_m = Extent::of(&[along(&name, motion(&tones))]).stroke_m;
    for tone in &mut tones {
        tone.amplitude_m *= sizes.mm * peak_mm / peak_m;
    }
    along(&name, motion(&tones).sampled(stretch.end_s(), TABLE_S))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_has_three_lists_of_a_few_seconds_whose_names_differ() {
        for motion in Motion::ALL {
            for seed in 0..8 {
                let tests = Tests::draw(motion, 1.0, false, &mut Random::new(seed, 0));
                assert!((6..=7).contains(&tests.train.len()) && tests.holdout.len() == 2);
                assert_eq!(tests.third.len(), 3);
                let all = tests.all();
                for (index, test) in all.iter().enumerate() {
                    let (length_s, name) = (test.duration_s, &test.name);
                    assert!((2.0..7.5).contains(&length_s), "{name}: {length_s} s");
                    assert!(all[..index].iter().all(|other| other.name != *name), "{name}");
                }
                let total: f64 = tests.train.iter().map(|test| test.duration_s).sum();
                assert!((20.0..36.0).contains(&total), "{motion:?}: {total} s");
            }
        }
    }

    #[test]
    fn the_third_set_ends_with_another_motion_within_the_range_of_training() {
        for motion in Motion::ALL {
            for seed in 0..8 {
                let tests = Tests::draw(motion, 1.0, false, &mut Random::new(seed, 0));
                let (whole, last) = (Extent::of(&tests.train), tests.third.last().unwrap());
                let own = Extent::of(std::slice::from_ref(last));
                assert!(last.name.starts_with("other-"), "{}", last.name);
                assert!(own.stroke_m < whole.stroke_m, "{own:?} {whole:?}");
                assert!(own.speed_m_per_s < whole.speed_m_per_s, "{own:?} {whole:?}");
            }
        }
    }

    #[test]
    fn motions_have_the_speeds_and_strokes_of_a_yaw_damper() {
        for motion in Motion::ALL {
            let tests = Tests::draw(motion, 1.0, false, &mut Random::new(3, 0));
            let Extent { speed_m_per_s, stroke_m, .. } = Extent::of(&tests.train);
            println!("{motion:?}: {speed_m_per_s} m/s, {stroke_m} m");
            assert!((0.06..0.5).contains(&speed_m_per_s), "{motion:?}: {speed_m_per_s}");
            assert!((5e-3..30e-3).contains(&stroke_m), "{motion:?}: {stroke_m}");
        }
    }
}
