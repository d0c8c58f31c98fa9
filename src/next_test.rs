//! `yawbench identify --next-test`: the tests that separate what the records cannot, as a list that
//! `characterise` runs.

use crate::error::CommandError;
use clap::Args;
use identification::{Control, Identification, Motion, NextTest, next_tests};
use measurement::Measurement;
use report::{Cell, Table};
use signal::statistics::min_max;
use std::fmt::Write as _;
use virtual_bench::bench_visit::proposals::{Proposal, RigLimits, proposals};

/// The list of tests in the result folder.
pub(crate) const NEXT_TEST: &str = "next-test.toml";
/// Sampling rate of the motions, Hz.
const RATE_HZ: f64 = 500.0;

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
    /// The `[[test]]` tables.
    pub(crate) list: String,
    /// The tests for a terminal.
    pub(crate) text: String,
}

impl NextTestArgs {
    /// True where the next test is asked for.
    pub(crate) fn is_wanted(&self) -> bool {
        self.next_test
    }

    /// Checks the limits before any work.
    ///
    /// # Errors
    /// A limit that is not above zero.
    pub(crate) fn check(&self) -> Result<(), CommandError> {
        let limits = [
            ("--stroke-mm", self.stroke_mm),
            ("--speed-mm-per-s", self.speed_mm_per_s),
            ("--force-kn", self.force_kn),
        ];
        for (name, value) in limits {
            if let Some(value) = value.filter(|value| !value.is_finite() || *value <= 0.0) {
                let found = format!("{name} {}", files::number(value));
                return Err(CommandError::option(found, "a finite number above 0"));
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
        let records = Limits::of(found);
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
        Ok(Proposed { list: list(&tests, &all), text: text(&tests, found) })
    }
}

/// What the records show that the rig can do.
struct Limits {
    stroke_m: f64,
    speed_m_per_s: f64,
    force_n: f64,
}

impl Limits {
    fn of(found: &Identification) -> Self {
        let tests = || found.train.tests.iter().chain(&found.holdout.tests);
        let most = |values: &[f64]| min_max(values).map_or(0.0, |(low, high)| high.max(-low));
        let over = |of: &dyn Fn(&Measurement) -> f64| {
            tests().map(|test| of(&test.record)).fold(0.0, f64::max)
        };
        Self {
            stroke_m: over(&|record| most(&record.displacement_m)),
            speed_m_per_s: over(&|record| most(&record.velocity_m_per_s)),
            force_n: 1.1 * over(&|record| most(&record.force_n)),
        }
    }
}

fn list(tests: &[NextTest], all: &[Proposal]) -> String {
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
        let _ = write!(
            text,
            "\n# {a} or {b}: {:.4} N rms that no refit removes\n{}",
            test.difference_n, all[test.motion].text
        );
    }
    text
}

fn text(tests: &[NextTest], found: &Identification) -> String {
    if tests.is_empty() {
        return "next test: these records leave nothing open that a test within the limits would \
                separate\n"
            .to_owned();
    }
    let result = &found.result;
    let noise_n = result.noise_floor_n.or(result.noise_at_least_n);
    let table = Table::new("Next tests")
        .text("test")
        .text("separates")
        .number("duration", "s")
        .number("difference, rms", "N")
        .number_with_digits("over the noise", "", 3)
        .number("largest force", "N");
    let rows = tests.iter().map(|test| {
        let [a, b] = &test.separates;
        [
            Cell::from(test.name.as_str()),
            format!("{a} / {b}").into(),
            test.duration_s.into(),
            test.difference_n.into(),
            noise_n.map(|noise_n| test.difference_n / noise_n).into(),
            test.largest_force_n.into(),
        ]
    });
    format!("\n{}", table.rows(rows).to_text())
}
