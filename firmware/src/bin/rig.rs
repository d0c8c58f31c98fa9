//! The rig on a board, as a node on a line to the board of the locomotive.
//!
//! It answers commands as they arrive and ends with its first run: well where it is back in
//! STANDBY.
#![no_std]
#![no_main]

use can_protocol::RunState;
use core::fmt::Write;
use cortex_m_rt::entry;
use firmware::board::console::{Console, exit};
use firmware::board::timer::Timer;
use firmware::board::uart::Uart;
use firmware::roles::{self, PERIOD_US};
use firmware::setup;

#[entry]
fn main() -> ! {
    exit(run().unwrap_or(false))
}

/// Serves a host; whether its run ended in order.
fn run() -> Option<bool> {
    let mut rig = roles::rig(setup::rig_damper()?);
    let mut line = Uart::start();
    let mut timer = Timer::start(cortex_m::Peripherals::take()?.SYST, PERIOD_US);
    loop {
        cortex_m::asm::wfi();
        rig.poll(&mut line);
        if timer.passed().is_some() {
            rig.tick(&mut line);
        }
        let node = rig.rig();
        let is_back = node.runs() > 0 && node.run_state() == RunState::Standby;
        if is_back || node.is_latched() {
            let (frames, state) = (node.frames(), node.run_state().name());
            let _ = writeln!(Console, "rig {state} after {} commands", frames.received);
            return Some(is_back);
        }
    }
}
