//! A rehearsal as text for a terminal.

use super::{CheckMargin, Rehearsal, Verdict};
use crate::control::End;
use report::{Cell, Table, significant};
use std::fmt;

impl fmt::Display for Rehearsal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        let (seconds, kmh) = (self.duration_s, self.speed_kmh);
        write!(f, "emulated rig: {seconds:.1} s at {kmh:.0} km/h, {}", self.state.name())?;
        if let Some(ram) = &self.ram {
            write!(f, "; the ram is {:.2} ms late ({})", 1e3 * ram.delay_s, ram.source)?;
        }
        writeln!(f)?;
        for line in table(&self.checks).lines() {
            writeln!(f, "{line}")?;
        }
        if let Some(cause) = &self.cause {
            writeln!(f, "ended early {}: what comes later is not known", cause.message)?;
        }
        f.write_str(&self.last_line())
    }
}

impl Rehearsal {
    fn last_line(&self) -> String {
        let with = |verdict: Verdict| {
            let checks = self.checks.iter().filter(|check| check.verdict == verdict);
            checks.map(CheckMargin::name).collect::<Vec<_>>()
        };
        let (beyond, small) = (with(Verdict::Beyond), with(Verdict::Small));
        let cut = match with(Verdict::Cut).join(", ") {
            none if none.is_empty() => none,
            cut => format!(
                "; cut on purpose, at contacts of virtual_wear that no ram can follow and the limits \
                 round: {cut}"
            ),
        };
        if !beyond.is_empty() {
            format!("beyond: {}", beyond.join(", "))
        } else if self.state != End::Completed {
            "not completed".to_owned()
        } else if small.is_empty() {
            format!("every limit holds{cut}")
        } else {
            format!("every limit holds; less than a fifth is left: {}{cut}", small.join(", "))
        }
    }
}

impl CheckMargin {
    /// The check with the place that it is of.
    fn name(&self) -> String {
        match &self.place {
            Some(place) => format!("{place} {}", self.check),
            None => self.check.to_owned(),
        }
    }
}

fn table(checks: &[CheckMargin]) -> Table {
    let table = Table::new("")
        .text("of")
        .text("check")
        .written("reached", "")
        .written("limit", "")
        .text("unit")
        .fixed("margin", "%", 0)
        .text("verdict");
    let written = |value: Option<f64>| value.map(|value| significant(value, 3));
    table.rows(checks.iter().map(|check| -> [Cell; 7] {
        [
            check.place.as_deref().unwrap_or("run").into(),
            check.check.into(),
            written(check.reached).into(),
            written(check.limit).into(),
            check.unit.unwrap_or_default().into(),
            check.margin_percent.into(),
            check.verdict.name().into(),
        ]
    }))
}
