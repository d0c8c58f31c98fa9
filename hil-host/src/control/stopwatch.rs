//! The stages of a cycle, for whoever times them.

use firmware_core::line::Arrow;

/// A stage of a cycle, in the order of [`super`]'s drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Every bus is drained.
    Receive,
    /// Every rig has an input.
    Decode,
    /// Rigs are judged, and the forces of the cycle chosen.
    Guard,
    /// The vehicle has moved.
    Step,
    /// Every rig has a command, which was judged too.
    Compensate,
    /// Every command is a frame.
    Encode,
    /// The frames are with the buses.
    Send,
    /// Behind the last frame: watch, slow messages, hash and row.
    Record,
}

/// Takes the time behind each stage.
pub(crate) trait Stopwatch {
    /// A stage has just ended.
    fn lap(&mut self, stage: Stage);
}

/// No stopwatch: a run.
impl Stopwatch for () {
    #[inline]
    fn lap(&mut self, _stage: Stage) {}
}

impl From<Arrow> for Stage {
    fn from(arrow: Arrow) -> Self {
        match arrow {
            Arrow::Guard => Self::Guard,
            Arrow::VehicleStep => Self::Step,
            // The commands are judged behind it.
            Arrow::Compensation => Self::Compensate,
        }
    }
}
