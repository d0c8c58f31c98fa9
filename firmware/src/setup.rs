//! The scenario in flash, and the places in RAM that are filled from it at the start.
//!
//! The build script reads the scenario on the host. Vehicle, contact table, track and start are
//! constants of the core's own types; dampers are built from their numbers. The line and its state
//! are in RAM from the reset on, as the image has them, and never move.

use firmware_core::compensation::Compensator;
use firmware_core::damper::{Damper, DamperError, Effect, Nominal};
use firmware_core::lanes::Lanes;
use firmware_core::line::{Fade, Line, LineState, RigSlot, Slot};
use firmware_core::supervision::CommandLimits;
use firmware_core::track::{Irregularity, IrregularitySample, Layout, Track};
use firmware_core::vehicle::{
    Anchor, Axle, Body, BodyId, BumpStop, DAMPER_SLOTS, DamperMount, RailSupport, Suspension,
    Vehicle, VehicleState,
};
use firmware_core::wheel_rail::creep::{CreepForce, CreepLaw, Creepage};
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::{ContactTable, ZoneTable};
use firmware_core::wheel_rail::wheel::{Rolling, Surface, Wheel, WheelForce};
use nalgebra::Vector3;
use nodes::timed::TimedServer;
use nodes::track::{Server, Terms, Ways};
use same_bits::locomotive::BoardWindow;
use same_bits::two_roles::{self, BoardReader};
use static_cell::{ConstStaticCell, StaticCell};

/// What a damper is made from.
pub struct Numbers {
    nominal: Nominal,
    effects: &'static [(&'static str, &'static [f64])],
}

// The scenario as constants.
include!(concat!(env!("OUT_DIR"), "/setup.rs"));

/// A body by its place.
const fn body(index: usize) -> BodyId {
    match BodyId::new(index) {
        Some(body) => body,
        None => BodyId::GROUND,
    }
}

/// The vehicle.
pub static VEHICLE: Vehicle = THE_VEHICLE;
static TRACK: Track<'static> = Track {
    layout: Layout::tangent(),
    irregularity: Irregularity {
        samples: &SAMPLES,
        before: 0,
        behind: 0,
        first_m: TRACK_FIRST_M,
        step_m: TRACK_STEP_M,
    },
};
static CHANGEABLE: ConstStaticCell<Vehicle> = ConstStaticCell::new(THE_VEHICLE);
static LINE: ConstStaticCell<Line<'static>> = ConstStaticCell::new(Line {
    vehicle: &VEHICLE,
    track: &TRACK,
    contact: Some(&TABLE),
    speed_m_per_s: SPEED_M_PER_S,
    cycle_s: CYCLE_S,
    substeps: SUBSTEPS,
    slots: [const { Slot::Empty }; DAMPER_SLOTS],
    fade: Fade::NONE,
});
static STATE: ConstStaticCell<LineState> = ConstStaticCell::new(LineState::of(START));
static WINDOW: StaticCell<BoardWindow> = StaticCell::new();
static READER: ConstStaticCell<BoardReader> = ConstStaticCell::new(BoardReader::NEW);
static RIG: StaticCell<Damper> = StaticCell::new();

/// A vehicle in RAM, for another creep law; none the second time.
pub fn changeable_vehicle() -> Option<&'static mut Vehicle> {
    CHANGEABLE.try_take()
}

/// The line with a model in every slot; none the second time, or where the vehicle cannot run or a
/// damper cannot be built.
#[inline(never)]
pub fn line(vehicle: &'static Vehicle) -> Option<&'static mut Line<'static>> {
    vehicle.check().ok()?;
    let line = LINE.try_take()?;
    line.vehicle = vehicle;
    let step_s = CYCLE_S / f64::from(SUBSTEPS);
    for (slot, numbers) in line.slots.iter_mut().zip(&DAMPERS) {
        mount(slot, numbers, step_s)?;
    }
    Some(line)
}

/// The state of a line in steady running; none the second time.
#[inline(never)]
pub fn start(line: &Line<'_>) -> Option<&'static mut LineState> {
    let state = STATE.try_take()?;
    line.begin(state);
    Some(state)
}

/// A window on the track, empty; none the second time.
#[inline(never)]
pub fn window() -> Option<&'static mut BoardWindow> {
    Some(WINDOW.try_uninit()?.write(BoardWindow::new(SAMPLES.len(), TRACK_FIRST_M, TRACK_STEP_M)))
}

/// The reader of the track that this image is built for, there and back and there again; none the
/// second time.
pub fn track_reader() -> Option<&'static mut BoardReader> {
    let reader = READER.try_take()?;
    reader.begin(Terms {
        session: two_roles::TRACK_SESSION,
        expected: Some(TRACK_FINGERPRINT),
        reach_m: VEHICLE.reach_m(),
        ahead_m: SPEED_M_PER_S * CYCLE_S,
    });
    Some(reader)
}

/// A server of the track in flash, there and back and there again; none where it does not travel.
pub fn track_server() -> Option<TimedServer<&'static [IrregularitySample]>> {
    Some(TimedServer::new(Server::of(&TRACK.irregularity, Ways::ThereAndBack).ok()?))
}

/// The line with a rig in the first slot; none the second time, or where a damper cannot be built.
#[inline(never)]
pub fn line_with_rig(vehicle: &'static Vehicle) -> Option<&'static mut Line<'static>> {
    let line = line(vehicle)?;
    line.fade =
        Fade { motion_cycles: RAMP_CYCLES, measuring_cycles: 0, coupling_cycles: RAMP_CYCLES };
    put_on_rig(line.slots.get_mut(two_roles::SLOT)?)?;
    Some(line)
}

/// Puts a rig into the slot of a modelled damper, which becomes its model.
#[inline(never)]
fn put_on_rig(slot: &mut Slot<'_>) -> Option<()> {
    let Slot::Modelled(model) = slot else { return None };
    let limits = CommandLimits {
        stroke_m: STROKE_M,
        velocity_m_per_s: VELOCITY_M_PER_S,
        acceleration_m_per_s2: ACCELERATION_M_PER_S2,
    };
    *slot = Slot::Rig(RigSlot::new(model.clone(), COMPENSATOR, limits, CYCLE_S));
    Some(())
}

/// The damper on the rig; none the second time, or where it cannot be built.
#[inline(never)]
pub fn rig_damper() -> Option<&'static Damper> {
    let Ok(damper) = Damper::new(RIG_DAMPER.nominal, &effects(&RIG_DAMPER)?) else { return None };
    let damper = RIG.try_uninit()?.write(damper);
    damper.prepare(CYCLE_S / f64::from(nodes::rig::SUBSTEPS));
    Some(damper)
}

/// Effects in one damper at most.
const MOST: usize = firmware_core::damper::MAX_EFFECTS;

/// Builds a damper and puts it into its slot.
#[inline(never)]
fn mount(slot: &mut Slot<'_>, numbers: &Numbers, step_s: f64) -> Option<()> {
    put(slot, Damper::new(numbers.nominal, &effects(numbers)?))?;
    if let Slot::Modelled(damper) = slot {
        damper.prepare(step_s);
    }
    Some(())
}

/// A function of its own, so that its copies, 22 kB each, are not on the stack while a damper is
/// built.
#[inline(never)]
fn put(slot: &mut Slot<'_>, built: Result<Damper, DamperError>) -> Option<()> {
    *slot = Slot::Modelled(built.ok()?);
    Some(())
}

/// The effects of a damper from their numbers.
#[inline(never)]
fn effects(numbers: &Numbers) -> Option<heapless::Vec<Effect, MOST>> {
    let mut effects = heapless::Vec::new();
    for (name, values) in numbers.effects {
        effects.push(Effect::from_values(name, values).ok()?).ok()?;
    }
    Some(effects)
}
