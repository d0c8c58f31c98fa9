//! One check: what was looked at, what was found, what is expected, and the way out.

use report::{Cell, Table};
use serde::Serialize;

/// What a check comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As it should be.
    Good,
    /// Something is to be changed; [`Check::advice`] says what.
    Change,
    /// It cannot be judged; [`Check::advice`] says why.
    Unknown,
}

impl Verdict {
    /// The word for it, on the terminal and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Change => "change",
            Self::Unknown => "unknown",
        }
    }
}

/// One row of the answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// What was looked at.
    pub what: String,
    /// What was found, in words and with its unit.
    pub found: String,
    /// What is expected.
    pub expected: String,
    /// What it comes to.
    pub verdict: Verdict,
    /// What to change, or why it cannot be judged; empty where all is good.
    pub advice: String,
    /// A command that makes the change; empty where no single command does.
    pub command: String,
}

impl Check {
    /// A check that is good.
    pub(crate) fn good(what: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            what: what.to_owned(),
            found: found.into(),
            expected: expected.into(),
            verdict: Verdict::Good,
            advice: String::new(),
            command: String::new(),
        }
    }

    /// The same check, good or with something to change.
    #[must_use]
    pub(crate) fn or_change(self, is_good: bool, advice: &str, command: &str) -> Self {
        if is_good {
            return self;
        }
        let (advice, command) = (advice.to_owned(), command.to_owned());
        Self { verdict: Verdict::Change, advice, command, ..self }
    }

    /// A check that cannot be judged, and why.
    pub(crate) fn unknown(what: &str, found: &str, expected: &str, why: &str) -> Self {
        let check = Self::good(what, found, expected);
        Self { verdict: Verdict::Unknown, advice: why.to_owned(), ..check }
    }
}

/// Whether something is to be changed.
pub fn asks_for_a_change(checks: &[Check]) -> bool {
    checks.iter().any(|check| check.verdict == Verdict::Change)
}

/// The checks as a table, and below it what to change and what could not be judged. Checks with the
/// same advice share a paragraph, and a command stands on a line of its own, to be pasted.
///
/// ```
/// use hil_host::doctor::{Check, Verdict, lines};
/// let check = Check {
///     what: "queue".to_owned(),
///     found: "1000 frames".to_owned(),
///     expected: "4 to 10 frames".to_owned(),
///     verdict: Verdict::Change,
///     advice: "a long queue keeps old commands".to_owned(),
///     command: "sudo ip link set can0 txqueuelen 10".to_owned(),
/// };
/// assert_eq!(
///     lines("Bus", &[check]),
///     [
///         "Bus",
///         "check  found        expected        verdict",
///         "queue  1000 frames  4 to 10 frames  change",
///         "",
///         "To change:",
///         "- queue: a long queue keeps old commands",
///         "    sudo ip link set can0 txqueuelen 10",
///     ]
/// );
/// ```
pub fn lines(caption: &str, checks: &[Check]) -> Vec<String> {
    let table = Table::new("").text("check").text("found").text("expected").text("verdict");
    let table = table.rows(checks.iter().map(|check| -> [Cell; 4] {
        [
            check.what.as_str().into(),
            check.found.as_str().into(),
            check.expected.as_str().into(),
            check.verdict.name().into(),
        ]
    }));
    let mut lines = vec![caption.to_owned()];
    lines.extend(table.lines());
    for (verdict, heading) in
        [(Verdict::Change, "To change:"), (Verdict::Unknown, "Not judged, and why:")]
    {
        let shown: Vec<&Check> = checks.iter().filter(|check| check.verdict == verdict).collect();
        if !shown.is_empty() {
            lines.extend([String::new(), heading.to_owned()]);
            lines.extend(paragraphs(&shown));
        }
    }
    lines
}

/// Columns of a line of advice.
const WIDTH: usize = 100;

/// A text in lines of at most [`WIDTH`] columns where its words allow it, indented from the second.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in files::quote::escaped(text).split(' ') {
        let Some(line) = lines.last_mut() else { break };
        let is_empty = line.trim().is_empty();
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(format!("  {word}"));
        } else {
            line.push_str(if is_empty { "" } else { " " });
            line.push_str(word);
        }
    }
    lines
}

/// The advice of some checks; those that share it stand together.
fn paragraphs(checks: &[&Check]) -> Vec<String> {
    let mut lines = Vec::new();
    for (at, check) in checks.iter().enumerate() {
        let is_same =
            |other: &&&Check| (&other.advice, &other.command) == (&check.advice, &check.command);
        if checks.iter().take(at).any(|earlier| is_same(&earlier)) {
            continue;
        }
        let names: Vec<&str> = checks.iter().filter(is_same).map(|c| c.what.as_str()).collect();
        lines.extend(wrapped(&format!("- {}: {}", names.join(", "), check.advice)));
        if !check.command.is_empty() {
            lines.push(format!("    {}", files::quote::escaped(&check.command)));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_wraps_and_a_command_never_does() {
        let long = "word ".repeat(60).trim_end().to_owned();
        let check = Check::good("a", "b", "c").or_change(false, &long, &long);
        let lines = paragraphs(&[&check, &check]);
        let (command, advice) = lines.split_last().unwrap();
        assert_eq!(*command, format!("    {long}"));
        assert!(advice.len() == 4 && advice.iter().all(|line| line.chars().count() <= WIDTH));
        assert!(
            advice[0].starts_with("- a, a: word") && advice[1].starts_with("  word"),
            "{advice:?}"
        );
        let words = advice.iter().flat_map(|line| line.split_whitespace());
        assert_eq!(words.filter(|word| *word == "word").count(), 60);
    }
}
