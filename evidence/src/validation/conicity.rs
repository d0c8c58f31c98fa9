//! Equivalent conicity against the benchmark of UIC 519 / EN 15302.
//!
//! The benchmark gives the rolling radius difference of a wheelset over its lateral shift as a
//! table and the conicity by integration with bounds, row by row. Cases A to I stand for wheels and
//! tracks; E1 to E4 are pairs of like wheels, E5 to E7 pairs of unlike ones, which rest off the
//! middle. Two shapes with closed forms are compared as well: a cone, and a cubic by both methods
//! ([`scenario::conicity::RollingRadiusDifference`]).

use super::check::{Check, Reference};
use super::columns;
use crate::error::EvidenceError;
use report::Plot;
use scenario::conicity::RollingRadiusDifference;
use std::sync::atomic::AtomicBool;

/// Case, its table of rolling radius differences.
const CASES: [(&str, &str); 7] = [
    ("E1", include_str!("tables/uic519-e1.csv")),
    ("E2", include_str!("tables/uic519-e2.csv")),
    ("E3", include_str!("tables/uic519-e3.csv")),
    ("E4", include_str!("tables/uic519-e4.csv")),
    ("E5", include_str!("tables/uic519-e5.csv")),
    ("E6", include_str!("tables/uic519-e6.csv")),
    ("E7", include_str!("tables/uic519-e7.csv")),
];
/// Amplitudes with reference and bounds, all cases.
const CONICITIES: &str = include_str!("tables/uic519-conicity.csv");

/// Distance between the values of a table (m).
const STEP_M: f64 = 0.1e-3;

/// The comparison.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn reference(stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let mut checks = Vec::new();
    let mut plots = Vec::new();
    let mut beyond = 0;
    for (case, differences) in CASES {
        EvidenceError::check(stop)?;
        let benchmark = Benchmark::new(case, differences)?;
        beyond += benchmark.beyond();
        checks.extend(benchmark.checks());
        plots.push(benchmark.plot());
    }
    checks.extend(closed_forms());
    Ok(Reference {
        name: "uic-519",
        title: "Equivalent conicity, UIC 519 / EN 15302",
        what: "Conicity by integration of the motion between its turning points, from the \
               benchmark's tables of rolling radius differences (wheel diameter 920 mm, gauge \
               1435.16 mm), amplitudes from 1 mm on. A cone and a cubic difference have closed forms."
            .to_owned(),
        source: "Benchmark tables as in the open project B_ECC (criogenox, MIT licence); closed forms: \
                 2 gamma y, and the lemniscate integral.",
        tolerance: "The benchmark's own bounds: 0.05, or half the conicity where that is less; up to 0.01 \
                    where there is none. Closed forms: a table in straight pieces of width h is off by \
                    h2/8 times its second derivative; twice that."
            .to_owned(),
        limits: vec![format!(
            "{beyond} rows of the benchmark have amplitudes beyond its tables; without a radius \
             difference our function returns no conicity, and these rows are not compared."
        )],
        checks,
        plots,
    })
}

/// One case of the benchmark.
struct Benchmark {
    case: &'static str,
    table: RollingRadiusDifference,
    /// Amplitude (mm), reference, upper and lower bound.
    rows: Vec<[f64; 4]>,
}

impl Benchmark {
    fn new(case: &'static str, differences: &str) -> Result<Self, EvidenceError> {
        let [shifts_mm, differences_mm] = columns(differences, ["shift_mm", "difference_mm"])?;
        let first_m = shifts_mm.first().copied().unwrap_or(0.0) * 1e-3;
        let differences_m = differences_mm.iter().map(|value| value * 1e-3).collect();
        let own: Vec<&str> =
            CONICITIES.lines().filter(|line| line.starts_with(&format!("{case},"))).collect();
        let head = CONICITIES.lines().next().unwrap_or_default();
        let text = format!("{head}\n{}", own.join("\n"));
        let [amplitude, reference, upper, lower] =
            columns(&text, ["amplitude_mm", "reference", "upper", "lower"])?;
        let rows = (0..amplitude.len())
            .map(|row| [amplitude[row], reference[row], upper[row], lower[row]])
            .collect();
        Ok(Self { case, table: RollingRadiusDifference::new(first_m, STEP_M, differences_m), rows })
    }

    fn ours(&self, amplitude_mm: f64) -> Option<f64> {
        self.table.integrated_conicity(amplitude_mm * 1e-3)
    }

    fn checks(&self) -> Vec<Check> {
        let quantity = format!("equivalent conicity, case {}", self.case);
        let check = |row: &[f64; 4]| {
            let [amplitude_mm, reference, upper, lower] = *row;
            let ours = self.ours(amplitude_mm)?;
            let at = format!("amplitude {amplitude_mm} mm");
            Some(Check::between(&quantity, &at, [reference, ours], [lower, upper]))
        };
        self.rows.iter().filter_map(check).collect()
    }

    fn beyond(&self) -> usize {
        self.rows.iter().filter(|row| self.ours(row[0]).is_none()).count()
    }

    fn plot(&self) -> Plot {
        let column =
            |index: usize| -> Vec<f64> { self.rows.iter().map(|row| row[index]).collect() };
        let ours: Vec<f64> =
            self.rows.iter().map(|row| self.ours(row[0]).unwrap_or(f64::NAN)).collect();
        Plot::new(&format!("Case {}", self.case))
            .x("amplitude", "mm")
            .y("equivalent conicity", "")
            .band("bounds", &column(0), &column(3), &column(2))
            .line("ours", &column(0), &ours)
            .height_px(240)
    }
}

/// A cone and a cubic radius difference `dr = 4 b y^3`: harmonic `1.5 b A^2`; the motion
/// `y'' = -4 b y^3 / (e r0)` has the quarter period of the lemniscate.
fn closed_forms() -> Vec<Check> {
    let cone: Vec<f64> = (-80..=80).map(|step| 2.0 * 0.05 * f64::from(step) * STEP_M).collect();
    let cone = RollingRadiusDifference::new(-8e-3, STEP_M, cone);
    // Tables in straight pieces: off by h2/8 f'' = 3 b h2 y against 4 b y^3; twice that at the
    // amplitude.
    let (b, amplitude_m, fine_m) = (1000.0, 4e-3, 0.01e-3);
    let share = 1.5 * (fine_m / amplitude_m) * (fine_m / amplitude_m);
    let cubic = (-800..=800).map(|step| {
        let shift_m = f64::from(step) * fine_m;
        4.0 * b * shift_m * shift_m * shift_m
    });
    let cubic = RollingRadiusDifference::new(-8e-3, fine_m, cubic.collect());
    let quarter = 1.311_028_777_146_06 / (libm::sqrt(2.0 * b) * amplitude_m);
    let rate = std::f64::consts::FRAC_PI_2 / quarter;
    let (harmonic, integrated) = ("conicity by the first harmonic", "conicity by integration");
    let none = f64::NAN;
    vec![
        // A cone is exact but for the rules of integration over 1440 and 2000 points.
        Check::near(
            harmonic,
            "cone 0.05, 3 mm",
            [0.05, cone.harmonic_conicity(3e-3).unwrap_or(none)],
            1e-7,
        ),
        Check::near(
            integrated,
            "cone 0.05, 3 mm",
            [0.05, cone.integrated_conicity(3e-3).unwrap_or(none)],
            1e-7,
        ),
        Check::within(
            harmonic,
            "cubic, 4 mm",
            [
                1.5 * b * amplitude_m * amplitude_m,
                cubic.harmonic_conicity(amplitude_m).unwrap_or(none),
            ],
            share,
        ),
        Check::within(
            integrated,
            "cubic, 4 mm",
            [0.5 * rate * rate, cubic.integrated_conicity(amplitude_m).unwrap_or(none)],
            share,
        ),
    ]
}
