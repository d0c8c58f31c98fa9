//! Effects that these records could not distinguish or show, and the tests that would.

use super::words::{listed, spoken};
use crate::identify::Identification;
use firmware_core::damper::effects::CATALOGUE;
use report::{Section, Table};

/// The limits of these records.
pub(super) fn section(identification: &Identification) -> Section {
    let result = &identification.result;
    let mut section = Section::new("Effects that could not be distinguished or tested");
    let rivals: Vec<_> =
        result.effects.iter().filter(|effect| !effect.alternatives.is_empty()).collect();
    if rivals.is_empty() && !result.effects.is_empty() {
        section = section.text(
            "These records distinguish every effect that was added from all \
                                others that they can show.",
        );
    }
    for effect in rivals {
        let group: Vec<String> = std::iter::once(effect.name)
            .chain(effect.alternatives.iter().copied())
            .map(spoken)
            .collect();
        let mut table = Table::new(&format!("Not distinguished: {}", listed(&group)))
            .text("effect")
            .text("test that shows it");
        for name in std::iter::once(effect.name).chain(effect.alternatives.iter().copied()) {
            let info = CATALOGUE.iter().find(|info| info.name == name);
            table = table.row([name.into(), info.map_or("", |info| info.shown_by).into()]);
        }
        section = section.table(table);
    }
    if result.not_testable.is_empty() {
        return section.text("Every effect of the catalogue would show in these records.");
    }
    let mut table = Table::new("Effects that these records cannot show")
        .text("effect")
        .text("why")
        .text("test that would show it");
    for hidden in &result.not_testable {
        table = table.row([
            hidden.name.into(),
            hidden.why.as_str().into(),
            hidden.test_that_would.as_str().into(),
        ]);
    }
    section
        .text("These effects may be present or not. The test in the last column would show it.")
        .table(table)
}
