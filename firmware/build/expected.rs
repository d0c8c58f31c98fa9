//! The hashes of the runs of `same-bits` on the host that builds the image.

use crate::setup;
use firmware_core::line::{Fade, Line, RigSlot, Slot};
use firmware_core::supervision::CommandLimits;
use firmware_core::track::{Irregularity, IrregularitySample, Track};
use firmware_core::vehicle::{DAMPER_SLOTS, Vehicle};
use nodes::rig::{ModelSetup, SUBSTEPS};
use nodes::track::{as_sent, there_and_back};
use same_bits::{codec, compensator, contact, effect, locomotive, state_machine, two_roles};
use scenario::run::{CYCLE_S, Run, SlotForce};
use std::fmt::Write;

/// Steps of the locomotive: in every test run, and in the long one.
const LOCOMOTIVE_STEPS: [u32; 2] = [1_000, 10_000];

/// Steps of everything else.
const STEPS: u32 = 10_000;

/// The source of `expected.rs`.
pub(crate) fn source(run: &Run) -> String {
    let mut rows = Vec::new();
    for law in locomotive::LAWS {
        for steps in LOCOMOTIVE_STEPS {
            rows.push(("creep", law, steps, creep(run, law, steps)));
        }
    }
    // On the track as a whole here, through a window there.
    let [law, ..] = locomotive::LAWS;
    rows.push(("window", law, STEPS, creep(run, law, STEPS)));
    for number in 0..effect::COUNT {
        let name = effect::name(number);
        let hash = effect::run(number, STEPS).unwrap_or_else(|| panic!("{name}: no damper"));
        rows.push(("effect", name, STEPS, hash));
    }
    for name in compensator::NAMES {
        let hash = compensator::run(name, STEPS).unwrap_or_else(|| panic!("no {name}"));
        rows.push(("compensator", name, STEPS, hash));
    }
    let track = long_track(run);
    for cycles in two_roles::CYCLES {
        rows.push(("roles", "loopback", cycles, roles(run, &track, cycles, Around::Model)));
    }
    let [short, _] = two_roles::CYCLES;
    rows.push(("roles", "servo", short, roles(run, &track, short, Around::Servo)));
    rows.push(("contact", "rows", STEPS, contact::run(STEPS)));
    rows.push(("state", "machine", STEPS, state_machine::run(STEPS)));
    rows.push(("codec", "all", STEPS, codec::run(STEPS).unwrap_or_else(|| panic!("no node"))));
    let mut text = String::from("/// All of them.\npub static EXPECTED: &[Expected] = &[\n");
    for (group, name, steps, hash) in rows {
        let fields = format!("group: {group:?}, name: {name:?}, steps: {steps}, hash: {hash:#x}");
        let _ = writeln!(text, "    Expected {{ {fields} }},");
    }
    text.push_str("];\n");
    text
}

/// Cycles before and after those of RUN: four fades of half a second, and reserve.
const FADES: u32 = 4_000;

/// The track as it travels, there and back, for the longest run of both roles.
fn long_track(run: &Run) -> Vec<IrregularitySample> {
    let samples = &run.track.samples;
    let longest = two_roles::CYCLES.into_iter().max().unwrap_or(0) + FADES;
    let way_m = f64::from(longest) * CYCLE_S * run.speed_m_per_s;
    let more = (way_m / samples.step_m) as usize;
    let numbers = 0..samples.samples.len() + more;
    let sample = |place| {
        let number = there_and_back(place as u32, samples.samples.len() as u32) as usize;
        as_sent(&samples.samples[number]).unwrap_or_else(|| panic!("{number} does not travel"))
    };
    numbers.map(sample).collect()
}

/// What the node of the rig has around it.
#[derive(Clone, Copy)]
enum Around {
    Model,
    Servo,
}

/// The locomotive and the rig as nodes of one bus.
fn roles(run: &Run, samples: &[IrregularitySample], cycles: u32, around: Around) -> u64 {
    let irregularity = Irregularity { samples, ..run.track.view().irregularity };
    let track = Track { irregularity, ..run.track.view() };
    let mut line = line(run, &run.vehicle, &track);
    let limits = CommandLimits {
        stroke_m: run.motion.stroke_m,
        velocity_m_per_s: run.motion.velocity_m_per_s,
        acceleration_m_per_s2: run.motion.acceleration_m_per_s2,
    };
    if let Some(slot) = line.slots.get_mut(two_roles::SLOT)
        && let Slot::Modelled(model) = slot
    {
        let (model, compensator) = (model.clone(), setup::compensator(run));
        *slot = Slot::Rig(RigSlot::new(model, compensator, limits, CYCLE_S));
    }
    let ramp_cycles = run.motion.ramp_cycles;
    line.fade =
        Fade { motion_cycles: ramp_cycles, measuring_cycles: 0, coupling_cycles: ramp_cycles };
    let damper = run.rig.damper.clone().prepared(CYCLE_S / f64::from(SUBSTEPS));
    let setup = ModelSetup {
        damper: &damper,
        stroke_m: run.rig.stroke_m,
        rate_m_per_s: run.rig.rate_m_per_s,
        lag_s: run.rig.lag_s,
        seed: 1,
    };
    let mut state = line.start(run.start.state.clone());
    let hash = match around {
        Around::Model => two_roles::run(&line, &mut state, two_roles::rig(&setup), cycles),
        Around::Servo => {
            let rig = two_roles::behind_servo(&setup, CYCLE_S);
            two_roles::run(&line, &mut state, rig, cycles)
        }
    };
    hash.unwrap_or_else(|| panic!("the roles ended before {cycles} cycles"))
}

/// The locomotive with modelled dampers in all slots.
fn creep(run: &Run, law: &str, steps: u32) -> u64 {
    let mut vehicle = run.vehicle.clone();
    assert!(locomotive::use_law(&mut vehicle, law), "no {law}");
    let track = run.track.view();
    let line = line(run, &vehicle, &track);
    locomotive::run(&line, &mut line.start(run.start.state.clone()), steps, &mut ())
}

/// The line of the scenario with a modelled damper in every slot.
#[expect(clippy::large_stack_arrays, reason = "four dampers, on a host")]
fn line<'a>(run: &'a Run, vehicle: &'a Vehicle, track: &'a Track<'a>) -> Line<'a> {
    let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
    for (slot, place) in slots.iter_mut().zip(&run.slots) {
        let damper = match &place.force {
            SlotForce::Modelled(damper) => damper,
            SlotForce::Rig { model, .. } | SlotForce::StandIn { model, .. } => model,
        };
        *slot = Slot::Modelled(damper.clone().prepared(CYCLE_S / f64::from(run.substeps)));
    }
    Line {
        vehicle,
        track,
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        speed_m_per_s: run.speed_m_per_s,
        cycle_s: CYCLE_S,
        substeps: run.substeps,
        slots,
        fade: Fade::default(),
    }
}
