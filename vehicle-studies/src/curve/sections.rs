//! Where the full curve of a layout is, and where its transitions.

use firmware_core::track::{Layout, LayoutPoint};
use serde::{Deserialize, Serialize};

/// Steps in which a layout is looked through (m).
const STEP_M: f64 = 0.1;

/// A part of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Curvature grows.
    Entry,
    /// Curvature and cant are those of the full curve.
    Curve,
    /// Curvature falls.
    Exit,
}

impl Part {
    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Entry => "entry",
            Self::Curve => "curve",
            Self::Exit => "exit",
        }
    }

    fn at(here: &LayoutPoint) -> Option<Self> {
        let grows = here.curvature_rate_per_m2 * here.curvature_per_m;
        match grows {
            grows if grows > 0.0 => Some(Self::Entry),
            grows if grows < 0.0 => Some(Self::Exit),
            _ => (here.curvature_per_m != 0.0).then_some(Self::Curve),
        }
    }
}

/// A section of track.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// The part of the curve that it is.
    pub part: Part,
    /// Where it begins (m).
    pub from_m: f64,
    /// Where it ends (m).
    pub to_m: f64,
}

/// The sections of a layout in order, straight track left out; to a tenth of a metre.
pub(super) fn sections(layout: &Layout) -> Vec<Section> {
    let mut found: Vec<Section> = Vec::new();
    let steps = libm::ceil(layout.end_m() / STEP_M) as usize;
    for step in 0..steps {
        let from_m = step as f64 * STEP_M;
        let to_m = from_m + STEP_M;
        let Some(part) = Part::at(&layout.at(0.5 * (from_m + to_m))) else { continue };
        match found.last_mut().filter(|last| last.part == part) {
            Some(last) => last.to_m = to_m,
            None => found.push(Section { part, from_m, to_m }),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_has_an_entry_a_full_curve_and_an_exit() {
        let mut layout = Layout::tangent();
        layout.hold(100.0).unwrap();
        layout.ramp(60.0, 1.0 / 400.0, 0.08, 6.0).unwrap();
        layout.hold(200.0).unwrap();
        layout.ramp(60.0, 0.0, 0.0, 6.0).unwrap();
        let ends: Vec<f64> = sections(&layout).iter().map(|section| section.to_m.round()).collect();
        assert_eq!(ends, [160.0, 360.0, 420.0]);
    }
}
