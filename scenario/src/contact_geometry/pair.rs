//! A wheel on a rail: the divide between tread and flange, and the tables.

use super::placement::{PlacedRail, Placement};
use super::soft_minimum::{Facing, SOFTNESS_M, WheelPlace, contact};
use crate::error::ScenarioError;
use crate::profile::{Profile, SurfacePoint};
use firmware_core::wheel_rail::geometry::{
    ContactGeometry, ContactZones, TABLE_FIRST_SHIFT_M, TABLE_ROWS, TABLE_STEP_M,
};

/// Distance between the places of a wheel (m). A whole number of them makes a table step.
const PLACE_STEP_M: f64 = TABLE_STEP_M / PLACES_PER_ROW as f64;
const PLACES_PER_ROW: i64 = 2;

/// Shift of the first table row, in places.
const FIRST_SHIFT: i64 = -256;
const _: () = assert!(FIRST_SHIFT as f64 * PLACE_STEP_M == TABLE_FIRST_SHIFT_M);

/// The flange is looked for up to this shift, in places: 13 mm.
const LAST_SHIFT_OF_SEARCH: i64 = 208;

/// Depth of the relief at the divide (m), and the width over which it runs out (m).
const RELIEF_DEPTH_M: f64 = 0.4e-3;
const RELIEF_WIDTH_M: f64 = 2.0e-3;

/// Wheel slope of the divide where the contact passes the throat without a jump: tan 30 degrees.
const DIVIDE_SLOPE: f64 = 0.577;

/// A jump of the rigid contact counts as one when it is at least this wide (m).
const JUMP_M: f64 = 3.0e-3;

/// Both zones at one shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Both {
    /// The running tread.
    pub tread: ContactGeometry,
    /// The flange with its throat.
    pub flange: ContactGeometry,
}

impl Both {
    /// The rigid contact of the whole wheel: both zones weighted by who touches first.
    pub fn rigid(&self) -> ContactGeometry {
        let lead = (self.tread.touch_m - self.flange.touch_m) / SOFTNESS_M;
        let flange = 1.0 / (1.0 + libm::exp(-lead.clamp(-700.0, 700.0)));
        let mix = |tread: f64, other: f64| tread * (1.0 - flange) + other * flange;
        let first_m = self.tread.touch_m.min(self.flange.touch_m);
        let (a, b) = (&self.tread, &self.flange);
        ContactGeometry {
            touch_m: first_m - SOFTNESS_M * libm::log1p(libm::exp(-lead.abs())),
            slope: mix(a.slope, b.slope),
            radius_deviation_m: mix(a.radius_deviation_m, b.radius_deviation_m),
            lateral_m: mix(a.lateral_m, b.lateral_m),
            curvature_lateral_per_m: mix(a.curvature_lateral_per_m, b.curvature_lateral_per_m),
            rail_radius_m: mix(a.rail_radius_m, b.rail_radius_m),
        }
    }
}

/// A wheel profile over a placed rail, divided into tread and flange.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair {
    rail: PlacedRail,
    grid: RailGrid,
    first: i64,
    flange: Vec<WheelPlace>,
    tread: Vec<WheelPlace>,
    divide_m: f64,
    datum_m: f64,
    placement: Placement,
}

impl ContactPair {
    /// Places the rail and divides the wheel.
    ///
    /// ```
    /// use scenario::contact_geometry::{ContactPair, Placement};
    /// use scenario::profile::{cn60, lma};
    /// # fn main() -> Result<(), scenario::ScenarioError> {
    /// let pair = ContactPair::new(&lma(), cn60(), Placement::CHINA)?;
    /// let centred = pair.at(0.0, 0.0).tread;
    /// assert!((centred.slope - 1.0 / 40.0).abs() < 0.001); // runs on the 1:40 cone
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// Distances that do not fit each other, see [`PlacedRail::new`].
    pub fn new(
        wheel: &Profile,
        head: Profile,
        placement: Placement,
    ) -> Result<Self, ScenarioError> {
        let rail = PlacedRail::new(head, &placement)?;
        let first = libm::ceil(wheel.first_m() / PLACE_STEP_M) as i64;
        let last = libm::floor(wheel.last_m() / PLACE_STEP_M) as i64;
        let whole: Vec<WheelPlace> = (first..=last)
            .map(|index| {
                let outward_m = index as f64 * PLACE_STEP_M;
                let drawn = wheel.at(outward_m);
                WheelPlace { outward_m, drawn, relieved_m: drawn.down_m }
            })
            .collect();
        let grid = RailGrid::under(&rail, first, last);
        let (divide_m, width_m) = divide(&whole, first, &grid);
        let relieved = |place: &WheelPlace| {
            let near = 1.0 - (place.outward_m - divide_m).abs() / width_m;
            let relief_m = RELIEF_DEPTH_M * near.max(0.0) * near.max(0.0);
            WheelPlace { relieved_m: place.drawn.down_m - relief_m, ..*place }
        };
        let (flange, tread): (Vec<_>, Vec<_>) =
            whole.iter().map(relieved).partition(|place| place.outward_m < divide_m);
        ScenarioError::check_dimension(
            "places on the tread of the wheel",
            tread.len() as f64,
            100.0,
            1e5,
        )?;
        ScenarioError::check_dimension(
            "places on the flange of the wheel",
            flange.len() as f64,
            100.0,
            1e5,
        )?;
        let mut pair = Self { rail, grid, first, flange, tread, divide_m, datum_m: 0.0, placement };
        pair.datum_m = pair.at(0.0, 0.0).tread.touch_m;
        Ok(pair)
    }

    /// Both zones at a shift and a roll (outward side down), solved exactly for that place.
    pub fn at(&self, shift_m: f64, roll_rad: f64) -> Both {
        let (sine, cosine) = (libm::sin(roll_rad), libm::cos(roll_rad));
        let facing = |wheel: &'_ WheelPlace| {
            let outward_m = wheel.outward_m * cosine - wheel.relieved_m * sine;
            let rail = self.rail.at(outward_m + shift_m);
            (rail, rail.down_m - wheel.outward_m * sine - wheel.relieved_m * cosine)
        };
        let solve = |zone: &[WheelPlace]| {
            let faced: Vec<(SurfacePoint, f64)> = zone.iter().map(facing).collect();
            let places = zone.iter().zip(&faced).map(|(wheel, (rail, gap_m))| Facing {
                wheel,
                rail: *rail,
                gap_m: *gap_m,
            });
            contact(places, PLACE_STEP_M, self.datum_m)
        };
        Both { tread: solve(&self.tread), flange: solve(&self.flange) }
    }

    /// Tables of both zones over the range of shift, without roll.
    pub fn tables(&self) -> Box<ContactZones> {
        let row = |zone: &[WheelPlace], first: i64, row: usize| {
            let shift = FIRST_SHIFT + PLACES_PER_ROW * row as i64;
            contact(self.grid.facing(zone, first, shift), PLACE_STEP_M, self.datum_m)
        };
        let tread_first = self.first + self.flange.len() as i64;
        Box::new(ContactZones {
            tread: core::array::from_fn(|index| row(&self.tread, tread_first, index)),
            flange: core::array::from_fn(|index| row(&self.flange, self.first, index)),
        })
    }

    /// Wheel coordinate that divides tread and flange (m).
    pub fn divide_m(&self) -> f64 {
        self.divide_m
    }

    /// The distances the pair was built with.
    pub fn placement(&self) -> &Placement {
        &self.placement
    }
}

/// The rail on the grid of the wheel's places, so that every table shift meets stored points.
#[derive(Debug, Clone, PartialEq)]
struct RailGrid {
    first: i64,
    points: Vec<SurfacePoint>,
}

impl RailGrid {
    /// Under the places `first..=last` of a wheel, for all shifts of the table.
    fn under(rail: &PlacedRail, first: i64, last: i64) -> Self {
        let start = first + FIRST_SHIFT;
        let end = last + FIRST_SHIFT + PLACES_PER_ROW * TABLE_ROWS as i64;
        let points = (start..=end).map(|index| rail.at(index as f64 * PLACE_STEP_M)).collect();
        Self { first: start, points }
    }

    /// Facing `zone`, whose first place is `first`, at a whole number of steps of shift.
    fn facing<'a>(
        &'a self,
        zone: &'a [WheelPlace],
        first: i64,
        shift: i64,
    ) -> impl Iterator<Item = Facing<'a>> + Clone {
        let offset = (first + shift - self.first).max(0) as usize;
        let under = self.points.get(offset..).unwrap_or_default();
        zone.iter().zip(under).map(|(wheel, rail)| Facing {
            wheel,
            rail: *rail,
            gap_m: rail.down_m - wheel.relieved_m,
        })
    }
}

/// Where to divide the wheel, and how wide the relief may be.
///
/// The rigid contact is followed while the flange closes in. Where it jumps over the throat, the
/// divide is at the widest gap between the two contacts; otherwise it is at [`DIVIDE_SLOPE`].
fn divide(whole: &[WheelPlace], first: i64, rail: &RailGrid) -> (f64, f64) {
    let closest = |shift: i64| {
        let mut best: Option<Facing<'_>> = None;
        for place in rail.facing(whole, first, shift) {
            if best.is_none_or(|best| place.gap_m < best.gap_m) {
                best = Some(place);
            }
        }
        best.map_or((0.0, 0.0), |best| (best.wheel.outward_m, best.wheel.drawn.slope))
    };
    let mut before = closest(0);
    for shift in 1..=LAST_SHIFT_OF_SEARCH {
        let now = closest(shift);
        let crosses = before.1 > -DIVIDE_SLOPE && now.1 < -DIVIDE_SLOPE;
        if crosses && before.0 - now.0 > JUMP_M {
            let mut widest = (f64::NEG_INFINITY, 0.5 * (before.0 + now.0));
            for place in rail.facing(whole, first, shift) {
                let outward_m = place.wheel.outward_m;
                if outward_m > now.0 && outward_m < before.0 && place.gap_m > widest.0 {
                    widest = (place.gap_m, outward_m);
                }
            }
            let room_m = (before.0 - widest.1).min(widest.1 - now.0);
            return (widest.1, RELIEF_WIDTH_M.min(room_m.max(0.5e-3)));
        }
        before = now;
    }
    let steep = |place: &&WheelPlace| place.outward_m < 0.0 && place.drawn.slope < -DIVIDE_SLOPE;
    let divide_m = whole.iter().rev().find(steep).map_or(-0.030, |place| place.outward_m);
    (divide_m, RELIEF_WIDTH_M)
}
