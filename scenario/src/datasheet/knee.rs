//! Two lines with a knee through a force-velocity table.
//!
//! ```text
//! F = Ce v up to the knee,  F = F_r + C2 (v - F_r / Ce) beyond it        0 <= C2 < Ce
//! ```
//! The rows up to the knee are a line through the origin, those beyond it any line; both by least
//! squares of relative errors, for every place the knee can have between rows. The knee is where
//! the lines meet, and has to lie between the rows that it parts. One row beyond it takes C2 as
//! 0.06 Ce. Where a single line meets all rows within 2 % rms, or no knee does better, there is
//! none. Limits: the table is taken as quasi-static; a quadratic orifice becomes a secant.

use super::C2_SHARE;

/// One speed of a table, both directions averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Speed, m/s.
    pub velocity_m_per_s: f64,
    /// Force, N.
    pub force_n: f64,
    /// Tolerance of the force, a share of it.
    pub tolerance: f64,
}

/// Two lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoLines {
    /// Slope of the first, N s/m.
    pub ce_n_s_per_m: f64,
    /// Force at the knee, N; absent without one.
    pub f_relief_n: Option<f64>,
    /// Slope beyond it, N s/m; absent where the rows do not determine it.
    pub c2_n_s_per_m: Option<f64>,
}

impl TwoLines {
    /// Force at a speed, N.
    pub fn force_n(&self, velocity_m_per_s: f64) -> f64 {
        let line = self.ce_n_s_per_m * velocity_m_per_s;
        let c2 = self.c2_n_s_per_m.unwrap_or(C2_SHARE * self.ce_n_s_per_m);
        match self.f_relief_n {
            Some(force) if line > force => {
                force + c2 * (velocity_m_per_s - force / self.ce_n_s_per_m)
            }
            _ => line,
        }
    }

    fn error(&self, rows: &[Row]) -> f64 {
        let square = |row: &Row| {
            let error = self.force_n(row.velocity_m_per_s) / row.force_n - 1.0;
            error * error
        };
        rows.iter().map(square).sum::<f64>() / rows.len() as f64
    }
}

/// The lines of rows in order of speed; `None` without rows.
///
/// ```
/// use scenario::datasheet::knee::{Row, fit};
/// let row = |v: f64, force_n| Row { velocity_m_per_s: v, force_n, tolerance: 0.15 };
/// // 1000 kN s/m up to 18 kN, 80 kN s/m beyond.
/// let lines = fit(&[row(0.005, 5.0e3), row(0.01, 10.0e3), row(0.05, 20.56e3), row(0.1, 24.56e3)]);
/// let lines = lines.unwrap();
/// assert!((lines.ce_n_s_per_m - 1.0e6).abs() < 1.0);
/// assert!((lines.f_relief_n.unwrap() - 18.0e3).abs() < 1.0);
/// assert!((lines.c2_n_s_per_m.unwrap() - 80.0e3).abs() < 1.0);
/// ```
pub fn fit(rows: &[Row]) -> Option<TwoLines> {
    let single = through_origin(rows)?;
    let mut best = (single.error(rows), single);
    if best.0 < 0.02 * 0.02 {
        return Some(single);
    }
    for below in 1..rows.len() {
        let (first, second) = (rows.get(..below)?, rows.get(below..)?);
        for lines in knees(through_origin(first)?, second) {
            let force = lines.f_relief_n.unwrap_or(f64::MAX);
            let speed = force / lines.ce_n_s_per_m;
            let (before, after) =
                (first.last()?.velocity_m_per_s, second.first()?.velocity_m_per_s);
            // A knee on a row is a knee: the tables of makers stand on it.
            let parts = speed >= before * (1.0 - 1e-6) && speed <= after * (1.0 + 1e-6);
            let error = lines.error(rows);
            if parts && error < best.0 * (1.0 - 1e-9) {
                best = (error, lines);
            }
        }
    }
    Some(best.1)
}

fn through_origin(rows: &[Row]) -> Option<TwoLines> {
    let (mut top, mut bottom) = (0.0, 0.0);
    for row in rows {
        let share = row.velocity_m_per_s / row.force_n;
        top += share;
        bottom += share * share;
    }
    let ce_n_s_per_m = top / bottom;
    ce_n_s_per_m.is_finite().then_some(TwoLines {
        ce_n_s_per_m,
        f_relief_n: None,
        c2_n_s_per_m: None,
    })
}

/// Lines beyond a knee: the one through the rows where there are two, and a flat one should that
/// fall.
fn knees(first: TwoLines, rows: &[Row]) -> Vec<TwoLines> {
    let ce = first.ce_n_s_per_m;
    let knee = |base: f64, slope: f64, known: bool| TwoLines {
        ce_n_s_per_m: ce,
        f_relief_n: Some(base / (1.0 - slope / ce)),
        c2_n_s_per_m: known.then_some(slope),
    };
    // F = base + slope v, weights 1/F^2.
    let sum = |of: fn(&Row) -> f64| -> f64 {
        rows.iter().map(|row| of(row) / (row.force_n * row.force_n)).sum()
    };
    let (w, wv, wf) = (sum(|_| 1.0), sum(|r| r.velocity_m_per_s), sum(|r| r.force_n));
    if rows.len() < 2 {
        let slope = C2_SHARE * ce;
        return vec![knee((wf - slope * wv) / w, slope, false)];
    }
    let wvv = sum(|r| r.velocity_m_per_s * r.velocity_m_per_s);
    let wvf = sum(|r| r.velocity_m_per_s * r.force_n);
    let slope = (w * wvf - wv * wf) / (w * wvv - wv * wv);
    if slope < 0.0 {
        return vec![knee(wf / w, 0.0, true)];
    }
    if slope >= ce {
        return Vec::new();
    }
    vec![knee((wf - slope * wv) / w, slope, true)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(of: &[(f64, f64)]) -> Vec<Row> {
        let row = |(v, f): &(f64, f64)| Row { velocity_m_per_s: *v, force_n: *f, tolerance: 0.15 };
        of.iter().map(row).collect()
    }

    #[test]
    fn a_line_has_no_knee() {
        let lines = fit(&rows(&[(0.01, 1e3), (0.05, 5.05e3), (0.1, 9.9e3)])).unwrap();
        assert!((lines.ce_n_s_per_m / 1e5 - 1.0).abs() < 0.01);
        assert_eq!(lines.f_relief_n, None);
        assert_eq!(fit(&rows(&[(0.02, 3e3)])).unwrap().ce_n_s_per_m, 1.5e5);
        assert_eq!(fit(&[]), None);
    }

    #[test]
    fn one_row_beyond_the_knee_takes_the_default_slope() {
        // 500 kN s/m to 10 kN at 20 mm/s, then 30 kN s/m: 10.9 kN at 50 mm/s.
        let lines = fit(&rows(&[(0.01, 5e3), (0.05, 10.9e3)])).unwrap();
        assert!((lines.f_relief_n.unwrap() - 10e3).abs() < 1e-6);
        assert_eq!(lines.c2_n_s_per_m, None);
        assert!((lines.force_n(0.05) - 10.9e3).abs() < 1e-6);
    }

    #[test]
    fn scattered_rows_give_the_knee_within_their_scatter() {
        let truth = TwoLines { ce_n_s_per_m: 4e5, f_relief_n: Some(8e3), c2_n_s_per_m: Some(2e4) };
        let scatter = [0.02, -0.02, 0.01, -0.015, 0.02, -0.02, 0.015];
        let speeds = [0.005, 0.01, 0.015, 0.03, 0.06, 0.1, 0.15];
        let scattered: Vec<(f64, f64)> =
            speeds.iter().zip(scatter).map(|(v, s)| (*v, truth.force_n(*v) * (1.0 + s))).collect();
        let found = fit(&rows(&scattered)).unwrap();
        assert!((found.ce_n_s_per_m / 4e5 - 1.0).abs() < 0.03, "{found:?}");
        assert!((found.f_relief_n.unwrap() / 8e3 - 1.0).abs() < 0.04, "{found:?}");
        assert!((found.c2_n_s_per_m.unwrap() / 2e4 - 1.0).abs() < 0.3, "{found:?}");
    }

    #[test]
    fn a_falling_end_becomes_a_flat_one() {
        let found = fit(&rows(&[(0.01, 1e3), (0.02, 2e3), (0.05, 2.1e3), (0.1, 2.0e3)])).unwrap();
        assert_eq!(found.c2_n_s_per_m, Some(0.0));
    }
}
