//! The residual of a model: noise, or structure.
//!
//! Three questions, each answered against chance with independent stretches of record: does the
//! residual repeat from cycle to cycle ([`repeat`]); has it a shape over a coordinate that holds on
//! left-out tests ([`maps`]); has its spectrum lines ([`lines`])? A residual with none of these
//! above a quarter of the noise floor is taken for noise, unless a cycle is unlike all others
//! ([`unlike`]). Structure of two ten-thousandths of the force and less may come from steps,
//! interpolation and bounds of the models themselves.

pub(crate) mod coordinates;
mod cycles;
pub(crate) mod lines;
pub(crate) mod maps;
pub(crate) mod repeat;
pub(crate) mod unlike;

use super::fit::Fit;
use super::test_set::TestSet;
use coordinates::{Coordinate, Track};
use lines::Line;
use maps::CoordinateMap;
use rayon::prelude::*;
use repeat::Repeat;
use signal::statistics::rms;

/// Structure below this share of the noise floor is not reported.
const LEAST_SHARE_OF_FLOOR: f64 = 0.25;
/// Structure below this share of the rms force may be the models' own.
const LEAST_SHARE_OF_FORCE: f64 = 2e-4;
/// A residual this many times the noise floor is no noise, even if no structure is significant.
const FAR_ABOVE_FLOOR: f64 = 1.5;
/// Largest probability of structure by chance, over all coordinates.
const LARGEST_P: f64 = 1e-3;

/// The residual of a model in all respects.
#[derive(Debug, Clone)]
pub struct ResidualAnalysis {
    /// rms of the residual, N.
    pub rms_n: f64,
    /// Noise floor, N.
    pub noise_floor_n: f64,
    /// The method by which the floor was found.
    pub noise_floor_method: &'static str,
    /// Maps over every coordinate that was measured, the one that explains most first.
    pub maps: Vec<CoordinateMap>,
    /// The part that repeats from cycle to cycle.
    pub repeat: Repeat,
    /// Tones and bands.
    pub lines: Vec<Line>,
    /// The structure, if there is any.
    pub unexplained: Option<Unexplained>,
}

/// Structure that no accepted effect explains.
#[derive(Debug, Clone, PartialEq)]
pub struct Unexplained {
    /// Its rms, N.
    pub rms_n: f64,
    /// The coordinate over which it has a shape.
    pub coordinate: &'static str,
    /// In words.
    pub description: String,
}

impl ResidualAnalysis {
    /// Analyses the residual of a fitted model.
    pub fn new(fit: &Fit, tests: &TestSet) -> Option<Self> {
        let damper = fit.model.damper(&fit.values)?;
        let tracks: Vec<Track> = tests
            .tests
            .par_iter()
            .zip(&fit.starts_m)
            .map(|(test, start_m)| Track::simulate(&damper, test, *start_m))
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
        let rms_n = fit.rms_n(tests);
        let lines_rms_n = pooled(&lines, tests);
        // A line that does not repeat with the cycle is no noise.
        let without_lines = |floor: f64| {
            let rest = floor * floor - lines_rms_n * lines_rms_n;
            if lines_rms_n > repeat.repeated_in_all_rms_n {
                rest.max(0.01 * floor * floor).sqrt()
            } else {
                floor
            }
        };
        let (noise_floor_n, noise_floor_method) = match repeat.noise_floor_n {
            Some(floor) => {
                (without_lines(floor), "difference of the residual between successive cycles")
            }
            None => (without_lines(rms_n), "rms of the residual, as no test has cycles"),
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
        left.unexplained = left.judge(&residual_n, tests);
        Some(left)
    }

    /// The same, with something unexplained that the training tests do not show, if they show
    /// nothing themselves.
    pub(crate) fn or_unexplained(self, other: impl FnOnce() -> Option<Unexplained>) -> Self {
        let unexplained = self.unexplained.or_else(other);
        Self { unexplained, ..self }
    }

    fn judge(&self, residual_n: &[Vec<f64>], tests: &TestSet) -> Option<Unexplained> {
        let own_n = LEAST_SHARE_OF_FORCE * tests.rms_force_n();
        let least = (LEAST_SHARE_OF_FLOOR * self.noise_floor_n).max(own_n);
        let questions = (self.maps.len() + 1) as f64;
        let mapped =
            self.maps.iter().find(|map| map.p_value * questions < LARGEST_P && map.rms_n > least);
        let repeats =
            self.repeat.p_value * questions < LARGEST_P && self.repeat.repeated_rms_n > least;
        let lines_rms_n = pooled(&self.lines, tests);
        let strongest = self.lines.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
        // A spectrum weights the middle of a record most, and so overestimates a line that is there
        // only.
        let at_most = |rms_n: f64| rms_n.min(self.rms_n);
        if let Some(line) = strongest.filter(|_| lines_rms_n > least)
            && mapped.is_none_or(|map| map.rms_n < lines_rms_n)
            && lines_rms_n > self.repeat.repeated_in_all_rms_n
        {
            let test = &tests.tests[line.test];
            let name = &test.record.name;
            let whole_n = rms(&residual_n[line.test][test.counted()]);
            return Some(Unexplained {
                rms_n: at_most(lines_rms_n),
                coordinate: "frequency",
                description: format!(
                    "a line at {:.2} Hz with {} N rms in test {name}, lines in {} of {} tests; \
                     it does not repeat with the cycle",
                    line.frequency_hz,
                    short(line.rms_n.min(whole_n)),
                    self.lines.len(),
                    tests.tests.len()
                ),
            });
        }
        if let Some(event) = self.event(tests) {
            return Some(event);
        }
        if let Some(map) = mapped {
            let repeated_n = if repeats { self.repeat.repeated_rms_n } else { 0.0 };
            return Some(Unexplained {
                rms_n: at_most(map.rms_n.max(repeated_n)),
                coordinate: map.coordinate.name(),
                description: describe(map),
            });
        }
        if !repeats && self.rms_n > (FAR_ABOVE_FLOOR * self.noise_floor_n).max(own_n) {
            return Some(Unexplained {
                rms_n: self.rms_n,
                coordinate: "unknown",
                description: format!(
                    "{} N rms is {:.1} times the noise floor, and the records are too short to \
                     find its coordinate",
                    short(self.rms_n),
                    self.rms_n / self.noise_floor_n
                ),
            });
        }
        repeats.then(|| Unexplained {
            rms_n: at_most(self.repeat.repeated_rms_n),
            coordinate: "phase",
            description: format!(
                "{} N rms repeat in every cycle, without one shape over any coordinate",
                short(at_most(self.repeat.repeated_rms_n))
            ),
        })
    }
}

impl ResidualAnalysis {
    /// Cycles that are unlike all others, described by the largest of them.
    fn event(&self, tests: &TestSet) -> Option<Unexplained> {
        let unlike = &self.repeat.unlike;
        let largest = unlike.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n))?;
        let record = &tests.tests[largest.test].record;
        let ends = cycles::starts(&tests.tests[largest.test]);
        let square_n2: f64 = unlike.iter().map(|one| one.square_n2).sum();
        let rms_n = (square_n2 / tests.counted_samples() as f64).sqrt();
        let (from, to) = (ends.get(largest.cycle)?, ends.get(largest.cycle + 1)?);
        Some(Unexplained {
            rms_n: rms_n.min(self.rms_n),
            coordinate: "time",
            description: format!(
                "a single event in test {}, between {:.2} and {:.2} s: the cycle differs from its \
                 neighbours by {} N rms, cycles usually by {} N; {} such in all: a fault of the \
                 record?",
                record.name,
                record.time_s(*from),
                record.time_s(*to),
                short(largest.rms_n),
                short(largest.usual_n),
                if unlike.len() == 1 {
                    "one cycle".to_owned()
                } else {
                    format!("{} cycles", unlike.len())
                },
            ),
        })
    }
}

/// rms of lines over all tests, N.
fn pooled(lines: &[Line], tests: &TestSet) -> f64 {
    let squares: f64 = lines
        .iter()
        .map(|line| line.rms_n * line.rms_n * tests.tests[line.test].counted().len() as f64)
        .sum();
    let counted: usize = tests.tests.iter().map(|test| test.counted().len()).sum();
    (squares / counted.max(1) as f64).sqrt()
}

/// The place where a map is largest, in words.
fn describe(map: &CoordinateMap) -> String {
    let (upper, lower) = map.coordinate.branches();
    let cells = map.centres.iter().zip(map.upper_n.iter().zip(&map.lower_n));
    let largest = cells
        .flat_map(|(centre, (above, below))| [(*centre, *above, upper), (*centre, *below, lower)])
        .filter_map(|(centre, mean, branch)| mean.map(|mean| (centre, mean, branch)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let place = largest.map_or(String::new(), |(centre, mean, branch)| {
        let unit = map.coordinate.unit();
        format!("; largest near {} {unit}, {branch}: {} N", short(centre), short(mean))
    });
    format!(
        "{:.0} % of the squared residual follows {} on left-out tests{place}",
        100.0 * map.share,
        map.coordinate.name().replace('_', " ")
    )
}

/// Three digits.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (2.0 - libm::floor(libm::log10(value.abs()))).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$}")
}
