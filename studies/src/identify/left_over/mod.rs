//! What is left when the model has all that was found: noise, or something without a name.
//!
//! Three questions, each answered against chance with independent stretches of record:
//! does the residual repeat from cycle to cycle ([`repeat`]); has it a shape over a coordinate that
//! holds on tests left out ([`maps`]); has it lines in its spectrum ([`lines`])? What has none of
//! these, above a fifth of the noise floor, is taken for noise.

pub mod coordinates;
pub mod lines;
pub mod maps;
pub mod repeat;

use super::fit::Fit;
use super::tests_at_hand::TestsAtHand;
use coordinates::{Coordinate, Track};
use lines::Line;
use maps::CoordinateMap;
use rayon::prelude::*;
use repeat::Repeat;

/// Structure below this share of the noise floor is not worth a word.
const LEAST_SHARE_OF_FLOOR: f64 = 0.25;
/// Largest probability of structure by chance, over all coordinates.
const LARGEST_P: f64 = 1e-3;

/// The residual of a model, looked at from all sides.
#[derive(Debug, Clone)]
pub struct LeftOver {
    /// rms of the residual, N.
    pub rms_n: f64,
    /// Noise floor, N.
    pub noise_floor_n: f64,
    /// How the floor was found.
    pub noise_floor_method: &'static str,
    /// Over every coordinate that was measured, the one that explains most first.
    pub maps: Vec<CoordinateMap>,
    /// What repeats.
    pub repeat: Repeat,
    /// Tones and bands.
    pub lines: Vec<Line>,
    /// What stands out, if anything does.
    pub unexplained: Option<Unexplained>,
}

/// Structure that no accepted effect explains.
#[derive(Debug, Clone, PartialEq)]
pub struct Unexplained {
    /// Its rms, N.
    pub rms_n: f64,
    /// Where it lives.
    pub coordinate: &'static str,
    /// In words.
    pub description: String,
}

impl LeftOver {
    /// Looks at the residual of a fitted model.
    pub fn of(fit: &Fit, tests: &TestsAtHand) -> Option<Self> {
        let damper = fit.model.damper(&fit.values)?;
        let tracks: Vec<Track> = tests
            .tests
            .par_iter()
            .zip(&fit.starts_m)
            .map(|(test, start_m)| Track::of(&damper, test, *start_m))
            .collect();
        let residual_n: Vec<Vec<f64>> =
            (0..tests.tests.len()).map(|test| fit.residual_n(tests, test)).collect();
        let mut maps: Vec<CoordinateMap> = Coordinate::ALL
            .into_par_iter()
            .filter_map(|coordinate| maps::map(coordinate, &tracks, &residual_n, tests))
            .collect();
        maps.sort_by(|a, b| b.share.total_cmp(&a.share));
        let repeat = repeat::repeat(&residual_n, tests);
        let lines = lines::lines(&residual_n, tests);
        let rms_n = (fit.total_n2() / tests.counted_samples() as f64).sqrt();
        let (noise_floor_n, noise_floor_method) = match repeat.noise_floor_n {
            Some(floor) => (floor, "difference of the residual between successive cycles"),
            None => (rms_n, "rms of the residual, as no test has cycles"),
        };
        let mut left = Self {
            rms_n,
            noise_floor_n,
            noise_floor_method,
            maps,
            repeat,
            lines,
            unexplained: None,
        };
        left.unexplained = left.judge(tests);
        Some(left)
    }

    fn judge(&self, tests: &TestsAtHand) -> Option<Unexplained> {
        let least = LEAST_SHARE_OF_FLOOR * self.noise_floor_n;
        let questions = (self.maps.len() + 1) as f64;
        let mapped =
            self.maps.iter().find(|map| map.p_value * questions < LARGEST_P && map.rms_n > least);
        let repeats =
            self.repeat.p_value * questions < LARGEST_P && self.repeat.repeated_rms_n > least;
        let samples = tests.counted_samples() as f64;
        let in_lines: f64 = self
            .lines
            .iter()
            .map(|line| line.rms_n * line.rms_n * tests.tests[line.test].counted().len() as f64)
            .sum();
        let lines_rms_n = (in_lines / samples).sqrt();
        let strongest = self.lines.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
        if let Some(line) = strongest.filter(|_| lines_rms_n > least)
            && mapped.is_none_or(|map| map.rms_n < lines_rms_n)
            && lines_rms_n > self.repeat.repeated_rms_n
        {
            let name = &tests.tests[line.test].record.name;
            return Some(Unexplained {
                rms_n: lines_rms_n,
                coordinate: "frequency",
                description: format!(
                    "a line at {:.2} Hz with {:.3} N rms in test {name}, lines in {} of {} tests; \
                     it does not repeat with the cycle",
                    line.frequency_hz,
                    line.rms_n,
                    self.lines.len(),
                    tests.tests.len()
                ),
            });
        }
        if let Some(map) = mapped {
            return Some(Unexplained {
                rms_n: map.rms_n.max(if repeats { self.repeat.repeated_rms_n } else { 0.0 }),
                coordinate: map.coordinate.name(),
                description: describe(map),
            });
        }
        repeats.then(|| Unexplained {
            rms_n: self.repeat.repeated_rms_n,
            coordinate: "phase",
            description: format!(
                "{:.3} N rms come again in every cycle, without one shape over any coordinate",
                self.repeat.repeated_rms_n
            ),
        })
    }
}

/// Where a map is largest, in words.
fn describe(map: &CoordinateMap) -> String {
    let cells = map.centres.iter().zip(map.upper_n.iter().zip(&map.lower_n));
    let largest = cells
        .flat_map(|(centre, (upper, lower))| [(*centre, *upper, "+"), (*centre, *lower, "-")])
        .filter_map(|(centre, mean, branch)| mean.map(|mean| (centre, mean, branch)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let place = largest.map_or(String::new(), |(centre, mean, branch)| {
        format!("; largest {mean:.3} N near {centre:.4e} on the {branch} branch")
    });
    format!(
        "{:.1} % of the squared residual follows {} on tests left out{place}",
        100.0 * map.share,
        map.coordinate.label()
    )
}
