//! A motion of two sines, 8 mm at 1.5 Hz and 0.8 mm at 7 Hz, which opens the relief valve.

use firmware_core::command::Command;

/// Length of a step (s).
pub(crate) const STEP_S: f64 = 1e-3;

/// Where the ram is at a step.
pub(crate) fn at(step: u32) -> Command {
    let at_s = f64::from(step) * STEP_S;
    let sine = |size_m: f64, hz: f64| {
        let omega = 2.0 * core::f64::consts::PI * hz;
        let (sin, cos) = libm::sincos(omega * at_s);
        (size_m * sin, size_m * omega * cos)
    };
    let (slow, fast) = (sine(8e-3, 1.5), sine(0.8e-3, 7.0));
    Command { displacement_m: slow.0 + fast.0, velocity_m_per_s: slow.1 + fast.1 }
}
