//! `vsqrt.f64`, which `core` does not offer: the one crate below the image with unsafe code, and it
//! has this function alone.
//!
//! It assembles only for a processor with double-precision hardware (`-C target-cpu=cortex-m7`).
//! The instruction rounds correctly (Arm `DDI0403E`, A2.5), so the bits are those of any other
//! square root.
#![no_std]

/// The square root; not a number below zero.
#[cfg(target_arch = "arm")]
#[inline(always)]
#[must_use]
pub fn sqrt(value: f64) -> f64 {
    let root: f64;
    // SAFETY: reads one register and writes another; no memory, no stack, no side effect.
    unsafe {
        core::arch::asm!(
            "vsqrt.f64 {root}, {value}",
            root = lateout(dreg_low16) root,
            value = in(dreg_low16) value,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    root
}
