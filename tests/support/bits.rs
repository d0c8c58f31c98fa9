//! Hashes of what computes, without a bench around it: the golden test compares them in the build
//! of the tests, the example `bits` of `scenario` in others.

#![allow(clippy::unwrap_used, clippy::large_stack_arrays, reason = "a test may fail loudly")]

use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, DamperState, Effect, Motion, Nominal};
use firmware_core::fnv;
use firmware_core::guard::ForceInput;
use firmware_core::lanes::Lanes;
use firmware_core::line::{Fade, Line, Slot};
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::creep::{ConicalPrescribed, CreepLaw, Creepage, Fastsim, Patch};
use scenario::run::{CYCLE_S, Overrides, Run};
use std::collections::BTreeMap;
use std::path::Path;

fn hash(values: impl IntoIterator<Item = f64>) -> String {
    let hash = values.into_iter().fold(fnv::START, |hash, value| fnv::add(hash, value.to_bits()));
    format!("{hash:016x}")
}

/// Each creep law over a grid of creepages that reaches from pure creep into full sliding.
pub(crate) fn creep_laws() -> BTreeMap<String, String> {
    let patch = Patch {
        normal_n: 110e3,
        along_m: 7e-3,
        across_m: 5e-3,
        c11: 4.6,
        c22: 4.2,
        c23: 2.1,
        shear_modulus_pa: 8.0e10,
        friction: 0.3,
    };
    let prescribed = ConicalPrescribed { shear_force_n: 8.8e6, psi: 0.54, phi: 0.6 };
    let laws = [
        ("linear_saturated", CreepLaw::LinearSaturated),
        ("polach", CreepLaw::Polach),
        ("fastsim", CreepLaw::Fastsim(Fastsim::new(10, 10).unwrap())),
        ("conical_prescribed", CreepLaw::ConicalPrescribed(prescribed)),
    ];
    let steps = [-1e-2, -2e-3, -3e-4, 0.0, 1e-4, 1e-3, 2e-2];
    laws.into_iter()
        .map(|(name, law)| {
            let mut forces = Vec::new();
            for longitudinal in steps {
                for lateral in steps {
                    for spin_per_m in [-0.5, 0.0, 0.1] {
                        let force =
                            law.force(&patch, Creepage { longitudinal, lateral, spin_per_m });
                        forces.extend([
                            force.longitudinal_n,
                            force.lateral_n,
                            force.spin_moment_n_m,
                        ]);
                    }
                }
            }
            (name.to_owned(), hash(forces))
        })
        .collect()
}

/// Each effect alone at its usual size, for two seconds of two sines of 1.5 and 7 Hz.
pub(crate) fn effects() -> BTreeMap<String, String> {
    let force = |effects: &[Effect]| {
        let step_s = 1e-3;
        let damper = Damper::new(Nominal::NEW, effects).unwrap().prepared(step_s);
        let motion = |step: u32| {
            let at_s = f64::from(step) * step_s;
            let sine = |size_m: f64, hz: f64| {
                let omega = 2.0 * core::f64::consts::PI * hz;
                let (sin, cos) = libm::sincos(omega * at_s);
                (size_m * sin, size_m * omega * cos)
            };
            let (slow, fast) = (sine(8e-3, 1.5), sine(0.8e-3, 7.0));
            Motion::new(slow.0 + fast.0, slow.1 + fast.1)
        };
        let mut state = DamperState::starting(motion(0));
        let forces = (1..=2000).map(|step| damper.advance(&mut state, motion(step), step_s));
        hash(forces.collect::<Vec<_>>())
    };
    let scale = Nominal::NEW.scale();
    let mut table: BTreeMap<String, String> = CATALOGUE
        .iter()
        .map(|info| {
            let usual: Vec<f64> = info.parameters.iter().map(|row| row.usual(&scale)).collect();
            (info.name.to_owned(), force(&[Effect::from_values(info.name, &usual).unwrap()]))
        })
        .collect();
    table.insert("none".into(), force(&[]));
    table
}

/// Cycles of each vehicle.
const CYCLES: usize = 1000;

/// The trajectory of a vehicle with each creep law on straight and curved track, every damper
/// modelled, and of four side by side.
pub(crate) fn vehicles(root: &Path) -> BTreeMap<String, String> {
    let laws = [
        ("linear_saturated", CreepLaw::LinearSaturated),
        ("polach", CreepLaw::Polach),
        ("fastsim", CreepLaw::Fastsim(Fastsim::new(10, 10).unwrap())),
    ];
    let mut found = BTreeMap::new();
    for name in ["ss9-160kmh", "ss9-curve-400m"] {
        let overrides = Overrides { duration_s: Some(5.0), ..Overrides::default() };
        let path = root.join("scenarios").join(name).with_extension("toml");
        let run = Run::load(&path, overrides).unwrap_or_else(|error| panic!("{error}"));
        for (law, creep) in laws {
            let mut vehicle = run.vehicle.clone();
            vehicle.axles.iter_mut().for_each(|axle| axle.wheel.creep = creep);
            found.insert(format!("{name}-{law}"), alone(&run, &vehicle));
            if run.track.layout.is_tangent() {
                found.insert(format!("{name}-{law}-batch"), side_by_side(&run, &vehicle));
            }
        }
    }
    found
}

fn alone(run: &Run, vehicle: &Vehicle) -> String {
    let track = run.track.view();
    let damper = run.rig.damper.clone().prepared(CYCLE_S / f64::from(run.substeps));
    let line = Line {
        vehicle,
        track: &track,
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        speed_m_per_s: run.speed_m_per_s,
        cycle_s: CYCLE_S,
        substeps: run.substeps,
        slots: std::array::from_fn(|_| Slot::Modelled(damper.clone())),
        fade: Fade::default(),
    };
    let mut state = line.start(run.start.state.clone());
    let mut hash = fnv::START;
    for _ in 0..CYCLES {
        line.step(&mut state, &[ForceInput::Missing; DAMPER_SLOTS]);
        hash = state.hashed(hash, vehicle);
    }
    assert!(!state.is_safe(), "a vehicle that runs");
    format!("{hash:016x}")
}

/// Vehicles side by side.
const LANES: usize = 4;

/// The dampers of vehicles side by side.
struct Dampers {
    damper: Damper,
    states: [[DamperState; LANES]; DAMPER_SLOTS],
}

impl DamperForces for Dampers {
    fn force_n(&mut self, slot: usize, lane: usize, m: f64, m_per_s: f64, substep_s: f64) -> f64 {
        self.damper.advance(&mut self.states[slot][lane], Motion::new(m, m_per_s), substep_s)
    }
}

/// At different speeds and places of the track.
fn side_by_side(run: &Run, vehicle: &Vehicle) -> String {
    let track = run.track.view();
    let substep_s = CYCLE_S / f64::from(run.substeps);
    let running = Running {
        speed_m_per_s: Lanes([0.8, 1.0, 1.1, 1.2].map(|share| share * run.speed_m_per_s)),
        tracks: [&track; LANES],
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        substep_s,
    };
    let mut state = VehicleState::<LANES>::default();
    for (lane, distance_m) in [0.0, 3.0, 7.0, 11.0].into_iter().enumerate() {
        state.put(lane, &run.start.state);
        state.distance_m.set_lane(lane, distance_m);
    }
    let states = [[DamperState::rest(); LANES]; DAMPER_SLOTS];
    let damper = run.rig.damper.clone().prepared(substep_s);
    let mut dampers = Dampers { damper, states };
    vehicle.start(&mut state, &running);
    let mut seen = Vec::new();
    for _ in 0..CYCLES {
        vehicle.step(&mut state, &running, &mut dampers, run.substeps);
        seen.extend(state.position.iter().flatten().chain(&state.damper_n).flat_map(|v| v.0));
    }
    hash(seen)
}
