//! The figures as text for people.

use super::{Dynamic, ForcePoint, Laboratory, TestFigures};
use files::quoted;
use report::{Cell, Table};
use std::fmt;

/// A unit that suits the size of what is printed.
#[derive(Clone, Copy)]
struct Unit {
    per_si: f64,
    name: &'static str,
}

/// The units of a table.
#[derive(Clone, Copy)]
struct Units {
    force: Unit,
    stiffness: Unit,
    damping: Unit,
}

impl fmt::Display for Laboratory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = Units::of(self);
        if !self.force_velocity.is_empty() {
            writeln!(f, "{}", self.force_table(units))?;
        }
        if self.tests.iter().any(|test| test.dynamic.is_some()) {
            writeln!(f, "{}", self.dynamic_table(units))?;
        }
        write!(f, "{}", self.test_table(units))?;
        if self.tests.iter().any(|test| !test.holds.is_empty()) {
            write!(f, "\n{}", self.hold_table())?;
        }
        for test in &self.tests {
            for repair in &test.repairs {
                writeln!(f, "note: {}: {repair}", quoted(&test.name))?;
            }
        }
        Ok(())
    }
}

impl Laboratory {
    fn force_table(&self, Units { force, .. }: Units) -> Table {
        let [out, back] = if self.direction_declared {
            ["extension", "compression"]
        } else {
            ["side A", "side B"]
        };
        Table::new("Force over velocity (median over the middle fifth of the stroke)")
            .text("test")
            .fixed("velocity", "mm/s", 2)
            .fixed(out, force.name, 4)
            .fixed(back, force.name, 4)
            .text("datasheet")
            .rows(self.force_velocity.iter().map(|point| {
                [
                    point.test.as_str().into(),
                    (point.velocity_m_per_s * 1e3).into(),
                    (point.extension_n * force.per_si).into(),
                    (point.compression_n * force.per_si).into(),
                    point.verdict(force),
                ]
            }))
    }

    fn dynamic_table(&self, Units { stiffness, damping, .. }: Units) -> Table {
        let caption = "Dynamic stiffness and damping (first harmonic; describing functions at this \
                       amplitude)";
        let rows = self.tests.iter().filter_map(|test| {
            let (dynamic, hz) = (test.dynamic.as_ref()?, test.frequency_hz?);
            Some([
                test.name.as_str().into(),
                hz.into(),
                (dynamic.amplitude_m * 1e3).into(),
                (dynamic.stiffness_real_n_per_m * stiffness.per_si).into(),
                (dynamic.stiffness_imaginary_n_per_m * stiffness.per_si).into(),
                (dynamic.stiffness_n_per_m * stiffness.per_si).into(),
                dynamic.phase_deg.into(),
                (dynamic.damping_n_s_per_m * damping.per_si).into(),
                test.work_per_cycle_j.unwrap_or(0.0).into(),
                dynamic.third_harmonic().into(),
            ])
        });
        Table::new(caption)
            .text("test")
            .fixed("f", "Hz", 3)
            .fixed("X", "mm", 3)
            .fixed("K'", stiffness.name, 4)
            .fixed("K''", stiffness.name, 4)
            .fixed("|K*|", stiffness.name, 4)
            .fixed("phase", "deg", 2)
            .fixed("C", damping.name, 2)
            .fixed("work", "J/cycle", 2)
            .fixed("F3/F1", "", 3)
            .rows(rows)
    }

    fn test_table(&self, Units { force, .. }: Units) -> Table {
        let oil = |[first, last]: [f64; 2]| Cell::from(format!("{first:.1} to {last:.1}"));
        Table::new("Tests")
            .text("test")
            .fixed("length", "s", 1)
            .fixed("at", "mm", 2)
            .fixed("+-", "mm", 3)
            .number("cycles", "")
            .fixed("max", force.name, 3)
            .fixed("min", force.name, 3)
            .fixed("mean", force.name, 4)
            .fixed("work", "J/cycle", 2)
            .text("oil degC")
            .rows(self.tests.iter().map(|test| {
                [
                    test.name.as_str().into(),
                    test.duration_s.into(),
                    (test.mean_m * 1e3).into(),
                    (test.amplitude_m * 1e3).into(),
                    (test.cycles_used as u64).into(),
                    (test.force_max_n * force.per_si).into(),
                    (test.force_min_n * force.per_si).into(),
                    (test.force_mean_n * force.per_si).into(),
                    test.work_per_cycle_j.into(),
                    test.temperature_degc.map_or(Cell::Empty, oil),
                ]
            }))
    }

    fn hold_table(&self) -> Table {
        let holds = self.tests.iter().flat_map(|test| {
            test.holds.iter().map(|hold| {
                [
                    test.name.as_str().into(),
                    (hold.displacement_m * 1e3).into(),
                    hold.duration_s.into(),
                    hold.force_n.into(),
                ]
            })
        });
        Table::new("Forces at rest")
            .text("test")
            .fixed("at", "mm", 2)
            .fixed("for", "s", 1)
            .fixed("force", "N", 1)
            .rows(holds)
    }
}

impl ForcePoint {
    /// What the datasheet says about this point.
    fn verdict(&self, unit: Unit) -> Cell {
        let Some(limit) = &self.limit else { return Cell::Empty };
        let verdict = if self.within_limit == Some(true) { "within" } else { "OUTSIDE" };
        let side = |force: Option<f64>| {
            force.map_or("-".to_owned(), |n| format!("{:.3}", n * unit.per_si))
        };
        let (out, back) = (side(limit.extension_n), side(limit.compression_n));
        let (unit, percent) = (unit.name, limit.tolerance * 100.0);
        format!("{verdict} {out} / {back} {unit} +-{percent:.0} %").into()
    }
}

impl Dynamic {
    /// The third harmonic of the force over the first.
    fn third_harmonic(&self) -> f64 {
        let force = |order: usize| self.harmonics.get(order).map_or(0.0, |h| h.force_n);
        if force(1) > 0.0 { force(3) / force(1) } else { 0.0 }
    }
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
