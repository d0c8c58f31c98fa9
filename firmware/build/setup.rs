//! The set-up of a run as Rust source.
//!
//! What the core can be given as it is stands there as a constant: the vehicle, the contact table,
//! samples of the track, the state to start from. Dampers are built from their numbers, as
//! anywhere.

use crate::literal::Literal;
use firmware_core::compensation::Compensator;
use firmware_core::damper::{Damper, Effect};
use firmware_core::track::Layout;
use nodes::track::{Identity, Ways};
use same_bits::two_roles;
use scenario::run::{CYCLE_S, Run, SlotForce};
use std::fmt::Write;

/// The source of `setup.rs`.
pub(crate) fn source(run: &Run) -> String {
    let contact = run.contact.as_ref().unwrap_or_else(|| panic!("no wheels on profiles"));
    assert!(run.track.layout == Layout::tangent(), "only a straight track is taken to a board");
    let samples = &run.track.samples;
    assert!((samples.before, samples.behind) == (0, 0), "only a whole track is taken to a board");
    let mut text = String::new();
    let mut number = |name: &str, about: &str, value: f64| {
        put(&mut text, about, &format!("pub(crate) const {name}: f64 = {}", value.literal()));
    };
    number("SPEED_M_PER_S", "Running speed (m/s).", run.speed_m_per_s);
    number("CYCLE_S", "Length of a cycle (s).", CYCLE_S);
    number("TRACK_FIRST_M", "Distance of the first sample (m).", samples.first_m);
    number("TRACK_STEP_M", "Distance between samples (m).", samples.step_m);
    let fingerprint = Identity::of(&run.track.view().irregularity, Ways::ThereAndBack)
        .unwrap_or_else(|e| panic!("{e}"))
        .fingerprint;
    number("STROKE_M", "Largest displacement of a command (m).", run.motion.stroke_m);
    let most = run.motion.velocity_m_per_s;
    number("VELOCITY_M_PER_S", "Largest speed of a command (m/s).", most);
    let most = run.motion.acceleration_m_per_s2;
    number("ACCELERATION_M_PER_S2", "Largest acceleration of a command (m/s2).", most);
    number("RIG_STROKE_M", "Largest travel of the rig (m).", run.rig.stroke_m);
    number("RIG_RATE_M_PER_S", "Largest speed of the rig (m/s).", run.rig.rate_m_per_s);
    number("RIG_LAG_S", "Time constant of the rig (s).", run.rig.lag_s);
    let fingerprint = format!("const TRACK_FINGERPRINT: u32 = {fingerprint:#010x}");
    put(&mut text, "The track there and back, as it travels.", &fingerprint);
    let ramp = format!("const RAMP_CYCLES: u32 = {}", run.motion.ramp_cycles);
    put(&mut text, "Cycles of a fade.", &ramp);
    let compensator = format!("const COMPENSATOR: Compensator = {}", compensator(run).literal());
    put(&mut text, "How the delay of the rig is compensated.", &compensator);
    let damper_on_rig = format!("static RIG_DAMPER: Numbers = {}", numbers(&run.rig.damper));
    put(&mut text, "The damper on the rig.", &damper_on_rig);
    let substeps = format!("const SUBSTEPS: u32 = {}", run.substeps);
    put(&mut text, "Substeps per cycle.", &substeps);
    let about = "Contact of a wheel on a rail.";
    let table = contact.table.literal();
    put(&mut text, about, &format!("static TABLE: ContactTable = {table}"));
    let count = samples.samples.len();
    let list = samples.samples.literal();
    let about = "Irregularity along the track.";
    put(
        &mut text,
        about,
        &format!("pub(crate) static SAMPLES: [IrregularitySample; {count}] = {list}"),
    );
    let start = run.start.state.literal().replacen("OneVehicle", "VehicleState", 1);
    put(&mut text, "Steady running.", &format!("const START: VehicleState = {start}"));
    let dampers: Vec<String> = run.slots.iter().map(|slot| damper(&slot.force)).collect();
    let list = format!("static DAMPERS: [Numbers; {}] = [{}]", dampers.len(), dampers.join(", "));
    put(&mut text, "The dampers in their slots.", &list);
    let vehicle = run.vehicle.literal();
    put(&mut text, "The vehicle.", &format!("const THE_VEHICLE: Vehicle = {vehicle}"));
    text
}

fn put(text: &mut String, about: &str, item: &str) {
    let _ = writeln!(text, "/// {about}\n{item};");
}

/// How the delay of the rig is compensated.
pub(crate) fn compensator(run: &Run) -> Compensator {
    match run.slots.get(two_roles::SLOT).map(|slot| &slot.force) {
        Some(SlotForce::Rig { compensator, .. }) => *compensator,
        _ => panic!("no rig in slot {}", two_roles::SLOT),
    }
}

/// The damper in a slot; of one on a rig its model.
fn damper(force: &SlotForce) -> String {
    let damper: &Damper = match force {
        SlotForce::Modelled(damper) => damper,
        SlotForce::Rig { model, .. } | SlotForce::StandIn { model, .. } => model,
    };
    numbers(damper)
}

/// What a damper is made from.
fn numbers(damper: &Damper) -> String {
    assert!(damper.empirical().is_none(), "no empirical map is taken to a board");
    let effect = |effect: &Effect| format!("({:?}, &{})", effect.name(), effect.values().literal());
    let effects: Vec<String> = damper.effects().iter().map(effect).collect();
    let nominal = damper.nominal().literal();
    format!("Numbers {{ nominal: {nominal}, effects: &[{}] }}", effects.join(", "))
}
