//! The report of a map.

use super::{Cell, WearMap};
use report::{Plot, Report, Section};

impl WearMap {
    /// The report, behind its title and facts.
    pub fn page(&self, report: Report) -> Report {
        let Self { most_force_error_percent: force, most_work_error_percent: work, .. } = self;
        let found = Section::new("Where wear in software holds")
            .text(&self.in_words())
            .note(&format!(
                "Errors are those of a damper behind wear in software against one with the wear in \
                 its joint, on the same emulated rig. A cell holds with a force within {force} % of \
                 the healthy damper's and a work per cycle within {work} % of its work."
            ))
            .table(self.summary());
        let report = report.subtitle("Wear in software against wear in the joint").section(found);
        let maps =
            self.rigs().into_iter().fold(report, |report, rig| report.section(self.map(rig)));
        maps.section(Section::new("Every cell").table(self.every_cell()))
    }

    /// The worst of all specimens on a rig, over clearance and stiffness.
    fn map(&self, rig: &str) -> Section {
        let of_rig: Vec<&Cell> = self.cells.iter().filter(|cell| cell.rig == rig).collect();
        let axis = |of: fn(&Cell) -> f64| {
            let mut values: Vec<f64> = of_rig.iter().map(|cell| of(cell)).collect();
            values.sort_unstable_by(f64::total_cmp);
            values.dedup();
            values
        };
        let (clearances, stiffnesses) =
            (axis(|cell| cell.clearance_2a_mm), axis(|cell| cell.ke_mn_per_m));
        let worst = |of: fn(&Cell) -> f64| -> Vec<f64> {
            let at = |ke: f64, clearance: f64| {
                let here = of_rig
                    .iter()
                    .filter(|cell| cell.ke_mn_per_m == ke && cell.clearance_2a_mm == clearance);
                here.map(|cell| of(cell).abs()).fold(0.0_f64, f64::max)
            };
            let places =
                stiffnesses.iter().flat_map(|ke| clearances.iter().map(move |a| (*ke, *a)));
            places.map(|(ke, clearance)| at(ke, clearance)).collect()
        };
        let plot = |title: &str, of: fn(&Cell) -> f64| {
            Plot::new(title).x("clearance 2a", "mm").y("stiffness Ke", "MN/m").map(
                "error",
                "%",
                &clearances,
                &stiffnesses,
                &worst(of),
            )
        };
        Section::new(rig)
            .text("The worst of all dampers on the rig.")
            .plot(plot("Error of the force", |cell| cell.force_error_percent))
            .plot(plot("Error of the work per cycle", |cell| cell.work_error_percent))
    }
}
