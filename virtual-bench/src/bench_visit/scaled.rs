//! The tests of a visit for a damper of any stroke: those of [`protocol::short`], every length and
//! speed times a scale, at the same frequencies.

use super::protocol::{self, ROUNDING_S, Test};
use crate::excitation::{Excitation, Leg};

/// Sines: name, amplitude (mm), frequency (Hz), cycles, middle (mm).
const SINES: [(&str, f64, f64, f64, f64); 6] = [
    ("sine-middle", 3.46, 3.5, 17.5, 0.0),
    ("sine-small", 1.0, 3.5, 17.5, 0.0),
    ("sine-large", 8.0, 3.5, 17.5, 0.0),
    ("sine-slow", 1.5, 1.0, 7.5, 0.0),
    ("sine-quick", 1.0, 10.0, 40.5, 0.0),
    ("sine-off-middle", 3.46, 3.5, 17.5, 40.0),
];

/// Ten tests in about a minute, the last one for testing only.
pub fn whole(scale: f64) -> Vec<Test> {
    let mm = 1e-3 * scale;
    let mut tests: Vec<Test> = SINES
        .iter()
        .map(|&(name, amplitude, hz, cycles, middle)| Test {
            mean_m: mm * middle,
            ..Test::new(name, Excitation::sine(mm * amplitude, hz), cycles / hz)
        })
        .collect();
    let along = |name: &str, path: Excitation| {
        let end_s = path.end_s().unwrap_or(0.0);
        Test::new(name, path, end_s)
    };
    let leg = |to_mm: f64, hold_s| Leg { to_m: mm * to_mm, speed_m_per_s: 20.0 * mm, hold_s };
    let ramps = [leg(4.0, 1.5), leg(-4.0, 1.5), leg(4.0, 1.5), leg(0.0, 1.5)];
    tests.push(along("triangle-slow", Excitation::triangle(5.0 * mm, 5.0 * mm, 2, ROUNDING_S)));
    tests.push(along("triangle-wide", Excitation::triangle(20.0 * mm, 20.0 * mm, 2, ROUNDING_S)));
    tests.push(along("ramps", Excitation::path(&ramps, ROUNDING_S)));
    tests.push(service(mm, 8.0));
    tests
}

/// Five tests of about a second: enough to try the campaign itself.
pub fn brief(scale: f64) -> Vec<Test> {
    let mm = 1e-3 * scale;
    let sine = |name: &str, amplitude: f64, hz: f64| {
        Test::new(name, Excitation::sine(mm * amplitude, hz), 1.2)
    };
    vec![
        sine("sine-middle", 3.46, 3.5),
        sine("sine-small", 1.0, 3.5),
        sine("sine-large", 8.0, 3.5),
        sine("sine-quick", 1.0, 8.0),
        service(mm, 2.0),
    ]
}

fn service(mm: f64, duration_s: f64) -> Test {
    let excitation = protocol::service(2.0 * mm, 0.5, 12.0, 24, 2014);
    Test { test_only: true, ..Test::new("service", excitation, duration_s) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_full_scale_they_are_those_of_a_short_visit() {
        let (ours, theirs) = (whole(1.0), protocol::short());
        assert_eq!(ours.len(), theirs.len());
        for test in &ours {
            let same = |other: &&Test| {
                other.excitation == test.excitation && (other.mean_m - test.mean_m).abs() < 1e-12
            };
            let found = theirs.iter().find(same).expect(&test.name);
            assert!((found.duration_s - test.duration_s).abs() < 1e-9, "{}", test.name);
        }
        let (speed, way) = protocol::reach(&ours);
        let (double_speed, double_way) = protocol::reach(&whole(2.0));
        assert!((double_speed / speed - 2.0).abs() < 1e-9 && (double_way / way - 2.0).abs() < 1e-9);
    }
}
