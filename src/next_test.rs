//! `yawbench identify --next-test`: the tests that separate what the records cannot, as a list that
//! `characterise` runs.

use crate::error::CommandError;
use clap::Args;
use identification::result::IdentifyResult;
use identification::{Control, Identification, Motion, NextTest, Question, next_tests};
use measurement::Measurement;
use report::{Cell, Table};
use signal::statistics::min_max;
use std::fmt::Write as _;
use std::ops::RangeInclusive;
use virtual_bench::bench_visit::proposals::{Proposal, RigLimits, proposals};

/// The list of tests in the result folder.
pub(crate) const NEXT_TEST: &str = "next-test.toml";
/// Sampling rate of the motions, Hz.
const RATE_HZ: f64 = 500.0;
/// Strokes of rigs, mm: a tenth of a millimetre is less than the free play of a yaw damper, and no
/// damper of a vehicle moves a metre to either side.
const STROKE_MM: RangeInclusive<f64> = 0.1..=1000.0;
/// Highest speeds of rigs, mm/s: from a creep to the fastest that a record may show, 10 m/s.
const SPEED_MM_PER_S: RangeInclusive<f64> = 0.1..=10_000.0;
/// Largest forces of rigs, kN: from a load cell of 1 N to half of what a record may show.
const FORCE_KN: RangeInclusive<f64> = 0.001..=10_000.0;

/// What the rig can do.
#[derive(Debug, Args)]
pub(crate) struct NextTestArgs {
    /// Write the tests that separate what these records cannot to next-test.toml, a list that
    /// characterise runs.
    #[arg(long)]
    next_test: bool,
    /// Farthest displacement of the rig to either side [default: that of the records].
    #[arg(long, value_name = "MM", requires = "next_test")]
    stroke_mm: Option<f64>,
    /// Highest speed of the rig [default: that of the records].
    #[arg(long, value_name = "MM/S", requires = "next_test")]
    speed_mm_per_s: Option<f64>,
    /// Largest force of the rig [default: that of the records].
    #[arg(long, value_name = "KN", requires = "next_test")]
    force_kn: Option<f64>,
}

/// The next tests and their list.
pub(crate) struct Proposed {
    /// The `[[test]]` tables; none where no test is proposed.
    pub(crate) list: Option<String>,
    /// The tests for a terminal.
    pub(crate) text: String,
}

impl NextTestArgs {
    /// True where the next test is asked for.
    pub(crate) fn is_wanted(&self) -> bool {
        self.next_test
    }

    /// Checks the limits before anything is read.
    ///
    /// # Errors
    /// A limit that no rig has.
    pub(crate) fn check(&self) -> Result<(), CommandError> {
        let limits = [
            ("--stroke-mm", self.stroke_mm, STROKE_MM),
            ("--speed-mm-per-s", self.speed_mm_per_s, SPEED_MM_PER_S),
            ("--force-kn", self.force_kn, FORCE_KN),
        ];
        for (name, value, range) in limits {
            if let Some(value) = value.filter(|value| !range.contains(value)) {
                let found = format!("{name} {}", files::number(value));
                return Err(CommandError::option(found, between(&range)));
            }
        }
        Ok(())
    }

    /// Checks the limits that the records stand in for, before the work.
    ///
    /// # Errors
    /// Records of a motion that no rig makes, and no limit instead.
    pub(crate) fn check_records(&self, question: &Question) -> Result<(), CommandError> {
        let records = Limits::of(&question.train.iter().chain(&question.holdout));
        let limits = [
            ("--stroke-mm", self.stroke_mm, 1e3 * records.stroke_m, STROKE_MM),
            ("--speed-mm-per-s", self.speed_mm_per_s, 1e3 * records.speed_m_per_s, SPEED_MM_PER_S),
        ];
        for (name, given, own, range) in limits {
            if self.next_test && given.is_none() && !range.contains(&own) {
                let found = format!("no {name}, and records of {}", files::number(own));
                return Err(CommandError::option(found, format!("{name}, {}", between(&range))));
            }
        }
        Ok(())
    }

    /// The tests that separate most per second.
    ///
    /// # Errors
    /// A motion that cannot be prepared.
    pub(crate) fn propose(
        &self,
        found: &Identification,
        control: Control<'_>,
    ) -> Result<Proposed, CommandError> {
        let tests = found.train.tests.iter().chain(&found.holdout.tests);
        let records = Limits::of(&tests.map(|test| &test.record));
        let metres = |given: Option<f64>, own: f64| given.map_or(own, |value| 1e-3 * value);
        let limits = RigLimits {
            stroke_m: metres(self.stroke_mm, records.stroke_m),
            speed_m_per_s: metres(self.speed_mm_per_s, records.speed_m_per_s),
        };
        let force_n = self.force_kn.map_or(records.force_n, |kn| 1e3 * kn);
        let all = proposals(&limits);
        let motions: Vec<Motion> = all
            .iter()
            .map(|proposal| Motion {
                name: proposal.test.name.clone(),
                rate_hz: RATE_HZ,
                displacement_m: proposal.displacement_m(RATE_HZ),
            })
            .collect();
        let tests = next_tests(found, &motions, force_n, control)?;
        let result = &found.result;
        let list = (!tests.is_empty()).then(|| list(&tests, &all, noise_n(result)));
        let text = if tests.is_empty() { none(result) } else { text(&tests, noise_n(result)) };
        Ok(Proposed { list, text })
    }
}

/// A range in words.
fn between(range: &RangeInclusive<f64>) -> String {
    format!("{} to {}", files::number(*range.start()), files::number(*range.end()))
}

/// What the records show that the rig can do.
struct Limits {
    stroke_m: f64,
    speed_m_per_s: f64,
    force_n: f64,
}

impl Limits {
    fn of<'a>(records: &(impl Iterator<Item = &'a Measurement> + Clone)) -> Self {
        let most = |values: &[f64]| min_max(values).map_or(0.0, |(low, high)| high.max(-low));
        let over = |of: &dyn Fn(&Measurement) -> f64| records.clone().map(of).fold(0.0, f64::max);
        Self {
            stroke_m: over(&|record| most(&record.displacement_m)),
            speed_m_per_s: over(&|record| most(&record.velocity_m_per_s)),
            force_n: 1.1 * over(&|record| most(&record.force_n)),
        }
    }
}

/// rms of the noise, or its lower bound, N.
fn noise_n(result: &IdentifyResult) -> Option<f64> {
    result.noise_floor_n.or(result.noise_at_least_n)
}

/// The difference is below the noise: the test would not separate its models.
fn is_too_small(test: &NextTest, noise_n: Option<f64>) -> bool {
    noise_n.is_some_and(|noise_n| test.difference_n < noise_n)
}

fn list(tests: &[NextTest], all: &[Proposal], noise_n: Option<f64>) -> String {
    let mut text = String::from(
        "# Tests that separate what the records cannot, by yawbench identify --next-test.\n",
    );
    let mut listed: Vec<usize> = Vec::new();
    for test in tests {
        let [a, b] = &test.separates;
        if listed.contains(&test.motion) {
            continue;
        }
        listed.push(test.motion);
        let remark = if is_too_small(test, noise_n) {
            ",\n# below the noise: too small to separate them"
        } else {
            ""
        };
        let _ = write!(
            text,
            "\n# {a} or {b}: {:.4} N rms that no refit removes{remark}\n{}",
            test.difference_n, all[test.motion].text
        );
    }
    text
}

/// Why no test is proposed, and what remains open all the same.
fn none(result: &IdentifyResult) -> String {
    let has_rivals = result.effects.iter().any(|effect| !effect.alternatives.is_empty());
    let mut text = String::from(if has_rivals || !result.not_testable.is_empty() {
        "next test: none; no motion within the limits separates the models that these records do \
         not\n"
    } else {
        "next test: none; there are no two models that these records do not separate\n"
    });
    if let Some(why) = &result.not_judged {
        let _ = writeln!(text, "  open: the residual is not judged: {why}");
    }
    if result.unexplained.is_some() {
        text.push_str(
            "  open: the unexplained part of the residual, for which there is no model to \
             compare\n",
        );
    }
    for effect in &result.not_testable {
        let _ =
            writeln!(text, "  open: {}; it would show in {}", effect.name, effect.test_that_would);
    }
    let nominal = result.nominal.iter().filter(|(_, value)| value.std.is_none());
    let of_effects = result.effects.iter().flat_map(|effect| &effect.parameters);
    let free: Vec<&str> = nominal
        .map(|(name, _)| name.as_str())
        .chain(of_effects.filter(|(_, value)| value.std.is_none()).map(|(name, _)| *name))
        .collect();
    if !free.is_empty() {
        let _ = writeln!(text, "  open: not fixed by these records: {}", free.join(", "));
    }
    text
}

fn text(tests: &[NextTest], noise_n: Option<f64>) -> String {
    let table = Table::new("Next tests")
        .text("test")
        .text("separates")
        .number("duration", "s")
        .number("difference, rms", "N")
        .number_with_digits("over the noise", "", 3)
        .number("largest force", "N")
        .text("remark");
    let rows = tests.iter().map(|test| {
        let [a, b] = &test.separates;
        let remark = if is_too_small(test, noise_n) { "too small to separate them" } else { "" };
        [
            Cell::from(test.name.as_str()),
            format!("{a} / {b}").into(),
            test.duration_s.into(),
            test.difference_n.into(),
            noise_n.map(|noise_n| test.difference_n / noise_n).into(),
            test.largest_force_n.into(),
            remark.into(),
        ]
    });
    format!("\n{}", table.rows(rows).to_text())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(stroke_mm: f64, speed_mm_per_s: f64, force_kn: f64) -> NextTestArgs {
        NextTestArgs {
            next_test: true,
            stroke_mm: Some(stroke_mm),
            speed_mm_per_s: Some(speed_mm_per_s),
            force_kn: Some(force_kn),
        }
    }

    #[test]
    fn a_stroke_of_1e300_mm_ended_in_a_panic_and_one_of_1e7_in_all_memory() {
        assert!(args(75.0, 300.0, 40.0).check().is_ok());
        for stroke_mm in [1e300, 1e9, 1e7, 1e5, 1e-300, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            let why = args(stroke_mm, 300.0, 40.0).check().unwrap_err();
            assert_eq!(why.exit_code(), 2);
            let said = why.to_string();
            assert!(said.ends_with(": expected 0.1 to 1000") && said.len() < 60, "{said}");
        }
        for (speed_mm_per_s, force_kn) in [(1e300, 40.0), (1e-300, 40.0), (1.0, 1e5), (1.0, 1e-9)] {
            assert!(args(75.0, speed_mm_per_s, force_kn).check().is_err());
        }
    }

    fn proposed(difference_n: f64) -> NextTest {
        NextTest {
            motion: 0,
            name: "holds".to_owned(),
            separates: ["a", "b"].map(str::to_owned),
            difference_n,
            largest_force_n: 1e4,
            duration_s: 10.0,
        }
    }

    #[test]
    fn a_difference_below_the_noise_was_proposed_without_a_word() {
        let said = |difference_n| text(&[proposed(difference_n)], Some(20.0));
        assert!(said(5.0).contains("too small to separate them"));
        assert!(!said(50.0).contains("too small"));
        assert!(!text(&[proposed(5.0)], None).contains("too small"), "the noise is unknown");
    }
}
