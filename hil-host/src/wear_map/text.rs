//! A map in words and tables.

use super::{Cell, WearMap};
use report::{Cell as Entry, Table};

impl WearMap {
    /// The rigs, in their order.
    pub(super) fn rigs(&self) -> Vec<&str> {
        distinct(self.cells.iter().map(|cell| cell.rig.as_str()))
    }

    /// The specimens, in their order.
    pub(super) fn specimens(&self) -> Vec<&'static str> {
        distinct(self.cells.iter().map(|cell| cell.specimen))
    }

    /// Cells that a run would accept and that do not hold.
    pub fn broken(&self) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(|cell| cell.is_accepted && !cell.holds)
    }

    /// One row for each rig and specimen: the worst of its cells.
    pub fn summary(&self) -> Table {
        let mut table = Table::new("Worst of all clearances and stiffnesses")
            .text("rig")
            .text("damper on the rig")
            .fixed("force error", "%", 1)
            .fixed("work error", "%", 1)
            .fixed("against wear on the rig", "%", 1)
            .fixed("mismatch", "%", 1)
            .fixed("loop gain", "", 2)
            .fixed("expected error", "%", 1)
            .fixed("rounding", "mm", 2)
            .text("accepted")
            .text("of them hold");
        for rig in self.rigs() {
            for specimen in self.specimens() {
                let own = || {
                    self.cells.iter().filter(|cell| cell.rig == rig && cell.specimen == specimen)
                };
                let worst = |of: fn(&Cell) -> f64| own().map(of).fold(0.0_f64, f64::max);
                let accepted = own().filter(|cell| cell.is_accepted).count();
                let held = own().filter(|cell| cell.is_accepted && cell.holds).count();
                table = table.row([
                    Entry::Text(rig.to_owned()),
                    Entry::Text(specimen.to_owned()),
                    Entry::Number(worst(|cell| cell.force_error_percent)),
                    Entry::Number(worst(|cell| cell.work_error_percent.abs())),
                    Entry::Number(worst(|cell| cell.on_rig_force_error_percent)),
                    Entry::Number(worst(|cell| cell.mismatch_percent.unwrap_or(0.0))),
                    Entry::Number(worst(|cell| cell.loop_gain.unwrap_or(0.0))),
                    Entry::Number(worst(|cell| cell.expected_error_percent.unwrap_or(0.0))),
                    Entry::Number(worst(|cell| cell.rounding_mm)),
                    Entry::Text(format!("{accepted} of {}", own().count())),
                    Entry::Text(format!("{held} of {accepted}")),
                ]);
            }
        }
        table
    }

    /// Every cell, as it can be pasted.
    pub(super) fn every_cell(&self) -> Table {
        let table = Table::new("Every cell")
            .text("rig")
            .text("damper on the rig")
            .fixed("2a", "mm", 1)
            .fixed("Ke", "MN/m", 2)
            .fixed("force error", "%", 2)
            .fixed("work error", "%", 2)
            .fixed("of its own work", "%", 1)
            .fixed("force, against wear on the rig", "%", 2)
            .fixed("work, against wear on the rig", "%", 2)
            .fixed("mismatch", "%", 1)
            .fixed("loop gain", "", 3)
            .fixed("expected error", "%", 2)
            .fixed("rounding", "mm", 2)
            .fixed("limited", "%", 1)
            .text("accepted")
            .text("holds");
        let yes = |is_so: bool| Entry::Text(if is_so { "yes" } else { "no" }.to_owned());
        let or_nan = |value: Option<f64>| Entry::Number(value.unwrap_or(f64::NAN));
        table.rows(self.cells.iter().map(|cell| {
            [
                Entry::Text(cell.rig.clone()),
                Entry::Text(cell.specimen.to_owned()),
                Entry::Number(cell.clearance_2a_mm),
                Entry::Number(cell.ke_mn_per_m),
                Entry::Number(cell.force_error_percent),
                Entry::Number(cell.work_error_percent),
                Entry::Number(cell.own_work_error_percent),
                Entry::Number(cell.on_rig_force_error_percent),
                Entry::Number(cell.on_rig_work_error_percent),
                or_nan(cell.mismatch_percent),
                or_nan(cell.loop_gain),
                or_nan(cell.expected_error_percent),
                Entry::Number(cell.rounding_mm),
                Entry::Number(cell.limited_percent),
                yes(cell.is_accepted),
                yes(cell.holds),
            ]
        }))
    }

    /// What holds, in a sentence.
    pub fn in_words(&self) -> String {
        let accepted = self.cells.iter().filter(|cell| cell.is_accepted).count();
        let broken = self.broken().count();
        let Self { most_force_error_percent: force, most_work_error_percent: work, .. } = self;
        format!(
            "{} of {accepted} accepted cells hold: force within {force} % and work per cycle within \
             {work} % of the healthy damper's. Emulated rigs.",
            accepted - broken
        )
    }
}

/// Each once, in the order in which they come.
fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for item in items {
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}
