//! Colours, dashes and marks of the traces.
//!
//! The hues can be distinguished with the common kinds of colour blindness (they lean on the
//! palette of Okabe and Ito), and neighbours differ in lightness, so that grey print still
//! separates them. A dash helps only where a line is smooth: on a noisy record of thousands of
//! points it is dust, so dense lines stay solid.

use serde_json::{Value, json};

/// Colours of the traces. Lightness L* of the first four: 33, 59, 70, 47.
pub const PALETTE: [&str; 8] =
    ["#0b4f8a", "#e0700a", "#56b4e9", "#00805f", "#8e3b82", "#c9a000", "#4d4d4d", "#d68fb8"];
const DASHES: [&str; 8] =
    ["solid", "9px,3px", "solid", "2px,2px", "9px,3px,2px,3px", "solid", "4px,2px", "2px,3px"];
const SYMBOLS: [&str; 8] = [
    "circle",
    "diamond-open",
    "square",
    "x-thin-open",
    "triangle-up-open",
    "cross-thin-open",
    "star",
    "circle-open",
];
const PATTERNS: [&str; 4] = ["", "/", ".", "x"];

/// Above this number of points a line stays solid.
const DASH_UP_TO: usize = 600;

pub(crate) fn colour(slot: usize) -> &'static str {
    PALETTE[slot % PALETTE.len()]
}

/// The colour of a slot, thin enough to see others through.
pub(crate) fn tint(slot: usize) -> String {
    format!("{}40", colour(slot))
}

/// The line of a trace with so many samples, of which some are drawn in this view. The dash is that
/// of the trace, so that a zoom looks like the whole.
pub(crate) fn line(slot: usize, samples: usize, drawn: usize, dashed: bool) -> Value {
    let dash = if dashed {
        "7px,4px"
    } else if samples <= DASH_UP_TO {
        DASHES[slot % DASHES.len()]
    } else {
        "solid"
    };
    let width = if drawn <= DASH_UP_TO || dashed { 2.0 } else { 1.2 };
    json!({"color": colour(slot), "dash": dash, "width": width})
}

/// A wide grey line that others are drawn over; light enough to show them in print.
pub(crate) fn backdrop() -> Value {
    json!({"color": "#cdd3d8", "dash": "solid", "width": 5})
}

/// The line between marks: solid, the marks distinguish traces.
pub(crate) fn joint(slot: usize) -> Value {
    json!({"color": colour(slot), "width": 1.5})
}

pub(crate) fn marker(slot: usize, points: usize) -> Value {
    let (size, opacity) = if points > DASH_UP_TO { (4, 0.5) } else { (7, 0.9) };
    json!({
        "color": colour(slot), "symbol": SYMBOLS[slot % SYMBOLS.len()],
        "size": size, "opacity": opacity, "line": {"width": 1.3, "color": colour(slot)},
    })
}

pub(crate) fn bar(slot: usize) -> Value {
    json!({
        "color": colour(slot), "opacity": 0.85, "line": {"width": 0.5, "color": "#ffffff"},
        // Without its own background a pattern is drawn on nothing, and white on nothing is
        // nothing.
        "pattern": {"shape": PATTERNS[slot % PATTERNS.len()], "fgcolor": "#ffffff",
                    "bgcolor": colour(slot), "size": 6},
    })
}
