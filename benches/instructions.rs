//! So many cycles of the vehicle step and nothing else, for a tool that counts instructions:
//! `cargo xtask instructions` runs it under callgrind with two numbers of cycles and takes the
//! difference. Time is measured by the other benches.

use firmware_core::damper::{Damper, DamperState, Motion};
use firmware_core::guard::ForceInput;
use firmware_core::lanes::Lanes;
use firmware_core::line::{Line, Slot};
use firmware_core::supervision::{Arrival, Belief, Checks, Event, Growth, Measured};
use firmware_core::vehicle::{DAMPER_SLOTS, DamperForces, Running, Vehicle, VehicleState};
use firmware_core::wheel_rail::creep::{CreepLaw, Fastsim};
use scenario::run::{CYCLE_S, Overrides, Run};
use std::hint::black_box;
use std::path::Path;

/// Cycles before the count begins to matter: the vehicle is on rough track.
const BEFORE: u32 = 1000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (kind, cycles) = match words.as_slice() {
        [kind @ ("step" | "rig" | "polach" | "fastsim" | "batch"), cycles, ..] => {
            (*kind, cycles.parse().unwrap_or(0))
        }
        // As `cargo bench` starts it.
        _ => return println!("counts nothing by itself: cargo xtask instructions"),
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/ss9-160kmh.toml");
    let overrides = Overrides { duration_s: Some(20.0), ..Overrides::default() };
    let run = Run::load(&path, overrides).unwrap_or_else(|error| panic!("{error}"));
    let track = run.track.view();
    let mut line = hil_host::run::line(&run, &track);
    let mut vehicle = run.vehicle.clone();
    let law = match kind {
        "polach" => Some(CreepLaw::Polach),
        "fastsim" => Fastsim::new(10, 10).map(CreepLaw::Fastsim),
        _ => None,
    };
    for axle in &mut vehicle.axles {
        axle.wheel.creep = law.unwrap_or(axle.wheel.creep);
    }
    line.vehicle = &vehicle;
    match kind {
        "rig" => on_a_rig(&run, &line, BEFORE + cycles),
        "batch" => batch(&run, &line, BEFORE + cycles),
        _ => modelled(&run, line, BEFORE + cycles),
    }
}

/// All four dampers modelled.
fn modelled(run: &Run, mut line: Line<'_>, cycles: u32) {
    line.slots.iter_mut().for_each(Slot::use_model);
    let mut state = line.start(run.start.state.clone());
    for _ in 0..cycles {
        line.step(black_box(&mut state), &[ForceInput::Missing; 4]);
    }
    black_box(state);
}

/// Vehicles side by side.
const LANES: usize = 4;

/// The dampers of every vehicle of a batch.
struct Dampers {
    damper: Damper,
    states: [[DamperState; LANES]; DAMPER_SLOTS],
}

impl DamperForces for Dampers {
    fn force_n(
        &mut self,
        slot: usize,
        lane: usize,
        extension_m: f64,
        rate_m_per_s: f64,
        substep_s: f64,
    ) -> f64 {
        let motion = Motion::new(extension_m, rate_m_per_s);
        self.damper.advance(&mut self.states[slot][lane], motion, substep_s)
    }
}

/// Four vehicles side by side, each at another place of the track.
fn batch(run: &Run, line: &Line<'_>, cycles: u32) {
    let vehicle: &Vehicle = line.vehicle;
    let substep_s = CYCLE_S / f64::from(run.substeps);
    let running = Running {
        speed_m_per_s: Lanes([run.speed_m_per_s; LANES]),
        tracks: [line.track; LANES],
        contact: line.contact,
        substep_s,
    };
    let start = &run.start.state;
    let mut state = VehicleState::<LANES> {
        distance_m: Lanes([0.0, 3.0, 7.0, 11.0]),
        position: start.position.map(|pose| pose.map(|value| Lanes::splat(value.lane(0)))),
        rail_position: start
            .rail_position
            .map(|rails| rails.map(|rail| rail.map(|value| Lanes::splat(value.lane(0))))),
        ..VehicleState::default()
    };
    let mut dampers = Dampers {
        damper: run.rig.damper.clone().prepared(substep_s),
        states: std::array::from_fn(|_| std::array::from_fn(|_| DamperState::rest())),
    };
    vehicle.start(&mut state, &running);
    for _ in 0..cycles {
        vehicle.step(black_box(&mut state), &running, &mut dampers, run.substeps);
    }
    assert!(state.is_finite(), "a batch that runs");
    black_box(state);
}

/// One of them on a rig that follows at once, with all checks of what is believed. The damper that
/// answers in place of a rig costs as much as the modelled one whose place it takes.
fn on_a_rig(run: &Run, line: &Line<'_>, cycles: u32) {
    let damper: Damper = run.rig.damper.clone().prepared(CYCLE_S);
    let mut mounted = DamperState::rest();
    let mut state = line.start(run.start.state.clone());
    state.on(Event::Agreed);
    state.on(Event::Arm);
    line.couple(&mut state, [0.0; 4]).unwrap_or_else(|far| panic!("{far:?}"));
    let checks = Checks::usual(15, CYCLE_S, 100e3);
    let (mut belief, mut growth) = (Belief::default(), Growth::default());
    belief.begin(state.slots[0].command);
    let mut counter = 0;
    for _ in 0..cycles {
        let command = state.slots[0].command;
        belief.sent(command);
        let force_n =
            damper.advance(&mut mounted, Motion::new(command.displacement_m, 0.0), CYCLE_S);
        let measured = Measured {
            counter,
            echo: Some(counter),
            displacement_m: Some(command.displacement_m),
            force_n: Some(force_n),
            is_valid: true,
            runs: true,
        };
        let input = belief.take(&checks, Arrival::Frame(measured), Some(counter));
        black_box(growth.take(command.displacement_m, 0.1));
        let mut inputs = [ForceInput::Missing; 4];
        inputs[0] = input;
        line.step(black_box(&mut state), &inputs);
        counter = (counter + 1) % 15;
    }
    assert!(belief.cause().is_none(), "a sound rig: {:?}", belief.cause());
    black_box(state);
}
