//! The vehicle file: bodies, elements and wheelsets, every number with its provenance.
//!
//! Points are given in vehicle axes: station along the vehicle (forward positive), `lateral_m` to
//! the right of the centre line, `height_m` above the rail head. An element names its first body
//! once and its second bodies as a list; it is repeated for each of them at that body's station,
//! and for both sides when `lateral_m` is not zero and `both_sides` is not switched off.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use crate::wheel_rail::WheelRailFile;
use files::{did_you_mean, quoted};
use firmware_core::vehicle::{
    Anchor, Axle, Body, BodyId, BumpStop, DamperMount, Suspension, Torsion, Vehicle,
};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A vehicle as it stands in its file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleFile {
    /// What it is called.
    pub name: String,
    /// What one should know about its numbers.
    pub about: Option<String>,
    /// Wheels, rails, friction, creep.
    pub wheel_rail: WheelRailFile,
    /// The bodies.
    pub body: Vec<BodyFile>,
    /// Springs and dampers.
    #[serde(default)]
    pub suspension: Vec<SuspensionFile>,
    /// Rotational springs.
    #[serde(default)]
    pub torsion: Vec<TorsionFile>,
    /// Lateral stops.
    #[serde(default)]
    pub bump_stop: Vec<BumpStopFile>,
    /// Damper slots, in order.
    #[serde(default)]
    pub damper_slot: Vec<DamperSlotFile>,
}

/// A coordinate of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Coordinate {
    Lateral,
    Vertical,
    Roll,
    Pitch,
    Yaw,
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BodyFile {
    /// Name by which elements find it.
    pub name: String,
    /// Mass.
    pub mass_kg: Quantity,
    /// Moment of inertia about the longitudinal axis.
    pub roll_inertia_kg_m2: Option<Quantity>,
    /// Moment of inertia about the lateral axis.
    pub pitch_inertia_kg_m2: Option<Quantity>,
    /// Moment of inertia about the vertical axis.
    pub yaw_inertia_kg_m2: Option<Quantity>,
    /// Position along the vehicle; for several equal bodies, one each.
    pub station_m: Quantity,
    /// Height of the centre of gravity above the rail head.
    pub height_m: Quantity,
    /// Rolls on the track as a wheelset.
    #[serde(default)]
    pub wheelset: bool,
    /// Free coordinates; all five unless given.
    pub free: Option<Vec<Coordinate>>,
}

/// Springs and dampers between a first body and each of the second ones.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys say it")]
pub struct SuspensionFile {
    pub name: String,
    pub first: String,
    pub second: Vec<String>,
    pub lateral_m: Quantity,
    pub height_m: Quantity,
    #[serde(default = "yes")]
    pub both_sides: bool,
    pub stiffness_x_n_per_m: Option<Quantity>,
    pub stiffness_y_n_per_m: Option<Quantity>,
    pub stiffness_z_n_per_m: Option<Quantity>,
    pub damping_x_n_s_per_m: Option<Quantity>,
    pub damping_y_n_s_per_m: Option<Quantity>,
    pub damping_z_n_s_per_m: Option<Quantity>,
    /// Total lateral free play, one for all or one per second body.
    #[serde(default)]
    pub play_y_m: Vec<Quantity>,
}

/// Rotational springs and dampers between two bodies.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys say it")]
pub struct TorsionFile {
    pub name: String,
    pub first: String,
    pub second: Vec<String>,
    pub stiffness_roll_n_m_per_rad: Option<Quantity>,
    pub stiffness_pitch_n_m_per_rad: Option<Quantity>,
    pub stiffness_yaw_n_m_per_rad: Option<Quantity>,
    pub damping_roll_n_m_s_per_rad: Option<Quantity>,
    pub damping_pitch_n_m_s_per_rad: Option<Quantity>,
    pub damping_yaw_n_m_s_per_rad: Option<Quantity>,
}

/// A lateral stop on the centre line.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys say it")]
pub struct BumpStopFile {
    pub name: String,
    pub first: String,
    pub second: Vec<String>,
    pub height_m: Quantity,
    /// Rising deflections; the first is the free gap.
    pub deflection_m: Vec<Quantity>,
    /// Force at each deflection, from zero.
    pub force_n: Vec<Quantity>,
    pub provenance: Option<crate::quantity::Provenance>,
    pub note: Option<String>,
}

/// A longitudinal damper between two bodies.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys say it")]
pub struct DamperSlotFile {
    pub place: String,
    pub first: String,
    pub second: String,
    pub lateral_m: Quantity,
    pub height_m: Quantity,
}

/// Rounding of the heights and stations in a file (m).
const AXLE_TOLERANCE_M: f64 = 1e-6;

/// Masses that a body can have (kg). These bounds and the following lie far beyond any vehicle:
/// they keep the equations from overflowing, and the message at the number that would do it.
const MASS_KG: [f64; 2] = [1e-3, 1e7];
/// Moments of inertia that a body can have (kg m2).
const INERTIA_KG_M2: [f64; 2] = [1e-6, 1e12];
/// Largest stiffness and damping, in any direction (N/m, N s/m, N m/rad, N m s/rad).
const RATE_MAX: f64 = 1e15;
/// Largest force of a bump stop (N).
const FORCE_MAX_N: f64 = 1e12;
/// Largest coordinate of a point on a vehicle (m).
const LENGTH_MAX_M: f64 = 1e3;

fn yes() -> bool {
    true
}

impl VehicleFile {
    /// Builds the vehicle; `source` is the file it came from, for errors.
    ///
    /// # Errors
    /// The first number, name or count that does not fit, with file and line.
    pub fn build(&self, source: &Source) -> Result<Vehicle, ScenarioError> {
        let mut vehicle = Vehicle::default();
        let radius_m = self.wheel_rail.radius_m(source)?;
        for body in &self.body {
            let built = body.build(source, radius_m)?;
            push(&mut vehicle.bodies, built, source, "body")?;
        }
        let find = Finder { bodies: &self.body, source };
        for element in &self.suspension {
            element.build(&find, &mut vehicle)?;
        }
        for element in &self.torsion {
            element.build(&find, &mut vehicle)?;
        }
        for element in &self.bump_stop {
            element.build(&find, &mut vehicle)?;
        }
        for slot in &self.damper_slot {
            let first = find.id(&slot.first)?;
            let second = find.id(&slot.second)?;
            let at = find.body(second).station_m.value;
            let place = [
                at,
                slot.lateral_m.sized(source, "lateral_m", LENGTH_MAX_M)?,
                slot.height_m.sized(source, "height_m", LENGTH_MAX_M)?,
            ];
            let mount = DamperMount {
                first: find.anchor(first, place),
                second: find.anchor(second, place),
                direction: Vector3::x(),
            };
            for anchor in [&mount.first, &mount.second] {
                let what = || format!("damper_slot \"{}\"", quoted(&slot.place));
                find.on_axle(anchor, [true, false], &slot.height_m, what)?;
            }
            push(&mut vehicle.dampers, mount, source, "damper_slot")?;
        }
        let wheel = self.wheel_rail.wheel(source)?;
        let rail = self.wheel_rail.rail_support(source)?;
        for (index, body) in self.body.iter().enumerate() {
            if body.wheelset
                && let Some(id) = BodyId::new(index)
            {
                push(&mut vehicle.axles, Axle { body: id, wheel, rail }, source, "wheelset")?;
            }
        }
        vehicle.check().map_err(|error| source.whole_error(error.to_string()))?;
        Ok(vehicle)
    }
}

/// Adds to a bounded list, or says that it is full.
fn push<T, const N: usize>(
    list: &mut heapless::Vec<T, N>,
    item: T,
    source: &Source,
    what: &str,
) -> Result<(), ScenarioError> {
    list.push(item).map_err(|_| {
        source.whole_error(format!("more than {N} of {what}; a vehicle has room for {N}"))
    })
}

/// Finds bodies by name.
struct Finder<'a> {
    bodies: &'a [BodyFile],
    source: &'a Source,
}

impl Finder<'_> {
    fn id(&self, name: &str) -> Result<BodyId, ScenarioError> {
        if name == "track" {
            return Ok(BodyId::GROUND);
        }
        let found = self.bodies.iter().position(|body| body.name == name);
        found.and_then(BodyId::new).ok_or_else(|| {
            let known: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
            self.source.whole_error(format!(
                "body \"{}\" does not exist, expected track or one of {}{}",
                quoted(name),
                quoted(&known.join(", ")),
                did_you_mean(name, known.iter().copied())
            ))
        })
    }

    fn body(&self, id: BodyId) -> &BodyFile {
        debug_assert!(id.index() < self.bodies.len(), "a body that `id` has found");
        &self.bodies[id.index()]
    }

    /// A point in vehicle axes (station, right, height) as seen from a body.
    fn anchor(&self, body: BodyId, [station, right, height]: [f64; 3]) -> Anchor {
        let (origin, level) = if body == BodyId::GROUND {
            (station, height)
        } else {
            (self.body(body).station_m.value, self.body(body).height_m.value)
        };
        Anchor { body, point_m: Vector3::new(station - origin, right, level - height) }
    }

    /// On a wheelset that spins, a longitudinal force acts at the height of the axle and a vertical
    /// one at its station. Elsewhere the element would turn with the wheelset: its pitch is the sum
    /// of the deviations of its spin, and the wheel load would drift.
    fn on_axle(
        &self,
        anchor: &Anchor,
        [longitudinal, vertical]: [bool; 2],
        near: &Quantity,
        what: impl Fn() -> String,
    ) -> Result<(), ScenarioError> {
        let Some(body) = self.spinning(anchor.body) else { return Ok(()) };
        let (ahead_m, above_m) = (anchor.point_m.x, -anchor.point_m.z);
        let (force, place, off_m) = if longitudinal && above_m.abs() > AXLE_TOLERANCE_M {
            ("longitudinal", "above", above_m)
        } else if vertical && ahead_m.abs() > AXLE_TOLERANCE_M {
            ("vertical", "ahead of", ahead_m)
        } else {
            return Ok(());
        };
        let message = format!(
            "{} acts {off_m:.4} m {place} the axle of \"{}\", expected 0: the wheelset's spin adds \
             up, and with a {force} force off the axle the wheel load would drift",
            what(),
            quoted(&body.name),
        );
        Err(near.error(self.source, message))
    }

    /// The body, if it is a wheelset that spins: its pitch angle is the sum of the deviations of
    /// its spin.
    fn spinning(&self, id: BodyId) -> Option<&BodyFile> {
        if id == BodyId::GROUND {
            return None;
        }
        let body = self.body(id);
        let spins = body.free.as_ref().is_none_or(|free| free.contains(&Coordinate::Pitch));
        (body.wheelset && spins).then_some(body)
    }

    /// Optional quantities that may not be negative, zero where absent.
    fn three(
        &self,
        values: [&Option<Quantity>; 3],
        keys: [&str; 3],
    ) -> Result<[f64; 3], ScenarioError> {
        let mut result = [0.0; 3];
        for ((slot, value), key) in result.iter_mut().zip(values).zip(keys) {
            if let Some(value) = value {
                *slot = value.up_to(self.source, key, RATE_MAX)?;
            }
        }
        Ok(result)
    }
}

impl BodyFile {
    fn build(&self, source: &Source, radius_m: f64) -> Result<Body, ScenarioError> {
        let mass_kg = self.mass_kg.positive_within(source, "mass_kg", MASS_KG[0], MASS_KG[1])?;
        let mut inertia_kg_m2 = [0.0; 3];
        let given = [
            (&self.roll_inertia_kg_m2, "roll_inertia_kg_m2"),
            (&self.pitch_inertia_kg_m2, "pitch_inertia_kg_m2"),
            (&self.yaw_inertia_kg_m2, "yaw_inertia_kg_m2"),
        ];
        for (slot, (value, key)) in inertia_kg_m2.iter_mut().zip(given) {
            if let Some(value) = value {
                let [least, most] = INERTIA_KG_M2;
                *slot = value.positive_within(source, key, least, most)?;
            }
        }
        let free = match &self.free {
            None => [true; 5],
            Some(list) => {
                let mut free = [false; 5];
                for coordinate in list {
                    free[*coordinate as usize] = true;
                }
                free
            }
        };
        let body = Body {
            mass_kg,
            inertia_kg_m2,
            free,
            station_m: self.station_m.sized(source, "station_m", LENGTH_MAX_M)?,
            height_m: self.height_m.sized(source, "height_m", LENGTH_MAX_M)?,
            rolling_radius_m: self.wheelset.then_some(radius_m),
        };
        for (axis, (value, key)) in given.into_iter().enumerate() {
            if free[2 + axis] && value.is_none() {
                let name = quoted(&self.name);
                return Err(self.mass_kg.error(
                    source,
                    format!("body \"{name}\" has no {key}, but that axis is free"),
                ));
            }
        }
        Ok(body)
    }
}

impl SuspensionFile {
    fn build(&self, find: &Finder<'_>, vehicle: &mut Vehicle) -> Result<(), ScenarioError> {
        let source = find.source;
        let stiffness_n_per_m = find.three(
            [&self.stiffness_x_n_per_m, &self.stiffness_y_n_per_m, &self.stiffness_z_n_per_m],
            ["stiffness_x_n_per_m", "stiffness_y_n_per_m", "stiffness_z_n_per_m"],
        )?;
        let damping_n_s_per_m = find.three(
            [&self.damping_x_n_s_per_m, &self.damping_y_n_s_per_m, &self.damping_z_n_s_per_m],
            ["damping_x_n_s_per_m", "damping_y_n_s_per_m", "damping_z_n_s_per_m"],
        )?;
        if self.play_y_m.len() > 1 && self.play_y_m.len() != self.second.len() {
            return Err(self.lateral_m.error(
                source,
                format!(
                    "suspension \"{}\": {} values of play_y_m for {} second bodies",
                    quoted(&self.name),
                    self.play_y_m.len(),
                    self.second.len()
                ),
            ));
        }
        let first = find.id(&self.first)?;
        let lateral = self.lateral_m.sized(source, "lateral_m", LENGTH_MAX_M)?;
        let height = self.height_m.sized(source, "height_m", LENGTH_MAX_M)?;
        let sides: &[f64] = if self.both_sides && lateral != 0.0 { &[-1.0, 1.0] } else { &[1.0] };
        for (number, name) in self.second.iter().enumerate() {
            let second = find.id(name)?;
            let at = if second == BodyId::GROUND { first } else { second };
            let station = find.body(at).station_m.value;
            let play = self.play_y_m.get(number).or(self.play_y_m.first());
            let play_y = play.map_or(Ok(0.0), |p| p.up_to(source, "play_y_m", LENGTH_MAX_M))?;
            for side in sides {
                let place = [station, side * lateral, height];
                let element = Suspension {
                    first: find.anchor(first, place),
                    second: find.anchor(second, place),
                    stiffness_n_per_m,
                    damping_n_s_per_m,
                    play_m: [0.0, play_y, 0.0],
                };
                let acts =
                    |axis: usize| stiffness_n_per_m[axis] != 0.0 || damping_n_s_per_m[axis] != 0.0;
                for anchor in [&element.first, &element.second] {
                    let what = || format!("suspension \"{}\"", quoted(&self.name));
                    find.on_axle(anchor, [acts(0), acts(2)], &self.height_m, what)?;
                }
                push(&mut vehicle.suspensions, element, source, "suspension")?;
            }
        }
        Ok(())
    }
}

impl TorsionFile {
    fn build(&self, find: &Finder<'_>, vehicle: &mut Vehicle) -> Result<(), ScenarioError> {
        let stiffness_n_m_per_rad = find.three(
            [
                &self.stiffness_roll_n_m_per_rad,
                &self.stiffness_pitch_n_m_per_rad,
                &self.stiffness_yaw_n_m_per_rad,
            ],
            [
                "stiffness_roll_n_m_per_rad",
                "stiffness_pitch_n_m_per_rad",
                "stiffness_yaw_n_m_per_rad",
            ],
        )?;
        let damping_n_m_s_per_rad = find.three(
            [
                &self.damping_roll_n_m_s_per_rad,
                &self.damping_pitch_n_m_s_per_rad,
                &self.damping_yaw_n_m_s_per_rad,
            ],
            [
                "damping_roll_n_m_s_per_rad",
                "damping_pitch_n_m_s_per_rad",
                "damping_yaw_n_m_s_per_rad",
            ],
        )?;
        let first = find.id(&self.first)?;
        let pitch = [&self.stiffness_pitch_n_m_per_rad, &self.damping_pitch_n_m_s_per_rad];
        let pitch = pitch.into_iter().flatten().find(|given| given.value != 0.0);
        for name in &self.second {
            let second = find.id(name)?;
            for id in [first, second] {
                if let (Some(given), Some(body)) = (pitch, find.spinning(id)) {
                    let message = format!(
                        "torsion \"{}\" acts about the pitch axis of \"{}\", expected roll or yaw \
                         alone: the wheelset spins about that axis, its spin adds up, and the torque \
                         would brake it and make the wheel load drift",
                        quoted(&self.name),
                        quoted(&body.name),
                    );
                    return Err(given.error(find.source, message));
                }
            }
            let element = Torsion { first, second, stiffness_n_m_per_rad, damping_n_m_s_per_rad };
            push(&mut vehicle.torsions, element, find.source, "torsion")?;
        }
        Ok(())
    }
}

impl BumpStopFile {
    fn build(&self, find: &Finder<'_>, vehicle: &mut Vehicle) -> Result<(), ScenarioError> {
        let source = find.source;
        let count = self.deflection_m.len();
        if count < 2 || count != self.force_n.len() {
            return Err(self.height_m.error(
                source,
                format!(
                    "bump_stop \"{}\": {count} deflections and {} forces, expected two or more pairs",
                    quoted(&self.name),
                    self.force_n.len()
                ),
            ));
        }
        let mut characteristic = heapless::Vec::new();
        let mut last = (-1.0, 0.0);
        for (deflection, force) in self.deflection_m.iter().zip(&self.force_n) {
            let pair = (
                deflection.up_to(source, "deflection_m", LENGTH_MAX_M)?,
                force.up_to(source, "force_n", FORCE_MAX_N)?,
            );
            if pair.0 <= last.0 || pair.1 < last.1 || (last.0 < 0.0 && pair.1 != 0.0) {
                return Err(deflection.error(
                    source,
                    format!(
                        "bump_stop \"{}\": points must rise from force zero",
                        quoted(&self.name)
                    ),
                ));
            }
            last = pair;
            push(&mut characteristic, pair, source, "deflection_m")?;
        }
        let first = find.id(&self.first)?;
        let height = self.height_m.sized(source, "height_m", LENGTH_MAX_M)?;
        for name in &self.second {
            let second = find.id(name)?;
            let place = [find.body(second).station_m.value, 0.0, height];
            let element = BumpStop {
                first: find.anchor(first, place),
                second: find.anchor(second, place),
                characteristic: characteristic.clone(),
            };
            push(&mut vehicle.bump_stops, element, source, "bump_stop")?;
        }
        Ok(())
    }
}
