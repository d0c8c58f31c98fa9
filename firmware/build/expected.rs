//! The hashes of the runs of `same-bits` on the host that builds the image.

use firmware_core::line::{Fade, Line, Slot};
use firmware_core::vehicle::DAMPER_SLOTS;
use same_bits::{codec, compensator, effect, locomotive, state_machine};
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

/// The locomotive with modelled dampers in all slots.
#[expect(clippy::large_stack_arrays, reason = "four dampers, on a host")]
fn creep(run: &Run, law: &str, steps: u32) -> u64 {
    let mut vehicle = run.vehicle.clone();
    assert!(locomotive::use_law(&mut vehicle, law), "no {law}");
    let track = run.track.view();
    let mut slots = [const { Slot::Empty }; DAMPER_SLOTS];
    for (slot, place) in slots.iter_mut().zip(&run.slots) {
        let damper = match &place.force {
            SlotForce::Modelled(damper) => damper,
            SlotForce::Rig { model, .. } | SlotForce::StandIn { model, .. } => model,
        };
        *slot = Slot::Modelled(damper.clone().prepared(CYCLE_S / f64::from(run.substeps)));
    }
    let line = Line {
        vehicle: &vehicle,
        track: &track,
        contact: run.contact.as_ref().map(|contact| &*contact.table),
        speed_m_per_s: run.speed_m_per_s,
        cycle_s: CYCLE_S,
        substeps: run.substeps,
        slots,
        fade: Fade::default(),
    };
    locomotive::run(&line, &mut line.start(run.start.state.clone()), steps, &mut ())
}
