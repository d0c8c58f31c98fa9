//! A user's own profile, from a CSV of points.
//!
//! ```text
//! # any number of comment lines
//! y_mm,z_mm
//! -69.5,13.9
//! -69.2,15.1
//! ```
//!
//! The header names the unit: `y_mm,z_mm` or `y_m,z_m`. `y` points away from the track centre and
//! grows from row to row, `z` points down. A wheel has its tape circle at `y = 0` and its flange at
//! negative `y`; a rail head is given uncanted. The points are smoothed over arc length (ripples of
//! 3 mm are halved, longer ones kept) and become a chain of arcs with common tangents through about
//! one point in 0.2 mm, so that slope and curvature are usable. Parts steeper than 80 degrees are
//! cut off.

use super::chain::Chain;
use super::smoothing::smooth;
use super::{Profile, Provenance};
use crate::error::ScenarioError;
use crate::source;
use files::{Limit, quoted};
use std::path::Path;

/// Which body a file of points describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// A wheel: `z` is counted from the tape circle, the flange is at negative `y`.
    Wheel,
    /// A rail head: `z` is counted from its highest point.
    Rail,
}

/// Ripples of this wavelength are halved (m).
const HALF_WAVELENGTH_M: f64 = 3.0e-3;

/// Least distance between the joints of the arcs (m).
const JOINT_DISTANCE_M: f64 = 0.2e-3;

/// Steepest slope that is followed.
const STEEPEST: f64 = 5.67;

/// Fewest points, and largest distance between two of them (m), that make a profile.
const FEWEST_POINTS: usize = 20;
const LARGEST_DISTANCE_M: f64 = 5.0e-3;

impl Profile {
    /// Reads a profile from a CSV of points.
    ///
    /// # Errors
    /// [`ScenarioError::Points`] with the row and what was expected there: a file that cannot be
    /// read, another header, a cell that is no number, `y` that does not grow, too few points,
    /// points too far apart, a wheel without its tape circle or with `z` pointing up.
    pub fn from_csv(path: &Path, part: Part) -> Result<Self, ScenarioError> {
        Self::from_csv_hashed(path, part).map(|(profile, _)| profile)
    }

    /// The same with the hash of the file's bytes.
    pub(crate) fn from_csv_hashed(
        path: &Path,
        part: Part,
    ) -> Result<(Self, String), ScenarioError> {
        let (text, hash) = source::read_hashed(path, Limit::Table)?;
        Ok((Self::from_text(path, &text, part)?, hash))
    }

    fn from_text(path: &Path, text: &str, part: Part) -> Result<Self, ScenarioError> {
        let complain = |row: usize, found: String, expected: &str| ScenarioError::Points {
            file: path.to_path_buf(),
            row: (row > 0).then_some(row),
            found,
            expected: expected.to_owned(),
        };
        let points = read_points(text, &complain)?;
        let chain = fit(&points);
        let (first_m, last_m) = chain.ends_m();
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into());
        let source = format!("points of {}", path.display());
        let crossing = |anchor_m: f64| {
            Self::new(
                name.clone(),
                Provenance::Measured,
                source.clone(),
                chain.sections(anchor_m, 0.0),
                last_m,
            )
        };
        match part {
            Part::Wheel => {
                if first_m > -0.040 || last_m < 0.010 {
                    let found = format!("y from {:.1} to {:.1} mm", first_m * 1e3, last_m * 1e3);
                    return Err(complain(0, found, "a wheel from -40 mm or less to 10 mm or more"));
                }
                let wheel = crossing(0.0);
                let flange_m = wheel.at(-0.055_f64.max(first_m)).down_m;
                if flange_m < 0.010 {
                    let found = format!("a flange {:.1} mm below the tread", flange_m * 1e3);
                    return Err(complain(0, found, "z pointing down, the flange at negative y"));
                }
                Ok(wheel)
            }
            Part::Rail => {
                let head = crossing(0.5 * (first_m + last_m));
                let lowest = (0..=2000)
                    .map(|part| first_m + (last_m - first_m) * f64::from(part) / 2000.0)
                    .min_by(|a, b| head.at(*a).down_m.total_cmp(&head.at(*b).down_m));
                let crown_m = lowest.unwrap_or(0.0);
                if crown_m < first_m + 5e-3 || crown_m > last_m - 5e-3 {
                    let found = format!("the highest point at y = {:.1} mm", crown_m * 1e3);
                    return Err(complain(0, found, "z pointing down, the crown between the sides"));
                }
                Ok(crossing(crown_m))
            }
        }
    }
}

type Complain<'a> = &'a dyn Fn(usize, String, &str) -> ScenarioError;

/// The points in metres.
fn read_points(text: &str, complain: Complain<'_>) -> Result<Vec<(f64, f64)>, ScenarioError> {
    const HEADERS: &str = "the header `y_mm,z_mm` or `y_m,z_m`";
    let mut rows = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (row, header) =
        rows.next().ok_or_else(|| complain(0, "an empty file".to_owned(), HEADERS))?;
    let squeezed: String = header.chars().filter(|letter| !letter.is_whitespace()).collect();
    let scale = match squeezed.as_str() {
        "y_mm,z_mm" => 1e-3,
        "y_m,z_m" => 1.0,
        _ => return Err(complain(row, format!("`{}`", quoted(header)), HEADERS)),
    };
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (row, line) in rows {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let &[y, z] = cells.as_slice() else {
            return Err(complain(row, format!("{} cells", cells.len()), "two cells, y and z"));
        };
        let number = |cell: &str| {
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| complain(row, format!("`{}`", quoted(cell)), "a number"))
        };
        let point = (number(y)? * scale, number(z)? * scale);
        if let Some(before) = points.last() {
            let distance_m = point.0 - before.0;
            if distance_m <= 0.0 {
                return Err(complain(
                    row,
                    format!("y = {}", quoted(y)),
                    "y larger than in the row before",
                ));
            }
            if distance_m > LARGEST_DISTANCE_M {
                let found = format!("a gap of {:.1} mm in y", distance_m * 1e3);
                return Err(complain(row, found, "points no further apart than 5 mm"));
            }
        }
        points.push(point);
    }
    if points.len() < FEWEST_POINTS {
        return Err(complain(0, format!("{} points", points.len()), "at least 20 points"));
    }
    Ok(points)
}

/// The chain of arcs through the smoothed points.
fn fit(points: &[(f64, f64)]) -> Chain {
    let mut along_m = Vec::with_capacity(points.len());
    let mut length_m = 0.0;
    let mut before = points.first().copied().unwrap_or((0.0, 0.0));
    for point in points {
        length_m += libm::hypot(point.0 - before.0, point.1 - before.1);
        along_m.push(length_m);
        before = *point;
    }
    let outward: Vec<f64> = points.iter().map(|point| point.0).collect();
    let down: Vec<f64> = points.iter().map(|point| point.1).collect();
    let outward = smooth(&along_m, &outward, HALF_WAVELENGTH_M);
    let down = smooth(&along_m, &down, HALF_WAVELENGTH_M);
    let tangents = outward.values.iter().zip(outward.slopes.iter().zip(&down.slopes));
    let mut joints: Vec<(f64, f64)> = Vec::new();
    let mut last_m = f64::NEG_INFINITY;
    for (outward_m, (forward, fall)) in tangents {
        let steep = *forward <= 0.0 || fall.abs() > STEEPEST * forward;
        if steep && *outward_m > 0.0 {
            break;
        }
        if steep {
            joints.clear();
            last_m = f64::NEG_INFINITY;
        } else if outward_m - last_m >= JOINT_DISTANCE_M * forward {
            joints.push((*outward_m, fall / forward));
            last_m = *outward_m;
        }
    }
    Chain::through(joints)
}
