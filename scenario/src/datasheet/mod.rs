//! What a maker says about a damper, turned into the five nominal numbers.
//!
//! ```toml
//! [damper]                        # any of these, with one way to know Ce
//! ce_n_s_per_m = 1.0e6
//! ke_n_per_m = 12.5e6
//! clearance_2a_m = 0.0            # default 0
//! v_relief_m_per_s = 0.018
//! f_relief_n = 18.0e3
//! c2_n_s_per_m = 60.0e3           # default 0.06 Ce
//!
//! [[force]]                       # or the force-velocity table, one row per speed
//! velocity_m_per_s = 0.01
//! extension_n = 9.9e3             # one of the two is enough
//! compression_n = 10.1e3
//! tolerance = 0.15                # share, default 0.15
//!
//! [[dynamic]]                     # and the table of dynamic stiffness, small sines
//! frequency_hz = 3.0
//! amplitude_m = 1.0e-3
//! stiffness_n_per_m = 8.0e6       # first harmonic of force over displacement
//! phase_deg = 35.0                # of force before displacement; may be absent
//! ```
//!
//! - **Ce, relief force, C2**: what `[damper]` says; else two of Ce, relief force and relief
//!   velocity; else two lines with a knee through the force table, as quasi-static ([`knee`]). Ce
//!   and the relief force rule where all three are given and do not agree. Without any of them the
//!   relief never opens.
//! - **Ke**: what `[damper]` says; else the one for which the simulated damper has the dynamic
//!   table's first harmonics ([`first_harmonic`]); else a stiff one, Ce over 10 ms.
//!
//! Every step of the conversion is a line in [`Datasheet::conversion`].

pub mod first_harmonic;
pub mod knee;
#[cfg(test)]
mod tests;

use crate::error::ScenarioError;
use crate::kind::Kind;
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::damper::Nominal;
use first_harmonic::Point;
use knee::{Row, TwoLines};
use serde::Deserialize;
use std::path::Path;

/// Second slope over first by default.
pub const C2_SHARE: f64 = 0.06;

/// Ce over Ke where Ke is unknown (s): stiff against any motion below 10 Hz.
pub const STIFF_S: f64 = 10e-3;

/// Tolerance of a force table that names none.
pub const TOLERANCE: f64 = 0.15;

/// A datasheet, converted.
#[derive(Debug, Clone, PartialEq)]
pub struct Datasheet {
    /// The five numbers; the relief force is infinite where nothing is known of a relief.
    pub nominal: Nominal,
    /// Which of them the datasheet gives, as such or by its tables.
    pub given: Given,
    /// What does not agree within the datasheet, each a line.
    pub warnings: Vec<String>,
    /// How the numbers came about, each a line to print.
    pub conversion: Vec<String>,
}

/// Which nominal numbers a datasheet gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "one for each number")]
#[expect(missing_docs, reason = "the names say it")]
pub struct Given {
    pub ce: bool,
    pub ke: bool,
    pub clearance_2a: bool,
    pub f_relief: bool,
    pub c2: bool,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct DatasheetFile {
    #[serde(default)]
    damper: DamperTable,
    #[serde(default)]
    force: Vec<ForceRow>,
    #[serde(default)]
    dynamic: Vec<DynamicRow>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct DamperTable {
    ce_n_s_per_m: Option<Quantity>,
    ke_n_per_m: Option<Quantity>,
    clearance_2a_m: Option<Quantity>,
    v_relief_m_per_s: Option<Quantity>,
    f_relief_n: Option<Quantity>,
    c2_n_s_per_m: Option<Quantity>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ForceRow {
    velocity_m_per_s: Quantity,
    extension_n: Option<Quantity>,
    compression_n: Option<Quantity>,
    tolerance: Option<Quantity>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct DynamicRow {
    frequency_hz: Quantity,
    amplitude_m: Quantity,
    stiffness_n_per_m: Quantity,
    phase_deg: Option<Quantity>,
}

impl Datasheet {
    /// Reads a datasheet.
    ///
    /// # Errors
    /// The first thing that does not fit, with file and line.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        Self::from_source(&Source::read(path)?)
    }

    /// Reads a datasheet that is in memory.
    ///
    /// # Errors
    /// The first thing that does not fit, with file and line.
    ///
    /// ```
    /// use scenario::{datasheet::Datasheet, source::Source};
    /// let text = "[damper]\nce_n_s_per_m = 1e6\nf_relief_n = 15e3\nv_relief_m_per_s = 0.02\n";
    /// let sheet = Datasheet::from_source(&Source::from_text("sheet.toml".as_ref(), text))?;
    /// assert_eq!(sheet.nominal.f_relief_n, 15e3);
    /// assert_eq!(sheet.nominal.ke_n_per_m, 1e8);
    /// let warning = "v_relief 0.02 m/s does not agree with F_relief / Ce";
    /// assert!(sheet.warnings[0].starts_with(warning));
    /// # Ok::<(), scenario::source::ScenarioError>(())
    /// ```
    pub fn from_source(source: &Source) -> Result<Self, ScenarioError> {
        let file: DatasheetFile = source.parse_as(Kind::Datasheet)?;
        let (mut warnings, mut conversion) = (Vec::new(), Vec::new());
        let rows = force_rows(source, &file.force, &mut warnings)?;
        let points = dynamic_points(source, &file.dynamic)?;
        let direct = file.damper.checked(source)?;
        let table = knee::fit(&rows);
        if let Some(lines) = &table {
            tell_table(lines, &rows, &mut warnings, &mut conversion);
        }
        let (ce_n_s_per_m, f_relief_n) =
            direct.dashpot(source, table.as_ref(), &mut warnings, &mut conversion)?;
        let (c2_n_s_per_m, c2_given) =
            direct.second_slope(ce_n_s_per_m, f_relief_n, table.as_ref(), &mut conversion);
        let mut nominal = Nominal {
            ce_n_s_per_m,
            ke_n_per_m: ce_n_s_per_m / STIFF_S,
            clearance_2a_m: direct.clearance_2a_m.unwrap_or(0.0),
            f_relief_n,
            c2_n_s_per_m,
        };
        if c2_n_s_per_m >= ce_n_s_per_m {
            warnings.push(format!(
                "C2 {c2_n_s_per_m} N s/m is not below Ce {ce_n_s_per_m} N s/m: no relief at all"
            ));
        }
        if direct.clearance_2a_m.is_none() {
            conversion.push("2a = 0 m, by default: no clearance is given".to_owned());
        }
        let ke_given = direct.stiffness(&mut nominal, &points, &mut warnings, &mut conversion);
        nominal.validate().map_err(|error| source.whole_error(error.to_string()))?;
        let given = Given {
            ce: true,
            ke: ke_given,
            clearance_2a: direct.clearance_2a_m.is_some(),
            f_relief: f_relief_n.is_finite(),
            c2: c2_given,
        };
        Ok(Self { nominal, given, warnings, conversion })
    }
}

/// The values of `[damper]`.
struct Direct {
    ce_n_s_per_m: Option<f64>,
    ke_n_per_m: Option<f64>,
    clearance_2a_m: Option<f64>,
    v_relief_m_per_s: Option<f64>,
    f_relief_n: Option<f64>,
    c2_n_s_per_m: Option<f64>,
}

impl DamperTable {
    fn checked(&self, source: &Source) -> Result<Direct, ScenarioError> {
        let positive = |value: &Option<Quantity>, key: &str| {
            value.as_ref().map(|value| value.positive(source, key)).transpose()
        };
        let not_negative = |value: &Option<Quantity>, key: &str| {
            value.as_ref().map(|value| value.not_negative(source, key)).transpose()
        };
        Ok(Direct {
            ce_n_s_per_m: positive(&self.ce_n_s_per_m, "ce_n_s_per_m")?,
            ke_n_per_m: positive(&self.ke_n_per_m, "ke_n_per_m")?,
            clearance_2a_m: not_negative(&self.clearance_2a_m, "clearance_2a_m")?,
            v_relief_m_per_s: positive(&self.v_relief_m_per_s, "v_relief_m_per_s")?,
            f_relief_n: positive(&self.f_relief_n, "f_relief_n")?,
            c2_n_s_per_m: not_negative(&self.c2_n_s_per_m, "c2_n_s_per_m")?,
        })
    }
}

impl Direct {
    /// Ce and the relief force (infinite without relief).
    fn dashpot(
        &self,
        source: &Source,
        table: Option<&TwoLines>,
        warnings: &mut Vec<String>,
        conversion: &mut Vec<String>,
    ) -> Result<(f64, f64), ScenarioError> {
        let by_relief = self.f_relief_n.zip(self.v_relief_m_per_s).map(|(f, v)| f / v);
        let ce = if let Some(ce) = self.ce_n_s_per_m {
            ce
        } else if let Some(ce) = by_relief {
            conversion.push(format!("Ce = F_relief / v_relief = {ce:.6e} N s/m"));
            ce
        } else if let Some(table) = table {
            table.ce_n_s_per_m
        } else {
            return Err(source.whole_error(
                "no way to know Ce, expected ce_n_s_per_m, or f_relief_n and v_relief_m_per_s, or [[force]] rows",
            ));
        };
        if let Some(table) = table {
            compare("Ce", ce, table.ce_n_s_per_m, "N s/m", warnings);
        }
        let by_table = table.and_then(|table| table.f_relief_n);
        let f_relief_n = match (self.f_relief_n, self.v_relief_m_per_s) {
            (Some(force), speed) => {
                let follows = force / ce;
                if let Some(speed) = speed.filter(|speed| (speed / follows - 1.0).abs() > 0.01) {
                    warnings.push(format!(
                        "v_relief {speed} m/s does not agree with F_relief / Ce = {follows} m/s: Ce and F_relief rule"
                    ));
                }
                force
            }
            (None, Some(speed)) => {
                conversion.push(format!("F_relief = Ce v_relief = {:.6e} N", ce * speed));
                ce * speed
            }
            (None, None) => by_table.unwrap_or(f64::INFINITY),
        };
        if f_relief_n.is_infinite() {
            conversion.push("F_relief: nothing is said, the relief never opens".to_owned());
        }
        if let Some(force) = by_table {
            compare("F_relief", f_relief_n, force, "N", warnings);
        }
        Ok((ce, f_relief_n))
    }

    fn second_slope(
        &self,
        ce: f64,
        f_relief_n: f64,
        table: Option<&TwoLines>,
        conversion: &mut Vec<String>,
    ) -> (f64, bool) {
        let by_table = table.and_then(|table| table.c2_n_s_per_m);
        match (self.c2_n_s_per_m, by_table) {
            (Some(c2), _) | (None, Some(c2)) => (c2, true),
            (None, None) => {
                if f_relief_n.is_finite() {
                    conversion.push(format!(
                        "C2 = {C2_SHARE} Ce = {:.6e} N s/m, by default",
                        C2_SHARE * ce
                    ));
                }
                (C2_SHARE * ce, false)
            }
        }
    }

    /// Sets Ke; false when nothing determines it.
    fn stiffness(
        &self,
        nominal: &mut Nominal,
        points: &[Point],
        warnings: &mut Vec<String>,
        conversion: &mut Vec<String>,
    ) -> bool {
        let fitted = first_harmonic::fit_ke(nominal, points);
        match (self.ke_n_per_m, fitted) {
            (Some(ke), fitted) => {
                nominal.ke_n_per_m = ke;
                if let Some(fit) = fitted {
                    compare("Ke", ke, fit.ke_n_per_m, "N/m", warnings);
                }
                true
            }
            (None, Some(fit)) if fit.bounded => {
                nominal.ke_n_per_m = fit.ke_n_per_m;
                conversion.push(format!(
                    "Ke = {:.6e} N/m from {} dynamic rows, simulated with clearance and relief",
                    fit.ke_n_per_m,
                    points.len()
                ));
                for (point, found) in points.iter().zip(&fit.found) {
                    let line = point.compared_with(found);
                    if point.differs(found) {
                        warnings.push(line);
                    } else {
                        conversion.push(line);
                    }
                }
                true
            }
            (None, fitted) => {
                if fitted.is_some() {
                    warnings.push(
                        "the dynamic rows do not tell Ke: any stiff one gives the same".to_owned(),
                    );
                }
                conversion.push(format!(
                    "Ke = Ce / {STIFF_S} s = {:.6e} N/m: a stiff one, nothing is said about it",
                    nominal.ke_n_per_m
                ));
                false
            }
        }
    }
}

fn compare(name: &str, taken: f64, other: f64, unit: &str, warnings: &mut Vec<String>) {
    if (other / taken - 1.0).abs() > 0.1 {
        warnings
            .push(format!("{name} {taken:.6e} {unit} is taken; the tables say {other:.6e} {unit}"));
    }
}

/// Rows of the force table by rising velocity.
fn force_rows(
    source: &Source,
    rows: &[ForceRow],
    warnings: &mut Vec<String>,
) -> Result<Vec<Row>, ScenarioError> {
    let mut found: Vec<Row> = Vec::new();
    for row in rows {
        let velocity = row.velocity_m_per_s.positive(source, "velocity_m_per_s")?;
        let tolerance = match &row.tolerance {
            Some(share) => share.within(source, "tolerance", 1e-6, 1.0, "a share, 0 to 1")?,
            None => TOLERANCE,
        };
        let side = |force: &Option<Quantity>, key: &str| match force {
            Some(force) => {
                let value = force.finite(source, key)?.abs();
                if value > 0.0 {
                    return Ok(Some(value));
                }
                Err(force.error(source, format!("{key} = 0, expected a force")))
            }
            None => Ok(None),
        };
        let extension = side(&row.extension_n, "extension_n")?;
        let compression = side(&row.compression_n, "compression_n")?;
        let force_n = match (extension, compression) {
            (Some(one), Some(other)) => {
                let mean = 0.5 * (one + other);
                if (one - other).abs() > tolerance * mean {
                    warnings.push(format!(
                        "at {velocity} m/s extension {one} N and compression {other} N differ by {:.0} %: the nominal damper takes their mean",
                        100.0 * (one - other).abs() / mean
                    ));
                }
                mean
            }
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => {
                let message = "a row without force, expected extension_n or compression_n";
                return Err(row.velocity_m_per_s.error(source, message));
            }
        };
        if found.iter().any(|other| other.velocity_m_per_s == velocity) {
            let message = format!("velocity_m_per_s = {velocity} twice, expected one row each");
            return Err(row.velocity_m_per_s.error(source, message));
        }
        found.push(Row { velocity_m_per_s: velocity, force_n, tolerance });
    }
    found.sort_by(|a, b| a.velocity_m_per_s.total_cmp(&b.velocity_m_per_s));
    for pair in found.windows(2) {
        if pair[1].force_n < pair[0].force_n {
            warnings.push(format!(
                "the force falls from {} N at {} m/s to {} N at {} m/s",
                pair[0].force_n,
                pair[0].velocity_m_per_s,
                pair[1].force_n,
                pair[1].velocity_m_per_s
            ));
        }
    }
    Ok(found)
}

fn dynamic_points(source: &Source, rows: &[DynamicRow]) -> Result<Vec<Point>, ScenarioError> {
    rows.iter()
        .map(|row| {
            let phase = |phase: &Quantity| {
                phase.within(source, "phase_deg", 0.0, 90.0, "0 (a spring) to 90 (a dashpot)")
            };
            Ok(Point {
                frequency_hz: row.frequency_hz.positive(source, "frequency_hz")?,
                amplitude_m: row.amplitude_m.positive(source, "amplitude_m")?,
                stiffness_n_per_m: row.stiffness_n_per_m.positive(source, "stiffness_n_per_m")?,
                phase_deg: row.phase_deg.as_ref().map(phase).transpose()?,
            })
        })
        .collect()
}

fn tell_table(
    lines: &TwoLines,
    rows: &[Row],
    warnings: &mut Vec<String>,
    conversion: &mut Vec<String>,
) {
    let knee = match (lines.f_relief_n, lines.c2_n_s_per_m) {
        (Some(force), Some(c2)) => format!(", F_relief = {force:.6e} N, C2 = {c2:.6e} N s/m"),
        (Some(force), None) => format!(", F_relief = {force:.6e} N (C2 = {C2_SHARE} Ce)"),
        (None, _) => ", no knee".to_owned(),
    };
    conversion.push(format!(
        "Ce = {:.6e} N s/m{knee} by two lines through {} rows of force",
        lines.ce_n_s_per_m,
        rows.len()
    ));
    for row in rows {
        let fitted = lines.force_n(row.velocity_m_per_s);
        if (fitted / row.force_n - 1.0).abs() > row.tolerance {
            warnings.push(format!(
                "at {} m/s two lines give {fitted:.6e} N, the table {} N: out of its tolerance of {:.0} %",
                row.velocity_m_per_s,
                row.force_n,
                100.0 * row.tolerance
            ));
        }
    }
}
