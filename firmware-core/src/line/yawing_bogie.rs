//! A bogie that does nothing but yaw, with two dampers and what measures their forces: the line
//! with rigs in a closed form, for its tests.

use super::{Fade, Line, LineState, RigSlot, Slot, StandIn};
use crate::command::Command;
use crate::compensation::Compensator;
use crate::damper::{Damper, DamperState, Motion, Nominal};
use crate::guard::ForceInput;
use crate::lanes::Lanes;
use crate::supervision::{CommandLimits, Event};
use crate::track::Track;
use crate::vehicle::{
    Anchor, Body, BodyId, DAMPER_SLOTS, DamperMount, Torsion, Vehicle, VehicleState, YAW,
};
use nalgebra::Vector3;

pub(super) const CYCLE_S: f64 = 1e-3;
const INERTIA_KG_M2: f64 = 12e3;
/// Lateral distance of either damper from the middle (m).
const OFF_M: f64 = 1.4;

/// A damper without relief, whose force is linear but for its clearance.
pub(super) fn damper() -> Damper {
    let nominal = Nominal { ce_n_s_per_m: 30e3, f_relief_n: 6e3, ..Nominal::NEW };
    let Ok(damper) = Damper::new(nominal, &[]) else { panic!("a damper") };
    damper
}

pub(super) fn rig() -> Slot<'static> {
    Slot::Rig(RigSlot {
        model: damper().prepared(CYCLE_S / 4.0),
        wear: None,
        compensator: Compensator::None,
        limits: CommandLimits { stroke_m: 0.1, velocity_m_per_s: 1.0, acceleration_m_per_s2: 1e3 },
    })
}

pub(super) fn stands_in(is_reversed: bool) -> Slot<'static> {
    Slot::StandIn(StandIn { model: damper().prepared(CYCLE_S / 4.0), of: 0, is_reversed })
}

/// A bogie on a torsion spring of 3 Hz, a damper to either side.
pub(super) fn bogie() -> Vehicle {
    let Some(body) = BodyId::new(0) else { panic!("a body") };
    let mut vehicle = Vehicle::default();
    let bogie = Body {
        mass_kg: 8e3,
        inertia_kg_m2: [4e3, INERTIA_KG_M2, INERTIA_KG_M2],
        free: [false, false, false, false, true],
        station_m: 0.0,
        height_m: 0.0,
        rolling_radius_m: None,
    };
    let omega = core::f64::consts::TAU * 3.0;
    let spring = Torsion {
        first: BodyId::GROUND,
        second: body,
        stiffness_n_m_per_rad: [0.0, 0.0, INERTIA_KG_M2 * omega * omega],
        damping_n_m_s_per_rad: [0.0; 3],
    };
    let fits = vehicle.bodies.push(bogie).is_ok() && vehicle.torsions.push(spring).is_ok();
    assert!(fits);
    for lateral_m in [-OFF_M, OFF_M] {
        let end = |body| Anchor { body, point_m: Vector3::new(0.0, lateral_m, 0.0) };
        let mount =
            DamperMount { first: end(BodyId::GROUND), second: end(body), direction: Vector3::x() };
        assert!(vehicle.dampers.push(mount).is_ok());
    }
    vehicle
}

/// A line that has been coupled with the bogie turned by 2 mrad, and the dampers on its rigs: one
/// in slot 0, and perhaps a second.
pub(super) struct Coupled<'a> {
    pub(super) line: Line<'a>,
    pub(super) state: LineState,
    mounted: [DamperState; DAMPER_SLOTS],
    on_rigs: Damper,
}

impl<'a> Coupled<'a> {
    pub(super) fn new(
        vehicle: &'a Vehicle,
        track: &'a Track<'a>,
        second: Slot<'a>,
        fade: Fade,
    ) -> Self {
        let mut all = core::array::from_fn(|_| Slot::Empty);
        (all[0], all[1]) = (rig(), second);
        let line = Line {
            vehicle,
            track,
            contact: None,
            speed_m_per_s: 0.0,
            cycle_s: CYCLE_S,
            substeps: 4,
            slots: all,
            fade,
        };
        let mut state = line.start(VehicleState::default());
        state.on(Event::Agreed);
        state.on(Event::Arm);
        assert!(line.couple(&mut state, [0.0; DAMPER_SLOTS]).is_ok());
        state.vehicle.position[0][YAW] = Lanes([2e-3]);
        let mounted = [DamperState::rest(); DAMPER_SLOTS];
        Self { line, state, mounted, on_rigs: damper().prepared(CYCLE_S) }
    }

    /// One cycle; every rig follows its last command at once. `change` is what a rig shows in place
    /// of its force (N).
    pub(super) fn cycle(&mut self, change: impl Fn(usize, f64) -> ForceInput) {
        let mut inputs = [ForceInput::Missing; DAMPER_SLOTS];
        for (slot, input) in inputs.iter_mut().enumerate() {
            if !matches!(self.line.slots[slot], Slot::Rig(_)) {
                continue;
            }
            let Command { displacement_m, velocity_m_per_s } = self.state.slots[slot].command;
            let motion = Motion::new(displacement_m, velocity_m_per_s);
            let force_n = self.on_rigs.advance(&mut self.mounted[slot], motion, CYCLE_S);
            *input = change(slot, force_n);
        }
        self.line.step(&mut self.state, &inputs);
    }

    pub(super) fn yaw_rad(&self) -> f64 {
        self.state.vehicle.position[0][YAW].lane(0)
    }

    /// The force that the vehicle feels in a slot (N).
    pub(super) fn force_n(&self, slot: usize) -> f64 {
        self.state.vehicle.damper_n[slot].lane(0)
    }
}
