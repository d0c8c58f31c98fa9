//! Manchester contact benchmark: one wheelset, shifted and yawed, both wheels on their rails.
//!
//! S1002 on UIC60 at 1:40, gauge 1435 mm, back-to-back 1360 mm, rolling radius 460 mm, friction
//! 0.3, 2 m/s; the wheelset is moved by 0 to 10 mm and yawed by 0 to 24 mrad, with the roll and the
//! spin that go with it, and each wheel carries 10 kN. CONTACT gives position, angle and creepages
//! of the contact and all forces. Ours are what a run uses: the contact table of one wheel and its
//! law of creep ([`firmware_core::wheel_rail::wheel`]), FASTSIM on a fine grid.
//!
//! Three definitions are brought together. CONTACT divides by the rolling speed `(V + |W| r)/2`,
//! ours by `V`; it gives the motion of the rail against the wheel and the force on the rail; its
//! axes are those of the track, ours those of a wheel.

use super::check::{Check, Reference};
use super::{columns, fastsim};
use crate::error::EvidenceError;
use firmware_core::wheel_rail::creep::{CreepLaw, Fastsim};
use firmware_core::wheel_rail::geometry::TABLE_FIRST_SHIFT_M;
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::ContactTable;
use firmware_core::wheel_rail::wheel::{Surface, Touch, Wheel, WheelForce, WheelMotion};
use report::Plot;
use scenario::contact_geometry::{ContactPair, PlacedRail, Placement};
use scenario::profile::{Profile, s1002, uic60};
use std::sync::atomic::AtomicBool;

const SIDES: [(&str, f64, &str); 2] = [
    ("left", -1.0, include_str!("tables/manchester-a22-left.csv")),
    ("right", 1.0, include_str!("tables/manchester-a22-right.csv")),
];
const HEADS: [&str; 12] = [
    "y_mm",
    "yaw_rad",
    "roll_rad",
    "spin_rad_per_s",
    "contact_y_mm",
    "angle_rad",
    "longitudinal",
    "lateral",
    "spin_per_mm",
    "normal_n",
    "along_n",
    "across_n",
];
const RADIUS_M: f64 = 0.46;
const TAPE_M: f64 = 0.75;
const SPEED_M_PER_S: f64 = 2.0;
const LOAD_N: f64 = 10e3;
const FRICTION: f64 = 0.3;
/// Softness of the contact geometry's minimum (m).
const SOFTNESS_M: f64 = 5e-6;

/// The comparison.
///
/// # Errors
/// Profiles or a table that do not fit.
pub(super) fn reference(stop: &AtomicBool) -> Result<Reference, EvidenceError> {
    let bench = Bench::new()?;
    let creep = CreepLaw::Fastsim(
        Fastsim::new(100, 100)
            .ok_or(EvidenceError::NotComputed("a grid of FASTSIM that does not fit"))?,
    );
    let (mut checks, mut plots) = (Vec::new(), Vec::new());
    let mut outside = Vec::new();
    let (mut roll_rad, mut spin_ratio) = (0.0_f64, 1.0_f64);
    for (name, side, text) in SIDES {
        let cases = cases(side, text)?;
        let settle_all = |creep: CreepLaw| -> Result<Vec<Settled>, EvidenceError> {
            let settle = |case| {
                EvidenceError::check(stop)?;
                Ok(bench.settle(case, creep))
            };
            cases.iter().map(settle).collect()
        };
        let settled = settle_all(creep)?;
        for (case, ours) in cases.iter().zip(&settled) {
            checks.extend(bench.checks(name, case, ours));
            roll_rad = roll_rad.max(case.roll_rad.abs());
            spin_ratio = spin_ratio.max(case.creepage[2] / ours.creepage[2]);
            if ours.beyond_the_table {
                outside.push(format!("{} mm {name}", case.y_mm));
            }
        }
        plots.extend(geometry_plots(name, &cases, &settled));
        let others = [
            ("linear, saturated", settle_all(CreepLaw::LinearSaturated)?),
            ("Polach", settle_all(CreepLaw::Polach)?),
        ];
        plots.extend(force_plots(name, &cases, &settled, &others));
    }
    Ok(Reference {
        name: "manchester-contact",
        title: "Manchester contact benchmark A-2.2, S1002 on UIC60",
        what: "Position, angle, creepages and forces of both wheels' contacts over 0 to 10 mm of lateral \
               shift and 0 to 24 mrad of yaw; 10 kN on each wheel."
            .to_owned(),
        source: "Examples mbench_a22_left and mbench_a22_right of the open program CONTACT (Vollebregt, \
                 Apache-2.0); benchmark: Shackleton and Iwnicki, Vehicle System Dynamics 46 (2008).",
        tolerance: tolerance(bench.fastsim_share),
        limits: limits(&outside, roll_rad, spin_ratio),
        checks,
        plots,
    })
}

fn tolerance(fastsim_share: f64) -> String {
    format!(
        "Per case, from the effects left out. Where wheel and rail nearly conform, the contact may \
         lie anywhere the gap is within a few micrometres of its smallest: ours is a mean over 5 \
         um, theirs the middle of the interpenetrating region. Ours leaves out that a yawed wheel \
         reaches ahead of its axle, which lowers it by r yaw2 tan2(angle) / 2. So position, angle \
         and rolling radius may differ by as much as they vary over all places where the gap, with \
         or without that term, is within 5 um of its smallest. Creepages follow from angle and \
         radius, with terms of second order in yaw, yaw2/2, and the roll of the axle in spin, \
         which ours leaves out. Normal force: the load turned by the angle's tolerance. Tangential \
         forces: {:.2} % of the friction limit, the distance of FASTSIM from the full theory (its \
         own section), the direction of creepage turned by the tolerances of its parts, and the \
         normal force turned by that of the angle. Half a printed digit is added.",
        100.0 * fastsim_share
    )
}

fn limits(outside: &[String], roll_rad: f64, spin_ratio: f64) -> Vec<String> {
    let mut limits = vec![
        format!(
            "Spin is that of an axle parallel to the track; a wheelset that climbs rolls by up to {:.0} mrad, as \
             much as the contact angle of the tread, and CONTACT's spin is up to {spin_ratio:.1} times ours there. \
             It hardly moves the force, which slides as a whole.",
            1e3 * roll_rad
        ),
        "Just where the contact jumps from tread to throat (right wheel, 5 mm) it lies in two places at once; \
         ours is a mean of them, theirs another, and the tolerances are as wide as the jump."
            .to_owned(),
    ];
    if !outside.is_empty() {
        limits.push(format!(
            "Shift and roll together leave the contact table, which is held at its end (16 mm), at {}: beyond \
             what track with a gauge in order lets a wheelset do.",
            outside.join(", ")
        ));
    }
    limits
}

/// One position of the wheelset, for one wheel; CONTACT's numbers in its axes.
struct Case {
    side: f64,
    y_mm: f64,
    yaw_rad: f64,
    roll_rad: f64,
    spin_rad_per_s: f64,
    contact_y_mm: f64,
    angle_rad: f64,
    creepage: [f64; 3],
    normal_n: f64,
    along_n: f64,
    across_n: f64,
}

fn cases(side: f64, text: &str) -> Result<Vec<Case>, EvidenceError> {
    let columns = columns(text, HEADS)?;
    let case = |row: usize| {
        let [
            y_mm,
            yaw_rad,
            roll_rad,
            spin_rad_per_s,
            contact_y_mm,
            angle_rad,
            xi,
            eta,
            phi,
            n,
            x,
            y,
        ] = columns.each_ref().map(|column| column[row]);
        Case {
            side,
            y_mm,
            yaw_rad,
            roll_rad,
            spin_rad_per_s,
            contact_y_mm,
            angle_rad,
            creepage: [xi, eta, phi],
            normal_n: n,
            along_n: x,
            across_n: y,
        }
    };
    Ok((0..columns[0].len()).map(case).collect())
}

impl Case {
    /// The wheel's motion in its own axes, at a drop.
    fn motion(&self, drop_m: f64) -> WheelMotion {
        let roll_rad = self.side * self.roll_rad;
        WheelMotion {
            shift_m: self.side * self.y_mm * 1e-3 - roll_rad * RADIUS_M,
            drop_m,
            roll_rad,
            yaw_rad: self.side * self.yaw_rad,
            spin_rad_per_s: self.spin_rad_per_s,
            speed_m_per_s: SPEED_M_PER_S,
            ..WheelMotion::default()
        }
    }
}

/// Ours, in CONTACT's axes and definitions; the zone that carries more.
struct Settled {
    contact_y_mm: f64,
    angle_rad: f64,
    /// Longitudinal, lateral, spin (1/mm).
    creepage: [f64; 3],
    normal_n: f64,
    along_n: f64,
    across_n: f64,
    touch: Touch,
    beyond_the_table: bool,
}

/// Profiles, their table, and the rail in its place.
struct Bench {
    table: ContactTable,
    wheel: Profile,
    rail: PlacedRail,
    /// Distance of FASTSIM from the full theory over the friction limit.
    fastsim_share: f64,
}

impl Bench {
    fn new() -> Result<Self, EvidenceError> {
        let pair = ContactPair::new(&s1002(), uic60(), Placement::UIC)?;
        let table = ContactTable::new(&pair.tables(), RADIUS_M, Material::STEEL);
        let rail = PlacedRail::new(uic60(), &Placement::UIC)?;
        let fastsim_share = fastsim::difference_to_full_theory()?;
        Ok(Self { table, wheel: s1002(), rail, fastsim_share })
    }

    /// The wheel let down until its rail carries the load.
    fn settle(&self, case: &Case, creep: CreepLaw) -> Settled {
        let wheel = Wheel {
            tape_m: TAPE_M,
            radius_m: RADIUS_M,
            friction: FRICTION,
            material: Material::STEEL,
            surface: Surface::Profiles,
            creep,
        };
        let force =
            |drop_m: f64| -> WheelForce { wheel.force(Some(&self.table), &case.motion(drop_m)) };
        let (mut high, mut low) = (-0.05, 0.01);
        for _ in 0..60 {
            let middle = 0.5 * (high + low);
            if -force(middle).vertical_n < LOAD_N {
                high = middle;
            } else {
                low = middle;
            }
        }
        let motion = case.motion(low);
        let zones = [&self.table.tread, &self.table.flange];
        let touching =
            zones.into_iter().filter_map(|zone| Some((zone, wheel.touch(zone, &motion)?)));
        let heavier =
            touching.max_by(|(_, a), (_, b)| a.patch.normal_n.total_cmp(&b.patch.normal_n));
        let (zone, touch) = heavier.unwrap_or((&self.table.tread, NO_TOUCH));
        let force = force(low);
        let creepage = touch.creepage(&motion);
        let side = case.side;
        let outward_m = side * case.y_mm * 1e-3 + touch.arm_m - motion.roll_rad * touch.radius_m;
        let rolling = rolling(case, touch.radius_m);
        // Where the table of that zone is read.
        let read_m = motion.shift_m - motion.roll_rad * zone.rail_radius_m(motion.shift_m);
        Settled {
            contact_y_mm: 1e3 * side * outward_m,
            angle_rad: -side * libm::atan2(touch.sine, touch.cosine),
            creepage: [
                -creepage.longitudinal / rolling,
                -side * creepage.lateral / rolling,
                -side * creepage.spin_per_m * 1e-3 / rolling,
            ],
            normal_n: force.tread_n + force.flange_n,
            along_n: -force.longitudinal_n,
            across_n: -side * force.lateral_n,
            touch,
            beyond_the_table: read_m.abs() > TABLE_FIRST_SHIFT_M.abs(),
        }
    }

    /// Ours against theirs, every quantity of one wheel.
    fn checks(&self, name: &str, case: &Case, ours: &Settled) -> Vec<Check> {
        let room = self.room(case, &ours.touch);
        let rate = case.spin_rad_per_s.abs() / SPEED_M_PER_S;
        let rolling = rolling(case, ours.touch.radius_m);
        let yaw_rad = case.yaw_rad.abs();
        let second_order = 0.5 * yaw_rad * yaw_rad;
        let longitudinal = rate * room.radius_m / rolling + second_order;
        let lateral = rate * yaw_rad * ours.touch.radius_m * room.secant / rolling
            + second_order * ours.creepage[1].abs();
        let spin = 1e-3 * rate * (room.sine + case.roll_rad.abs()) / rolling;
        // The force turns with the direction of creepage.
        let [xi, eta, _] = ours.creepage;
        let square = (xi * xi + eta * eta).max(f64::MIN_POSITIVE);
        let turn = ((xi * lateral).abs() + (eta * longitudinal).abs()) / square;
        let limit_n = FRICTION * ours.normal_n;
        let tangential_n = limit_n * (self.fastsim_share + turn.min(1.0));
        let normal_n = ours.normal_n * room.angle_rad * ours.touch.sine.abs() / ours.touch.cosine
            + tangential_n * ours.touch.sine.abs();
        let across_n = tangential_n + ours.normal_n * room.angle_rad / ours.touch.cosine;

        let at = format!("{} mm, {:.1} mrad", case.y_mm, 1e3 * case.yaw_rad);
        let near = |what: &str, values: [f64; 2], tolerance: f64, unit: &'static str| {
            let digit = half_a_digit(values[0]);
            Check::near(&format!("{what}, {name} wheel"), &at, values, tolerance + digit).unit(unit)
        };
        let [their_xi, their_eta, their_spin] = case.creepage;
        let [our_xi, our_eta, our_spin] = ours.creepage;
        vec![
            near(
                "contact position",
                [case.contact_y_mm, ours.contact_y_mm],
                1e3 * room.place_m,
                "mm",
            ),
            // Angles are printed with four decimals.
            near("contact angle", [case.angle_rad, ours.angle_rad], room.angle_rad + 5e-5, "rad"),
            near("longitudinal creepage", [their_xi, our_xi], longitudinal, ""),
            near("lateral creepage", [their_eta, our_eta], lateral, ""),
            near("spin", [their_spin, our_spin], spin, "1/mm"),
            near("normal force", [case.normal_n, ours.normal_n], normal_n, "N"),
            near("longitudinal force", [case.along_n, ours.along_n], tangential_n, "N"),
            near("lateral force", [case.across_n, ours.across_n], across_n, "N"),
        ]
    }

    /// How far place, angle and radius vary over where the contact may lie.
    fn room(&self, case: &Case, touch: &Touch) -> Room {
        const STEP_M: f64 = 0.02e-3;
        let motion = case.motion(0.0);
        let (sine, cosine) = (libm::sin(motion.roll_rad), libm::cos(motion.roll_rad));
        let places = ((self.wheel.last_m() - self.wheel.first_m()) / STEP_M) as u32;
        let place = |index: u32| {
            let wheel_m = self.wheel.first_m() + f64::from(index) * STEP_M;
            let wheel = self.wheel.at(wheel_m);
            let outward_m = wheel_m * cosine - wheel.down_m * sine;
            let rail = self.rail.at(outward_m + motion.shift_m);
            let gap_m = rail.down_m - wheel_m * sine - wheel.down_m * cosine;
            let ahead = case.yaw_rad * (wheel.slope + motion.roll_rad);
            let yawed_m = gap_m - 0.5 * RADIUS_M * ahead * ahead;
            Place { wheel_m, radius_m: RADIUS_M + wheel.down_m, slope: rail.slope, gap_m, yawed_m }
        };
        let places: Vec<Place> = (0..=places).map(place).collect();
        let least = |gap: fn(&Place) -> f64| places.iter().map(gap).fold(f64::INFINITY, f64::min);
        let (plain_m, yawed_m) = (least(|p| p.gap_m), least(|p| p.yawed_m));
        let may_touch =
            |p: &&Place| p.gap_m <= plain_m + SOFTNESS_M || p.yawed_m <= yawed_m + SOFTNESS_M;
        let mut room = Room::default();
        let angle_rad = libm::atan2(touch.sine, touch.cosine);
        for place in places.iter().filter(may_touch) {
            // The rail falls outward where it pushes the wheel outward.
            let angle = -libm::atan(place.slope);
            room.grow(&Room {
                place_m: place.wheel_m - (touch.arm_m - TAPE_M),
                angle_rad: angle - angle_rad,
                sine: libm::sin(angle) - touch.sine,
                secant: 1.0 / libm::cos(angle) - 1.0 / touch.cosine,
                radius_m: place.radius_m - touch.radius_m,
            });
        }
        room
    }
}

const NO_TOUCH: Touch = Touch {
    patch: firmware_core::wheel_rail::creep::Patch {
        normal_n: f64::NAN,
        along_m: 0.0,
        across_m: 0.0,
        c11: 0.0,
        c22: 0.0,
        c23: 0.0,
        shear_modulus_pa: 0.0,
        friction: 0.0,
    },
    sine: f64::NAN,
    cosine: f64::NAN,
    arm_m: f64::NAN,
    radius_m: f64::NAN,
    is_lifted: true,
};

/// Rolling speed over the running speed.
fn rolling(case: &Case, radius_m: f64) -> f64 {
    0.5 * (1.0 + case.spin_rad_per_s.abs() * radius_m / SPEED_M_PER_S)
}

/// CONTACT prints four significant digits.
fn half_a_digit(value: f64) -> f64 {
    if value == 0.0 {
        0.0
    } else {
        0.5 * libm::pow(10.0, libm::floor(libm::log10(value.abs())) - 3.0)
    }
}

/// A place on the wheel over the rail.
struct Place {
    wheel_m: f64,
    radius_m: f64,
    slope: f64,
    gap_m: f64,
    /// Gap of the yawed wheel.
    yawed_m: f64,
}

/// Largest differences from our contact.
#[derive(Default)]
struct Room {
    place_m: f64,
    angle_rad: f64,
    sine: f64,
    secant: f64,
    radius_m: f64,
}

impl Room {
    fn grow(&mut self, other: &Self) {
        let larger = |own: &mut f64, other: f64| *own = own.max(other.abs());
        larger(&mut self.place_m, other.place_m);
        larger(&mut self.angle_rad, other.angle_rad);
        larger(&mut self.sine, other.sine);
        larger(&mut self.secant, other.secant);
        larger(&mut self.radius_m, other.radius_m);
    }
}

fn column<T>(all: &[T], of: impl Fn(&T) -> f64) -> Vec<f64> {
    all.iter().map(of).collect()
}

fn geometry_plots(name: &str, cases: &[Case], ours: &[Settled]) -> [Plot; 2] {
    let y = column(cases, |case| case.y_mm);
    let over_y = |what: &str, unit: &str, ours: &[f64], theirs: &[f64]| {
        Plot::new(&format!("{what}, {name} wheel"))
            .x("lateral shift of the wheelset", "mm")
            .y(&what.to_lowercase(), unit)
            .points("ours", &y, ours)
            .scatter("CONTACT", &y, theirs)
            .height_px(280)
    };
    [
        over_y(
            "Contact position",
            "mm",
            &column(ours, |o| o.contact_y_mm),
            &column(cases, |c| c.contact_y_mm),
        ),
        over_y(
            "Contact angle",
            "rad",
            &column(ours, |o| o.angle_rad),
            &column(cases, |c| c.angle_rad),
        ),
    ]
}

fn force_plots(
    name: &str,
    cases: &[Case],
    ours: &[Settled],
    others: &[(&str, Vec<Settled>); 2],
) -> [Plot; 2] {
    type Force = (&'static str, fn(&Settled) -> f64, fn(&Case) -> f64);
    let y = column(cases, |case| case.y_mm);
    let forces: [Force; 2] = [
        ("Longitudinal force", |o| 1e-3 * o.along_n, |c| 1e-3 * c.along_n),
        ("Lateral force", |o| 1e-3 * o.across_n, |c| 1e-3 * c.across_n),
    ];
    forces.map(|(what, of_ours, of_theirs)| {
        let plot = Plot::new(&format!("{what}, {name} wheel"))
            .x("lateral shift of the wheelset", "mm")
            .y(&what.to_lowercase(), "kN")
            .points("FASTSIM", &y, &column(ours, of_ours))
            .scatter("CONTACT", &y, &column(cases, of_theirs))
            .height_px(280);
        others
            .iter()
            .fold(plot, |plot, (law, settled)| plot.dashed(law, &y, &column(settled, of_ours)))
    })
}
