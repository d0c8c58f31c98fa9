//! The report of runs side by side.

use super::result::{Difference, GroupComparison, SideBySide};
use super::trust::Trust;
use report::{Cell, Plot, Report, Section, Table};

/// All words, in the order of their colours.
const TRUSTS: [Trust; 3] =
    [Trust::LargerThanRepeatability, Trust::WithinRepeatability, Trust::Unknown];

impl SideBySide {
    /// The report.
    pub fn page(&self) -> Report {
        let mut first = Section::new("Differences and repeats");
        for line in self.in_words.iter().chain(&self.groups_in_words()) {
            first = first.text(line);
        }
        let first = self.notes.iter().fold(first, |section, note| section.warning(note));
        let report = Report::new("Runs side by side").section(first);
        let report = self
            .comparisons
            .iter()
            .fold(report, |report, found| report.section(self.section(found)));
        let spread = Section::new("Repeats")
            .text("Mean, standard deviation (n - 1) and range of the repeats of each group.")
            .table(self.repeats_table());
        report.section(spread).section(Section::new("Runs").table(self.runs_table()))
    }

    fn section(&self, found: &GroupComparison) -> Section {
        Section::new(&format!("{} against {}", found.group, found.against))
            .text(&found.in_words())
            .note(&self.rule())
            .plot(plot(found))
            .table(found.table())
    }

    fn runs_table(&self) -> Table {
        let starts =
            || self.groups.iter().flat_map(|group| &group.runs).map(|run| run.started_unix_s);
        let begin_s = starts().fold(f64::INFINITY, f64::min);
        let rows = self.groups.iter().flat_map(|group| {
            group.runs.iter().map(move |run| {
                [
                    Cell::from(group.name.as_str()),
                    Cell::from(run.run.as_str()),
                    Cell::from((run.started_unix_s - begin_s) / 60.0),
                    Cell::from(run.trajectory_hash.as_str()),
                    Cell::from(if run.is_repeat { "" } else { "the same computation" }),
                    Cell::from(run.title.as_str()),
                ]
            })
        });
        Table::new("In the order of each group")
            .text("group")
            .text("run")
            .fixed("began", "min", 1)
            .text("trajectory hash")
            .text("repeat")
            .text("title")
            .rows(rows)
    }
}

/// Differences with their intervals, over the mean of the first group.
fn plot(found: &GroupComparison) -> Plot {
    let rows: Vec<(f64, f64, &Difference)> = found
        .quantities
        .iter()
        .enumerate()
        .filter_map(|(n, row)| {
            let reference = row.reference.filter(|reference| *reference != 0.0)?;
            Some(((n + 1) as f64, 100.0 / reference.abs(), row))
        })
        .collect();
    let GroupComparison { group, against, .. } = found;
    let mut plot = Plot::new(&format!("{group} less {against}, over the mean of {against}"))
        .caption("In the order of the table. Bars are 95 % intervals, one by one.")
        .x("row of the table", "")
        .y("difference", "%")
        .palette(&TRUSTS.map(Trust::name))
        .limit("no difference", 0.0);
    for (n, percent, row) in &rows {
        if let Some(interval) = row.interval {
            let ends = interval.map(|end| percent * end);
            plot = plot.line("95 % interval", &[*n, *n], &ends);
        }
    }
    for trust in TRUSTS {
        let of_word = rows.iter().filter(|(_, _, row)| row.trust == trust);
        let points = of_word.filter_map(|(n, percent, row)| Some((*n, percent * row.difference?)));
        let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
        if !x.is_empty() {
            plot = plot.scatter(trust.name(), &x, &y);
        }
    }
    plot
}
