//! The host's end of one rig: what goes out to it, what has come back.

use super::watch::{Watch, WatchState};
use crate::bus::WireFrame;
use crate::record::FrameBytes;
use can_protocol::{
    Command, Frame, Measurement, MeasurementFlags, Mode, Node, Profile, Receiver, ReceiverState,
    Residual, RunState, Status,
};
use firmware_core::guard::{self, ForceInput};
use firmware_core::vehicle::DAMPER_SLOTS;

/// Parameters of a port.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// The rig's node.
    pub node: Node,
    /// Number of the bus that it is on.
    pub bus: usize,
    /// The damper slot that it serves.
    pub slot: usize,
    profile: Profile,
    receiver: Receiver<Measurement>,
    watch: Option<Box<Watch>>,
}

/// What a port remembers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PortState {
    receiver: ReceiverState,
    /// Counter of the last command sent.
    sent: Option<u8>,
    /// Newest measurement since the last cycle.
    newest: Option<Kept>,
    /// Whether a bad frame came since the last cycle.
    bad: bool,
    /// Measurement that the last cycle used.
    pub used: Option<Measurement>,
    /// Commands sent.
    pub commands: u64,
    /// Commands whose displacement, velocity or counter did not fit the frame.
    pub saturated: u64,
    /// Measurements with a flag: limit reached, actuator lagging, value beyond the frame.
    pub flagged: u64,
    /// The watch over the rig's damper.
    pub watch: WatchState,
    /// Counter of the last residual sent.
    residual_counter: Option<u8>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Kept {
    measurement: Measurement,
    bytes: FrameBytes,
}

/// Lost frames in a row that a measurement may stand for; below half the 4-bit counter.
const MAX_DELTA: u8 = 5;

impl Port {
    /// A port.
    ///
    /// # Errors
    /// Never with the constants used here; the receiver checks them.
    pub fn new(
        node: Node,
        bus: usize,
        slot: usize,
        profile: Profile,
    ) -> Result<Self, can_protocol::Error> {
        debug_assert!(slot < DAMPER_SLOTS, "a vehicle has no damper slot {slot}");
        let receiver = Receiver::new(profile, node, MAX_DELTA)?;
        Ok(Self { node, bus, slot, profile, receiver, watch: None })
    }

    /// The same port with a watch over the rig's damper.
    #[must_use]
    pub fn watched(mut self, watch: Watch) -> Self {
        self.watch = Some(Box::new(watch));
        self
    }

    /// What the watch shows, as a frame; none without a watch.
    pub fn residual(&self, state: &mut PortState, run: RunState) -> Option<Frame> {
        self.watch.as_ref()?;
        let view = state.watch.view;
        // The message is classical on either bus.
        let counter =
            state.residual_counter.map_or(0, |counter| Profile::Classical.next_counter(counter));
        state.residual_counter = Some(counter);
        let residual = Residual {
            node: self.node,
            counter,
            state: run,
            rms_n: view.residual_rms_n,
            watch: view.verdict,
        };
        Some(residual.encode().0)
    }

    /// Compares the measurement of this cycle with the model, where there is both.
    pub fn watch(&self, state: &mut PortState, input: ForceInput) {
        let Some(watch) = &self.watch else { return };
        match (input, state.used.and_then(|used| used.displacement_m)) {
            (ForceInput::Fresh(force_n), Some(displacement_m)) => {
                watch.take(&mut state.watch, displacement_m, force_n);
            }
            _ => watch.wait(&mut state.watch),
        }
    }

    /// Takes in a frame, if it is this rig's measurement.
    pub fn take_frame(&self, state: &mut PortState, frame: &WireFrame) -> bool {
        let Some(reception) = self.receiver.accept(&mut state.receiver, frame.id(), frame.data())
        else {
            return false;
        };
        match reception.data {
            Some(measurement) => {
                let mut bytes = FrameBytes::default();
                for (to, from) in bytes.iter_mut().zip(frame.data()) {
                    *to = *from;
                }
                state.newest = Some(Kept { measurement, bytes });
            }
            None if reception.status == Status::WrongCrc => state.bad = true,
            None => {}
        }
        true
    }

    /// What the cycle gets: the newest measurement since the last one, or why there is none.
    pub fn take_input(&self, state: &mut PortState) -> (ForceInput, FrameBytes) {
        let bad = core::mem::take(&mut state.bad);
        let Some(kept) = state.newest.take() else {
            self.receiver.no_frame(&mut state.receiver);
            let input = if bad { ForceInput::Invalid } else { ForceInput::Missing };
            return (input, FrameBytes::default());
        };
        let measurement = kept.measurement;
        state.used = Some(measurement);
        state.flagged += u64::from(!measurement.flags.is_empty());
        let sound = !measurement.flags.contains(MeasurementFlags::SENSOR_INVALID)
            && measurement.state == RunState::Run;
        let input = match measurement.force_n {
            Some(force_n) if sound => ForceInput::Fresh(force_n),
            _ => ForceInput::Invalid,
        };
        (input, kept.bytes)
    }

    /// The next command.
    pub fn command(
        &self,
        state: &mut PortState,
        command: &guard::Command,
        run: RunState,
        time_us: u32,
    ) -> Frame {
        let counter = state.sent.map_or(0, |counter| self.profile.next_counter(counter));
        let (frame, saturated) = Command {
            node: self.node,
            counter,
            state: run,
            mode: if run == RunState::Run { Mode::FollowWithVelocity } else { Mode::Hold },
            echo: state.receiver.echo(),
            displacement_m: Some(command.displacement_m),
            velocity_m_per_s: Some(command.velocity_m_per_s),
            time_us: Some(time_us),
        }
        .encode(self.profile);
        state.sent = Some(counter);
        state.commands += 1;
        state.saturated += u64::from(!saturated.is_empty());
        frame
    }

    /// Whether the rig has answered the last command.
    pub fn has_echo(&self, state: &PortState) -> bool {
        let newest = state.newest.map(|kept| kept.measurement);
        newest.is_some_and(|measurement| measurement.echo == state.sent && state.sent.is_some())
    }

    /// How often each receiver status occurred.
    pub fn counts<'a>(&self, state: &'a PortState) -> &'a can_protocol::Counts {
        state.receiver.counts()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement(counter: u8, force_n: f64) -> WireFrame {
        let (frame, _) = Measurement {
            node: Node::ALL[0],
            counter,
            state: RunState::Run,
            flags: MeasurementFlags::empty(),
            echo: Some(counter),
            force_n: Some(force_n),
            displacement_m: Some(0.0),
            time_us: None,
        }
        .encode(Profile::Classical);
        WireFrame::from(&frame)
    }

    fn port() -> Port {
        Port::new(Node::ALL[0], 0, 0, Profile::Classical).unwrap()
    }

    #[test]
    fn of_several_measurements_the_newest_counts() {
        let (port, mut state) = (port(), PortState::default());
        for counter in 0..3 {
            assert!(port.take_frame(&mut state, &measurement(counter, f64::from(counter) * 10.0)));
        }
        assert_eq!(port.take_input(&mut state).0, ForceInput::Fresh(20.0));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Missing);
        assert_eq!(port.counts(&state).no_new_data, 1);
    }

    #[test]
    fn a_rig_that_is_not_running_gives_no_force() {
        let (port, mut state) = (port(), PortState::default());
        let (frame, _) = Measurement {
            state: RunState::Safe,
            ..Measurement::decode(0x201, measurement(0, 5.0).data()).unwrap()
        }
        .encode(Profile::Classical);
        port.take_frame(&mut state, &WireFrame::from(&frame));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Invalid);
    }

    #[test]
    fn the_echo_of_the_last_command_is_recognised() {
        let (port, mut state) = (port(), PortState::default());
        assert!(!port.has_echo(&state));
        let command = guard::Command::default();
        port.command(&mut state, &command, RunState::Run, 0);
        port.take_frame(&mut state, &measurement(0, 1.0));
        assert!(port.has_echo(&state));
        port.command(&mut state, &command, RunState::Run, 1000);
        assert!(!port.has_echo(&state));
    }
}
