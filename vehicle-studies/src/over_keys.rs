//! Plots of what a study found over what was varied: lines over one key, a map over two.

use crate::study::Point;
use report::Plot;
use scenario::setting::Setting;

/// Lowest and highest of a quantity of what was found.
pub type Range<'a, F> = &'a dyn Fn(&F) -> Option<[f64; 2]>;

/// A quantity of what was found, drawn as a line.
pub struct Line<'a, F> {
    /// What it is called.
    pub name: &'a str,
    /// The quantity.
    pub of: &'a dyn Fn(&F) -> Option<f64>,
    /// Lowest and highest of it, drawn as a band around the line.
    pub range: Option<Range<'a, F>>,
}

/// Values of a key in rising order, each once.
pub fn values<F>(points: &[Point<F>], axis: usize) -> Vec<f64> {
    let mut values: Vec<f64> =
        points.iter().filter_map(|point| Some(point.at.get(axis)?.number())).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    values
}

/// The quantities of a unit over the key that was varied, with limits; over two keys the first quantity as
/// a map. None where nothing, or more, was varied.
pub fn plot<F>(
    title: &str,
    [name, unit]: [&str; 2],
    points: &[Point<F>],
    lines: &[Line<'_, F>],
    limits: &[(&str, f64)],
) -> Option<Plot> {
    let keys: Vec<String> = points.first()?.at.iter().map(Setting::called).collect();
    match &keys[..] {
        [key] if points.len() > 1 => {
            let x = values(points, 0);
            let at = |value: f64| points.iter().find(|point| point.at[0].number() == value);
            let along = |of: &dyn Fn(&F) -> Option<f64>| -> Vec<f64> {
                x.iter()
                    .map(|value| at(*value).and_then(|point| of(&point.found)).unwrap_or(f64::NAN))
                    .collect()
            };
            let mut plot = Plot::new(title).x(key, "").y(name, unit);
            for line in lines {
                if let Some(range) = line.range {
                    let end = |end: usize| along(&|found| Some(range(found)?[end]));
                    plot = plot.band(&format!("{}, seeds", line.name), &x, &end(0), &end(1));
                }
                plot = plot.points(line.name, &x, &along(line.of));
            }
            Some(limits.iter().fold(plot, |plot, (label, value)| plot.limit(label, *value)))
        }
        [slow, quick] => {
            let line = lines.first()?;
            let z = |point: &Point<F>| (line.of)(&point.found).unwrap_or(f64::NAN);
            Some(map(title, [line.name, unit], [slow, quick], points, z))
        }
        _ => None,
    }
}

/// A map of a quantity over two keys, the first one upward.
pub fn map<F>(
    title: &str,
    [name, unit]: [&str; 2],
    [slow, quick]: [&str; 2],
    points: &[Point<F>],
    z: impl Fn(&Point<F>) -> f64,
) -> Plot {
    let (y, x) = (values(points, 0), values(points, 1));
    let at = |slow: f64, quick: f64| {
        let here =
            |point: &&Point<F>| point.at[0].number() == slow && point.at[1].number() == quick;
        points.iter().find(here).map_or(f64::NAN, &z)
    };
    // Rows of the map are the slow key's values.
    let z: Vec<f64> = y.iter().flat_map(|y| x.iter().map(|x| at(*y, *x))).collect();
    Plot::new(title).x(quick, "").y(slow, "").map(name, unit, &x, &y, &z)
}
