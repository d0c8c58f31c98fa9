//! Runs the locomotive or a part of it, and compares it with the host, bit for bit.
//!
//! The command line of the emulator says what: a group, a name and a number of steps, as
//! `list` shows them. Out comes a line with both hashes; for the locomotive also what each
//! step has cost, and how deep the stack was.
#![no_std]
#![no_main]

use can_protocol::ReceiverState;
use core::fmt::Write;
use cortex_m_rt::entry;
use firmware::board::console::{CommandLine, Console, exit};
use firmware::board::stack;
use firmware::board::stopwatch::Stopwatch;
use firmware::expected::{self, EXPECTED, Expected};
use firmware::setup;
use firmware_core::damper::Damper;
use firmware_core::line::{Line, LineState, SlotState};
use firmware_core::track::{IrregularitySample, Track};
use firmware_core::vehicle::{Vehicle, VehicleState};
use firmware_core::wheel_rail::table::ContactTable;
use same_bits::{codec, compensator, contact, effect, locomotive, state_machine};

#[entry]
fn main() -> ! {
    let line = CommandLine::read();
    let mut words = line.words();
    let group = words.next().unwrap_or_default();
    let name = words.next().unwrap_or_default();
    let steps = words.next().and_then(|word| word.parse().ok()).unwrap_or(0);
    match group {
        "list" => list(),
        "sizes" => sizes(),
        _ => exit(measure(group, name, steps)),
    }
    exit(true)
}

/// Runs it; whether it has the host's hash.
fn measure(group: &str, name: &str, steps: u32) -> bool {
    stack::paint();
    let Some(hash) = run(group, name, steps) else {
        let _ = writeln!(Console, "cannot run {group} {name}");
        return false;
    };
    let host = expected::hash(group, name, steps);
    let verdict = if hash == host { "same" } else { "DIFFERENT" };
    let _ = writeln!(Console, "{group} {name} {steps} {hash:016x} host {host:016x} {verdict}");
    hash == host
}

/// Everything that has a hash of the host's.
fn list() {
    // The roles have images of their own.
    for Expected { group, name, steps, .. } in EXPECTED.iter().filter(|row| row.group != "roles") {
        let _ = writeln!(Console, "{group} {name} {steps}");
    }
}

fn run(group: &str, name: &str, steps: u32) -> Option<u64> {
    match group {
        "creep" => creep(name, steps),
        "window" => window(name, steps),
        "effect" => {
            let number = (0..effect::COUNT).find(|number| effect::name(*number) == name)?;
            effect::run(number, steps)
        }
        "compensator" => compensator::run(name, steps),
        "contact" => Some(contact::run(steps)),
        "state" => Some(state_machine::run(steps)),
        "codec" => codec::run(steps),
        _ => None,
    }
}

/// The locomotive, with what it costs.
#[inline(never)]
fn creep(law: &str, steps: u32) -> Option<u64> {
    let vehicle = setup::changeable_vehicle()?;
    if !locomotive::use_law(vehicle, law) {
        return None;
    }
    let line = setup::line(vehicle)?;
    let state = setup::start(line)?;
    let _ = writeln!(Console, "stack setup {}", stack::deepest());
    stack::paint();
    let mut laps = Laps(Stopwatch::start(cortex_m::Peripherals::take()?.SYST));
    let hash = locomotive::run(line, state, steps, &mut laps);
    let _ = writeln!(Console, "stack steps {}", stack::deepest());
    Some(hash)
}

/// The locomotive on a track that is handed over while it runs.
#[inline(never)]
fn window(law: &str, steps: u32) -> Option<u64> {
    let vehicle = setup::changeable_vehicle()?;
    if !locomotive::use_law(vehicle, law) {
        return None;
    }
    let line = setup::line(vehicle)?;
    let state = setup::start(line)?;
    locomotive::run_in_window(line, setup::window()?, state, steps)
}

/// Bytes of what a board holds.
fn sizes() {
    for (name, bytes) in [
        ("Line", size_of::<Line<'_>>()),
        ("Damper", size_of::<Damper>()),
        ("LineState", size_of::<LineState>()),
        ("SlotState", size_of::<SlotState>()),
        ("VehicleState", size_of::<VehicleState>()),
        ("Vehicle", size_of::<Vehicle>()),
        ("ContactTable", size_of::<ContactTable>()),
        ("Track", size_of::<Track<'_>>()),
        ("IrregularitySample", size_of::<IrregularitySample>()),
        ("ReceiverState", size_of::<ReceiverState>()),
    ] {
        let _ = writeln!(Console, "size {name} {bytes}");
    }
}

/// Prints the ticks of each step.
struct Laps(Stopwatch);

impl locomotive::Watch for Laps {
    fn begins(&mut self) {
        self.0.begin();
    }

    fn ends(&mut self) {
        let ticks = self.0.ticks();
        let _ = writeln!(Console, "ticks {ticks}");
    }
}
