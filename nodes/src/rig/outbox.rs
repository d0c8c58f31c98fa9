//! The outgoing frames of a rig with their counters, until the owner takes them.

use super::{Reading, Timing};
use can_protocol::{
    ArmMessage, Fault, FaultCode, Frame, Heartbeat, HeartbeatFlags, Measurement, MeasurementFlags,
    MessageId, Node, Pressure, Profile, RunState, Seal, Sender, Telemetry, Trips,
};
use heapless::Deque;

/// Frames that wait to be taken: a cycle has at most six.
const FRAMES: usize = 8;

/// What a rig says of itself in its slow messages.
#[derive(Debug, Clone, Copy)]
pub struct Says {
    /// Its run state.
    pub state: RunState,
    /// The number of its start.
    pub boot: u32,
    /// Key switch and latch.
    pub flags: HeartbeatFlags,
    /// Its supply pressure.
    pub pressure: Pressure,
    /// Guards and limits that have tripped.
    pub trips: Trips,
    /// Of the damper's oil, where it is known (degrees Celsius).
    pub temperature_degc: Option<f64>,
}

/// Frames on their way out.
#[derive(Debug, Clone, PartialEq)]
pub struct Outbox {
    node: Node,
    frames: Deque<Frame, FRAMES>,
    heartbeat_counter: u8,
    fault_counter: u8,
    telemetry_counter: u8,
}

impl Outbox {
    /// Nothing to send yet.
    pub fn new(node: Node) -> Self {
        Self {
            node,
            frames: Deque::new(),
            heartbeat_counter: 0,
            fault_counter: 0,
            telemetry_counter: 0,
        }
    }

    /// The next frame to send.
    pub fn take(&mut self) -> Option<Frame> {
        self.frames.pop_front()
    }

    /// An answer of the arming exchange.
    pub fn answer(&mut self, answer: &ArmMessage) {
        self.put(answer.encode().0);
    }

    /// What the sensors show, sealed.
    pub fn measurement(
        &mut self,
        (profile, seal): (Profile, Seal),
        state: RunState,
        flags: MeasurementFlags,
        echo: Option<u8>,
        reading: &Reading,
        time_us: u32,
    ) {
        let measurement = Measurement {
            node: self.node,
            counter: seal.counter(profile),
            state,
            flags,
            echo,
            force_n: Some(reading.force_n),
            displacement_m: Some(reading.displacement_m),
            time_us: Some(time_us),
        };
        self.put(measurement.encode_sealed(profile, seal).0);
    }

    /// Telemetry and heartbeat, in the cycles that the protocol gives them.
    pub fn slow_messages(&mut self, cycle: u64, timing: Timing, says: Says) {
        let Says { state, trips, pressure, temperature_degc, .. } = says;
        if is_due(MessageId::Telemetry(self.node), cycle, timing) {
            let telemetry = Telemetry {
                node: self.node,
                counter: self.telemetry_counter,
                state,
                temperature_degc,
                pressure,
                trips,
            };
            self.put(telemetry.encode().0);
            self.telemetry_counter = Profile::Classical.next_counter(self.telemetry_counter);
        }
        if is_due(MessageId::Heartbeat(Sender::Rig(self.node)), cycle, timing) {
            self.heartbeat(says);
        }
    }

    /// The rig is alive.
    pub fn heartbeat(&mut self, says: Says) {
        let Says { state, boot, flags, .. } = says;
        let sender = Sender::Rig(self.node);
        let heartbeat = Heartbeat::new(sender, self.heartbeat_counter, state, boot);
        self.put(Heartbeat { flags, ..heartbeat }.encode().0);
        self.heartbeat_counter = Profile::Classical.next_counter(self.heartbeat_counter);
    }

    /// Something has happened to the rig.
    pub fn fault(&mut self, state: RunState, code: FaultCode, detail: u16) {
        let counter = self.fault_counter;
        let fault = Fault { sender: Sender::Rig(self.node), counter, state, code, detail };
        self.put(fault.encode().0);
        self.fault_counter = Profile::Classical.next_counter(counter);
    }

    /// An owner that takes nothing out loses frames, the newest first, and no more than frames.
    pub fn put(&mut self, frame: Frame) {
        let _full = self.frames.push_back(frame);
    }
}

/// Whether a slow message falls on this cycle, by its period in the protocol.
fn is_due(message: MessageId, cycle: u64, timing: Timing) -> bool {
    let period_us = u64::from(message.nominal_period_us().unwrap_or(u32::MAX));
    let cycles = (period_us / u64::from(timing.period_us.max(1))).max(1);
    cycle.is_multiple_of(cycles)
}
