//! The result as text for a terminal, and the tables that the page shares with it.

use super::identify::OnMass;
use super::result::{LawFound, OnMassResult};
use report::{Cell, Table};

impl OnMass {
    /// The summary for a terminal.
    pub fn summary(&self) -> String {
        let result = &self.result;
        let mut lines = Vec::new();
        if result.interrupted {
            lines.push("interrupted: the findings are those of the search so far\n".to_owned());
        }
        lines.push(format!("{}\n", result.sentence()));
        for table in [models(result), records(result), parameters(result)] {
            lines.push(format!("\n{}", table.to_text()));
        }
        lines.push("\n".to_owned());
        lines.extend(result.laws.iter().filter(|law| !law.given).map(law));
        lines.extend(
            result.unexplained.iter().map(|part| format!("unexplained: {}\n", part.description)),
        );
        lines.push(format!("noise floor: {}\n", floor(result)));
        lines.extend(result.notes.iter().map(|note| format!("note: {note}\n")));
        lines.concat()
    }
}

/// The noise floor in words.
pub(super) fn floor(result: &OnMassResult) -> String {
    match result.noise_floor {
        Some(floor) => {
            format!("{floor:.3e} {}, {}", result.unit, result.noise_floor_method)
        }
        None => result.noise_floor_method.clone(),
    }
}

/// One law in words.
pub(super) fn law(law: &LawFound) -> String {
    let gain = law.gain.map_or(String::new(), |gain| {
        format!(": removes {:.2} % of the squared error on left-out parts", 100.0 * gain)
    });
    let mut text = format!("{} ({}){gain}\n", law.name, law.equation);
    if let Some(remark) = &law.remark {
        text.extend(["  ", remark, "\n"]);
    }
    if !law.alternatives.is_empty() {
        text.extend(["  cannot be distinguished from ", &law.alternatives.join(", "), "\n"]);
    }
    text
}

/// Errors of the models.
pub(super) fn models(result: &OnMassResult) -> Table {
    let table = Table::new(&format!("Error of the {} in free run, rms", result.output))
        .text("model")
        .number("training", result.unit)
        .number("left-out parts", result.unit)
        .number("held out", result.unit);
    let rows = result.models.iter().enumerate().map(|(n, model)| {
        let name = if n < result.kept { model.name.clone() } else { format!("({})", model.name) };
        [name.into(), model.train_rms.into(), model.left_out_rms.into(), model.holdout_rms.into()]
    });
    let floor = result.noise_floor;
    table.rows(rows).row(["noise floor".into(), floor.into(), Cell::Empty, Cell::Empty])
}

/// Errors record by record.
pub(super) fn records(result: &OnMassResult) -> Table {
    let first = result.models.first().map_or("first model", |model| model.name.as_str());
    let table = Table::new("Error record by record, rms")
        .text("record")
        .text("role")
        .text("start")
        .number("periods", "")
        .number("motion", result.unit)
        .number(first, result.unit)
        .number("kept model", result.unit);
    table.rows(result.per_record.iter().map(|row| {
        [
            row.name.as_str().into(),
            if row.role == "holdout" { "held out" } else { "fitted" }.into(),
            row.start.into(),
            (row.periods as u64).into(),
            row.motion_rms.into(),
            row.first_rms.into(),
            row.kept_rms.into(),
        ]
    }))
}

/// All parameters of the kept model.
pub(super) fn parameters(result: &OnMassResult) -> Table {
    let table = Table::new("Parameters")
        .text("parameter")
        .written("identified", "")
        .written("+-", "")
        .text("unit");
    let body = result.body.iter().map(|(name, value)| (name.clone(), value));
    let laws = result.laws.iter().flat_map(|law| {
        law.parameters.iter().map(|(name, value)| (format!("{}.{name}", law.name), value))
    });
    table.rows(body.chain(laws).map(|(name, value)| {
        let std = value.std.map_or_else(|| "not fixed".to_owned(), |std| format!("{std:.1e}"));
        [name.into(), format!("{:.5e}", value.value).into(), std.into(), value.unit.into()]
    }))
}

/// The candidates of one round.
pub(super) fn candidates(result: &OnMassResult, round: usize) -> Table {
    let percent = |share: Option<f64>| Cell::from(share.map(|share| 100.0 * share));
    let table = Table::new(&format!("Round {}", round + 1))
        .text("candidate")
        .number("training", result.unit)
        .number("left-out parts", result.unit)
        .fixed("gain, training", "%", 1)
        .fixed("gain, left out", "%", 1)
        .number("better parts of 6", "")
        .text("");
    let Some(round) = result.rounds.get(round) else { return table };
    let mut rows: Vec<_> = round.candidates.iter().collect();
    let key = |gain: Option<f64>| gain.unwrap_or(f64::NEG_INFINITY);
    rows.sort_by(|a, b| {
        let own = key(b.gain).total_cmp(&key(a.gain));
        own.then(key(b.fitted_gain).total_cmp(&key(a.fitted_gain)))
    });
    table.rows(rows.into_iter().map(|one| {
        [
            one.name.into(),
            one.train_rms.into(),
            one.left_out_rms.into(),
            percent(one.fitted_gain),
            percent(one.gain),
            one.better_parts.map(|parts| parts as u64).into(),
            if round.accepted == Some(one.name) { "accepted" } else { "" }.into(),
        ]
    }))
}
