//! A plot as plotly.js wants it: traces and layout in JSON, and the small print under it.

use serde_json::{Map, Value, json};

use crate::html::{escape, with_unit};
use crate::number::{decade, round_to_decimals};
use crate::plot::{Axis, Mark, Panel, Plot, Zoom};
use crate::series::{Kind, Trace};
use crate::style;
use crate::thin::{Drawn, MAX_DRAWN, choose};

/// Digits of what is drawn: of the span of a trace on a linear axis, of each value on a log axis.
const DIGITS: i32 = 6;
/// Share of the height between two panels.
const GAP: f64 = 0.07;

/// One drawing: the whole plot or one zoom of it.
pub(crate) fn view(plot: &Plot, zoom: Option<&Zoom>) -> Value {
    let names = names(plot);
    let mut shown = Vec::new();
    let mut data = Vec::new();
    for (index, panel) in plot.panels.iter().enumerate() {
        for trace in &panel.traces {
            let slot = names.iter().position(|n| *n == trace.name).unwrap_or(0);
            let first = !shown.contains(&trace.name.as_str());
            shown.push(trace.name.as_str());
            let base = json!({
                "name": escape(&trace.name), "legendgroup": slot.to_string(),
                "showlegend": first && zoom.is_none(), "meta": escape(&panel.y.unit),
                "yaxis": axis_id("y", index),
            });
            for drawn in draw(trace, slot, plot.x.log, panel.y.log, zoom) {
                data.push(joined(&base, drawn));
            }
        }
    }
    json!({"data": data, "layout": layout(plot, zoom, names.len())})
}

/// What a reader must know about the drawing: thinning and gaps.
pub(crate) fn small_print(plot: &Plot) -> Vec<String> {
    let mut lines = Vec::new();
    let traces = || plot.panels.iter().flat_map(|p| p.traces.iter().map(move |t| (p, t)));
    let longest = traces()
        .filter(|(_, t)| !matches!(t.kind, Kind::Bars | Kind::Map { .. }))
        .map(|(_, t)| t.y.len())
        .max()
        .unwrap_or(0);
    if longest > MAX_DRAWN {
        lines.push(format!(
            "Up to {longest} samples per trace; at most about {MAX_DRAWN} are drawn, the smallest \
             and the largest of every step, so peaks are true."
        ));
    }
    for (panel, trace) in traces() {
        let gaps = gaps(trace, plot.x.log, panel.y.log);
        if gaps > 0 {
            let why = if plot.x.log || panel.y.log {
                "not finite or not positive"
            } else {
                "not finite"
            };
            lines.push(format!("{}: {gaps} samples are {why} and left out.", trace.name));
        }
    }
    lines
}

fn gaps(trace: &Trace, log_x: bool, log_y: bool) -> usize {
    let bad = |v: f64, log: bool| !v.is_finite() || (log && v <= 0.0);
    match &trace.kind {
        Kind::Map { z, .. } => z.iter().filter(|&&z| !z.is_finite()).count(),
        Kind::NamedBars { .. } => trace.x.iter().filter(|&&x| bad(x, log_x)).count(),
        // A bar of height zero is an empty bin and no gap.
        Kind::Bars => trace.y.iter().filter(|y| !y.is_finite()).count(),
        Kind::Line { .. } | Kind::LineWithPoints | Kind::Scatter | Kind::Band { .. } => {
            trace.x.iter().zip(&trace.y).filter(|&(&x, &y)| bad(x, log_x) || bad(y, log_y)).count()
        }
    }
}

/// The names in order of first appearance: place in this list is colour and legend entry.
fn names(plot: &Plot) -> Vec<&str> {
    let mut names = Vec::new();
    for trace in plot.panels.iter().flat_map(|p| &p.traces) {
        if !names.contains(&trace.name.as_str()) {
            names.push(trace.name.as_str());
        }
    }
    names
}

fn draw(trace: &Trace, slot: usize, log_x: bool, log_y: bool, zoom: Option<&Zoom>) -> Vec<Value> {
    let chosen = || choose(&trace.x, &trace.y, log_x, zoom.map(|z| &z.x));
    match &trace.kind {
        Kind::Line { dashed } => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "lines", "line": style::line(slot, k.len(), *dashed),
                "x": numbers(&trace.x, &k, log_x), "y": numbers(&trace.y, &k, log_y),
            })]
        }
        Kind::LineWithPoints => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "lines+markers",
                "line": style::line(slot, k.len(), false), "marker": style::marker(slot, k.len()),
                "x": numbers(&trace.x, &k, log_x), "y": numbers(&trace.y, &k, log_y),
            })]
        }
        Kind::Scatter => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "markers", "marker": style::marker(slot, k.len()),
                "x": numbers(&trace.x, &k, log_x), "y": numbers(&trace.y, &k, log_y),
            })]
        }
        Kind::Bars => vec![bars(trace, slot, log_x)],
        Kind::NamedBars { names } => {
            let k = all(trace.x.len());
            let names: Vec<String> = names.iter().map(|n| escape(n)).collect();
            vec![json!({
                "type": "bar", "orientation": "h", "marker": style::bar(slot),
                "x": numbers(&trace.x, &k, log_x), "y": names,
            })]
        }
        Kind::Band { upper } => {
            let k = chosen();
            let line = json!({"width": 0.6, "color": style::colour(slot)});
            let x = numbers(&trace.x, &k, log_x);
            vec![
                json!({"type": "scatter", "mode": "lines", "line": line, "showlegend": false,
                       "x": x, "y": numbers(&trace.y, &k, log_y)}),
                json!({"type": "scatter", "mode": "lines", "line": line, "fill": "tonexty",
                       "fillcolor": style::tint(slot), "x": x,
                       "y": numbers(upper, &k, log_y)}),
            ]
        }
        Kind::Map { z, unit } => {
            let columns = trace.x.len().max(1);
            let rows: Vec<Value> =
                z.chunks(columns).map(|row| numbers(row, &all(row.len()), false)).collect();
            vec![json!({
                "type": "heatmap", "colorscale": "Cividis", "z": rows, "meta": escape(unit),
                "x": numbers(&trace.x, &all(trace.x.len()), log_x),
                "y": numbers(&trace.y, &all(trace.y.len()), log_y),
                "colorbar": {"title": {"text": escape(&with_unit(&trace.name, unit)),
                                       "side": "right"}},
            })]
        }
    }
}

/// Bars as centres and widths; on a log axis the middle is that of the ratio, so that the bars of
/// equal decades look alike.
fn bars(trace: &Trace, slot: usize, log_x: bool) -> Value {
    let pairs = || trace.x.windows(2).map(|edge| (edge[0], edge[1]));
    let centres: Vec<f64> = pairs()
        .map(|(a, b)| if log_x { (a * b).max(0.0).sqrt() } else { 0.5 * (a + b) })
        .collect();
    let widths: Vec<f64> = pairs().map(|(a, b)| b - a).collect();
    let offsets: Vec<f64> = pairs().zip(&centres).map(|((a, _), centre)| a - centre).collect();
    let k = all(centres.len());
    json!({
        "type": "bar", "marker": style::bar(slot),
        "x": numbers(&centres, &k, true), "width": numbers(&widths, &k, true),
        "offset": numbers(&offsets, &k, true), "y": numbers(&trace.y, &k, true),
    })
}

fn all(count: usize) -> Drawn {
    (0..count).map(Some).collect()
}

/// The chosen values, rounded; what is not finite is null, which breaks a line.
fn numbers(values: &[f64], chosen: &Drawn, log: bool) -> Value {
    let finite = || chosen.iter().flatten().map(|&k| values[k]).filter(|v| v.is_finite());
    let (low, high) = finite().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    let span = if high > low { high - low } else { high.abs() };
    let shared = DIGITS - 1 - decade(span);
    let number = |v: f64| {
        let decimals = if log { DIGITS - 1 - decade(v) } else { shared };
        let rounded = round_to_decimals(v, decimals);
        // Whole numbers without their ".0"; beyond 2^53 they are no longer exact.
        if rounded.fract() == 0.0 && rounded.abs() < 9.0e15 {
            Value::from(rounded as i64)
        } else {
            Value::from(rounded)
        }
    };
    chosen
        .iter()
        .map(|k| k.map(|k| values[k]).filter(|v| v.is_finite()).map_or(Value::Null, number))
        .collect()
}

fn layout(plot: &Plot, zoom: Option<&Zoom>, names: usize) -> Value {
    let count = plot.panels.len();
    let mut layout = Map::new();
    let x_range = zoom.map(|z| &z.x).or(plot.x.range.as_ref());
    let mut x = axis(&plot.x, x_range.map(|r| (*r.start(), *r.end())));
    x.insert("anchor".into(), axis_id("y", count - 1).into());
    layout.insert("xaxis".into(), x.into());
    for (index, panel) in plot.panels.iter().enumerate() {
        let range = match zoom {
            Some(zoom) if index == 0 && zoom.y.is_some() => zoom.y.as_ref().map(ends),
            Some(zoom) => range_inside(panel, zoom),
            None => panel.y.range.as_ref().map(ends),
        };
        let mut y = axis(&panel.y, range);
        // The first panel is on top.
        let height = (1.0 - GAP * (count - 1) as f64) / count as f64;
        let bottom = (height + GAP) * (count - 1 - index) as f64;
        y.insert("domain".into(), json!([bottom, (bottom + height).min(1.0)]));
        if plot.equal_aspect {
            y.insert("scaleanchor".into(), "x".into());
        }
        if panel.traces.iter().any(|t| matches!(t.kind, Kind::NamedBars { .. })) {
            y.insert("type".into(), "category".into());
            y.insert("autorange".into(), "reversed".into());
        }
        layout.insert(format!("yaxis{}", suffix(index)), y.into());
    }
    let (shapes, notes) = marks(plot, zoom);
    layout.insert("shapes".into(), shapes.into());
    layout.insert("annotations".into(), notes.into());
    layout.insert("showlegend".into(), (names > 1 && zoom.is_none()).into());
    let along_x = plot.panels.iter().flat_map(|p| &p.traces).all(Trace::runs_along_x);
    layout.insert("hovermode".into(), if along_x { "x unified" } else { "closest" }.into());
    layout.into()
}

fn axis(axis: &Axis, range: Option<(f64, f64)>) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("title".into(), json!({"text": escape(&with_unit(&axis.name, &axis.unit))}));
    if axis.log {
        out.insert("type".into(), "log".into());
    }
    if let Some((from, to)) = range {
        let place = |v: f64| if axis.log { libm::log10(v) } else { v };
        out.insert("range".into(), json!([place(from), place(to)]));
    }
    out
}

/// The y range of the samples inside a zoom, with a margin; none for an empty one or a log axis.
fn range_inside(panel: &Panel, zoom: &Zoom) -> Option<(f64, f64)> {
    let inside = panel.traces.iter().flat_map(|t| t.x.iter().zip(&t.y));
    let (low, high) = inside
        .filter(|(x, y)| zoom.x.contains(x) && y.is_finite())
        .fold((f64::MAX, f64::MIN), |(l, h), (_, &y)| (l.min(y), h.max(y)));
    let margin = 0.06 * (high - low);
    (!panel.y.log && margin > 0.0).then_some((low - margin, high + margin))
}

fn marks(plot: &Plot, zoom: Option<&Zoom>) -> (Vec<Value>, Vec<Value>) {
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
                    "type": "line", "xref": "x", "x0": x, "x1": x, "yref": over, "y0": 0, "y1": 1,
                    "line": {"color": "#555555", "width": 1.2, "dash": "2px,2px"},
                    "label": {"text": escape(label), "textposition": "end", "textangle": 0,
                              "xanchor": "left", "yanchor": "top"},
                })),
                Mark::Span { label, x } => shapes.push(json!({
                    "type": "rect", "xref": "x", "x0": x.start(), "x1": x.end(), "yref": over,
                    "y0": 0, "y1": 1, "layer": "below", "fillcolor": "#e9e4d4",
                    "line": {"width": 0},
                    "label": {"text": escape(label), "textposition": "top left"},
                })),
                Mark::Note { text, x, y } => {
                    // Unlike shapes, annotations take the logarithm on a log axis.
                    let place = |v: f64, log: bool| if log { libm::log10(v) } else { v };
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
    let (y_ref, (low, high)) =
        zoom.y.as_ref().map_or(("paper", (0.0, 1.0)), |y| ("y", ends(y)));
    json!({
        "type": "rect", "xref": "x", "x0": zoom.x.start(), "x1": zoom.x.end(), "yref": y_ref,
        "y0": low, "y1": high, "fillcolor": "rgba(60,60,60,0.07)",
        "line": {"color": "#777777", "width": 0.8, "dash": "3px,2px"},
    })
}

fn ends(range: &std::ops::RangeInclusive<f64>) -> (f64, f64) {
    (*range.start(), *range.end())
}

fn axis_id(letter: &str, index: usize) -> String {
    format!("{letter}{}", suffix(index))
}

fn suffix(index: usize) -> String {
    if index == 0 { String::new() } else { (index + 1).to_string() }
}

/// `base` with the members of `more`, which win.
fn joined(base: &Value, more: Value) -> Value {
    let mut out = base.as_object().cloned().unwrap_or_default();
    if let Value::Object(more) = more {
        out.extend(more);
    }
    out.into()
}
