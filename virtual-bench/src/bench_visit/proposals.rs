//! Tests that a bench could run, within its stroke, speed and force: the choice from which the next
//! test of an identification is taken.
//!
//! Sines at five amplitudes and seven frequencies, three of them about another middle; triangles at
//! five speeds; holds at three positions; one random motion. Each has the text with which a test
//! list states it.

use super::protocol::{Test, service, static_holds};
use crate::excitation::Excitation;

/// What the rig can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigLimits {
    /// Farthest displacement to either side, m.
    pub stroke_m: f64,
    /// Highest speed, m/s.
    pub speed_m_per_s: f64,
}

/// A test and its text in a test list.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// The test.
    pub test: Test,
    /// The `[[test]]` of a list.
    pub text: String,
}

/// Amplitudes, as shares of the stroke.
const AMPLITUDES: [f64; 5] = [0.05, 0.12, 0.3, 0.6, 0.95];
const FREQUENCIES_HZ: [f64; 7] = [0.2, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Speeds of triangles, as shares of the highest.
const SPEEDS: [f64; 5] = [0.02, 0.06, 0.2, 0.5, 0.95];
/// Shortest test with enough cycles, s, and cycles of a slow one.
const SHORTEST_S: f64 = 10.0;
const CYCLES: f64 = 5.0;
/// Longest test, s: a longer one would outweigh all others.
const LONGEST_S: f64 = 30.0;
/// Seed of the random motion.
const SEED: u64 = 7;

/// All tests within the limits.
pub fn proposals(limits: &RigLimits) -> Vec<Proposal> {
    let mut all = Vec::new();
    for share in AMPLITUDES {
        for frequency_hz in FREQUENCIES_HZ {
            all.extend(sine(share * limits.stroke_m, frequency_hz, 0.0, limits));
        }
    }
    for frequency_hz in [0.3, 1.0, 4.0] {
        for side in [-0.6, 0.6] {
            all.extend(sine(0.3 * limits.stroke_m, frequency_hz, side * limits.stroke_m, limits));
        }
    }
    for share in SPEEDS {
        all.extend(triangle(0.6 * limits.stroke_m, share * limits.speed_m_per_s));
    }
    all.extend(holds(limits));
    all.push(random(limits));
    all
}

fn sine(amplitude_m: f64, frequency_hz: f64, mean_m: f64, limits: &RigLimits) -> Option<Proposal> {
    let speed = amplitude_m * std::f64::consts::TAU * frequency_hz;
    let duration_s = (CYCLES / frequency_hz).max(SHORTEST_S);
    if speed > limits.speed_m_per_s || duration_s > LONGEST_S {
        return None;
    }
    let about = if mean_m == 0.0 { String::new() } else { format!("-about-{:.3}mm", mean_m * 1e3) };
    let name = format!("sine-{frequency_hz}hz-{:.3}mm{about}", amplitude_m * 1e3);
    let mut test = Test::new(&name, Excitation::sine(amplitude_m, frequency_hz), duration_s);
    test.mean_m = mean_m;
    let text = format!(
        "[[test]]\nname = \"{name}\"\nsine = {{ amplitude_m = {amplitude_m:e}, \
         frequency_hz = {frequency_hz:?} }}\nmean_m = {mean_m:e}\nduration_s = {duration_s:?}\n"
    );
    Some(Proposal { test, text })
}

fn triangle(stroke_m: f64, speed_m_per_s: f64) -> Option<Proposal> {
    let cycles = 3;
    let excitation =
        Excitation::triangle(stroke_m, speed_m_per_s, cycles, super::protocol::ROUNDING_S);
    let duration_s = excitation.end_s()?;
    if duration_s > LONGEST_S {
        return None;
    }
    let name = format!("triangle-{:.3}mm-{:.3}mmps", stroke_m * 1e3, speed_m_per_s * 1e3);
    let text = format!(
        "[[test]]\nname = \"{name}\"\ntriangle = {{ stroke_m = {stroke_m:e}, speed_m_per_s = \
         {speed_m_per_s:e}, cycles = {cycles} }}\n"
    );
    Some(Proposal { test: Test::new(name, excitation, duration_s), text })
}

/// Three positions, each approached from both sides.
fn holds(limits: &RigLimits) -> Option<Proposal> {
    let positions_m = [-0.6, 0.0, 0.6].map(|share| share * limits.stroke_m);
    let (speed, approach_m, hold_s) = (0.3 * limits.speed_m_per_s, 0.2 * limits.stroke_m, 1.0);
    let excitation = static_holds(&positions_m, speed, approach_m, hold_s);
    let duration_s = excitation.end_s().filter(|end_s| *end_s <= LONGEST_S)?;
    let name = "holds".to_owned();
    let text = format!(
        "[[test]]\nname = \"{name}\"\nholds = {{ positions_m = [{:e}, {:e}, {:e}], \
         speed_m_per_s = {speed:e}, approach_m = {approach_m:e}, hold_s = {hold_s:?} }}\n",
        positions_m[0], positions_m[1], positions_m[2]
    );
    Some(Proposal { test: Test::new(name, excitation, duration_s), text })
}

fn random(limits: &RigLimits) -> Proposal {
    let (lowest_hz, highest_hz, tones, duration_s) = (0.3, 6.0, 24, 20.0);
    // Peaks of random motion are about four times its rms.
    let fastest = std::f64::consts::TAU * 2.0;
    let rms_m = (0.25 * limits.stroke_m).min(0.25 * limits.speed_m_per_s / fastest);
    let excitation = service(rms_m, lowest_hz, highest_hz, tones, SEED);
    let name = "random".to_owned();
    let text = format!(
        "[[test]]\nname = \"{name}\"\nservice = {{ rms_m = {rms_m:e}, lowest_hz = {lowest_hz:?}, \
         highest_hz = {highest_hz:?}, tones = {tones}, seed = {SEED} }}\n\
         duration_s = {duration_s:?}\n"
    );
    Proposal { test: Test::new(name, excitation, duration_s), text }
}

impl Proposal {
    /// Displacement of the test at a sampling rate, m.
    pub fn displacement_m(&self, rate_hz: f64) -> Vec<f64> {
        let count = (self.test.duration_s * rate_hz) as usize;
        let at = |n: usize| self.test.excitation.displacement_m(n as f64 / rate_hz);
        (0..count).map(|n| self.test.mean_m + at(n)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench_visit::test_list::TestList;
    use scenario::source::Source;
    use std::path::Path;

    #[test]
    fn a_slow_rig_of_long_stroke_got_holds_of_hours() {
        for (stroke_m, speed_m_per_s) in [(1.0, 1e-4), (1.0, 10.0), (1e-4, 1e-4), (1e-4, 10.0)] {
            let all = proposals(&RigLimits { stroke_m, speed_m_per_s });
            let mut names: Vec<&str> = all.iter().map(|one| one.test.name.as_str()).collect();
            names.sort_unstable();
            assert!(!names.is_empty() && names.windows(2).all(|pair| pair[0] != pair[1]));
            for proposal in &all {
                assert!(proposal.test.duration_s <= LONGEST_S, "{}", proposal.test.name);
                let x = proposal.displacement_m(500.0);
                assert!(x.iter().all(|x| x.is_finite()), "{}", proposal.test.name);
            }
        }
    }

    #[test]
    fn every_proposal_keeps_the_limits_and_its_text_is_the_same_test() {
        let limits = RigLimits { stroke_m: 0.02, speed_m_per_s: 0.2 };
        let all = proposals(&limits);
        assert!(all.len() > 30, "{}", all.len());
        let text: String = all.iter().map(|proposal| proposal.text.as_str()).collect();
        let source = Source::from_text(Path::new("next-test.toml"), &text);
        let list = TestList::from_source(&source).unwrap();
        for (proposal, read) in all.iter().zip(&list.tests) {
            assert_eq!(proposal.test.name, read.name);
            let x = proposal.displacement_m(500.0);
            for (n, x) in x.iter().enumerate() {
                let again = read.mean_m + read.excitation.displacement_m(n as f64 / 500.0);
                assert!((x - again).abs() < 1e-9, "{}: {x} {again}", read.name);
                assert!(x.abs() <= 1.05 * limits.stroke_m, "{}: {x}", read.name);
            }
            let fastest = x.windows(2).map(|w| (w[1] - w[0]).abs() * 500.0).fold(0.0, f64::max);
            assert!(fastest < 1.1 * limits.speed_m_per_s, "{}: {fastest}", read.name);
        }
    }
}
