//! A smoothing cubic spline over arc length.
//!
//! Minimises `sum h_i (value_i - f(s_i))^2 + lambda integral f''(s)^2 ds` (Reinsch's construction,
//! a banded solve). A ripple of wavelength `L` keeps `1 / (1 + lambda (2 pi / L)^4)` of its size,
//! so `lambda = (L / 2 pi)^4` halves it: the parameter is stated as that wavelength. Over arc
//! length a circle of radius `R` is moved by no more than `lambda / R^3`: 4 nanometres at 14 mm and
//! 3 mm.

/// First derivatives at the knots of the smoothed values, and the smoothed values themselves.
///
/// `places` grow strictly; at least three of them.
pub(super) fn smooth(places: &[f64], values: &[f64], half_wavelength_m: f64) -> Smoothed {
    let lambda = {
        let ratio = half_wavelength_m / (2.0 * core::f64::consts::PI);
        ratio * ratio * ratio * ratio
    };
    let at = |list: &[f64], index: usize| list.get(index).copied().unwrap_or(0.0);
    let count = places.len().min(values.len());
    let step = |index: usize| at(places, index + 1) - at(places, index);
    // Each value weighs as much as the length it stands for.
    let weight = |index: usize| {
        let before = if index > 0 { step(index - 1) } else { 0.0 };
        let after = if index + 1 < count { step(index) } else { 0.0 };
        0.5 * (before + after)
    };
    let inner = count.saturating_sub(2);
    // Second differences: the column of an inner knot touches three values.
    let column = |knot: usize| {
        let (left, right) = (1.0 / step(knot), 1.0 / step(knot + 1));
        [left, -left - right, right]
    };
    let (mut diagonal, mut first, mut second) =
        (vec![0.0; inner], vec![0.0; inner], vec![0.0; inner]);
    let mut right_side = vec![0.0; inner];
    let product = |a: usize, b: usize| {
        let (one, other) = (column(a), column(b));
        let offset = b - a;
        (offset..3)
            .map(|row| at(&one, row) * at(&other, row - offset) / weight(a + row))
            .sum::<f64>()
    };
    for knot in 0..inner {
        let [a, b, c] = column(knot);
        if let Some(entry) = diagonal.get_mut(knot) {
            *entry = (step(knot) + step(knot + 1)) / 3.0 + lambda * product(knot, knot);
        }
        if knot + 1 < inner
            && let Some(entry) = first.get_mut(knot)
        {
            *entry = step(knot + 1) / 6.0 + lambda * product(knot, knot + 1);
        }
        if knot + 2 < inner
            && let Some(entry) = second.get_mut(knot)
        {
            *entry = lambda * product(knot, knot + 2);
        }
        if let Some(entry) = right_side.get_mut(knot) {
            *entry = a * at(values, knot) + b * at(values, knot + 1) + c * at(values, knot + 2);
        }
    }
    let bending = solve_banded(diagonal, first, second, right_side);
    // Second derivatives at all knots, zero at the ends.
    let curve = |index: usize| {
        if index == 0 || index + 1 >= count { 0.0 } else { at(&bending, index - 1) }
    };
    let mut smoothed: Vec<f64> = values.iter().take(count).copied().collect();
    for knot in 0..inner {
        for (row, coefficient) in column(knot).into_iter().enumerate() {
            if let Some(value) = smoothed.get_mut(knot + row) {
                *value -= lambda * coefficient * at(&bending, knot) / weight(knot + row);
            }
        }
    }
    let slopes = (0..count)
        .map(|index| {
            if index + 1 < count {
                let rise = (at(&smoothed, index + 1) - at(&smoothed, index)) / step(index);
                rise - step(index) * (2.0 * curve(index) + curve(index + 1)) / 6.0
            } else {
                let rise = (at(&smoothed, index) - at(&smoothed, index - 1)) / step(index - 1);
                rise + step(index - 1) * (2.0 * curve(index) + curve(index - 1)) / 6.0
            }
        })
        .collect();
    Smoothed { values: smoothed, slopes }
}

/// What [`smooth`] gives at the places.
pub(super) struct Smoothed {
    pub(super) values: Vec<f64>,
    pub(super) slopes: Vec<f64>,
}

/// Solves a symmetric positive definite system with two bands next to the diagonal (`L D L^T`).
fn solve_banded(
    mut diagonal: Vec<f64>,
    mut first: Vec<f64>,
    mut second: Vec<f64>,
    mut right: Vec<f64>,
) -> Vec<f64> {
    let count = diagonal.len();
    let at = |list: &[f64], index: Option<usize>| {
        index.and_then(|index| list.get(index)).copied().unwrap_or(0.0)
    };
    for k in 0..count {
        let (one, two) = (k.checked_sub(1), k.checked_sub(2));
        let pivot = at(&diagonal, Some(k))
            - at(&diagonal, one) * at(&first, one) * at(&first, one)
            - at(&diagonal, two) * at(&second, two) * at(&second, two);
        let next =
            (at(&first, Some(k)) - at(&diagonal, one) * at(&first, one) * at(&second, one)) / pivot;
        let after = at(&second, Some(k)) / pivot;
        let value = at(&right, Some(k))
            - at(&first, one) * at(&right, one)
            - at(&second, two) * at(&right, two);
        for (list, entry) in
            [(&mut diagonal, pivot), (&mut first, next), (&mut second, after), (&mut right, value)]
        {
            if let Some(place) = list.get_mut(k) {
                *place = entry;
            }
        }
    }
    for k in (0..count).rev() {
        let value = at(&right, Some(k)) / at(&diagonal, Some(k))
            - at(&first, Some(k)) * at(&right, Some(k + 1))
            - at(&second, Some(k)) * at(&right, Some(k + 2));
        if let Some(place) = right.get_mut(k) {
            *place = value;
        }
    }
    right
}
