//! Runs side by side, in words and tables.

use super::condition::Differing;
use super::result::{ComparedGroup, GroupComparison, SideBySide, Spread};
use crate::comparison::readable;
use files::quote::escaped;
use report::{Cell, Table};
use std::fmt;

/// Most keys that a line names.
const KEYS_MAX: usize = 4;

impl SideBySide {
    /// Mean and spread of every quantity in every group.
    pub(super) fn repeats_table(&self) -> Table {
        let mut table = Table::new("Repeats").text("quantity").text("unit");
        for group in &self.groups {
            let name = &group.name;
            table = table
                .number_with_digits(&format!("{name} mean"), "", 6)
                .number_with_digits(&format!("{name} sd"), "", 2)
                .number_with_digits(&format!("{name} range"), "", 2);
        }
        let rows = self.repeats.iter().map(|quantity| {
            let (scale, unit) = readable(quantity.unit);
            let name = [quantity.quantity.as_str().into(), unit.into()];
            let spreads = quantity.groups.iter().flat_map(move |spread| spread.cells(scale));
            name.into_iter().chain(spreads).collect::<Vec<Cell>>()
        });
        table.rows(rows)
    }

    /// The same with its last lines, which say what is larger.
    pub(super) fn worded(mut self) -> Self {
        self.in_words = self.comparisons.iter().map(GroupComparison::in_words).collect();
        if self.comparisons.is_empty() {
            let only = "one condition in all files: a spread and no difference; --group names \
                groups that the files do not tell apart";
            self.in_words.push(only.to_owned());
        }
        self
    }

    /// One line for each group, with its runs and in what they differ.
    pub(super) fn groups_in_words(&self) -> Vec<String> {
        self.groups.iter().map(ComparedGroup::in_words).collect()
    }

    /// How the words were found.
    pub(super) fn rule(&self) -> String {
        let percent = 100.0 * self.level;
        format!(
            "Larger than repeatability: with all quantities judged together (Holm), a claim too \
             many in at most {percent} % of such comparisons. Intervals are 95 % one by one \
             (Welch), so one that leaves out zero is not yet a claim."
        )
    }
}

impl Spread {
    fn cells(&self, scale: f64) -> [Cell; 3] {
        let range = self.min.zip(self.max).map(|(min, max)| max - min);
        // The range of one run is no range.
        let range = range.filter(|_| self.count > 1);
        [self.mean, self.standard_deviation, range].map(|value| value.map(|of| scale * of).into())
    }
}

impl ComparedGroup {
    fn in_words(&self) -> String {
        let runs: Vec<&str> = self.runs.iter().map(|run| run.run.as_str()).collect();
        let repeats = self.runs.iter().filter(|run| run.is_repeat).count();
        let count = if repeats == 1 { "1 run".to_owned() } else { format!("{repeats} runs") };
        let shown = self.differing.iter().take(KEYS_MAX).map(Differing::shown);
        let shown: Vec<String> = shown.collect();
        let more = match self.differing.len().saturating_sub(KEYS_MAX) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let differs = match shown[..] {
            [] => String::new(),
            _ => format!("; differs in {}{more}", shown.join(", ")),
        };
        let line = format!("{}: {count} ({}){differs}", self.name, runs.join(", "));
        escaped(&line)
    }
}

impl GroupComparison {
    /// Every quantity with its difference.
    pub(super) fn table(&self) -> Table {
        let rows = self.quantities.iter().map(|row| {
            let (scale, unit) = readable(row.unit);
            let number = |value: Option<f64>| Cell::from(value.map(|value| scale * value));
            let word = if row.is_drifted() { ", and drift" } else { "" };
            [
                Cell::from(row.quantity.as_str()),
                Cell::from(unit),
                number(row.difference),
                number(row.interval.map(|[low, high]| 0.5 * (high - low))),
                row.percent().into(),
                number(row.drift),
                Cell::Text(format!("{}{word}", row.trust.name())),
            ]
        });
        Table::new(&format!("{} less {}", self.group, self.against))
            .text("quantity")
            .text("unit")
            .number("difference", "")
            .number_with_digits("95 % ±", "", 2)
            .number_with_digits("of the mean", "%", 3)
            .number_with_digits("ABA drift", "", 2)
            .text("the difference is")
            .rows(rows)
    }

    /// Whether the difference or repeatability is larger.
    pub(super) fn in_words(&self) -> String {
        let Self { group, against, larger, within, unknown, .. } = self;
        let (all, what) =
            (larger + within + unknown, if self.is_wear { "wear" } else { "the difference" });
        let found = match () {
            () if *unknown == all => format!(
                "unknown in all {all} quantities: a group of fewer than two repeats has no spread"
            ),
            () if larger >= within => format!(
                "{what} is larger than repeatability in {larger} of {all} quantities, within it in \
                 {within}, unknown in {unknown}"
            ),
            () => format!(
                "{what} is within repeatability in {within} of {all} quantities, larger in \
                 {larger}, unknown in {unknown}"
            ),
        };
        let drift = match (&self.aba, self.drifted) {
            (None, _) => "no ABA test: a drift of the bench would look the same".to_owned(),
            (Some(aba), _) if *larger == 0 => format!("an ABA test with {}", aba.group),
            (Some(aba), 0) => {
                format!("drift by ABA ({}) is less than half of each of these", aba.group)
            }
            (Some(aba), n) => {
                format!("drift by ABA ({}) is more than half of {n} of these", aba.group)
            }
        };
        escaped(&format!("{group} against {against}: {found}; {drift}"))
    }
}

impl fmt::Display for SideBySide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.groups_in_words().iter().try_for_each(|line| writeln!(f, "{line}"))?;
        writeln!(f, "\n{}", self.repeats_table())?;
        self.comparisons.iter().try_for_each(|found| writeln!(f, "{}", found.table()))?;
        if !self.comparisons.is_empty() {
            writeln!(f, "{}", self.rule())?;
        }
        for note in &self.notes {
            writeln!(f, "note: {}", escaped(note))?;
        }
        self.in_words.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}
