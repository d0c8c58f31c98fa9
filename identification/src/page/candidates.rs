//! Candidates by their gain on left-out pieces.

use super::prefix::quantity;
use super::words::spoken;
use crate::identify::Identification;
use report::{Cell, Plot, Section, Table};

/// A loss beyond this is drawn to the edge, %: the size of a loss does not matter.
const WORST_DRAWN: f64 = -20.0;

/// Candidates, ranked.
pub(super) fn section(identification: &Identification) -> Section {
    let result = &identification.result;
    let findings = &identification.findings;
    let samples = identification.train.counted_samples().max(1) as f64;
    let error_n = |total_n2: f64| quantity((total_n2 / samples).sqrt(), "N");
    let before = error_n(findings.refitted.left_out.total_n2());
    let mut section = Section::new("Candidates").text(&format!(
        "Every effect of the catalogue was compared with the residual to first order; the best \
         were fitted together with all other parameters and judged on pieces of record that \
         their fit had not seen. There the error of the refitted model is {before} rms{}. The \
         gain is the share of that squared error that a candidate removes.",
        if result.effects.is_empty() {
            String::new()
        } else {
            let after = error_n(findings.with_effects.left_out.total_n2());
            format!(", that of the final one {after}")
        }
    ));
    let added: Vec<(String, f64)> = result
        .effects
        .iter()
        .map(|effect| (spoken(effect.name), 100.0 * effect.evidence.holdout_gain))
        .collect();
    let mut tried: Vec<(String, f64)> = result
        .rejected
        .iter()
        .filter_map(|rejected| Some((spoken(rejected.name), 100.0 * rejected.holdout_gain?)))
        .collect();
    tried.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    if !added.is_empty() || !tried.is_empty() {
        let largest = added.iter().chain(&tried).fold(0.0, |most: f64, (_, gain)| most.max(*gain));
        let least = tried.iter().fold(0.0, |least: f64, (_, gain)| least.min(*gain));
        let mut plot = Plot::new("Gain on left-out pieces")
            .palette(&["added", "tried and not added"])
            .x("squared error removed", "%")
            .at("", 3.0)
            .x_range(least.max(WORST_DRAWN) - 0.5..=(1.08 * largest).max(5.0))
            .caption(if added.is_empty() {
                "An effect is added from 3 % on (dotted), if it passes all other tests too."
            } else {
                "The gain of an added effect counts from the model before it, that of the others \
                 from the final model. Dotted: the 3 % that are needed."
            });
        for (name, bars) in [("added", &added), ("tried and not added", &tried)] {
            if !bars.is_empty() {
                let (names, gains): (Vec<&str>, Vec<f64>) =
                    bars.iter().map(|(name, gain)| (name.as_str(), *gain)).unzip();
                plot = plot.named_bars(name, &names, &gains);
            }
        }
        section = section.plot(plot);
    } else {
        section = section.text(if result.interrupted {
            "None was judged before the search was interrupted."
        } else {
            "None was fitted: to first order none explains the residual."
        });
    }
    section.table(table(identification))
}

fn table(identification: &Identification) -> Table {
    let result = &identification.result;
    let mut table = Table::new("Candidates by their gain on left-out pieces")
        .text("effect")
        .text("verdict")
        .number_with_digits("gain", "%", 3)
        .text("why");
    for effect in &result.effects {
        let evidence = &effect.evidence;
        table = table.row([
            Cell::from(effect.name),
            "added".into(),
            (100.0 * evidence.holdout_gain).into(),
            format!(
                "{:.0} % of the pieces improved or unchanged, {}",
                100.0 * evidence.tests_improved,
                super::words::probability(evidence.p_value)
            )
            .into(),
        ]);
    }
    let mut rejected: Vec<_> = result.rejected.iter().collect();
    let gain = |gain: Option<f64>| gain.unwrap_or(f64::NEG_INFINITY);
    rejected.sort_by(|a, b| gain(b.holdout_gain).total_cmp(&gain(a.holdout_gain)));
    for rejected in rejected {
        table = table.row([
            Cell::from(rejected.name),
            "not added".into(),
            rejected.holdout_gain.map(|gain| 100.0 * gain).into(),
            rejected.why.as_str().into(),
        ]);
    }
    table
}
