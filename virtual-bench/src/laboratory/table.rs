//! The figures as text for people.

use super::{Dynamic, ForcePoint, Laboratory, TestFigures};
use std::fmt;

/// A unit that suits the size of what is printed.
#[derive(Clone, Copy)]
struct Unit {
    per_si: f64,
    name: &'static str,
}

impl Unit {
    /// Of the names for millions, thousands and ones, the one that leaves a number above 0.5.
    fn of(largest: f64, [mega, kilo, one]: [&'static str; 3]) -> Self {
        match largest.abs() {
            size if size >= 0.5e6 => Self { per_si: 1e-6, name: mega },
            size if size >= 0.5e3 => Self { per_si: 1e-3, name: kilo },
            _ => Self { per_si: 1.0, name: one },
        }
    }
}

/// The units of a table.
#[derive(Clone, Copy)]
struct Units {
    force: Unit,
    stiffness: Unit,
    damping: Unit,
}

impl Units {
    fn of(laboratory: &Laboratory) -> Self {
        let largest =
            |of: &dyn Fn(&TestFigures) -> f64| laboratory.tests.iter().map(of).fold(0.0, f64::max);
        let dynamic = |of: fn(&Dynamic) -> f64| {
            largest(&|test: &TestFigures| {
                test.dynamic.as_ref().map_or(0.0, |dynamic| of(dynamic).abs())
            })
        };
        let force =
            largest(&|test: &TestFigures| test.force_max_n.abs().max(test.force_min_n.abs()));
        Self {
            force: Unit::of(force, ["MN", "kN", "N"]),
            stiffness: Unit::of(dynamic(|d| d.stiffness_n_per_m), ["MN/m", "kN/m", "N/m"]),
            damping: Unit::of(dynamic(|d| d.damping_n_s_per_m), ["MNs/m", "kNs/m", "Ns/m"]),
        }
    }
}

impl fmt::Display for Laboratory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = Units::of(self);
        let (force, stiffness, damping) =
            (units.force.name, units.stiffness.name, units.damping.name);
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
                format!("{out} {force}"),
                format!("{back} {force}")
            )?;
            for point in &self.force_velocity {
                point.row(f, width, units.force)?;
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
                "{:<width$} {:>7} {:>8} {:>10} {:>10} {:>10} {:>7} {:>9} {:>8} {:>6}",
                "test",
                "Hz",
                "mm",
                format!("K' {stiffness}"),
                format!("K'' {stiffness}"),
                format!("|K*| {stiffness}"),
                "deg",
                format!("C {damping}"),
                "J/cycle",
                "F3/F1"
            )?;
            for test in &self.tests {
                test.dynamic_row(f, width, units)?;
            }
            writeln!(f)?;
        }
        writeln!(f, "Tests")?;
        writeln!(
            f,
            "{:<width$} {:>6} {:>8} {:>8} {:>6} {:>9} {:>9} {:>9} {:>8}  oil degC",
            "test",
            "s",
            "at mm",
            "+- mm",
            "cycles",
            format!("max {force}"),
            format!("min {force}"),
            format!("mean {force}"),
            "J/cycle"
        )?;
        for test in &self.tests {
            test.row(f, width, units.force)?;
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
    fn row(&self, f: &mut fmt::Formatter<'_>, width: usize, unit: Unit) -> fmt::Result {
        write!(
            f,
            "{:<width$} {:>9.2} {:>13.4} {:>13.4}",
            self.test,
            self.velocity_m_per_s * 1e3,
            self.extension_n * unit.per_si,
            self.compression_n * unit.per_si
        )?;
        let Some(limit) = &self.limit else { return writeln!(f, "  -") };
        let verdict = if self.within_limit == Some(true) { "within" } else { "OUTSIDE" };
        let side = |force: Option<f64>| {
            force.map_or("-".to_owned(), |n| format!("{:.3}", n * unit.per_si))
        };
        writeln!(
            f,
            "  {verdict} {} / {} {} +-{:.0} %",
            side(limit.extension_n),
            side(limit.compression_n),
            unit.name,
            limit.tolerance * 100.0
        )
    }
}

impl TestFigures {
    fn dynamic_row(&self, f: &mut fmt::Formatter<'_>, width: usize, units: Units) -> fmt::Result {
        let (Some(dynamic), Some(hz)) = (&self.dynamic, self.frequency_hz) else { return Ok(()) };
        let force = |order: usize| dynamic.harmonics.get(order).map_or(0.0, |h| h.force_n);
        let third = if force(1) > 0.0 { force(3) / force(1) } else { 0.0 };
        writeln!(
            f,
            "{:<width$} {hz:>7.3} {:>8.3} {:>10.4} {:>10.4} {:>10.4} {:>7.2} {:>9.2} {:>8.2} {third:>6.3}",
            self.name,
            dynamic.amplitude_m * 1e3,
            dynamic.stiffness_real_n_per_m * units.stiffness.per_si,
            dynamic.stiffness_imaginary_n_per_m * units.stiffness.per_si,
            dynamic.stiffness_n_per_m * units.stiffness.per_si,
            dynamic.phase_deg,
            dynamic.damping_n_s_per_m * units.damping.per_si,
            self.work_per_cycle_j.unwrap_or(0.0),
        )
    }

    fn row(&self, f: &mut fmt::Formatter<'_>, width: usize, unit: Unit) -> fmt::Result {
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
            self.force_max_n * unit.per_si,
            self.force_min_n * unit.per_si,
            no_minus_zero(self.force_mean_n * unit.per_si, 1e4),
        )
    }
}

/// Rounded to one part in `per_unit`, with zero without a sign.
fn no_minus_zero(value: f64, per_unit: f64) -> f64 {
    libm::rint(value * per_unit) / per_unit + 0.0
}
