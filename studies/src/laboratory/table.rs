//! The figures as text for people.

use super::{ForcePoint, Laboratory, TestFigures};
use std::fmt;

impl fmt::Display for Laboratory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (out, back) = if self.direction_declared {
            ("extension", "compression")
        } else {
            ("side A", "side B")
        };
        let width =
            self.tests.iter().map(|test| test.name.chars().count()).max().unwrap_or(0).max(4);
        if !self.force_velocity.is_empty() {
            writeln!(f, "Force over velocity (median over the middle fifth of the stroke)")?;
            writeln!(
                f,
                "{:<width$} {:>9} {:>13} {:>13}  datasheet",
                "test",
                "mm/s",
                format!("{out} kN"),
                format!("{back} kN")
            )?;
            for point in &self.force_velocity {
                point.row(f, width)?;
            }
            writeln!(f)?;
        }
        if self.tests.iter().any(|test| test.dynamic.is_some()) {
            writeln!(
                f,
                "Dynamic stiffness and damping (first harmonic; describing functions at this amplitude)"
            )?;
            writeln!(
                f,
                "{:<width$} {:>7} {:>8} {:>9} {:>9} {:>9} {:>7} {:>9} {:>8} {:>6}",
                "test",
                "Hz",
                "mm",
                "K' MN/m",
                "K'' MN/m",
                "|K*| MN/m",
                "deg",
                "C kNs/m",
                "J/cycle",
                "F3/F1"
            )?;
            for test in &self.tests {
                test.dynamic_row(f, width)?;
            }
            writeln!(f)?;
        }
        writeln!(f, "Tests")?;
        writeln!(
            f,
            "{:<width$} {:>6} {:>8} {:>8} {:>6} {:>9} {:>9} {:>9} {:>8}  oil degC",
            "test", "s", "at mm", "+- mm", "cycles", "max kN", "min kN", "mean kN", "J/cycle"
        )?;
        for test in &self.tests {
            test.row(f, width)?;
        }
        let mut holds = self.tests.iter().filter(|test| !test.holds.is_empty()).peekable();
        if holds.peek().is_some() {
            writeln!(f, "\nForces at rest")?;
            writeln!(f, "{:<width$} {:>9} {:>9} {:>9}", "test", "at mm", "for s", "force N")?;
            for test in holds {
                for hold in &test.holds {
                    let at_mm = no_minus_zero(hold.displacement_m * 1e3, 100.0);
                    let for_s = hold.duration_s;
                    writeln!(
                        f,
                        "{:<width$} {at_mm:>9.2} {for_s:>9.1} {:>9.1}",
                        test.name, hold.force_n
                    )?;
                }
            }
        }
        for test in &self.tests {
            for repair in &test.repairs {
                writeln!(f, "note: {}: {repair}", test.name)?;
            }
        }
        Ok(())
    }
}

impl ForcePoint {
    fn row(&self, f: &mut fmt::Formatter<'_>, width: usize) -> fmt::Result {
        write!(
            f,
            "{:<width$} {:>9.2} {:>13.4} {:>13.4}",
            self.test,
            self.velocity_m_per_s * 1e3,
            self.extension_n * 1e-3,
            self.compression_n * 1e-3
        )?;
        let Some(limit) = &self.limit else { return writeln!(f, "  -") };
        let verdict = if self.within_limit == Some(true) { "within" } else { "OUTSIDE" };
        let side =
            |force: Option<f64>| force.map_or("-".to_owned(), |n| format!("{:.3}", n * 1e-3));
        writeln!(
            f,
            "  {verdict} {} / {} kN +-{:.0} %",
            side(limit.extension_n),
            side(limit.compression_n),
            limit.tolerance * 100.0
        )
    }
}

impl TestFigures {
    fn dynamic_row(&self, f: &mut fmt::Formatter<'_>, width: usize) -> fmt::Result {
        let (Some(dynamic), Some(hz)) = (&self.dynamic, self.frequency_hz) else { return Ok(()) };
        let force = |order: usize| dynamic.harmonics.get(order).map_or(0.0, |h| h.force_n);
        let third = if force(1) > 0.0 { force(3) / force(1) } else { 0.0 };
        writeln!(
            f,
            "{:<width$} {hz:>7.3} {:>8.3} {:>9.4} {:>9.4} {:>9.4} {:>7.2} {:>9.2} {:>8.2} {third:>6.3}",
            self.name,
            dynamic.amplitude_m * 1e3,
            dynamic.stiffness_real_n_per_m * 1e-6,
            dynamic.stiffness_imaginary_n_per_m * 1e-6,
            dynamic.stiffness_n_per_m * 1e-6,
            dynamic.phase_deg,
            dynamic.damping_n_s_per_m * 1e-3,
            self.work_per_cycle_j.unwrap_or(0.0),
        )
    }

    fn row(&self, f: &mut fmt::Formatter<'_>, width: usize) -> fmt::Result {
        let work = self.work_per_cycle_j.map_or("-".to_owned(), |work| format!("{work:.2}"));
        let oil = match self.temperature_degc {
            Some([first, last]) => format!("{first:.1} to {last:.1}"),
            None => "-".to_owned(),
        };
        writeln!(
            f,
            "{:<width$} {:>6.1} {:>8.2} {:>8.3} {:>6} {:>9.3} {:>9.3} {:>9.4} {work:>8}  {oil}",
            self.name,
            self.duration_s,
            no_minus_zero(self.mean_m * 1e3, 100.0),
            self.amplitude_m * 1e3,
            self.cycles_used,
            self.force_max_n * 1e-3,
            self.force_min_n * 1e-3,
            no_minus_zero(self.force_mean_n * 1e-3, 1e4),
        )
    }
}

/// Rounded to one part in `per_unit`, with zero without a sign.
fn no_minus_zero(value: f64, per_unit: f64) -> f64 {
    libm::rint(value * per_unit) / per_unit + 0.0
}
