//! What the physics tests share: scenarios, modelled dampers, runs that are recorded.

use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use scenario::run::{Overrides, Run, Slot, SlotForce};
use scenario::source::Source;
use std::path::{Path, PathBuf};

/// A scenario that is shipped.
pub(crate) fn scenario(name: &str) -> Run {
    Run::load(&folder().join(name), Overrides::default()).unwrap()
}

/// A scenario from its text, as if its file were in the folder of the shipped ones.
pub(crate) fn scenario_from(text: &str) -> Run {
    let source = Source::from_text(&folder().join("test.toml"), text);
    Run::from_source(&source, Overrides::default()).unwrap()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

/// The contact table of a run on profiles.
pub(crate) fn table(run: &Run) -> &ContactTable {
    &run.contact.as_ref().unwrap().table
}

/// The dampers of a run; one that is on a rig is taken from the next slot that is modelled.
pub(crate) fn dampers(run: &Run) -> Vec<Damper> {
    let modelled = run.slots.iter().find_map(|slot| match &slot.force {
        SlotForce::Modelled(damper) => Some(damper.clone()),
        SlotForce::Rig { .. } | SlotForce::StandIn { .. } => None,
    });
    let of_slot = |slot: &Slot| match &slot.force {
        SlotForce::Modelled(damper) => damper.clone(),
        SlotForce::Rig { .. } | SlotForce::StandIn { .. } => modelled.clone().unwrap(),
    };
    run.slots.iter().map(of_slot).collect()
}

/// Modelled dampers for vehicles in lanes, apart from the line.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Modelled<const L: usize> {
    pub(crate) dampers: Vec<[Damper; L]>,
    pub(crate) states: [[DamperState; L]; DAMPER_SLOTS],
}

impl<const L: usize> Modelled<L> {
    pub(crate) fn new(dampers: Vec<[Damper; L]>) -> Self {
        Self { dampers, states: [[DamperState::rest(); L]; DAMPER_SLOTS] }
    }
}

impl<const L: usize> DamperForces for Modelled<L> {
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        let motion = Motion::new(extension_m, rate_m_per_s);
        self.dampers[slot][lane].advance(&mut self.states[slot][lane], motion, substep_s)
    }
}

/// Lateral force of both rails on a wheelset (N), right positive.
pub(crate) fn axle_force_n(state: &VehicleState, axle: usize) -> f64 {
    let [[left], [right]] = &state.wheels[axle];
    right.lateral_n - left.lateral_n
}

/// Sum of the vertical forces on all wheels (N), up positive.
pub(crate) fn carried_n(vehicle: &Vehicle, state: &VehicleState) -> f64 {
    let wheels = state.wheels.iter().take(vehicle.axles.len()).flatten().flatten();
    wheels.map(|wheel| -wheel.vertical_n).sum()
}
