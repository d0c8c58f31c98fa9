//! Curvature and cant along the track, as a bounded list of polynomial sections.
//!
//! Curvature is positive in a right-hand curve, cant is the angle by which the right rail is lower.
//! A transition ramps both linearly (a clothoid) with corners rounded by parabolas, so that the
//! roll acceleration of the track stays finite. Heading and lateral offset are the integrals of
//! curvature in the small-angle sense: differences over the length of a vehicle are exact to second
//! order in (length / radius).

/// Largest number of polynomial sections.
pub const SECTIONS_MAX: usize = 64;

/// A section in which curvature and cant are quadratic in distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Section {
    start_m: f64,
    curvature: [f64; 3],
    cant: [f64; 3],
    heading_rad: f64,
    offset_m: f64,
}

impl Section {
    /// Straight and level, from far behind every vehicle.
    const TANGENT: Self = Self {
        start_m: -1e9,
        curvature: [0.0; 3],
        cant: [0.0; 3],
        heading_rad: 0.0,
        offset_m: 0.0,
    };
}

/// Why a layout cannot be built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LayoutError {
    /// More pieces than [`SECTIONS_MAX`] sections can hold.
    TooManySections,
    /// A length that is not positive and finite (m).
    Length(f64),
    /// A rounding that is not shorter than the transition (m).
    Rounding(f64),
}

impl core::fmt::Display for LayoutError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooManySections => {
                write!(f, "track layout has more than {SECTIONS_MAX} sections")
            }
            Self::Length(m) => write!(f, "length_m = {m}, expected a positive number"),
            Self::Rounding(m) => write!(f, "rounding_m = {m}, expected less than the transition"),
        }
    }
}

impl core::error::Error for LayoutError {}

/// The layout at one distance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LayoutPoint {
    /// Curvature, right-hand positive (1/m).
    pub curvature_per_m: f64,
    /// Its change with distance (1/m^2).
    pub curvature_rate_per_m2: f64,
    /// Cant angle, right rail lower (rad).
    pub cant_rad: f64,
    /// Its change with distance (rad/m).
    pub cant_rate_rad_per_m: f64,
    /// Second change with distance (rad/m^2).
    pub cant_bend_rad_per_m2: f64,
    /// Heading, the integral of curvature (rad).
    pub heading_rad: f64,
    /// Lateral offset, the integral of heading (m).
    pub offset_m: f64,
}

/// Curvature and cant over distance; tangent and level before its start.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    sections: heapless::Vec<Section, SECTIONS_MAX>,
    end_m: f64,
}

impl Default for Layout {
    fn default() -> Self {
        Self::tangent()
    }
}

impl Layout {
    /// A straight level track without end.
    pub const fn tangent() -> Self {
        let sections = heapless::Vec::from_array([Section::TANGENT]);
        Self { sections, end_m: 0.0 }
    }

    /// Continues with the present curvature and cant.
    ///
    /// # Errors
    /// A length that is not positive.
    pub fn hold(&mut self, length_m: f64) -> Result<(), LayoutError> {
        if !(length_m > 0.0 && length_m.is_finite()) {
            return Err(LayoutError::Length(length_m));
        }
        self.end_m += length_m;
        Ok(())
    }

    /// Adds a transition to another curvature (1/m, right positive) and cant (rad, right rail
    /// lower), with corners rounded over `rounding_m`.
    ///
    /// # Errors
    /// A length or rounding out of range, or a full list.
    pub fn ramp(
        &mut self,
        length_m: f64,
        curvature_per_m: f64,
        cant_rad: f64,
        rounding_m: f64,
    ) -> Result<(), LayoutError> {
        if !(length_m > 0.0 && length_m.is_finite()) {
            return Err(LayoutError::Length(length_m));
        }
        if !(rounding_m > 0.0 && rounding_m < 0.5 * length_m) {
            return Err(LayoutError::Rounding(rounding_m));
        }
        let from = self.at(self.end_m);
        // Between the parabolas the ramp runs at constant slope.
        let slope = |change: f64| change / (length_m - rounding_m);
        let (bend, tilt) =
            (slope(curvature_per_m - from.curvature_per_m), slope(cant_rad - from.cant_rad));
        let parabola = 0.5 / rounding_m;
        let pieces = [
            (rounding_m, [0.0, bend * parabola], [0.0, tilt * parabola]),
            (length_m - 2.0 * rounding_m, [bend, 0.0], [tilt, 0.0]),
            (rounding_m, [bend, -bend * parabola], [tilt, -tilt * parabola]),
        ];
        for (length, [bend, bend_rate], [tilt, tilt_rate]) in pieces {
            let start = self.at(self.end_m);
            self.push(Section {
                start_m: self.end_m,
                curvature: [start.curvature_per_m, bend, bend_rate],
                cant: [start.cant_rad, tilt, tilt_rate],
                heading_rad: start.heading_rad,
                offset_m: start.offset_m,
            })?;
            self.end_m += length;
        }
        let end = self.at(self.end_m);
        self.push(Section {
            start_m: self.end_m,
            curvature: [curvature_per_m, 0.0, 0.0],
            cant: [cant_rad, 0.0, 0.0],
            heading_rad: end.heading_rad,
            offset_m: end.offset_m,
        })
    }

    fn push(&mut self, section: Section) -> Result<(), LayoutError> {
        debug_assert!(
            self.sections.last().is_some_and(|last| last.start_m <= section.start_m),
            "sections follow one another"
        );
        self.sections.push(section).map_err(|_| LayoutError::TooManySections)
    }

    /// Whether the whole track is straight and level.
    pub fn is_tangent(&self) -> bool {
        self.sections.len() == 1
    }

    /// Distance at which the described track ends and its last curvature goes on (m).
    pub fn end_m(&self) -> f64 {
        self.end_m
    }

    /// The layout at a distance.
    pub fn at(&self, distance_m: f64) -> LayoutPoint {
        debug_assert!(!self.sections.is_empty(), "a layout has at least its straight start");
        debug_assert!(!distance_m.is_nan(), "a distance that is no number");
        let mut found = Section::default();
        for section in &self.sections {
            if section.start_m <= distance_m {
                found = *section;
            }
        }
        let x = distance_m - found.start_m;
        let [c0, c1, c2] = found.curvature;
        let [t0, t1, t2] = found.cant;
        LayoutPoint {
            curvature_per_m: c0 + x * (c1 + x * c2),
            curvature_rate_per_m2: c1 + 2.0 * x * c2,
            cant_rad: t0 + x * (t1 + x * t2),
            cant_rate_rad_per_m: t1 + 2.0 * x * t2,
            cant_bend_rad_per_m2: 2.0 * t2,
            heading_rad: found.heading_rad + x * (c0 + x * (c1 / 2.0 + x * c2 / 3.0)),
            offset_m: found.offset_m
                + x * (found.heading_rad + x * (c0 / 2.0 + x * (c1 / 6.0 + x * c2 / 12.0))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Layout {
        let mut layout = Layout::tangent();
        layout.hold(50.0).unwrap();
        layout.ramp(60.0, 1.0 / 400.0, 0.08, 6.0).unwrap();
        layout.hold(100.0).unwrap();
        layout.ramp(60.0, 0.0, 0.0, 6.0).unwrap();
        layout
    }

    #[test]
    fn a_transition_turns_by_its_mean_curvature() {
        let layout = curve();
        let turned = layout.at(110.0).heading_rad - layout.at(50.0).heading_rad;
        assert!((turned - 30.0 / 400.0).abs() < 1e-12, "{turned}");
        assert!((layout.at(150.0).curvature_per_m - 1.0 / 400.0).abs() < 1e-15);
        assert!((layout.at(300.0).cant_rad).abs() < 1e-15);
    }

    #[test]
    fn every_quantity_is_the_integral_of_the_next() {
        let layout = curve();
        let h = 1e-4;
        for distance in [30.0, 53.0, 80.0, 107.0, 150.0, 213.0, 240.0, 260.0] {
            let (a, b, c) = (layout.at(distance - h), layout.at(distance), layout.at(distance + h));
            let close = |got: f64, want: f64, tolerance: f64| {
                assert!((got - want).abs() < tolerance, "{distance}: {got} {want}");
            };
            close((c.offset_m - a.offset_m) / (2.0 * h), b.heading_rad, 1e-8);
            close((c.heading_rad - a.heading_rad) / (2.0 * h), b.curvature_per_m, 1e-9);
            close(
                (c.curvature_per_m - a.curvature_per_m) / (2.0 * h),
                b.curvature_rate_per_m2,
                1e-9,
            );
            close((c.cant_rad - a.cant_rad) / (2.0 * h), b.cant_rate_rad_per_m, 1e-9);
        }
    }

    #[test]
    fn impossible_pieces_are_refused_by_name() {
        let mut layout = Layout::tangent();
        assert_eq!(layout.hold(-1.0), Err(LayoutError::Length(-1.0)));
        assert_eq!(layout.ramp(10.0, 0.0, 0.0, 6.0), Err(LayoutError::Rounding(6.0)));
    }
}
