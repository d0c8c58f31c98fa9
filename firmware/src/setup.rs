//! The scenario in flash, and the places in RAM that are filled from it at the start.
//!
//! The build script reads the scenario on the host. Contact table, track and start are constants
//! of the core's own types; a vehicle and its dampers are built from their numbers. Everything that
//! is large stays in its place: it is filled there and never moved.

use firmware_core::compensation::Compensator;
use firmware_core::damper::{Damper, Effect, Nominal};
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
use same_bits::locomotive::BoardWindow;
use same_bits::two_roles;
use static_cell::StaticCell;

/// What a damper is made from.
pub struct Numbers {
    nominal: Nominal,
    effects: &'static [(&'static str, &'static [f64])],
}

// The scenario as constants, and `fill_vehicle`.
include!(concat!(env!("OUT_DIR"), "/setup.rs"));

/// A body by its place.
fn body(index: usize) -> BodyId {
    BodyId::new(index).unwrap_or(BodyId::GROUND)
}

/// A list of what fits into it, which the host has checked.
fn list<T: Clone, const N: usize>(values: &[T]) -> heapless::Vec<T, N> {
    heapless::Vec::from_slice(values).unwrap_or_default()
}

static VEHICLE: StaticCell<Vehicle> = StaticCell::new();
static TRACK: StaticCell<Track<'static>> = StaticCell::new();
static LINE: StaticCell<Line<'static>> = StaticCell::new();
static WINDOW: StaticCell<BoardWindow> = StaticCell::new();
static RIG: StaticCell<Damper> = StaticCell::new();
static STATE: StaticCell<LineState> = StaticCell::new();

/// The vehicle; none the second time, or where it does not fit.
#[inline(never)]
pub fn vehicle() -> Option<&'static mut Vehicle> {
    let vehicle = VEHICLE.try_uninit()?.write(Vehicle::default());
    (fill_vehicle(vehicle) && vehicle.check().is_ok()).then_some(vehicle)
}

/// The line with a model in every slot; none the second time, or where a damper cannot be built.
#[inline(never)]
pub fn line(vehicle: &'static Vehicle) -> Option<&'static mut Line<'static>> {
    let line = empty_line(vehicle)?;
    let step_s = CYCLE_S / f64::from(SUBSTEPS);
    for (slot, numbers) in line.slots.iter_mut().zip(&DAMPERS) {
        mount(slot, numbers, step_s)?;
    }
    Some(line)
}

#[expect(clippy::large_stack_arrays, reason = "empty slots, written in their place")]
#[inline(never)]
fn empty_line(vehicle: &'static Vehicle) -> Option<&'static mut Line<'static>> {
    Some(LINE.try_uninit()?.write(Line {
        vehicle,
        track: track()?,
        contact: Some(&TABLE),
        speed_m_per_s: SPEED_M_PER_S,
        cycle_s: CYCLE_S,
        substeps: SUBSTEPS,
        slots: [const { Slot::Empty }; DAMPER_SLOTS],
        fade: Fade::default(),
    }))
}

#[inline(never)]
fn track() -> Option<&'static Track<'static>> {
    let irregularity = Irregularity {
        samples: &SAMPLES,
        before: 0,
        behind: 0,
        first_m: TRACK_FIRST_M,
        step_m: TRACK_STEP_M,
    };
    Some(TRACK.try_uninit()?.write(Track { layout: Layout::tangent(), irregularity }))
}

/// The state of a line in steady running; none the second time.
#[inline(never)]
pub fn start(line: &Line<'_>) -> Option<&'static mut LineState> {
    Some(STATE.try_uninit()?.write(line.start(START.clone())))
}

/// A window on the track, empty; none the second time.
#[inline(never)]
pub fn window() -> Option<&'static mut BoardWindow> {
    Some(WINDOW.try_uninit()?.write(BoardWindow::new(SAMPLES.len(), TRACK_FIRST_M, TRACK_STEP_M)))
}

/// A window on a track without an end, empty; none the second time.
#[inline(never)]
pub fn endless_window() -> Option<&'static mut BoardWindow> {
    Some(WINDOW.try_uninit()?.write(BoardWindow::new(usize::MAX, TRACK_FIRST_M, TRACK_STEP_M)))
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
    let damper = RIG.try_uninit()?.write(damper(&RIG_DAMPER)?);
    damper.prepare(CYCLE_S / f64::from(nodes::rig::SUBSTEPS));
    Some(damper)
}

/// Effects in one damper at most.
const MOST: usize = firmware_core::damper::MAX_EFFECTS;

/// Puts a damper into its slot.
#[inline(never)]
fn mount(slot: &mut Slot<'_>, numbers: &Numbers, step_s: f64) -> Option<()> {
    *slot = Slot::Modelled(damper(numbers)?);
    if let Slot::Modelled(damper) = slot {
        damper.prepare(step_s);
    }
    Some(())
}

/// A damper from its numbers.
fn damper(numbers: &Numbers) -> Option<Damper> {
    let mut effects = heapless::Vec::<Effect, MOST>::new();
    for (name, values) in numbers.effects {
        effects.push(Effect::from_values(name, values).ok()?).ok()?;
    }
    Damper::new(numbers.nominal, &effects).ok()
}
