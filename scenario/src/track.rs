//! The track part of a scenario: one curve or none, and the irregularity.

use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::irregularity::{IrregularityFile, Samples, Stretches};
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::track::{Layout, Track};
use serde::{Deserialize, Serialize};

/// Distance between the rail heads, over which cant is measured (m).
pub const RAIL_SPACING_M: f64 = 1.5;

/// Corners of a transition are rounded over this length (m).
pub const ROUNDING_M: f64 = 6.0;

/// A track as it stands in a scenario; without a curve it is straight, without irregularity
/// perfect.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TrackFile {
    /// A curve between two transitions.
    pub curve: Option<CurveFile>,
    /// Deviation of the rails.
    pub irregularity: Option<IrregularityFile>,
}

/// Which way a curve turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Direction {
    Left,
    Right,
}

/// A circular curve with a transition on either side.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CurveFile {
    /// Radius of the full curve.
    pub radius_m: Quantity,
    /// Which way it turns.
    pub direction: Direction,
    /// Height of the outer rail over the inner one.
    pub cant_m: Quantity,
    /// Straight track before the first transition.
    pub lead_in_m: Quantity,
    /// Length of each transition.
    pub transition_m: Quantity,
    /// Length of the full curve.
    pub length_m: Quantity,
}

/// A track in memory, or a stretch of one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OwnedTrack {
    /// Curvature and cant.
    pub layout: Layout,
    /// Samples of irregularity.
    pub samples: Samples,
}

impl OwnedTrack {
    /// The track as a step sees it.
    pub fn view(&self) -> Track<'_> {
        Track { layout: self.layout.clone(), irregularity: self.samples.view() }
    }
}

impl TrackFile {
    /// Builds the track between two distances for a vehicle whose bodies reach so far from its
    /// reference point (m): of a random track the first stretch, and what makes the others.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub(crate) fn build(
        &self,
        source: &Source,
        between_m: (f64, f64),
        reach_m: f64,
        inputs: &mut Inputs,
    ) -> Result<(OwnedTrack, Option<Stretches>), ScenarioError> {
        let layout = match &self.curve {
            Some(curve) => curve.layout(source)?,
            None => Layout::tangent(),
        };
        let mut samples = Samples::default();
        let Some(irregularity) = &self.irregularity else {
            return Ok((OwnedTrack { layout, samples }, None));
        };
        let band = irregularity.band(source)?;
        let stretches = band.map(|band| Stretches::new(band, between_m, reach_m));
        if let Some(stretches) = &stretches {
            stretches.make(0, &mut samples, &|| true);
        }
        if let Some(measured) = irregularity.measured(source, between_m, inputs)? {
            samples = measured;
        }
        Ok((OwnedTrack { layout, samples }, stretches))
    }
}

impl CurveFile {
    fn layout(&self, source: &Source) -> Result<Layout, ScenarioError> {
        let radius_m = self.radius_m.within(source, "radius_m", 100.0, 1e6, "at least 100 m")?;
        let cant_m = self.cant_m.within(source, "cant_m", -0.2, 0.2, "-0.2 to 0.2 m")?;
        let sign = if self.direction == Direction::Right { 1.0 } else { -1.0 };
        let (curvature, cant) = (sign / radius_m, sign * cant_m / RAIL_SPACING_M);
        let lead_in_m = self.lead_in_m.positive(source, "lead_in_m")?;
        let transition_m = self.transition_m.within(
            source,
            "transition_m",
            2.0 * ROUNDING_M + 1.0,
            1e4,
            "at least 13 m",
        )?;
        let length_m = self.length_m.positive(source, "length_m")?;
        let mut layout = Layout::tangent();
        let fail = |error: firmware_core::track::LayoutError| {
            self.radius_m.error(source, error.to_string())
        };
        layout.hold(lead_in_m).map_err(fail)?;
        layout.ramp(transition_m, curvature, cant, ROUNDING_M).map_err(fail)?;
        layout.hold(length_m).map_err(fail)?;
        layout.ramp(transition_m, 0.0, 0.0, ROUNDING_M).map_err(fail)?;
        Ok(layout)
    }
}
