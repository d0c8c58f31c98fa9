//! What a residual shows: the structure that remains, what cannot be judged, what is remarkable.
//!
//! The first that applies is reported: a cycle that is unlike all others; a line, a map or a part
//! that repeats; a residual that follows the motion; a residual whose size follows the force; a
//! residual in a few short stretches or in one test; a constant.

use super::lone_test::LoneTest;
use super::maps::CoordinateMap;
use super::question::Answer;
use super::{ResidualAnalysis, cycles, lines};
use crate::test_set::TestSet;
use report::significant;
use signal::statistics::rms;

/// Structure below this share of the noise floor is not reported.
const LEAST_SHARE_OF_FLOOR: f64 = 0.25;
/// Structure below this share of the rms force may be the models' own.
const LEAST_SHARE_OF_FORCE: f64 = 2e-4;
/// A residual up to this multiple of a known noise floor is that noise: a floor is known within 30
/// %, and slow noise is not in it.
const AT_FLOOR: f64 = 1.3;
/// A residual from this multiple of a known noise floor is more than that noise.
const FAR_ABOVE_FLOOR: f64 = 1.5;
/// A residual from this multiple of the noise of the samples is not called noise: slow and coloured
/// noise of a bench is usually less.
const MOST_OF_SAMPLES: f64 = 5.0;
/// The same without its part that is slower than the motion, which is drift, where the floor is
/// unknown.
const MOST_WITHOUT_SLOW: f64 = 2.5;
/// A residual of a larger share of the force is not called noise where nothing is known of the
/// noise.
const MOST_OF_FORCE: f64 = 0.05;
/// The same where errors that a bench may have make a larger share of the residual.
const MOST_BY_THE_BENCH: f64 = 0.5;
/// A residual up to this multiple of the noise of the samples is that noise.
const AT_SAMPLES: f64 = 1.5;
/// Largest probability of structure by chance, over all coordinates.
const LARGEST_P: f64 = 1e-3;
/// A constant of a smaller share of the squared residual is not reported.
const LEAST_SHARE_OF_CONSTANT: f64 = 0.03;
/// Largest probability of a size that follows the force by chance.
const LARGEST_P_OF_SIZE: f64 = 0.01;
/// The same where the residual is far above a known floor.
const LARGEST_P_ABOVE_FLOOR: f64 = 0.05;

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

impl Unexplained {
    /// With the description of another structure in the same residual.
    fn also(self, other: &str) -> Self {
        Self { description: format!("{}; {other}", self.description), ..self }
    }
}

/// The structure of a residual, if there is any.
pub(super) fn judge(
    analysis: &ResidualAnalysis,
    residual_n: &[Vec<f64>],
    tests: &TestSet,
) -> Option<Unexplained> {
    let own_n = LEAST_SHARE_OF_FORCE * tests.rms_force_n();
    let floor_n = analysis.noise.floor_n.unwrap_or(0.0);
    let least_n = (LEAST_SHARE_OF_FLOOR * floor_n).max(own_n);
    let motion = follows_motion(analysis, least_n);
    let lone = LoneTest::of(residual_n, tests);
    let found = match (shaped(analysis, residual_n, least_n, tests), motion) {
        (None, motion) => motion
            .or_else(|| grows_between_cycles(analysis, own_n))
            .or_else(|| follows_force(analysis, own_n))
            .or_else(|| in_bursts(analysis, own_n, tests))
            .or_else(|| in_one_test(lone.as_ref(), analysis, own_n, tests))
            .or_else(|| constant(analysis, least_n)),
        (shaped, None) => shaped,
        // Kinks that follow the motion make lines too.
        (Some(shaped), Some(motion))
            if shaped.coordinate == "frequency" && motion.rms_n > shaped.rms_n =>
        {
            Some(motion.also(&shaped.description))
        }
        (Some(shaped), Some(motion)) => Some(shaped.also(&motion.description)),
    };
    match (found, lone) {
        (Some(found), Some(lone)) => Some(found.also(&lone.description())),
        (found, _) => found,
    }
}

/// Most of the residual is in one test, though the noise of one bench is as large in all.
fn in_one_test(
    lone: Option<&LoneTest<'_>>,
    analysis: &ResidualAnalysis,
    own_n: f64,
    tests: &TestSet,
) -> Option<Unexplained> {
    let lone = lone.filter(|lone| lone.is_louder() && analysis.rms_n > own_n)?;
    let rms_n = (lone.square_n2 / tests.counted_samples() as f64).sqrt().min(analysis.rms_n);
    Some(Unexplained {
        rms_n,
        coordinate: "test",
        description: format!(
            "{} N rms are in one test, where the residual is {:.0} times as large as in the others: \
             an effect that only its motion reaches, or a fault of its record",
            short(rms_n),
            lone.ratio.sqrt()
        ),
    })
}

/// More of the force follows from the motion than the model knows.
fn follows_motion(analysis: &ResidualAnalysis, least_n: f64) -> Option<Unexplained> {
    let motion = &analysis.motion;
    (motion.answer == Answer::Yes && motion.rms_n > least_n).then(|| Unexplained {
        rms_n: motion.rms_n.min(analysis.rms_n),
        coordinate: "motion",
        description: format!(
            "{} N rms more follow from the motion; no effect of the catalogue does it",
            short(motion.rms_n.min(analysis.rms_n))
        ),
    })
}

/// Cycles of equal motion differ by a share of the force.
fn grows_between_cycles(analysis: &ResidualAnalysis, own_n: f64) -> Option<Unexplained> {
    let rms_n = analysis.repeat.growing_n.filter(|rms_n| *rms_n > own_n)?.min(analysis.rms_n);
    Some(Unexplained {
        rms_n,
        coordinate: "size_of_the_force",
        description: format!(
            "{} N rms change from cycle to cycle of the same motion, as a share of the force: an \
             input that was not recorded, such as temperature or current, or a valve that switches",
            short(rms_n)
        ),
    })
}

/// The residual grows with the force, and not with the motion.
fn follows_force(analysis: &ResidualAnalysis, own_n: f64) -> Option<Unexplained> {
    let size = &analysis.size;
    let floor_n = analysis.noise.floor_n;
    let above = |multiple: f64| floor_n.is_none_or(|floor_n| analysis.rms_n > multiple * floor_n);
    let certain = size.is_below(LARGEST_P_OF_SIZE) && above(AT_FLOOR);
    let likely =
        floor_n.is_some() && size.is_below(LARGEST_P_ABOVE_FLOOR) && above(FAR_ABOVE_FLOOR);
    if analysis.rms_n <= own_n || !(certain || likely) {
        return None;
    }
    let floor_n = floor_n.unwrap_or(0.0);
    let rms_n = (analysis.rms_n * analysis.rms_n - floor_n * floor_n).max(0.0).sqrt();
    let how = if size.correlation > 0.0 {
        "grow with the force"
    } else {
        "are largest where the force is small, near the reversals"
    };
    Some(Unexplained {
        rms_n,
        coordinate: "size_of_the_force",
        description: format!(
            "{} N rms do not follow from the motion and {how}: an input that was not recorded, \
             such as temperature or current, a valve that switches, or the bench itself (ripple, \
             skew, mounting)",
            short(rms_n)
        ),
    })
}

/// Much of the residual is in a few short stretches.
fn in_bursts(analysis: &ResidualAnalysis, own_n: f64, tests: &TestSet) -> Option<Unexplained> {
    let bursts = analysis.bursts.as_ref()?;
    let floor_n = analysis.noise.floor_n.unwrap_or(0.0);
    if analysis.rms_n <= own_n || analysis.rms_n <= AT_FLOOR * floor_n {
        return None;
    }
    let rms_n = analysis.rms_n * bursts.share.sqrt();
    let record = &tests.tests.get(bursts.test)?.record;
    Some(Unexplained {
        rms_n,
        coordinate: "time",
        description: format!(
            "{} N rms are in {} s of {} s, the largest part at {:.2} s of test {}: an effect that \
             few strokes reach, or a fault of the record",
            short(rms_n),
            short(bursts.duration_s),
            short(bursts.of_s),
            record.time_s(bursts.largest_at),
            record.name
        ),
    })
}

/// A constant that no effect was accepted for.
fn constant(analysis: &ResidualAnalysis, least_n: f64) -> Option<Unexplained> {
    let mean_n = analysis.constant.mean_n;
    let share = (mean_n / analysis.rms_n) * (mean_n / analysis.rms_n);
    let is_one = analysis.constant.p_value < LARGEST_P
        && mean_n.abs() > least_n
        && share > LEAST_SHARE_OF_CONSTANT;
    is_one.then(|| Unexplained {
        rms_n: mean_n.abs(),
        coordinate: "constant",
        description: format!(
            "a constant of {} N: the zero of the load cell or a preload, which no accepted effect \
             describes",
            short(mean_n)
        ),
    })
}

/// The reason why a residual without structure cannot be called noise, if there is one.
pub(super) fn not_judged(analysis: &ResidualAnalysis) -> Option<String> {
    let floor_n = analysis.noise.floor_n;
    if let Some(of_samples_n) = analysis.noise.of_samples_n {
        let faster_n = analysis.without_slow_rms_n;
        let slow = analysis.rms_n > MOST_OF_SAMPLES * of_samples_n;
        let fast = floor_n.is_none() && faster_n > MOST_WITHOUT_SLOW * of_samples_n;
        if slow || fast {
            return Some(format!(
                "whether the residual of {} N rms is noise: it is {:.1} times the noise of the \
                 samples ({} N) and follows neither the motion nor the force: slow noise of the \
                 bench, or an input that was not recorded",
                short(analysis.rms_n),
                analysis.rms_n / of_samples_n,
                short(of_samples_n)
            ));
        }
    }
    if floor_n.is_some_and(|floor_n| analysis.rms_n <= FAR_ABOVE_FLOOR * floor_n) {
        return None;
    }
    if let Some(why) = noise_is_unknown(analysis) {
        return Some(why);
    }
    let Answer::NotTested(why) = [&analysis.motion.answer, &analysis.size.answer]
        .into_iter()
        .find(|answer| !answer.is_tested())?
    else {
        return None;
    };
    let noise = match floor_n {
        Some(floor_n) => format!("it is {:.1} times the noise floor", analysis.rms_n / floor_n),
        None => "the noise floor is unknown".to_owned(),
    };
    let question = if analysis.motion.answer.is_tested() {
        "whether its size follows the force"
    } else {
        "whether it follows the motion"
    };
    Some(format!(
        "whether the residual of {} N rms is noise: {noise}, and {question} is not tested by this \
         motion ({why})",
        short(analysis.rms_n)
    ))
}

/// The reason why a residual of which no noise is known cannot be called noise, if there is one.
fn noise_is_unknown(analysis: &ResidualAnalysis) -> Option<String> {
    let noise = &analysis.noise;
    let at_samples = noise.of_samples_n.is_some_and(|n| analysis.rms_n <= AT_SAMPLES * n);
    if noise.floor_n.is_some() || at_samples {
        return None;
    }
    let whether = format!(
        "whether the residual of {} N rms is noise: the noise floor is unknown",
        short(analysis.rms_n)
    );
    if analysis.size.by_the_bench > MOST_BY_THE_BENCH {
        Some(format!(
            "{whether}, and {:.0} % of its square grow with the force or its slope as an error of \
             the gain, a jitter of the clock or a filter would make it, or an input that was not \
             recorded",
            100.0 * analysis.size.by_the_bench
        ))
    } else if noise.of_samples_n.is_none() && analysis.share_of_force > MOST_OF_FORCE {
        let per_cent = 100.0 * analysis.share_of_force;
        Some(format!("{whether}, and {per_cent:.0} % of the force are more than a bench has"))
    } else {
        None
    }
}

/// A residual that is more than its noise and follows neither motion nor force.
pub(super) fn remark(analysis: &ResidualAnalysis) -> Option<String> {
    let floor_n = analysis.noise.floor_n?;
    let (rms_n, far_n) = (analysis.rms_n, FAR_ABOVE_FLOOR * floor_n);
    if analysis.unexplained.is_some() || not_judged(analysis).is_some() || rms_n <= far_n {
        return None;
    }
    let other_n = (rms_n * rms_n - floor_n * floor_n).sqrt();
    Some(format!(
        "{} N rms of the residual are slower or other than the noise ({} N) and follow neither the \
         motion nor the force: drift, or ripple of the bench",
        short(other_n),
        short(floor_n)
    ))
}

/// A single event, a line, a map or a part that repeats.
fn shaped(
    analysis: &ResidualAnalysis,
    residual_n: &[Vec<f64>],
    least: f64,
    tests: &TestSet,
) -> Option<Unexplained> {
    let questions = (analysis.maps.len() + 1) as f64;
    let mapped =
        analysis.maps.iter().find(|map| map.p_value * questions < LARGEST_P && map.rms_n > least);
    let repeats =
        analysis.repeat.p_value * questions < LARGEST_P && analysis.repeat.repeated_rms_n > least;
    let lines_rms_n = lines::pooled(&analysis.lines, tests);
    let strongest = analysis.lines.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
    // A spectrum weights the middle of a record most, and so overestimates a line that is there
    // only.
    let at_most = |rms_n: f64| rms_n.min(analysis.rms_n);
    if let Some(line) = strongest.filter(|_| lines_rms_n > least)
        && mapped.is_none_or(|map| map.rms_n < lines_rms_n)
        && lines_rms_n > analysis.repeat.repeated_in_all_rms_n
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
                analysis.lines.len(),
                tests.tests.len()
            ),
        });
    }
    if let Some(event) = event(analysis, tests) {
        return Some(event);
    }
    if let Some(map) = mapped {
        let repeated_n = if repeats { analysis.repeat.repeated_rms_n } else { 0.0 };
        return Some(Unexplained {
            rms_n: at_most(map.rms_n.max(repeated_n)),
            coordinate: map.coordinate.name(),
            description: describe(map),
        });
    }
    repeats.then(|| Unexplained {
        rms_n: at_most(analysis.repeat.repeated_rms_n),
        coordinate: "phase",
        description: format!(
            "{} N rms repeat in every cycle, without one shape over any coordinate",
            short(at_most(analysis.repeat.repeated_rms_n))
        ),
    })
}

/// Cycles that are unlike all others, described by the largest of them.
fn event(analysis: &ResidualAnalysis, tests: &TestSet) -> Option<Unexplained> {
    let unlike = &analysis.repeat.unlike;
    let largest = unlike.iter().max_by(|a, b| a.rms_n.total_cmp(&b.rms_n))?;
    let record = &tests.tests[largest.test].record;
    let ends = cycles::starts(&tests.tests[largest.test]);
    let square_n2: f64 = unlike.iter().map(|one| one.square_n2).sum();
    let rms_n = (square_n2 / tests.counted_samples() as f64).sqrt();
    let (from, to) = (ends.get(largest.cycle)?, ends.get(largest.cycle + 1)?);
    Some(Unexplained {
        rms_n: rms_n.min(analysis.rms_n),
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
    significant(value, 3)
}
