//! What stands over and under the data: limits, events, spans, notes, and the frame of a zoom.

use serde_json::{Value, json};

use crate::axis::{axis_id, ends, place};
use crate::html::escape;
use crate::plot::{Mark, Panel, Plot, Zoom};

/// Shapes and annotations of a view, as plotly.js wants them.
pub(crate) fn marks(plot: &Plot, zoom: Option<&Zoom>) -> (Vec<Value>, Vec<Value>) {
    let (mut shapes, mut notes) = (Vec::new(), Vec::new());
    for (index, panel) in plot.panels.iter().enumerate() {
        let y_id = axis_id("y", index);
        let over = format!("{y_id} domain");
        for mark in &panel.marks {
            match mark {
                Mark::Limit { label, y } => shapes.push(json!({
                    "type": "line", "xref": "x domain", "x0": 0, "x1": 1, "yref": y_id, "y0": y,
                    "y1": y, "line": {"color": "#555555", "width": 1.2, "dash": "6px,3px"},
                    "label": {"text": escape(label), "textposition": "end", "yanchor": "bottom"},
                })),
                Mark::At { label, x } => shapes.push(json!({
                    // The label stands next to its line, on the side that has room.
                    "type": "line", "xref": "x", "x0": x, "x1": x, "yref": over, "y0": 0, "y1": 1,
                    "line": {"color": "#555555", "width": 1.2, "dash": "2px,2px"},
                    "label": {"text": escape(label), "textposition": "end", "textangle": 0,
                              "yanchor": "top", "xanchor":
                                  if near_the_right(plot, panel, zoom, *x) { "right" } else { "left" }},
                })),
                Mark::Span { label, x } => shapes.push(json!({
                    "type": "rect", "xref": "x", "x0": x.start(), "x1": x.end(), "yref": over,
                    "y0": 0, "y1": 1, "layer": "below", "fillcolor": "#e9e4d4",
                    "line": {"width": 0},
                    "label": {"text": escape(label), "textposition": "top left"},
                })),
                Mark::Note { text, x, y } => {
                    // Unlike shapes, annotations take the logarithm on a log axis.
                    notes.push(json!({
                        "text": escape(text), "xref": "x", "x": place(*x, plot.x.log),
                        "yref": y_id, "y": place(*y, panel.y.log), "ax": 34, "ay": -30,
                    }));
                }
            }
        }
    }
    if zoom.is_none() {
        shapes.extend(plot.zooms.iter().map(zoomed_area));
    }
    (shapes, notes)
}

/// A faint frame in the whole view that shows where a zoom looks.
fn zoomed_area(zoom: &Zoom) -> Value {
    let (y_ref, (low, high)) = zoom.y.as_ref().map_or(("paper", (0.0, 1.0)), |y| ("y", ends(y)));
    json!({
        "type": "rect", "xref": "x", "x0": zoom.x.start(), "x1": zoom.x.end(), "yref": y_ref,
        "y0": low, "y1": high, "fillcolor": "rgba(60,60,60,0.07)",
        "line": {"color": "#777777", "width": 0.8, "dash": "3px,2px"},
    })
}

/// True when x lies in the last third of what the panel shows: its label then goes to the left.
fn near_the_right(plot: &Plot, panel: &Panel, zoom: Option<&Zoom>, x: f64) -> bool {
    let shown = zoom.map(|z| &z.x).or(plot.x.range.as_ref()).map(|r| vec![*r.start(), *r.end()]);
    let (low, high) = shown
        .unwrap_or_else(|| panel.traces.iter().flat_map(|t| t.x.iter().copied()).collect())
        .into_iter()
        .map(|v| place(v, plot.x.log))
        .filter(|v| v.is_finite())
        .fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    place(x, plot.x.log) > low + 0.67 * (high - low)
}

/// Values a little beyond the limits of a panel, so that a limit does not lie on the frame.
pub(crate) fn room_for_limits(panel: &Panel) -> Vec<f64> {
    let limits = panel.marks.iter().filter_map(|mark| match mark {
        Mark::Limit { y, .. } => Some(*y),
        _ => None,
    });
    limits.map(|y| if panel.y.log { y * 2.0 } else { y * 1.2 }).collect()
}
