//! The run state that every protected message and the heartbeat carry.
use crate::wire_enum::wire_enum;

wire_enum! {
    /// Run state of host or rig, as the 4-bit code on the wire. Codes 9 to 15 are reserved.
    RunState in "state" {
        /// Starting up, nothing checked yet.
        Init = 0, "INIT";
        /// Checked and idle: no power to the actuator.
        Standby = 1, "STANDBY";
        /// Ready to move, holding position.
        Armed = 2, "ARMED";
        /// Coupling is being faded in.
        RampIn = 3, "RAMP_IN";
        /// Coupled.
        Run = 4, "RUN";
        /// Coupling is being faded out.
        RampOut = 5, "RAMP_OUT";
        /// Decelerated by itself and holding position.
        Safe = 6, "SAFE";
        /// Latched fault: only an operator leaves it.
        Fault = 7, "FAULT";
        /// Following a motion of its own, with no vehicle coupled.
        OpenLoop = 8, "OPEN_LOOP";
    }
}

impl RunState {
    /// Whether the ram of a rig follows commands, coupled to a vehicle or not.
    pub const fn moves(self) -> bool {
        matches!(self, Self::OpenLoop | Self::RampIn | Self::Run | Self::RampOut)
    }
}
