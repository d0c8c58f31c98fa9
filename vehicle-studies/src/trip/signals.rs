//! The signals of a trip at 1 kHz: accelerations, wheelset positions, wheel forces, dampers.
//!
//! ```text
//! a_y = y'' + x psi'' - z phi''        a_z = z'' - x theta''        at a point x forward, z down
//! Y = -(lateral force on the wheelset)      Q = -(vertical force on it)
//! T gamma = -(Fx xi + Fy eta)               P = -V (Fx xi + Fy eta + Mz omega)
//! ```
//! Axes: x forward, y right, z down. Accelerations are those against the track's own frame, which
//! in a curve has the curve's: what `v^2/R` and cant do to an accelerometer is not in them, nor is
//! the share of gravity that it shows as the body rolls.
//!
//! The floor is watched on the vehicle's centre line above the centre of each bogie, where cabs and
//! locomotive practice for the Sperling index put the accelerometers, and above the middle of the
//! carbody; its height is given. Bodies are known by their names, as in a run's summary: `carbody`,
//! and bogies by what begins with `bogie`.
//!
//! Limits: accelerations, wheels and dampers are those of the last evaluation, one substep (at most
//! half a millisecond) before the positions of the same sample.

use super::Trip;
use super::TripState;
use crate::error::StudyError;
use firmware_core::line::LineState;
use firmware_core::vehicle::{
    BodyId, DAMPER_SLOTS, LATERAL, PITCH, ROLL, VERTICAL, Vehicle, VehicleState, YAW,
};
use firmware_core::wheel_rail::wheel::WheelForce;
use scenario::run::{CYCLE_S, Run};

/// Samples a second.
pub const RATE_HZ: f64 = 1.0 / CYCLE_S;

/// A place on a body where acceleration is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// What it is called.
    pub name: String,
    /// Its body.
    pub body: BodyId,
    /// How far ahead of the body's centre it is (m).
    pub forward_m: f64,
    /// How far below the body's centre it is (m).
    pub down_m: f64,
}

impl Place {
    /// The centre of a body.
    fn centre(name: &str, body: BodyId) -> Self {
        Self { name: name.to_owned(), body, forward_m: 0.0, down_m: 0.0 }
    }
}

/// Where a vehicle is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// On the floor above the bogies, from the front, then above the carbody's middle; none for a
    /// vehicle without a carbody.
    pub floor: Vec<Place>,
    /// The centres of the bogie frames, from the front.
    pub bogies: Vec<Place>,
    /// The centres of the wheelsets, from the front.
    pub wheelsets: Vec<Place>,
}

impl Places {
    /// The usual places of a vehicle with its floor at a height above the rails (m).
    pub fn of(run: &Run, floor_height_m: f64) -> Self {
        let station_m =
            |body: BodyId| run.vehicle.bodies.get(body.index()).map_or(0.0, |b| b.station_m);
        let wheelset = |body: BodyId| run.vehicle.axles.iter().any(|axle| axle.body == body);
        let named = run.body_names.iter().enumerate().filter_map(|(index, name)| {
            let body = BodyId::new(index)?;
            (!wheelset(body)).then_some((name.as_str(), body))
        });
        let mut bogies: Vec<Place> = named
            .clone()
            .filter(|(name, _)| name.starts_with("bogie"))
            .map(|(name, body)| Place::centre(name, body))
            .collect();
        bogies.sort_by(|a, b| station_m(b.body).total_cmp(&station_m(a.body)));
        let carbody = named.clone().find(|(name, _)| *name == "carbody").map(|(_, body)| body);
        let floor = carbody.map_or(Vec::new(), |carbody| {
            let height_m =
                run.vehicle.bodies.get(carbody.index()).map_or(0.0, |body| body.height_m);
            let above = |name: &str, station: f64| Place {
                name: format!("floor above {name}"),
                body: carbody,
                forward_m: station - station_m(carbody),
                down_m: height_m - floor_height_m,
            };
            let mut floor: Vec<Place> =
                bogies.iter().map(|bogie| above(&bogie.name, station_m(bogie.body))).collect();
            floor.push(above("the middle", station_m(carbody)));
            floor
        });
        Self { floor, bogies, ..Self::wheelsets_of(&run.vehicle) }
    }

    /// The wheelsets of a vehicle alone.
    pub fn wheelsets_of(vehicle: &Vehicle) -> Self {
        let axles = vehicle.axles.iter().enumerate();
        let wheelsets = axles
            .map(|(number, axle)| Place::centre(&format!("wheelset {}", number + 1), axle.body));
        Self { floor: Vec::new(), bogies: Vec::new(), wheelsets: wheelsets.collect() }
    }
}

/// Acceleration of a place over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Acceleration {
    /// What the place is called.
    pub name: String,
    /// To the right (m/s2).
    pub lateral_m_per_s2: Vec<f64>,
    /// Down (m/s2).
    pub vertical_m_per_s2: Vec<f64>,
}

/// A wheelset over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WheelsetSignal {
    /// How far ahead of the vehicle's reference point it runs (m).
    pub station_m: f64,
    /// Position to the right of the track's centre (m).
    pub lateral_m: Vec<f64>,
    /// Yaw, forward to the right (rad).
    pub yaw_rad: Vec<f64>,
    /// Left and right wheel; empty where wheels were not asked for.
    pub wheels: [WheelSignal; 2],
}

/// A wheel over time. Two patches are summed up in forces and powers; creepages are those of the
/// patch with the greater load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WheelSignal {
    /// Guiding force on the rail, outward (N).
    pub y_n: Vec<f64>,
    /// Wheel load (N).
    pub q_n: Vec<f64>,
    /// Creep force on the wheel, forward (N).
    pub creep_longitudinal_n: Vec<f64>,
    /// Creep force on the wheel, outward in the patch's plane (N).
    pub creep_lateral_n: Vec<f64>,
    /// Moment of spin on the wheel (N m).
    pub spin_moment_n_m: Vec<f64>,
    /// Longitudinal creepage.
    pub longitudinal_creepage: Vec<f64>,
    /// Lateral creepage.
    pub lateral_creepage: Vec<f64>,
    /// Spin creepage (1/m).
    pub spin_per_m: Vec<f64>,
    /// Power lost in the patches, spin included (W).
    pub wear_w: Vec<f64>,
    /// The wear number T gamma, spin left out (N); below zero where spin alone drives the wheel
    /// sideways against its creepage.
    pub t_gamma_n: Vec<f64>,
}

/// A damper slot over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DamperSignal {
    /// Extension from the beginning of the trip, mid-stroke (m).
    pub extension_m: Vec<f64>,
    /// Force, tension positive (N).
    pub force_n: Vec<f64>,
}

/// Whether wheels are recorded too; their twenty columns a wheelset are most of the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wheels {
    /// They are.
    Recorded,
    /// They are not.
    LeftOut,
}

/// The signals of a trip, one value per millisecond in every column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Signals {
    /// Distance of the vehicle's reference point along the track (m).
    pub distance_m: Vec<f64>,
    /// The floor, place by place as in [`Places::floor`].
    pub floor: Vec<Acceleration>,
    /// The bogie frames at their centres, from the front.
    pub bogies: Vec<Acceleration>,
    /// The wheelsets at their centres, from the front.
    pub wheelset_accelerations: Vec<Acceleration>,
    /// The wheelsets' positions and wheels, from the front.
    pub wheelsets: Vec<WheelsetSignal>,
    /// The damper slots, in their order.
    pub dampers: Vec<DamperSignal>,
    /// True when the vehicle left the track; columns end there.
    pub derailed: bool,
}

impl Signals {
    /// Runs on for a time and records it.
    ///
    /// # Errors
    /// The trip is stopped.
    pub fn of(
        trip: &Trip<'_>,
        state: &mut TripState,
        duration_s: f64,
        places: &Places,
        wheels: Wheels,
    ) -> Result<Self, StudyError> {
        let mut recorder = Some(Recorder::of(trip.vehicle(), places.clone(), wheels));
        let on_track = trip.record(state, duration_s, &mut recorder)?;
        let mut signals = recorder.map(|recorder| recorder.signals).unwrap_or_default();
        signals.derailed = !on_track;
        Ok(signals)
    }

    /// Columns without any value.
    fn none(vehicle: &Vehicle, places: &Places) -> Self {
        let named = |places: &[Place]| -> Vec<Acceleration> {
            let one =
                |place: &Place| Acceleration { name: place.name.clone(), ..Default::default() };
            places.iter().map(one).collect()
        };
        let station_m =
            |body: BodyId| vehicle.bodies.get(body.index()).map_or(0.0, |b| b.station_m);
        let wheelset = |place: &Place| WheelsetSignal {
            station_m: station_m(place.body),
            ..WheelsetSignal::default()
        };
        Self {
            floor: named(&places.floor),
            bogies: named(&places.bogies),
            wheelset_accelerations: named(&places.wheelsets),
            wheelsets: places.wheelsets.iter().map(wheelset).collect(),
            dampers: vec![DamperSignal::default(); vehicle.dampers.len()],
            ..Self::default()
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.distance_m.len()
    }

    /// True without any sample.
    pub fn is_empty(&self) -> bool {
        self.distance_m.is_empty()
    }

    /// A cycle of the vehicle in a lane; its dampers are in mid-stroke at the lengths given (m).
    fn push<const L: usize>(
        &mut self,
        vehicle: &VehicleState<L>,
        lane: usize,
        mid_stroke_m: &[f64; DAMPER_SLOTS],
        places: &Places,
        wheels: Wheels,
    ) {
        self.distance_m.push(vehicle.distance_m.lane(lane));
        for (signals, places) in [
            (&mut self.floor, &places.floor),
            (&mut self.bogies, &places.bogies),
            (&mut self.wheelset_accelerations, &places.wheelsets),
        ] {
            for (signal, place) in signals.iter_mut().zip(places) {
                let [lateral, vertical] = acceleration_m_per_s2(vehicle, lane, place);
                signal.lateral_m_per_s2.push(lateral);
                signal.vertical_m_per_s2.push(vertical);
            }
        }
        for ((signal, place), pair) in
            self.wheelsets.iter_mut().zip(&places.wheelsets).zip(&vehicle.wheels)
        {
            let pose = vehicle.position.get(place.body.index());
            let at = |coordinate: usize| pose.map_or(0.0, |pose| pose[coordinate].lane(lane));
            signal.lateral_m.push(at(LATERAL));
            signal.yaw_rad.push(at(YAW));
            if wheels == Wheels::Recorded {
                for (signal, forces) in signal.wheels.iter_mut().zip(pair) {
                    signal.push(&forces[lane]);
                }
            }
        }
        for (slot, (signal, mid_m)) in self.dampers.iter_mut().zip(mid_stroke_m).enumerate() {
            signal.extension_m.push(vehicle.extension_m[slot].lane(lane) - mid_m);
            signal.force_n.push(vehicle.damper_n[slot].lane(lane));
        }
    }
}

/// Signals that grow while a trip runs.
#[derive(Debug, Clone)]
pub(crate) struct Recorder {
    /// What was recorded so far.
    pub(crate) signals: Signals,
    places: Places,
    wheels: Wheels,
}

impl Recorder {
    /// Of places of a vehicle.
    pub(crate) fn of(vehicle: &Vehicle, places: Places, wheels: Wheels) -> Self {
        Self { signals: Signals::none(vehicle, &places), places, wheels }
    }

    /// A cycle of the vehicle in a lane of a batch; its dampers are in mid-stroke at the lengths
    /// given (m).
    pub(super) fn see<const L: usize>(
        &mut self,
        vehicle: &VehicleState<L>,
        lane: usize,
        mid_stroke_m: &[f64; DAMPER_SLOTS],
    ) {
        self.signals.push(vehicle, lane, mid_stroke_m, &self.places, self.wheels);
    }

    /// Whether it looks at wheel forces.
    pub(super) fn sees_wheels(&self) -> bool {
        self.wheels == Wheels::Recorded
    }

    /// A cycle of a vehicle on a line.
    pub(super) fn see_line(&mut self, state: &LineState) {
        let mid_stroke_m = state.slots.each_ref().map(|slot| slot.mid_stroke_m);
        self.see(&state.vehicle, 0, &mid_stroke_m);
    }
}

impl WheelsetSignal {
    /// Sum of the guiding forces of both wheels on the track, to the right (N).
    pub fn axle_force_n(&self) -> Vec<f64> {
        let [left, right] = &self.wheels;
        right.y_n.iter().zip(&left.y_n).map(|(right, left)| right - left).collect()
    }
}

impl WheelSignal {
    fn push(&mut self, force: &WheelForce) {
        let (tread, flange) = (&force.tread, &force.flange);
        let loaded = if force.flange_n > force.tread_n { flange } else { tread };
        self.y_n.push(-force.lateral_n);
        self.q_n.push(-force.vertical_n);
        self.creep_longitudinal_n.push(tread.force.longitudinal_n + flange.force.longitudinal_n);
        self.creep_lateral_n.push(tread.force.lateral_n + flange.force.lateral_n);
        self.spin_moment_n_m.push(tread.force.spin_moment_n_m + flange.force.spin_moment_n_m);
        self.longitudinal_creepage.push(loaded.creepage.longitudinal);
        self.lateral_creepage.push(loaded.creepage.lateral);
        self.spin_per_m.push(loaded.creepage.spin_per_m);
        self.wear_w.push(force.wear_w);
        let t_gamma_n = [tread, flange].map(|patch| {
            patch.force.longitudinal_n * patch.creepage.longitudinal
                + patch.force.lateral_n * patch.creepage.lateral
        });
        self.t_gamma_n.push(-t_gamma_n.iter().sum::<f64>());
    }
}

/// Acceleration of a place, to the right and down (m/s2).
fn acceleration_m_per_s2<const L: usize>(
    vehicle: &VehicleState<L>,
    lane: usize,
    place: &Place,
) -> [f64; 2] {
    debug_assert!(place.body.index() < vehicle.acceleration.len(), "no such body");
    let Some(rate) = vehicle.acceleration.get(place.body.index()) else { return [0.0; 2] };
    let of = |coordinate: usize| rate[coordinate].lane(lane);
    [
        of(LATERAL) + place.forward_m * of(YAW) - place.down_m * of(ROLL),
        of(VERTICAL) - place.forward_m * of(PITCH),
    ]
}
