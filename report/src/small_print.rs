//! The lines under a plot that say what the drawing leaves out.

use crate::number::significant;
use crate::plot::Plot;
use crate::series::{Kind, Trace};
use crate::thin::{self, MAX_DRAWN};

/// What a reader must know about the drawing: thinning and gaps.
pub(crate) fn lines(plot: &Plot) -> Vec<String> {
    let mut lines = Vec::new();
    let traces = || plot.panels.iter().flat_map(|p| p.traces.iter().map(move |t| (p, t)));
    for (_, trace) in traces().filter(|(_, trace)| all(trace) > MAX_DRAWN as u64) {
        let off_by = || thin::choose(&trace.x, &trace.y, false, plot.x.log, None).off_by;
        let how = match trace.kind {
            Kind::Bars | Kind::Map { .. } | Kind::NamedBars { .. } => continue,
            Kind::Scatter => "the outermost of every stretch".to_owned(),
            Kind::Line { .. } | Kind::Backdrop | Kind::LineWithPoints | Kind::Band { .. } => {
                match off_by() {
                    Some(share) => {
                        let percent = significant(100.0 * share, 2);
                        format!("so that the line is off by less than {percent} % of its span")
                    }
                    None => {
                        "the smallest and the largest of every step, so peaks are true".to_owned()
                    }
                }
            }
        };
        let drawn = match trace.y.len() {
            kept if kept > MAX_DRAWN => format!("at most about {MAX_DRAWN}"),
            kept => kept.to_string(),
        };
        let line = format!("Drawn with {drawn} of {} samples, {how}.", all(trace));
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    for (panel, trace) in traces() {
        let (gaps, samples) = match trace.of {
            Some(of) => (of.not_finite, of.all),
            None => gaps(trace, plot.x.log, panel.y.log),
        };
        if gaps > 0 {
            let log = plot.x.log || panel.y.log;
            let why = if log { "not finite or not positive" } else { "not finite" };
            let name = &trace.name;
            lines.push(format!("{name}: {gaps} of {samples} samples are {why} and left out."));
        }
    }
    lines
}

/// The samples of the record that a trace shows.
fn all(trace: &Trace) -> u64 {
    trace.of.map_or(trace.y.len() as u64, |of| of.all)
}

/// How many samples cannot be drawn, and of how many.
fn gaps(trace: &Trace, log_x: bool, log_y: bool) -> (u64, u64) {
    let bad = |v: f64, log: bool| !v.is_finite() || (log && v <= 0.0);
    let in_values = |values: &[f64], log: bool| values.iter().filter(|&&v| bad(v, log)).count();
    let in_pairs = |y: &[f64]| {
        trace.x.iter().zip(y).filter(|&(&x, &y)| bad(x, log_x) || bad(y, log_y)).count()
    };
    let (gaps, samples) = match &trace.kind {
        Kind::Map { z, .. } => (in_values(z, false), z.len()),
        Kind::NamedBars { .. } => (in_values(&trace.x, log_x), trace.x.len()),
        // A bar of height zero is an empty bin and no gap.
        Kind::Bars => (in_values(&trace.y, false), trace.y.len()),
        Kind::Band { upper } => (in_pairs(&trace.y).max(in_pairs(upper)), trace.x.len()),
        Kind::Line { .. } | Kind::Backdrop | Kind::LineWithPoints | Kind::Scatter => {
            (in_pairs(&trace.y), trace.x.len())
        }
    };
    (gaps as u64, samples as u64)
}
