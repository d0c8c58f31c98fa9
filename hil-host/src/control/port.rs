//! The host's end of one rig: what goes out to it, what has come back.

use super::news;
use super::watch::{Watch, WatchState};
use crate::bus::WireFrame;
use crate::record::FrameBytes;
use can_protocol::{
    Command, Frame, Measurement, MeasurementFlags, Mode, Node, Profile, Receiver, ReceiverState,
    Residual, RunState, Status,
};
use firmware_core::guard::{self, ForceInput, Guard};
use firmware_core::supervision::{Action, Arrival, Belief, Cause, Checks, Measured};
use firmware_core::vehicle::DAMPER_SLOTS;
use scenario::run::CYCLE_S;

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
    checks: Checks,
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
    /// What is believed of the rig.
    pub belief: Belief,
    /// What the rig has said of itself, the first that ends a run.
    news: Option<Cause>,
    /// The temperature that it reports (degrees Celsius).
    pub temperature_degc: Option<f64>,
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
        let force_n = Guard::default().force_limit_n;
        let checks = Checks::usual(profile.counter_modulus(), CYCLE_S, force_n);
        Ok(Self { node, bus, slot, profile, receiver, checks, watch: None })
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

    /// Takes in a frame, if it is this rig's measurement or something that it says of itself.
    pub fn take_frame(&self, state: &mut PortState, frame: &WireFrame) -> bool {
        let Some(reception) = self.receiver.accept(&mut state.receiver, frame.id(), frame.data())
        else {
            if let Some(temperature_degc) = news::temperature_degc(self.node, frame) {
                state.temperature_degc = temperature_degc;
            }
            let heard = news::cause(self.node, frame);
            state.news = state.news.or(heard);
            return heard.is_some();
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
            let arrival = if bad { Arrival::Damaged } else { Arrival::Nothing };
            let input = state.belief.take(&self.checks, arrival, state.sent);
            return (input, FrameBytes::default());
        };
        let measurement = kept.measurement;
        state.used = Some(measurement);
        state.flagged += u64::from(!measurement.flags.is_empty());
        state.news = state.news.or(news::of_state(measurement.state));
        let measured = Measured {
            counter: measurement.counter,
            echo: measurement.echo,
            displacement_m: measurement.displacement_m,
            force_n: measurement.force_n,
            is_valid: !measurement.flags.contains(MeasurementFlags::SENSOR_INVALID),
            runs: follows(measurement.state),
        };
        let input = state.belief.take(&self.checks, Arrival::Frame(measured), state.sent);
        (input, kept.bytes)
    }

    /// The first cause to end the run that this rig has given, and the strongest action that it has
    /// asked for.
    pub fn cause(&self, state: &PortState) -> Option<(Cause, Action)> {
        let cause = state.news.or(state.belief.cause())?;
        let action = state.belief.action().map_or(cause.action, |own| own.max(cause.action));
        debug_assert!(action > Action::Hold, "{cause:?}");
        Some((cause, action))
    }

    /// Displacement of the ram in the newest measurement (m).
    pub fn displacement_m(&self, state: &PortState) -> Option<f64> {
        state.newest.and_then(|kept| kept.measurement.displacement_m)
    }

    /// Begins to command a ram that stands still.
    pub fn begin(&self, state: &mut PortState, ram: guard::Command) {
        self.forget(state);
        // Frames are counted from here on.
        state.receiver = ReceiverState::default();
        state.belief.begin(ram);
    }

    /// Forgets what was measured and not used.
    pub fn forget(&self, state: &mut PortState) {
        (state.newest, state.bad) = (None, false);
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
            mode: if follows(run) { Mode::FollowWithVelocity } else { Mode::Hold },
            echo: state.receiver.echo(),
            displacement_m: Some(command.displacement_m),
            velocity_m_per_s: Some(command.velocity_m_per_s),
            time_us: Some(time_us),
        }
        .encode(self.profile);
        state.sent = Some(counter);
        state.belief.sent(*command);
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

/// Whether a rig follows commands in a state.
const fn follows(state: RunState) -> bool {
    matches!(state, RunState::RampIn | RunState::Run | RunState::RampOut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware_core::supervision::Signal;

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
            port.command(&mut state, &guard::Command::default(), RunState::Run, 0);
            assert!(port.take_frame(&mut state, &measurement(counter, f64::from(counter) * 10.0)));
        }
        assert_eq!(port.take_input(&mut state).0, ForceInput::Fresh(20.0));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Missing);
        assert_eq!(port.counts(&state).no_new_data, 1);
    }

    #[test]
    fn a_rig_that_is_not_running_gives_no_force() {
        let (port, mut state) = (port(), PortState::default());
        port.command(&mut state, &guard::Command::default(), RunState::Run, 0);
        let (frame, _) = Measurement {
            state: RunState::Safe,
            ..Measurement::decode(0x201, measurement(0, 5.0).data()).unwrap()
        }
        .encode(Profile::Classical);
        port.take_frame(&mut state, &WireFrame::from(&frame));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Invalid);
        let (cause, _) = port.cause(&state).unwrap();
        assert_eq!((cause.signal, cause.value), (Signal::RigState, 6.0));
    }

    #[test]
    fn a_measurement_in_fault_was_forgotten_after_its_cycle() {
        let (port, mut state) = (port(), PortState::default());
        for (counter, run) in [(0, RunState::Fault), (1, RunState::Run)] {
            port.command(&mut state, &guard::Command::default(), RunState::Run, 0);
            let sound = Measurement::decode(0x201, measurement(counter, 5.0).data()).unwrap();
            let (frame, _) = Measurement { state: run, ..sound }.encode(Profile::Classical);
            port.take_frame(&mut state, &WireFrame::from(&frame));
            port.take_input(&mut state);
        }
        assert_eq!(port.cause(&state).map(|(cause, _)| cause.value), Some(7.0));
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
