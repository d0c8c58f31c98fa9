//! The core on a Cortex-M7, with no way to panic, by proof of the linker.
//!
//! The panic handler calls a function that does not exist: while the optimiser can prove every
//! panic away the handler is dead and falls out; a single remaining path keeps it, and the image
//! does not link. There is no allocator, so a heap would stop the build even earlier. This holds
//! for every image of this crate:
//!
//! - `proof` calls every entry point of `firmware-core` and `can-protocol`, with inputs that the
//!   compiler cannot see through;
//! - `locomotive` and `rig` are the two roles on a bus ([`roles`]);
//! - `measure` runs the locomotive and its parts, compares each with the host's hash, and counts.
//!
//! [`setup`] is the scenario in flash, [`board`] what touches hardware.
#![no_std]

pub mod board;
pub mod expected;
pub mod roles;
pub mod setup;

use core::panic::PanicInfo;

/// Must not be reachable.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    #[expect(unsafe_code, reason = "a name for the linker to miss")]
    unsafe extern "C" {
        safe fn there_is_a_way_to_panic() -> !;
    }
    there_is_a_way_to_panic()
}
