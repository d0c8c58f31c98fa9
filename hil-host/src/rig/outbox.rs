//! The outgoing frames of a rig with their counters, until the owner takes them.

use super::{Reading, Timing};
use can_protocol::{
    Fault, FaultCode, Frame, Heartbeat, Measurement, MeasurementFlags, MessageId, Node, Pressure,
    Profile, RunState, Sender, Telemetry, Trips,
};
use heapless::Deque;

/// Frames that wait to be taken: a cycle has at most five.
const FRAMES: usize = 8;

/// Frames on their way out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outbox {
    node: Node,
    frames: Deque<Frame, FRAMES>,
    measurement_counter: u8,
    fault_counter: u8,
    telemetry_counter: u8,
}

impl Outbox {
    pub(super) fn new(node: Node) -> Self {
        Self {
            node,
            frames: Deque::new(),
            measurement_counter: 0,
            fault_counter: 0,
            telemetry_counter: 0,
        }
    }

    pub(super) fn take(&mut self) -> Option<Frame> {
        self.frames.pop_front()
    }

    /// Another profile has another range of counters.
    pub(super) fn change_profile(&mut self) {
        self.measurement_counter = 0;
    }

    pub(super) fn measurement(
        &mut self,
        profile: Profile,
        state: RunState,
        flags: MeasurementFlags,
        echo: Option<u8>,
        reading: &Reading,
        time_us: u32,
    ) {
        let measurement = Measurement {
            node: self.node,
            counter: self.measurement_counter,
            state,
            flags,
            echo,
            force_n: Some(reading.force_n),
            displacement_m: Some(reading.displacement_m),
            time_us: Some(time_us),
        };
        self.put(measurement.encode(profile).0);
        self.measurement_counter = profile.next_counter(self.measurement_counter);
    }

    /// Telemetry and heartbeat, in the cycles that the protocol gives them.
    pub(super) fn slow_messages(
        &mut self,
        cycle: u64,
        timing: Timing,
        state: RunState,
        trips: Trips,
    ) {
        if is_due(MessageId::Telemetry(self.node), cycle, timing) {
            let telemetry = Telemetry {
                node: self.node,
                counter: self.telemetry_counter,
                state,
                // Neither oil nor supply is modelled.
                temperature_degc: None,
                pressure: Pressure::Unknown,
                trips,
            };
            self.put(telemetry.encode().0);
            self.telemetry_counter = Profile::Classical.next_counter(self.telemetry_counter);
        }
        if is_due(MessageId::Heartbeat(Sender::Rig(self.node)), cycle, timing) {
            self.heartbeat(state);
        }
    }

    pub(super) fn heartbeat(&mut self, state: RunState) {
        self.put(Heartbeat::new(Sender::Rig(self.node), 0, state, 0).encode().0);
    }

    pub(super) fn fault(&mut self, state: RunState, code: FaultCode, detail: u16) {
        let counter = self.fault_counter;
        let fault = Fault { sender: Sender::Rig(self.node), counter, state, code, detail };
        self.put(fault.encode().0);
        self.fault_counter = Profile::Classical.next_counter(counter);
    }

    /// An owner that takes nothing out loses frames, the newest first, and no more than frames.
    fn put(&mut self, frame: Frame) {
        let _full = self.frames.push_back(frame);
    }
}

/// Whether a slow message falls on this cycle, by its period in the protocol.
fn is_due(message: MessageId, cycle: u64, timing: Timing) -> bool {
    let period_us = u64::from(message.nominal_period_us().unwrap_or(u32::MAX));
    let cycles = (period_us / u64::from(timing.period_us.max(1))).max(1);
    cycle.is_multiple_of(cycles)
}
