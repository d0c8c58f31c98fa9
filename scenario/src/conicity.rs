//! Rolling radius difference of a wheelset on track, and its equivalent conicity.
//!
//! A free wheelset obeys `y'' + dr(y) / (e r0) = 0` over distance, `dr` the rolling radius of the
//! right wheel less that of the left, `e` the spacing of the contacts. A cone of conicity `gamma`
//! has `dr = 2 gamma y`. For any other `dr` the **equivalent conicity** of a motion is that of the
//! cone with the same wavelength, found in two ways:
//!
//! * harmonic: the first harmonic of `dr` over a sine of amplitude `A`,
//!   `lambda(A) = 1 / (2 pi A) integral dr(A sin p) sin p dp`;
//! * by integration (UIC 519, EN 15302): the true motion between its two turning points,
//!   `wavelength = 2 integral dy / sqrt(2 / (e r0) (S_turn - S(y)))`, `S = integral dr dy`, and
//!   `gamma = 2 e r0 (pi / wavelength)^2`, in which `e r0` cancels.
//!
//! Limits: a quasi-static wheelset without yaw, both wheels alike.

use crate::contact_geometry::ContactPair;
use crate::known::Known;
use firmware_core::wheel_rail::geometry::ContactGeometry;
use std::convert::Infallible;

/// Wheelsets that were rolled last: every point of a map asks for the same.
static ROLLED: Known<(ContactPair, f64), RollingRadiusDifference> = Known::nothing();

/// A wheelset resting on both rails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestingWheelset {
    /// Contact of the right wheel.
    pub right: ContactGeometry,
    /// Contact of the left wheel.
    pub left: ContactGeometry,
    /// Roll, right side down (rad).
    pub roll_rad: f64,
}

impl RestingWheelset {
    /// The wheelset moved to the right by `shift_m`, rolled so that both wheels touch.
    ///
    /// ```
    /// # fn main() -> Result<(), scenario::ScenarioError> {
    /// use scenario::conicity::RestingWheelset;
    /// use scenario::contact_geometry::{ContactPair, Placement};
    /// use scenario::profile::{cn60, lma};
    /// let pair = ContactPair::new(&lma(), cn60(), Placement::CHINA)?;
    /// // On the 1:40 cone: 2 x 0.025 x 1 mm, a little more from the curved tread.
    /// let difference_mm = RestingWheelset::at(&pair, 1e-3).radius_difference_m() * 1e3;
    /// assert!((difference_mm - 0.051).abs() < 0.005);
    /// # Ok(())
    /// # }
    /// ```
    pub fn at(pair: &ContactPair, shift_m: f64) -> Self {
        let spacing_m = 2.0 * pair.placement().half_spacing_m();
        let mut roll_rad = 0.0;
        let mut resting = Self::rolled(pair, shift_m, roll_rad);
        for _ in 0..8 {
            let next = (resting.right.touch_m - resting.left.touch_m) / spacing_m;
            let change = next - roll_rad;
            roll_rad = next;
            resting = Self::rolled(pair, shift_m, roll_rad);
            if change.abs() < 1e-10 {
                break;
            }
        }
        resting
    }

    /// Rolling radius of the right wheel less that of the left (m).
    pub fn radius_difference_m(&self) -> f64 {
        self.right.radius_deviation_m - self.left.radius_deviation_m
    }

    /// Half the difference of the contact angles, right less left, against the wheelset (rad).
    pub fn half_angle_difference_rad(&self) -> f64 {
        0.5 * (libm::atan(self.right.slope) - libm::atan(self.left.slope))
    }

    fn rolled(pair: &ContactPair, shift_m: f64, roll_rad: f64) -> Self {
        Self {
            right: pair.at(shift_m, roll_rad).rigid(),
            left: pair.at(-shift_m, -roll_rad).rigid(),
            roll_rad,
        }
    }
}

/// Rolling radius difference over lateral shift, on an even grid, linear between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct RollingRadiusDifference {
    first_shift_m: f64,
    step_m: f64,
    differences_m: Vec<f64>,
    /// Integral of the difference over shift from the first point (m2).
    potential_m2: Vec<f64>,
}

impl RollingRadiusDifference {
    /// From values at `first_shift_m`, `first_shift_m + step_m`, and so on.
    pub fn new(first_shift_m: f64, step_m: f64, differences_m: Vec<f64>) -> Self {
        let mut potential_m2 = Vec::with_capacity(differences_m.len());
        let mut sum = 0.0;
        let mut before = differences_m.first().copied().unwrap_or(0.0);
        for (index, value) in differences_m.iter().enumerate() {
            if index > 0 {
                sum += 0.5 * (before + value) * step_m;
            }
            before = *value;
            potential_m2.push(sum);
        }
        Self { first_shift_m, step_m, differences_m, potential_m2 }
    }

    /// Of a wheelset on its track, every 0.1 mm up to `reach_m` on both sides.
    pub fn of_wheelset(pair: &ContactPair, reach_m: f64) -> Self {
        let rolled = |(pair, reach_m): &(ContactPair, f64)| {
            Ok::<_, Infallible>(Self::of_rolled_wheelset(pair, *reach_m))
        };
        let Ok(found) = ROLLED.answer((pair.clone(), reach_m), rolled);
        found
    }

    fn of_rolled_wheelset(pair: &ContactPair, reach_m: f64) -> Self {
        const STEP_M: f64 = 0.1e-3;
        let points = libm::round(reach_m / STEP_M).max(1.0) as usize;
        let half: Vec<f64> = (1..=points)
            .map(|index| RestingWheelset::at(pair, index as f64 * STEP_M).radius_difference_m())
            .collect();
        // Two alike wheels: the difference is odd.
        let mut differences_m: Vec<f64> = half.iter().rev().map(|value| -value).collect();
        differences_m.push(0.0);
        differences_m.extend(half);
        Self::new(-(points as f64) * STEP_M, STEP_M, differences_m)
    }

    /// The difference at a shift (m); held constant beyond the grid.
    pub fn at(&self, shift_m: f64) -> f64 {
        let (index, part) = self.cell(shift_m);
        let value = |at: usize| self.differences_m.get(at).copied().unwrap_or(0.0);
        value(index) + (value(index + 1) - value(index)) * part
    }

    /// Last shift of the grid (m).
    pub fn last_shift_m(&self) -> f64 {
        self.first_shift_m + self.step_m * (self.differences_m.len().saturating_sub(1)) as f64
    }

    /// Equivalent conicity by the first harmonic; `None` when the grid does not reach so far.
    ///
    /// ```
    /// use scenario::conicity::RollingRadiusDifference;
    /// // A cone 1:20: dr = 2 x 0.05 x y.
    /// let cone = RollingRadiusDifference::new(-0.01, 0.01, vec![-0.001, 0.0, 0.001]);
    /// let conicity = cone.harmonic_conicity(0.003).unwrap();
    /// assert!((conicity - 0.05).abs() < 1e-12);
    /// ```
    pub fn harmonic_conicity(&self, amplitude_m: f64) -> Option<f64> {
        const POINTS: u32 = 1440;
        if !self.reaches(-amplitude_m, amplitude_m) || amplitude_m <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        for point in 0..POINTS {
            let phase = (f64::from(point) + 0.5) / f64::from(POINTS) * 2.0 * core::f64::consts::PI;
            let sine = libm::sin(phase);
            sum += self.at(amplitude_m * sine) * sine;
        }
        Some(sum / (amplitude_m * f64::from(POINTS)))
    }

    /// Equivalent conicity by integration of the motion (UIC 519, EN 15302).
    ///
    /// The amplitude is half the distance between the turning points. `None` when the grid does not
    /// reach so far, or where the wheelset is not centred by its conicity. Inside a dead band
    /// without radius difference there is no motion and the conicity is zero.
    pub fn integrated_conicity(&self, amplitude_m: f64) -> Option<f64> {
        const POINTS: u32 = 2000;
        let rest = self.rest()?;
        let highest = self.potential_m2.first()?.min(*self.potential_m2.last()?);
        let (mut low, mut high) = (rest.potential_m2, highest);
        let width = |level: f64| {
            let (left_m, right_m) = self.turning_points(&rest, level);
            0.5 * (right_m - left_m)
        };
        let tolerance_m = 1e-9;
        if amplitude_m <= 0.0 || width(high) < amplitude_m - tolerance_m {
            return None;
        }
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if width(middle) < amplitude_m {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (left_m, right_m) = self.turning_points(&rest, high);
        if 0.5 * (right_m - left_m) > amplitude_m + 1e-6 {
            return Some(0.0);
        }
        let (centre_m, half_m) = (0.5 * (left_m + right_m), 0.5 * (right_m - left_m));
        let mut half_wavelength = 0.0;
        for point in 0..POINTS {
            let phase =
                ((f64::from(point) + 0.5) / f64::from(POINTS) - 0.5) * core::f64::consts::PI;
            let fall = high - self.potential(centre_m + half_m * libm::sin(phase));
            if fall <= 0.0 {
                return Some(0.0);
            }
            half_wavelength += half_m * libm::cos(phase) / libm::sqrt(2.0 * fall);
        }
        half_wavelength *= core::f64::consts::PI / f64::from(POINTS);
        let ratio = core::f64::consts::PI / (2.0 * half_wavelength);
        Some(2.0 * ratio * ratio)
    }

    /// Where the wheelset rests: the lowest point of the potential, both ends of it when it is
    /// flat.
    fn rest(&self) -> Option<Rest> {
        let lowest = self.potential_m2.iter().copied().fold(f64::INFINITY, f64::min);
        let flat = 1e-13 * (self.potential_m2.first()? - lowest).abs();
        let is_lowest = |value: &f64| *value - lowest <= flat;
        let first = self.potential_m2.iter().position(is_lowest)?;
        let last = self.potential_m2.iter().rposition(is_lowest)?;
        let falls = self.differences_m.iter().take(first).all(|value| *value <= 0.0);
        let rises = self.differences_m.iter().skip(last + 1).all(|value| *value >= 0.0);
        let place = |index: usize| self.first_shift_m + self.step_m * index as f64;
        (falls && rises).then(|| Rest {
            left_m: place(first),
            right_m: place(last),
            potential_m2: lowest,
        })
    }

    fn turning_points(&self, rest: &Rest, level: f64) -> (f64, f64) {
        let search = |rest_m: f64, end_m: f64| {
            let (mut inside, mut outside) = (rest_m, end_m);
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if self.potential(middle) < level {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            outside
        };
        (search(rest.left_m, self.first_shift_m), search(rest.right_m, self.last_shift_m()))
    }

    /// Integral of the difference, exact for the straight lines between the points.
    fn potential(&self, shift_m: f64) -> f64 {
        let (index, part) = self.cell(shift_m);
        let value = |at: usize| self.differences_m.get(at).copied().unwrap_or(0.0);
        let start = self.potential_m2.get(index).copied().unwrap_or(0.0);
        start + self.step_m * part * (value(index) + 0.5 * part * (value(index + 1) - value(index)))
    }

    fn cell(&self, shift_m: f64) -> (usize, f64) {
        let last = self.differences_m.len().saturating_sub(2) as f64;
        let place = ((shift_m - self.first_shift_m) / self.step_m).clamp(0.0, last + 1.0);
        let index = libm::floor(place).min(last);
        (index as usize, place - index)
    }

    fn reaches(&self, from_m: f64, to_m: f64) -> bool {
        let slack_m = 1e-9;
        from_m >= self.first_shift_m - slack_m && to_m <= self.last_shift_m() + slack_m
    }
}

/// The lowest part of the potential.
struct Rest {
    left_m: f64,
    right_m: f64,
    potential_m2: f64,
}

#[cfg(test)]
#[path = "conicity_tests.rs"]
mod tests;
