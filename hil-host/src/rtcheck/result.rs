//! What `rtcheck` says: a machine's answer in JSON, and the text of it.
//!
//! The schema of the JSON is `docs/schema/rtcheck.schema.json`.

use super::answer::{AnswerTimes, AnsweredBy};
use super::beside_page::{BesidePage, PartTimes};
use super::distribution::{Bin, Distribution, bins, histogram_lines};
use super::measure::Measured;
use crate::doctor::{Check, InterfaceKind, Verdict, asks_for_a_change, lines};
use report::{Cell, Table};
use scenario::run::Rate;
use serde::Serialize;

/// Share of the period that the worst vehicle step may take: the rest is for frames and lateness.
const STEP_SHARE: f64 = 0.5;

/// What was asked for, as far as the judgement needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Rate of the ticks.
    pub rate: Rate,
    /// Highest lateness (µs).
    pub budget_us: f64,
    /// The vehicle whose step was computed.
    pub vehicle: Option<String>,
    /// The bus, and what it is.
    pub bus: Option<(String, InterfaceKind)>,
}

/// What it comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Everything is within its limit.
    Held,
    /// Something is not.
    NotHeld,
}

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RtCheck {
    /// Version of this format.
    pub format: u32,
    /// What it comes to.
    pub outcome: Outcome,
    /// Distance of two ticks (µs).
    pub period_us: f64,
    /// Highest lateness (µs).
    pub budget_us: f64,
    /// What the system was asked for and what it granted, in words.
    pub realtime: Vec<String>,
    /// Ticks that were to come, `met` and `skipped` together.
    pub expected_ticks: u64,
    /// Ticks on which a cycle was run.
    pub met_ticks: u64,
    /// Ticks that had passed before the cycle before them ended.
    pub skipped_ticks: u64,
    /// Whether the user ended it early.
    pub interrupted: bool,
    /// How late the thread woke up (µs).
    pub lateness_us: Option<Distribution>,
    /// The same as a histogram.
    pub lateness_histogram: Vec<Bin>,
    /// The vehicle whose step was computed in every cycle.
    pub vehicle: Option<String>,
    /// Time of its step (µs).
    pub step_us: Option<Distribution>,
    /// The answers of the bus.
    pub answers: Option<AnswerResult>,
    /// The times with a page that is fed and without; null without a page.
    pub beside_page: Option<BesidePageResult>,
    /// The limits, one by one.
    pub checks: Vec<Check>,
}

/// What a page costs the loop: seconds in which it is fed alternate with seconds in which it is
/// not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BesidePageResult {
    /// Seconds in which the page is fed.
    pub fed: PartResult,
    /// Seconds in which it is not.
    pub unfed: PartResult,
}

/// Times of one of both parts (µs); null where there are none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct PartResult {
    pub lateness_us: Option<Distribution>,
    pub step_us: Option<Distribution>,
}

impl PartResult {
    fn of(times: &PartTimes, has_vehicle: bool) -> Self {
        let step_us = Distribution::of(&times.step_ns).filter(|_| has_vehicle);
        Self { lateness_us: Distribution::of(&times.lateness_ns), step_us }
    }
}

impl BesidePageResult {
    fn of(beside: &BesidePage, has_vehicle: bool) -> Self {
        let [fed, unfed] =
            [&beside.fed, &beside.unfed].map(|part| PartResult::of(part, has_vehicle));
        Self { fed, unfed }
    }

    /// Its rows.
    fn rows(&self) -> [(String, Option<Distribution>); 4] {
        [
            ("lateness, page not fed", self.unfed.lateness_us),
            ("lateness, page fed", self.fed.lateness_us),
            ("vehicle step, page not fed", self.unfed.step_us),
            ("vehicle step, page fed", self.fed.step_us),
        ]
        .map(|(name, times)| (name.to_owned(), times))
    }
}

/// The answer time of a bus.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnswerResult {
    /// The bus and what it is.
    pub bus: String,
    /// Whether it has the timing of CAN.
    pub is_can: bool,
    /// Who answered: `rig 1`, or `loopback`.
    pub answered_by: String,
    /// Announcements that the bus took.
    pub sent: u64,
    /// Announcements without an answer in time.
    pub lost: u64,
    /// From announcement to answer (µs).
    pub answer_us: Option<Distribution>,
}

impl RtCheck {
    /// Judges a measurement.
    pub fn of(measured: &Measured, setup: &Setup) -> Self {
        let lateness_us = Distribution::of(&measured.lateness_ns);
        let step_us = Distribution::of(&measured.step_ns);
        let answers = measured.answers.as_ref().zip(setup.bus.as_ref());
        let answers = answers.map(|(times, (bus, kind))| AnswerResult::of(times, bus, kind));
        let mut checks =
            vec![lateness(lateness_us, setup.budget_us), skipped(measured), step(step_us, setup)];
        checks.extend(answers.as_ref().map(AnswerResult::check));
        let is_held = !asks_for_a_change(&checks) && measured.met > 0;
        Self {
            format: 1,
            outcome: if is_held { Outcome::Held } else { Outcome::NotHeld },
            period_us: 1e-3 * setup.rate.cycle_ns() as f64,
            budget_us: setup.budget_us,
            realtime: measured.realtime.lines().collect(),
            expected_ticks: measured.expected,
            met_ticks: measured.met,
            skipped_ticks: measured.skipped,
            interrupted: measured.is_interrupted,
            lateness_us,
            lateness_histogram: bins(&measured.lateness_ns),
            vehicle: setup.vehicle.clone(),
            step_us,
            answers,
            beside_page: measured
                .beside_page
                .as_ref()
                .map(|beside| BesidePageResult::of(beside, setup.vehicle.is_some())),
            checks,
        }
    }

    /// The text for a terminal.
    pub fn lines(&self) -> Vec<String> {
        let mut text: Vec<String> =
            self.realtime.iter().map(|line| format!("real-time: {line}")).collect();
        text.push(format!(
            "{} ticks of {} us: {} met, {} skipped{}",
            self.expected_ticks,
            self.period_us,
            self.met_ticks,
            self.skipped_ticks,
            if self.interrupted { " (interrupted)" } else { "" }
        ));
        text.push(String::new());
        text.extend(self.times().lines());
        if !self.lateness_histogram.is_empty() {
            text.extend([String::new(), "Lateness (a bar is the logarithm of a count)".to_owned()]);
            text.extend(histogram_lines(&self.lateness_histogram, self.budget_us));
        }
        text.push(String::new());
        text.extend(lines("Limits", &self.checks));
        text.extend([String::new(), self.verdict().to_owned()]);
        text
    }

    /// The last line.
    fn verdict(&self) -> &'static str {
        match self.outcome {
            Outcome::Held => "Held: the loop keeps its pace on this machine, as it was measured.",
            Outcome::NotHeld => "NOT held: see what to change above.",
        }
    }

    fn times(&self) -> Table {
        let table = Table::new("").text("time");
        let table = ["p50", "p99", "p99.9", "p99.99", "worst"]
            .into_iter()
            .fold(table, |table, name| table.fixed(name, "us", 1));
        let vehicle = self.vehicle.as_deref().unwrap_or_default();
        let rows = [
            ("lateness".to_owned(), self.lateness_us),
            (format!("vehicle step, {vehicle}"), self.step_us),
            (
                self.answers.as_ref().map_or_else(String::new, AnswerResult::name),
                self.answers.as_ref().and_then(|answers| answers.answer_us),
            ),
        ];
        let beside_page = self.beside_page.iter().flat_map(BesidePageResult::rows);
        let known =
            rows.into_iter().chain(beside_page).filter_map(|(name, times)| Some((name, times?)));
        table.rows(known.map(|(name, times)| -> [Cell; 6] {
            let Distribution { p50, p99, p99_9, p99_99, max } = times;
            [name.into(), p50.into(), p99.into(), p99_9.into(), p99_99.into(), max.into()]
        }))
    }
}

impl AnswerResult {
    fn of(times: &AnswerTimes, bus: &str, kind: &InterfaceKind) -> Self {
        let is_can = *kind == InterfaceKind::Can;
        let suffix = match kind {
            InterfaceKind::Virtual => ", vcan (no CAN timing)",
            InterfaceKind::Can => "",
            _ => " (kind unknown)",
        };
        Self {
            bus: format!("{bus}{suffix}"),
            is_can,
            answered_by: match times.by {
                AnsweredBy::Rig(node) => format!("rig {node}"),
                AnsweredBy::Loopback => "loopback".to_owned(),
            },
            sent: times.sent,
            lost: times.lost,
            answer_us: Distribution::of(&times.times_ns),
        }
    }

    /// The name of its row.
    fn name(&self) -> String {
        let by = match self.answered_by.as_str() {
            "loopback" => "no rig: back to a second socket".to_owned(),
            rig => format!("{rig}, sync to heartbeat"),
        };
        format!("answer on {}: {by}", self.bus)
    }

    fn check(&self) -> Check {
        let (what, expected) = ("answers lost", "0");
        if self.sent + self.lost == 0 {
            let why = "the measurement was too short for an announcement";
            return Check::unknown(what, "none sent", expected, why);
        }
        let found = format!("{} of {}", self.lost, self.sent.max(self.lost));
        let advice = "a frame was dropped, or the answer took longer than 15 ms: doctor looks at \
                      the bus";
        Check::good(what, found, expected).or_change(self.lost == 0, advice, "yawbench doctor")
    }
}

/// What is wrong where the loop is late.
const HELD_BACK: &str = "something delays the loop (a tick is skipped where the cycle before it was \
                         more than a period late): doctor names what";

fn lateness(found: Option<Distribution>, budget_us: f64) -> Check {
    let (what, expected) = ("lateness, worst", format!("at most {budget_us} us"));
    let Some(found) = found else {
        return Check::unknown(what, "-", &expected, "no tick was met");
    };
    Check::good(what, format!("{:.0} us", found.max), expected).or_change(
        found.max <= budget_us,
        HELD_BACK,
        "yawbench doctor",
    )
}

fn skipped(measured: &Measured) -> Check {
    let found = format!("{} of {}", measured.skipped, measured.expected);
    Check::good("ticks skipped", found, "0").or_change(
        measured.skipped == 0,
        HELD_BACK,
        "yawbench doctor",
    )
}

fn step(found: Option<Distribution>, setup: &Setup) -> Check {
    let limit_us = STEP_SHARE * 1e-3 * setup.rate.cycle_ns() as f64;
    let (what, expected) = ("vehicle step, worst", format!("at most {limit_us} us"));
    let Some(found) = found else {
        let why = match setup.vehicle {
            Some(_) => "no tick was met",
            None => "no scenario was given: `yawbench rtcheck scenarios/ss9-160kmh.toml`",
        };
        return Check::unknown(what, "-", &expected, why);
    };
    // A step that is interrupted is long once; one that is too much work is long always.
    let is_interrupted = found.p99 <= limit_us;
    let (advice, command) = match (is_interrupted, cfg!(debug_assertions)) {
        (true, _) => (
            "the step itself is short, but it is interrupted: doctor names what",
            "yawbench doctor",
        ),
        (false, true) => {
            ("this is a build for tests: measure a release build", "cargo build --release")
        }
        (false, false) => (
            "the processor is too slow for this vehicle: choose a faster one, a simpler creep law \
             or fewer substeps, or stretch the run with --slow-down",
            "",
        ),
    };
    let check = Check::good(what, format!("{:.0} us", found.max), expected).or_change(
        found.max <= limit_us,
        advice,
        command,
    );
    debug_assert!(check.verdict != Verdict::Unknown, "a step that was measured is judged");
    check
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rtcheck::distribution::empty;
    use can_protocol::Node;

    /// Times in microseconds, and how often.
    fn times(list: &[(u64, u64)]) -> hdrhistogram::Histogram<u64> {
        let mut histogram = empty();
        for (time_us, count) in list {
            histogram.saturating_record_n(time_us * 1000, *count);
        }
        histogram
    }

    fn held() -> Measured {
        Measured {
            realtime: crate::realtime::RealtimeReport::default(),
            expected: 1000,
            met: 1000,
            skipped: 0,
            is_interrupted: false,
            lateness_ns: times(&[(5, 999), (40, 1)]),
            step_ns: times(&[(30, 1000)]),
            answers: Some(AnswerTimes {
                by: AnsweredBy::Rig(Node::ALL[0]),
                sent: 10,
                lost: 0,
                times_ns: times(&[(400, 10)]),
            }),
            beside_page: None,
        }
    }

    fn setup(kind: InterfaceKind) -> Setup {
        Setup {
            rate: Rate::Usual,
            budget_us: 100.0,
            vehicle: Some("SS9".to_owned()),
            bus: Some(("socketcan:x0".to_owned(), kind)),
        }
    }

    fn failing(result: &RtCheck) -> Vec<&str> {
        let checks = result.checks.iter().filter(|check| check.verdict == Verdict::Change);
        checks.map(|check| check.what.as_str()).collect()
    }

    #[test]
    fn everything_within_its_limit_is_held() {
        let result = RtCheck::of(&held(), &setup(InterfaceKind::Can));
        assert_eq!((result.outcome, failing(&result)), (Outcome::Held, vec![]));
        let text = result.lines().join("\n");
        assert!(text.contains("answer on socketcan:x0: rig 1, sync to heartbeat"), "{text}");
        assert!(text.contains("1000 ticks of 1000 us: 1000 met, 0 skipped"), "{text}");
        assert!(text.ends_with("as it was measured."), "{text}");
    }

    #[test]
    fn each_limit_fails_on_its_own() {
        type Change = fn(&mut Measured);
        let cases: [(&str, Change); 4] = [
            ("lateness, worst", |m| m.lateness_ns = times(&[(5, 999), (102, 1)])),
            ("ticks skipped", |m| (m.met, m.skipped) = (999, 1)),
            ("vehicle step, worst", |m| m.step_ns = times(&[(30, 999), (502, 1)])),
            ("answers lost", |m| m.answers.as_mut().unwrap().lost = 1),
        ];
        for (what, change) in cases {
            let mut measured = held();
            change(&mut measured);
            let result = RtCheck::of(&measured, &setup(InterfaceKind::Can));
            assert_eq!((result.outcome, failing(&result)), (Outcome::NotHeld, vec![what]));
            let check = result.checks.iter().find(|check| check.what == what).unwrap();
            assert_eq!(check.command, "yawbench doctor", "{what}");
        }
    }

    #[test]
    fn the_times_beside_a_page_stand_next_to_those_without() {
        let part = |lateness_us| PartTimes {
            lateness_ns: times(&[(lateness_us, 999), (10 * lateness_us, 1)]),
            step_ns: times(&[(30, 1000)]),
        };
        let beside_page = Some(BesidePage { fed: part(6), unfed: part(5) });
        let result = RtCheck::of(&Measured { beside_page, ..held() }, &setup(InterfaceKind::Can));
        let text = result.lines().join("\n");
        let row = |name: &str| {
            let line = text.lines().find(|line| line.contains(name)).unwrap_or_default();
            let numbers = line.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
            numbers.map(f64::round).collect::<Vec<_>>()
        };
        assert_eq!(row("lateness, page fed"), [6.0, 6.0, 6.0, 60.0, 60.0], "{text}");
        assert_eq!(row("lateness, page not fed"), [5.0, 5.0, 5.0, 50.0, 50.0], "{text}");
        assert_eq!(row("vehicle step, page fed").len(), 5, "{text}");
        let beside = result.beside_page.unwrap();
        assert!(beside.fed.lateness_us.unwrap().p50 > beside.unfed.lateness_us.unwrap().p50);
    }

    #[test]
    fn a_virtual_bus_is_not_called_can() {
        for kind in [InterfaceKind::Virtual, InterfaceKind::Unread("no ip".to_owned())] {
            let result = RtCheck::of(&held(), &setup(kind));
            assert!(result.answers.is_some_and(|answers| !answers.is_can));
        }
        let mut measured = held();
        measured.answers.as_mut().unwrap().by = AnsweredBy::Loopback;
        let result = RtCheck::of(&measured, &setup(InterfaceKind::Virtual));
        let expected = "answer on socketcan:x0, vcan (no CAN timing): no rig: back to a second \
                        socket";
        let text = result.lines().join("\n");
        assert!(text.contains(expected), "{text}");
    }

    #[test]
    fn nothing_measured_is_not_held() {
        let mut measured = Measured { expected: 0, met: 0, is_interrupted: true, ..held() };
        (measured.lateness_ns, measured.step_ns, measured.answers) = (empty(), empty(), None);
        let bare = Setup { rate: Rate::Usual, budget_us: 100.0, vehicle: None, bus: None };
        let result = RtCheck::of(&measured, &bare);
        assert_eq!((result.outcome, failing(&result)), (Outcome::NotHeld, vec![]));
        assert!(!result.lines().join("\n").contains("NaN"));
    }
}
