//! The core as a Cortex-M7 image that has no way to panic, by proof of the linker.
//!
//! The image calls the entry points of `firmware-core` ([`model`]) and `can-protocol` ([`bus`])
//! with inputs that the compiler cannot see through. Its panic handler calls a function that does
//! not exist: while the optimiser can prove every panic away the handler is dead and falls out; a
//! single remaining path keeps it, and the image does not link. There is no allocator, so a heap
//! would stop the build even earlier.
//!
//! The inputs are opaque, not sensible, and no board is driven: the image is evidence and the
//! frame for a port, not a product.
#![no_std]
#![no_main]

mod bus;
mod model;

use cortex_m_rt::entry;
// For its panic handler.
use firmware as _;

#[entry]
fn main() -> ! {
    loop {
        model::run();
        bus::run();
        #[cfg(feature = "panic-path")]
        core::hint::black_box([0_u8; 2][core::hint::black_box(1)]);
    }
}
