//! The timer that drives a node: one interrupt of `SysTick` is one tick.
//!
//! A tick that comes while the last one is still worked on is late: the next one is told how many
//! were missed, as the loop of the host is.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::interrupt::free;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;

/// Clock of `SysTick` on an MPS2 board (Hz).
const CLOCK_HZ: u32 = 25_000_000;

/// Interrupts so far.
static TICKS: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    TICKS.fetch_add(1, Ordering::Relaxed);
}

/// The running timer.
pub struct Timer {
    seen: u32,
    late: u32,
}

impl Timer {
    /// Starts the timer with a period (us), up to 671 ms.
    pub fn start(mut timer: SYST, period_us: u32) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload((CLOCK_HZ / 1_000_000 * period_us).saturating_sub(1));
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();
        Self { seen: TICKS.load(Ordering::Relaxed), late: 0 }
    }

    /// Waits for the next tick; how many were missed before it.
    pub fn wait(&mut self) -> u32 {
        loop {
            if let Some(missed) = self.passed() {
                return missed;
            }
            // A tick between the look and the sleep wakes the processor, although it is masked.
            free(|_| {
                if TICKS.load(Ordering::Relaxed) == self.seen {
                    cortex_m::asm::wfi();
                }
            });
        }
    }

    /// Whether a tick has come since the last one that was seen; how many were missed before it.
    pub fn passed(&mut self) -> Option<u32> {
        let now = TICKS.load(Ordering::Relaxed);
        let missed = now.wrapping_sub(self.seen).checked_sub(1)?;
        self.seen = now;
        self.late = self.late.saturating_add(missed);
        Some(missed)
    }

    /// Ticks that were missed so far.
    pub fn late(&self) -> u32 {
        self.late
    }
}
