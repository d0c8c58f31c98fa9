//! Time in cycles of the processor's clock, from the `SysTick` timer.
//!
//! The MPS2 boards clock `SysTick` with 25 MHz. QEMU counts one instruction as 1 ns with
//! `-icount shift=0`, so a tick there is [`INSTRUCTIONS_PER_TICK`] instructions; it has no cycle
//! counter (DWT) of its own.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// Instructions in one tick of an MPS2 in QEMU.
pub const INSTRUCTIONS_PER_TICK: u32 = 40;

/// The timer counts down in 24 bits.
const MASK: u32 = 0x00ff_ffff;

/// The running timer.
pub struct Stopwatch(u32);

impl Stopwatch {
    /// Starts the timer, which has no other user.
    pub fn start(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(MASK);
        timer.clear_current();
        timer.enable_counter();
        Self(SYST::get_current())
    }

    /// Begins a lap.
    #[inline]
    pub fn begin(&mut self) {
        self.0 = SYST::get_current();
    }

    /// Ticks since then, if they are less than the timer's whole range: 16.7 million.
    #[inline]
    pub fn ticks(&self) -> u32 {
        self.0.wrapping_sub(SYST::get_current()) & MASK
    }
}
