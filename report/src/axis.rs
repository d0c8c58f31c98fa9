//! Names and places on the axes of a figure, as plotly.js counts them.

/// Where a value lies on its axis: its logarithm on a log axis.
pub(crate) fn place(value: f64, log: bool) -> f64 {
    if log { libm::log10(value) } else { value }
}

/// The two ends of a range.
pub(crate) fn ends(range: &std::ops::RangeInclusive<f64>) -> (f64, f64) {
    (*range.start(), *range.end())
}

/// The name of the axis of a panel: y, y2, y3.
pub(crate) fn axis_id(letter: &str, index: usize) -> String {
    format!("{letter}{}", suffix(index))
}

/// What distinguishes the axes of one panel from those of another.
pub(crate) fn suffix(index: usize) -> String {
    if index == 0 { String::new() } else { (index + 1).to_string() }
}
