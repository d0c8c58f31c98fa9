//! Kalker's creep coefficients against his table and his asymptotes.
//!
//! `C11`, `C22`, `C23` over the axis ratio of the contact ellipse and Poisson's ratio: table E.3 of
//! "Three-Dimensional Elastic Bodies in Rolling Contact" (1990), copied here a second time and
//! apart from the one that runs, so that a slip in either shows. Between the ratios the values are
//! linear, between Poisson's ratios `1/C` is quadratic; slender ellipses, up to a ratio of 0.101,
//! follow the asymptotes.

use super::check::{Check, Reference};
use super::columns;
use crate::error::EvidenceError;
use firmware_core::wheel_rail::kalker::{KalkerCoefficients, coefficients};
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

const TABLE: &str = include_str!("tables/kalker-e3.csv");
const HEADS: [&str; 11] = [
    "longer_along",
    "ratio",
    "c11_0",
    "c11_25",
    "c11_50",
    "c22_0",
    "c22_25",
    "c22_50",
    "c23_0",
    "c23_25",
    "c23_50",
];
/// Poisson's ratios of the table.
const POISSON: [f64; 3] = [0.0, 0.25, 0.5];
/// Steel.
const STEEL: f64 = 0.28;
/// The numbers are copied or follow from a formula: only rounding errors remain.
const ROUNDING: f64 = 1e-12;

/// The comparison.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn reference(_stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let rows = rows()?;
    let mut checks = tabulated(&rows);
    checks.extend(between_poisson_ratios(&rows));
    checks.extend(slender());
    let step = |ratio: f64| coefficients(ratio, 1.0, STEEL).c22;
    let step_percent = 100.0 * (step(0.1011) / step(0.1009) - 1.0).abs();
    Ok(Reference {
        name: "kalker",
        title: "Kalker's creep coefficients",
        what: "C11, C22 and C23 at every entry of the table; between Poisson's ratios; slender ellipses \
               both ways."
            .to_owned(),
        source: "Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), table E.3, and its \
                 asymptotes, as in the open program CONTACT (Apache-2.0).",
        tolerance: "Rounding: the numbers are the table's, or follow from a formula.".to_owned(),
        limits: vec![
            format!(
                "From table to asymptote, at an axis ratio of 0.101, C22 steps by {step_percent:.1} %, as \
                 in the source. The table's own row at 0.1 lies below that and is checked half way \
                 to the next one."
            ),
            "C33, spin to spin moment, is left out, as in most vehicle codes.".to_owned(),
        ],
        checks,
        plots: Vec::new(),
    })
}

/// One axis ratio.
struct Row {
    longer_along: bool,
    ratio: f64,
    /// C11, C22, C23; each over Poisson's ratios.
    c: [[f64; 3]; 3],
}

fn rows() -> Result<Vec<Row>, EvidenceError> {
    let columns = columns(TABLE, HEADS)?;
    let row = |index: usize| {
        let [side, ratio, c @ ..] = columns.each_ref().map(|column| column[index]);
        let [a, b, d, e, f, g, h, i, j] = c;
        Row { longer_along: side == 1.0, ratio, c: [[a, b, d], [e, f, g], [h, i, j]] }
    };
    Ok((0..columns[0].len()).map(row).collect())
}

fn ours(longer_along: bool, ratio: f64, poisson: f64) -> [f64; 3] {
    let (a, b) = if longer_along { (1.0, ratio) } else { (ratio, 1.0) };
    let KalkerCoefficients { c11, c22, c23 } = coefficients(a, b, poisson);
    [c11, c22, c23]
}

fn ellipse(longer_along: bool, ratio: f64) -> String {
    let sides = if longer_along { "b/a" } else { "a/b" };
    format!("{sides} = {ratio:.2}")
}

const NAMES: [&str; 3] = ["C11", "C22", "C23"];

/// Every entry; the row at 0.1 by the value half way to the next.
fn tabulated(rows: &[Row]) -> Vec<Check> {
    let mut checks = Vec::new();
    for two in rows.windows(2).filter(|two| two[0].longer_along == two[1].longer_along) {
        let [low, high] = two else { continue };
        let below = low.ratio < 0.101;
        let middle = 0.5 * (low.ratio + high.ratio);
        for (which, name) in NAMES.into_iter().enumerate() {
            for (column, poisson) in POISSON.into_iter().enumerate() {
                let mut check = |ratio: f64, expected: f64| {
                    let ours = ours(low.longer_along, ratio, poisson)[which];
                    let at =
                        format!("{}, Poisson's ratio {poisson}", ellipse(low.longer_along, ratio));
                    let quantity = format!("{name}, table");
                    checks.push(Check::near(&quantity, &at, [expected, ours], ROUNDING * expected));
                };
                let (first, second) = (low.c[which][column], high.c[which][column]);
                if below {
                    check(middle, 0.5 * (first + second));
                }
                check(high.ratio, second);
            }
        }
    }
    checks
}

/// Steel: `1/C` on the parabola through the three tabulated values, by Newton's divided
/// differences.
fn between_poisson_ratios(rows: &[Row]) -> Vec<Check> {
    let mut checks = Vec::new();
    for row in rows.iter().filter(|row| row.ratio > 0.101) {
        for (which, name) in NAMES.into_iter().enumerate() {
            let [a, b, c] = row.c[which].map(|value| 1.0 / value);
            let (first, second) = ((b - a) / 0.25, (c - b) / 0.25);
            let bend = (second - first) / 0.5;
            let inverse = a + first * STEEL + bend * STEEL * (STEEL - 0.25);
            let expected = 1.0 / inverse;
            let ours = ours(row.longer_along, row.ratio, STEEL)[which];
            let at = format!("{}, steel", ellipse(row.longer_along, row.ratio));
            let quantity = format!("{name}, between Poisson's ratios");
            checks.push(Check::near(&quantity, &at, [expected, ours], ROUNDING * expected));
        }
    }
    checks
}

/// Both asymptotes for steel.
fn slender() -> Vec<Check> {
    let mut checks = Vec::new();
    for g in [0.02, 0.05, 0.1] {
        let factor = 1.0 / (1.0 - STEEL);
        let wide = [
            PI * PI / 4.0 * factor,
            PI * PI / 4.0,
            PI * f64::sqrt(g) / 3.0 * factor * (1.0 + STEEL * (libm::log(16.0 / g) - 5.0)),
        ];
        let log = libm::log(16.0 / (g * g));
        let (along, across) = (log - 2.0 * STEEL, (1.0 - STEEL) * log + 2.0 * STEEL);
        let bend = 3.0 - libm::log(4.0);
        let long = [
            2.0 * PI / g / along * (1.0 + bend / along),
            2.0 * PI / g / across * (1.0 + (1.0 - STEEL) * bend / across),
            2.0 * PI / 3.0 / (g * f64::sqrt(g)) / ((1.0 - STEEL) * log - 2.0 + 4.0 * STEEL),
        ];
        for (longer_along, expected) in [(false, wide), (true, long)] {
            let ours = ours(longer_along, g, STEEL);
            for (which, name) in NAMES.into_iter().enumerate() {
                let quantity = format!("{name}, slender ellipse");
                let values = [expected[which], ours[which]];
                let at = format!("{}, steel", ellipse(longer_along, g));
                checks.push(Check::near(&quantity, &at, values, ROUNDING * expected[which]));
            }
        }
    }
    checks
}
