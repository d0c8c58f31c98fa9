//! The locomotive on a board, with its rig and its track server on a loopback in the same program
//! or on a line to another board and a host.
//!
//! The command line says which, `loopback` or `uart`, and how many cycles of RUN. Out comes a line
//! with the trajectory hash and that of the host, and how many ticks came late.
#![no_std]
#![no_main]

use core::fmt::Write;
use cortex_m_rt::entry;
use firmware::board::console::{CommandLine, Console, exit};
use firmware::board::stack;
use firmware::board::timer::Timer;
use firmware::board::uart::Uart;
use firmware::expected;
use firmware::roles::{self, BoardLocomotive, PERIOD_US};
use firmware::setup;
use nodes::locomotive::{End, NotArmed};
use nodes::loopback::Loopback;
use nodes::rig::Plant;
use nodes::timed::TimedRig;
use nodes::track::TrackFault;
use same_bits::Random;

#[entry]
fn main() -> ! {
    let line = CommandLine::read();
    let mut words = line.words();
    let bus = words.next().unwrap_or_default();
    let cycles = words.next().and_then(|word| word.parse().ok()).unwrap_or(0);
    exit(run(bus, cycles).unwrap_or(false))
}

/// Runs it; whether it has the host's hash.
fn run(bus: &str, cycles: u32) -> Option<bool> {
    stack::paint();
    let locomotive = BoardLocomotive::new(cycles)?;
    let _ = writeln!(Console, "stack setup {}", stack::deepest());
    let timer = cortex_m::Peripherals::take()?.SYST;
    let (end, late) = match bus {
        "loopback" => on_a_loopback(roles::rig(locomotive.damper()?), locomotive, timer)?,
        "servo" => on_a_loopback(roles::servo_rig(locomotive.damper()?), locomotive, timer)?,
        "uart" => on_a_line(locomotive, timer)?,
        _ => return None,
    };
    let around = if bus == "servo" { "servo" } else { "loopback" };
    let (hash, host) = (locomotive.hash(), expected::hash("roles", around, cycles));
    let is_same = hash == host && end == End::Completed;
    let verdict = if is_same { "same" } else { "DIFFERENT" };
    let _ = writeln!(Console, "late {late}");
    let _ = writeln!(Console, "stack steps {}", stack::deepest());
    if end != End::Completed {
        if let End::NotArmed(NotArmed::Track(TrackFault::AnotherTrack { found, expected })) = end {
            let _ = writeln!(Console, "track {found:08x}, expected {expected:08x}");
        }
        let how = if end == End::Safe { "in SAFE" } else { "early" };
        let _ = writeln!(Console, "ended {how}");
    }
    let _ = writeln!(Console, "roles {bus} {cycles} {hash:016x} host {host:016x} {verdict}");
    Some(is_same)
}

/// Both roles and the track server in this program.
#[inline(never)]
fn on_a_loopback<P: Plant>(
    mut rig: TimedRig<P, Random>,
    locomotive: &mut BoardLocomotive,
    timer: cortex_m::peripheral::SYST,
) -> Option<(End, u32)> {
    let mut track = setup::track_server()?;
    let wire = Loopback::default();
    let [mut at_locomotive, mut at_rig, mut at_track] = wire.ends();
    stack::paint();
    let mut timer = Timer::start(timer, PERIOD_US);
    loop {
        let skipped = timer.wait();
        locomotive.tick(&mut at_locomotive, skipped);
        rig.tick(&mut at_rig);
        track.tick(&mut at_track);
        if let Some(end) = locomotive.end() {
            return Some((end, timer.late()));
        }
    }
}

/// The rig is another board, the track server a host.
#[inline(never)]
fn on_a_line(
    locomotive: &mut BoardLocomotive,
    timer: cortex_m::peripheral::SYST,
) -> Option<(End, u32)> {
    let mut line = Uart::start();
    stack::paint();
    let mut timer = Timer::start(timer, PERIOD_US);
    loop {
        let skipped = timer.wait();
        locomotive.tick(&mut line, skipped);
        if let Some(end) = locomotive.end() {
            return Some((end, timer.late()));
        }
    }
}
