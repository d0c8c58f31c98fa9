//! A plot as plotly.js wants it: traces and layout in JSON.

use serde_json::{Map, Value, json};

use crate::axis::{axis_id, ends, place, suffix};
use crate::html::{escape, with_unit};
use crate::marks::{marks, room_for_limits};
use crate::number::{decade, round_to_decimals};
use crate::plot::{Axis, Panel, Plot, Zoom};
use crate::series::{Kind, Trace};
use crate::style;
use crate::thin::{self, Drawn};

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
    json!({"data": data, "layout": layout(plot, zoom, legend_entries(plot))})
}

/// The names in order of palette and first appearance: place in this list is colour and legend
/// entry. Backdrops come last, whenever they are drawn: they have no colour to take.
fn names(plot: &Plot) -> Vec<&str> {
    let mut names: Vec<&str> = plot.palette.iter().map(String::as_str).collect();
    let traces = || plot.panels.iter().flat_map(|p| &p.traces);
    let coloured = traces().filter(|t| t.kind != Kind::Backdrop);
    for trace in coloured.chain(traces()) {
        if !names.contains(&trace.name.as_str()) {
            names.push(trace.name.as_str());
        }
    }
    names
}

/// How many names the legend lists.
fn legend_entries(plot: &Plot) -> usize {
    let mut names = Vec::new();
    for trace in plot.panels.iter().flat_map(|p| &p.traces) {
        if !names.contains(&trace.name.as_str()) {
            names.push(trace.name.as_str());
        }
    }
    names.len()
}

fn draw(trace: &Trace, slot: usize, log_x: bool, log_y: bool, zoom: Option<&Zoom>) -> Vec<Value> {
    let chosen = || {
        let scatter = matches!(trace.kind, Kind::Scatter);
        let window = zoom.map(|z| &z.x);
        thin::choose(&trace.x, &trace.y, scatter, log_x, window).drawn
    };
    match &trace.kind {
        Kind::Line { dashed } => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "lines", "line": style::line(slot, trace.x.len(), k.len(), *dashed),
                "x": numbers(&trace.x, &k, log_x), "y": numbers(&trace.y, &k, log_y),
            })]
        }
        Kind::Backdrop => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "lines", "line": style::backdrop(),
                "x": numbers(&trace.x, &k, log_x), "y": numbers(&trace.y, &k, log_y),
            })]
        }
        Kind::LineWithPoints => {
            let k = chosen();
            vec![json!({
                "type": "scatter", "mode": "lines+markers",
                "line": style::joint(slot), "marker": style::marker(slot, k.len()),
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
            let k = both_edges(&trace.x, &trace.y, upper, log_x, zoom);
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

/// The samples of a band: those that either of its edges needs.
fn both_edges(x: &[f64], lower: &[f64], upper: &[f64], log_x: bool, zoom: Option<&Zoom>) -> Drawn {
    let edge = |y| thin::choose(x, y, false, log_x, zoom.map(|z| &z.x)).drawn.into_iter().flatten();
    let mut kept: Vec<usize> = edge(lower).chain(edge(upper)).collect();
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(Some).collect()
}

/// Bars as centres and widths; on a log axis the middle is that of the ratio, so that the bars of
/// equal decades look alike.
fn bars(trace: &Trace, slot: usize, log_x: bool) -> Value {
    let pairs = || trace.x.windows(2).map(|edge| (edge[0], edge[1]));
    let centres: Vec<f64> =
        pairs().map(|(a, b)| if log_x { (a * b).max(0.0).sqrt() } else { 0.5 * (a + b) }).collect();
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
    let bar_names = bar_names(plot);
    let has_names = !bar_names.is_empty();
    let x_range = zoom.map(|z| &z.x).or(plot.x.range.as_ref());
    let mut x = axis(&plot.x, x_range.map(|r| (*r.start(), *r.end())));
    x.insert("anchor".into(), axis_id("y", count - 1).into());
    if plot.equal_aspect {
        x.insert("constrain".into(), "domain".into());
    }
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
        if range.is_none() {
            y.insert("autorangeoptions".into(), json!({"include": room_for_limits(panel)}));
        }
        if plot.equal_aspect {
            y.insert("scaleanchor".into(), "x".into());
            y.insert("constrain".into(), "domain".into());
        }
        if has_names {
            y.insert("type".into(), "category".into());
            y.insert("autorange".into(), "reversed".into());
        }
        layout.insert(format!("yaxis{}", suffix(index)), y.into());
    }
    layout.insert("bargap".into(), if has_names { 0.35 } else { 0.0 }.into());
    let lone = (1..bar_names.len()).all(|k| !bar_names[..k].contains(&bar_names[k]));
    if has_names && lone {
        // Every row has one bar, so none needs to make room for another.
        layout.insert("barmode".into(), "overlay".into());
    }
    let (shapes, notes) = marks(plot, zoom);
    layout.insert("shapes".into(), shapes.into());
    layout.insert("annotations".into(), notes.into());
    layout.insert("showlegend".into(), (names > 1 && zoom.is_none()).into());
    let along_x = plot.panels.iter().flat_map(|p| &p.traces).all(Trace::runs_along_x);
    layout.insert("hovermode".into(), if along_x { "x unified" } else { "closest" }.into());
    layout.into()
}

/// The names of all lying bars, in order of traces.
pub(crate) fn bar_names(plot: &Plot) -> Vec<&str> {
    let traces = plot.panels.iter().flat_map(|p| &p.traces);
    traces.flat_map(Trace::bar_names).map(String::as_str).collect()
}

fn axis(axis: &Axis, range: Option<(f64, f64)>) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("title".into(), json!({"text": escape(&with_unit(&axis.name, &axis.unit))}));
    if axis.log {
        out.insert("type".into(), "log".into());
        out.insert("minor".into(), json!({"showgrid": true}));
    }
    if let Some((from, to)) = range {
        out.insert("range".into(), json!([place(from, axis.log), place(to, axis.log)]));
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

/// `base` with the members of `more`, which win.
fn joined(base: &Value, more: Value) -> Value {
    let mut out = base.as_object().cloned().unwrap_or_default();
    if let Value::Object(more) = more {
        out.extend(more);
    }
    out.into()
}
