//! Plots of answers over the keys that are varied: lines over one key, a map or lines over two.

use crate::point::GridPoint;
use report::Plot;
use scenario::setting::Setting;

/// Values of each key from which a map is drawn: with fewer a map is a handful of large cells.
const FEWEST_OF_A_MAP: usize = 4;

/// Lowest and highest of a quantity of an answer.
pub(crate) type Range<'a, A> = &'a dyn Fn(&A) -> Option<[f64; 2]>;

/// A quantity of an answer, drawn as a line.
pub(crate) struct Line<'a, A> {
    /// What it is called.
    pub(crate) name: &'a str,
    /// The quantity.
    pub(crate) of: &'a dyn Fn(&A) -> Option<f64>,
    /// Lowest and highest of it, drawn as a band around the line.
    pub(crate) range: Option<Range<'a, A>>,
}

/// Values of a key in rising order, each once.
pub(crate) fn values<A>(points: &[GridPoint<A>], axis: usize) -> Vec<f64> {
    let mut values: Vec<f64> =
        points.iter().filter_map(|point| Some(point.at.get(axis)?.number())).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    values
}

/// The quantities of a unit over the key that is varied, with limits; over two keys the first
/// quantity alone. None where no key or more than two are varied.
pub(crate) fn plot<A>(
    title: &str,
    [name, unit]: [&str; 2],
    points: &[GridPoint<A>],
    lines: &[Line<'_, A>],
    limits: &[(&str, f64)],
) -> Option<Plot> {
    let keys: Vec<String> = points.first()?.at.iter().map(Setting::called).collect();
    debug_assert!(points.iter().all(|point| point.at.len() == keys.len()), "other keys");
    match &keys[..] {
        [key] if points.len() > 1 => {
            let x = values(points, 0);
            let at = |value: f64| points.iter().find(|point| point.at[0].number() == value);
            let along = |of: &dyn Fn(&A) -> Option<f64>| -> Vec<f64> {
                x.iter()
                    .map(|value| at(*value).and_then(|point| of(&point.answer)).unwrap_or(f64::NAN))
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
            let z = |point: &GridPoint<A>| (line.of)(&point.answer).unwrap_or(f64::NAN);
            Some(over_two(title, [line.name, unit], [slow, quick], points, z))
        }
        _ => None,
    }
}

/// A quantity over two keys: a map, the first key upward, or lines where a key has few values.
pub(crate) fn over_two<A>(
    title: &str,
    [name, unit]: [&str; 2],
    [slow, quick]: [&str; 2],
    points: &[GridPoint<A>],
    z: impl Fn(&GridPoint<A>) -> f64,
) -> Plot {
    let (y, x) = (values(points, 0), values(points, 1));
    if x.len().min(y.len()) < FEWEST_OF_A_MAP {
        return lines_over_two(title, [name, unit], [slow, quick], points, z);
    }
    let at = |slow: f64, quick: f64| {
        let here =
            |point: &&GridPoint<A>| point.at[0].number() == slow && point.at[1].number() == quick;
        points.iter().find(here).map_or(f64::NAN, &z)
    };
    // Rows of the map are the slow key's values.
    let z: Vec<f64> = y.iter().flat_map(|y| x.iter().map(|x| at(*y, *x))).collect();
    Plot::new(title).x(quick, "").y(slow, "").map(name, unit, &x, &y, &z)
}

/// A quantity over the key of more values, one line for each value of the other.
fn lines_over_two<A>(
    title: &str,
    [name, unit]: [&str; 2],
    keys: [&str; 2],
    points: &[GridPoint<A>],
    z: impl Fn(&GridPoint<A>) -> f64,
) -> Plot {
    let each = [values(points, 0), values(points, 1)];
    let along = usize::from(each[1].len() >= each[0].len());
    let across = 1 - along;
    let mut plot = Plot::new(title).x(keys[along], "").y(name, unit);
    for fixed in &each[across] {
        let mut on_line: Vec<&GridPoint<A>> =
            points.iter().filter(|point| point.at[across].number() == *fixed).collect();
        on_line.sort_by(|a, b| a.at[along].number().total_cmp(&b.at[along].number()));
        let Some(first) = on_line.first() else { continue };
        let label = format!("{} {}", keys[across], first.values_in_words()[across]);
        let x: Vec<f64> = on_line.iter().map(|point| point.at[along].number()).collect();
        let y: Vec<f64> = on_line.iter().map(|point| z(point)).collect();
        plot = plot.points(&label, &x, &y);
    }
    plot
}

#[cfg(test)]
mod tests {
    use super::*;
    use report::{Report, Section};

    /// The page of a quantity over `slow` times `quick` values.
    fn page(slow: usize, quick: usize) -> String {
        let point = |index: usize| GridPoint {
            index,
            study: String::new(),
            at: vec![
                Setting::to("damper.clearance_2a_m", 1e-3 * (index / quick) as f64),
                Setting::to("damper.ke_n_per_m", 1e6 * (index % quick) as f64),
            ],
            answer: index as f64,
            failure: None,
            pace: None,
        };
        let points: Vec<GridPoint<f64>> = (0..slow * quick).map(point).collect();
        let line = Line { name: "index", of: &|answer: &f64| Some(*answer), range: None };
        let plot = plot("Index", ["index", "km/h"], &points, &[line], &[]).unwrap();
        Report::new("grid").section(Section::new("grid").plot(plot)).to_html().unwrap()
    }

    #[test]
    fn a_two_by_two_sweep_is_drawn_as_lines_and_a_large_one_as_a_map() {
        let small = page(2, 2);
        assert!(small.contains("damper.clearance_2a_m 0.001"), "no line for a value");
        assert!(!page(4, 5).contains("damper.clearance_2a_m 0.001"));
        assert!(page(2, 5).contains("damper.clearance_2a_m 0.001"));
        assert!(page(5, 2).contains("damper.ke_n_per_m 1e6"));
    }
}
