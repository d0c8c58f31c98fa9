//! The host's end of one rig: what goes out to it, what has come back.

use super::stop::{PressureRequest, Stop};
use super::watch::{Watch, WatchState};
use crate::bus::WireFrame;
use crate::record::FrameBytes;
use can_protocol::arming::Agreement;
use can_protocol::{
    Command, Counts, Frame, Heartbeat, Measurement, MessageId, Node, Profile, Receiver,
    ReceiverState, Residual, RunState, Seal, Sender, SessionCode, Status,
};
use firmware_core::command;
use firmware_core::compensation::{Answer, CompensatorState};
use firmware_core::guard::ForceInput;
use firmware_core::supervision::{
    Action, Arrival, Belief, Cause, Checks, CommandLimits, Frames, Growth, Reached, SecondSender,
    Signal,
};
use firmware_core::vehicle::DAMPER_SLOTS;
use nodes::locomotive::{MAX_DELTA, command_message, measured, news};
use scenario::run::{BeyondLimits, CYCLE_S};

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
    beyond_limits: BeyondLimits,
    watch: Option<Box<Watch>>,
    /// Whether the vehicle goes on with the slot's model where the rig is lost.
    pub(super) may_drop_out: bool,
}

/// What a port remembers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PortState {
    /// The session of an armed rig; none before and after.
    armed: Option<Armed>,
    receiver: ReceiverState,
    /// What was received before the first cycle of the run.
    before: Counts,
    /// What was received by the end of the run.
    at_end: Option<Counts>,
    /// Where the ram stood in the first measurement after arming (m).
    stands_m: Option<f64>,
    /// Number of the next command since arming.
    cycle: u32,
    /// Counter of the last command sent.
    sent: Option<u8>,
    /// Newest measurement since the last cycle.
    newest: Option<Kept>,
    /// What came under the measurement's id since the last cycle.
    frames: Frames,
    second_sender: SecondSender,
    /// The state in its last heartbeat before arming.
    pub(super) says: Option<RunState>,
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
    /// Growth of the commanded motion.
    pub growth: Growth,
    /// The watch over the rig's damper.
    pub watch: WatchState,
    /// Counter of the last residual sent.
    residual_counter: Option<u8>,
    /// Why the slot goes on without the rig; none while it does not.
    pub dropped_out: Option<Stop>,
    /// What is still to be sent to a rig that has dropped out and is to drop its pressure.
    pub(super) pressure_off: Option<PressureRequest>,
}

/// What holds as long as a rig is armed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Armed {
    agreement: Agreement,
    /// The code that seals commands and measurements.
    code: SessionCode,
    /// The checks, within the limits that the rig has agreed to.
    checks: Checks,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Kept {
    measurement: Measurement,
    bytes: FrameBytes,
}

/// The largest force that is believed of any rig (N): a frame has little more.
pub(crate) const MOST_FORCE_N: f64 = 100e3;

impl Port {
    /// A port with the usual checks.
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
        let checks = Checks::usual(profile.counter_modulus(), CYCLE_S, MOST_FORCE_N);
        let beyond_limits = BeyondLimits::Saturate;
        let (watch, may_drop_out) = (None, false);
        Ok(Self { node, bus, slot, profile, receiver, checks, beyond_limits, watch, may_drop_out })
    }

    /// The same port with other checks of what its rig measures, and of what it is sent.
    #[must_use]
    pub fn checked(self, checks: Checks, beyond_limits: BeyondLimits) -> Self {
        debug_assert!(checks.force.limit <= MOST_FORCE_N, "{} N", checks.force.limit);
        debug_assert_eq!(checks.counter_modulus, self.profile.counter_modulus());
        Self { checks, beyond_limits, ..self }
    }

    /// The same port with a watch over the rig's damper.
    #[must_use]
    pub fn watched(mut self, watch: Watch) -> Self {
        self.watch = Some(Box::new(watch));
        self
    }

    /// The same port, whose slot goes on with its model where the rig is lost.
    #[must_use]
    pub fn dropping_out(self) -> Self {
        Self { may_drop_out: true, ..self }
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

    /// Takes notice of the state in a heartbeat of this rig.
    pub(super) fn hear_state(&self, state: &mut PortState, frame: &WireFrame) {
        if frame.id() == MessageId::Heartbeat(Sender::Rig(self.node)).raw()
            && let Ok(heartbeat) = Heartbeat::decode(frame.id(), frame.data())
        {
            state.says = Some(heartbeat.state);
        }
    }

    /// Takes in a frame, if it is this rig's measurement or something that it says of itself.
    pub fn take_frame(&self, state: &mut PortState, frame: &WireFrame) -> bool {
        let receiver = self.receiver(state);
        let Some(reception) = receiver.accept(&mut state.receiver, frame.id(), frame.data()) else {
            if let Some(telemetry) = news::telemetry(self.node, frame) {
                state.temperature_degc = telemetry.temperature_degc;
            }
            let heard = news::cause(self.node, frame);
            state.news = state.news.or(heard);
            return heard.is_some();
        };
        state.frames.conflict |= reception.status == Status::Conflict;
        state.frames.foreign |= reception.plain;
        state.frames.bad |= reception.status == Status::WrongCrc;
        if let Some(measurement) = reception.data {
            state.frames.good = true;
            state.stands_m = state.stands_m.or(measurement.displacement_m);
            let mut bytes = FrameBytes::default();
            for (to, from) in bytes.iter_mut().zip(frame.data()) {
                *to = *from;
            }
            state.newest = Some(Kept { measurement, bytes });
        }
        true
    }

    /// What the cycle gets: the newest measurement since the last one, or why there is none.
    pub fn take_input(&self, state: &mut PortState) -> (ForceInput, FrameBytes) {
        let frames = core::mem::take(&mut state.frames);
        if state.has_dropped_out() {
            return state.take_unbelieved(frames);
        }
        if state.second_sender.take(frames) {
            let value = f64::from(MessageId::Measurement(self.profile, self.node).raw());
            state.news = state.news.or(Some(Cause::fact(Signal::SecondSender, value)));
        }
        let checks = agreed(&self.checks, state.armed.as_ref());
        if let Some(temperature_degc) = state.temperature_degc {
            state.belief.temperature(checks, temperature_degc);
        }
        let Some(kept) = state.newest.take() else {
            self.receiver.no_frame(&mut state.receiver);
            let arrival = if frames.bad { Arrival::Damaged } else { Arrival::Nothing };
            let input = state.belief.take(checks, arrival, state.sent);
            return (input, FrameBytes::default());
        };
        let measurement = kept.measurement;
        state.used = Some(measurement);
        state.flagged += u64::from(!measurement.flags.is_empty());
        state.news = state.news.or(news::of_state(measurement.state));
        let arrival = Arrival::Frame(measured(&measurement));
        let input = state.belief.take(checks, arrival, state.sent);
        (input, kept.bytes)
    }

    /// Judges the force of a cycle against that of the slot's model after the last step (N).
    pub(super) fn judge_residual(&self, state: &mut PortState, input: ForceInput, model_n: f64) {
        let checks = agreed(&self.checks, state.armed.as_ref());
        if let ForceInput::Fresh(force_n) = input {
            state.belief.residual(checks, force_n - model_n);
        }
    }

    /// Judges whether the compensator of the rig has run away.
    pub(super) fn judge_compensation(&self, state: &mut PortState, compensator: &CompensatorState) {
        let checks = agreed(&self.checks, state.armed.as_ref());
        state.belief.compensation(checks, compensator.has_run_away());
    }

    /// The cause in a command that its limits have changed, where that ends a run.
    pub(super) fn beyond_limits(&self, limited: u64) -> Option<Cause> {
        let ends = limited > 0 && self.beyond_limits == BeyondLimits::Stop;
        ends.then_some(Cause::fact(Signal::CommandLimit, 1.0))
    }

    /// The first cause to end the run that this rig has given, and the strongest action that it has
    /// asked for.
    pub fn cause(&self, state: &PortState) -> Option<(Cause, Action)> {
        let cause = state.news.or(state.belief.cause())?;
        let action = state.belief.action().map_or(cause.action, |own| own.max(cause.action));
        debug_assert!(action > Action::Hold, "{cause:?}");
        Some((cause, action))
    }

    /// Where the ram stood in the first measurement after arming, from which on it is held (m).
    pub fn displacement_m(&self, state: &PortState) -> Option<f64> {
        state.stands_m
    }

    /// Begins the sealed session of a rig that is armed: both sides count from cycle 0.
    pub fn arm(&self, state: &mut PortState, agreement: Agreement) {
        let agreed = agreement.configuration.limits;
        let stroke_m = f64::from(agreed.stroke_um) * 1e-6;
        let checks = self.checks.within(f64::from(agreed.force_n), stroke_m);
        state.armed = Some(Armed { agreement, code: agreement.code(), checks });
        (state.receiver, state.before) = (ReceiverState::default(), Counts::default());
        (state.cycle, state.sent, state.stands_m) = (0, None, None);
    }

    /// Ends it.
    pub fn disarm(&self, state: &mut PortState) {
        state.armed = None;
    }

    /// Begins to command a ram that stands still: what came before belongs to no cycle, and frames
    /// are counted from here on.
    pub fn begin(&self, state: &mut PortState, ram: command::Command) {
        (state.newest, state.frames) = (None, Frames::default());
        state.before = *state.receiver.counts();
        state.belief.begin(ram);
    }

    /// Ends the run: what comes now belongs to no cycle.
    pub fn finish(&self, state: &mut PortState) {
        state.at_end = Some(self.counts(state));
    }

    /// How far what the rig has measured has come towards the limits of its checks.
    pub(crate) fn reached(&self, state: &PortState) -> [Reached; Reached::COUNT] {
        state.belief.reached(agreed(&self.checks, state.armed.as_ref()))
    }

    /// What holds for the rig: the checks within the limits that it has agreed to, and the limits
    /// of its commands.
    pub(super) fn agreed(&self, state: &PortState, limits: CommandLimits) -> Agreed {
        let checks = *agreed(&self.checks, state.armed.as_ref());
        Agreed { checks, limits, beyond_limits: self.beyond_limits }
    }

    /// The largest force that the host believes (N).
    pub(super) fn force_limit_n(&self) -> f64 {
        self.checks.force.limit
    }

    /// The receiver of the session, once there is one.
    fn receiver(&self, state: &PortState) -> Receiver<Measurement> {
        match &state.armed {
            Some(armed) => self.receiver.clone().sealed(armed.code),
            None => self.receiver.clone(),
        }
    }

    /// The next command, sealed. Before arming it is a plain one, which no rig obeys.
    pub fn command(
        &self,
        state: &mut PortState,
        command: &command::Command,
        run: RunState,
        time_us: u32,
    ) -> Frame {
        debug_assert!(state.armed.is_some(), "a command to a rig that is not armed");
        let cycle = state.cycle;
        state.cycle = cycle.saturating_add(1);
        let seal = state.armed.as_ref().map(|armed| Seal { code: armed.code, cycle });
        let counter = (cycle % u32::from(self.profile.counter_modulus())) as u8;
        let message = Command {
            counter,
            echo: state.receiver.echo(),
            ..command_message(self.node, command, run, time_us)
        };
        let (frame, saturated) = match seal {
            Some(seal) => message.encode_sealed(self.profile, seal),
            None => message.encode(self.profile),
        };
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

    /// How often each receiver status occurred in the cycles of the run.
    pub fn counts(&self, state: &PortState) -> Counts {
        if let Some(counts) = state.at_end {
            return counts;
        }
        let (now, before) = (state.receiver.counts(), &state.before);
        Counts {
            initial: now.initial - before.initial,
            ok: now.ok - before.ok,
            some_lost: now.some_lost - before.some_lost,
            repeated: now.repeated - before.repeated,
            wrong_sequence: now.wrong_sequence - before.wrong_sequence,
            conflict: now.conflict - before.conflict,
            wrong_crc: now.wrong_crc - before.wrong_crc,
            no_new_data: now.no_new_data - before.no_new_data,
            lost_frames: now.lost_frames - before.lost_frames,
            plain: now.plain - before.plain,
        }
    }
}

/// What holds for a rig, for those who look on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Agreed {
    /// What is checked of its measurements.
    pub(crate) checks: Checks,
    /// The limits of its commands.
    pub(crate) limits: CommandLimits,
    /// What becomes of a command beyond them.
    pub(crate) beyond_limits: BeyondLimits,
}

/// The checks that were agreed with a rig, or those that the host asks for.
fn agreed<'a>(asked: &'a Checks, armed: Option<&'a Armed>) -> &'a Checks {
    armed.map_or(asked, |armed| &armed.checks)
}

impl PortState {
    /// Whether the rig is armed.
    pub fn is_armed(&self) -> bool {
        self.armed.is_some()
    }

    /// The displacement that came with a force that is believed.
    pub(super) fn answer(&self, force: ForceInput) -> Option<Answer> {
        nodes::locomotive::answer(force, self.used.as_ref())
    }

    /// Whether the slot goes on without the rig.
    pub fn has_dropped_out(&self) -> bool {
        self.dropped_out.is_some()
    }

    /// What a rig that has dropped out still sends: it is kept, and nothing of it is used.
    fn take_unbelieved(&mut self, frames: Frames) -> (ForceInput, FrameBytes) {
        match self.newest.take() {
            Some(kept) => {
                self.used = Some(kept.measurement);
                (ForceInput::Invalid, kept.bytes)
            }
            None if frames.bad => (ForceInput::Invalid, FrameBytes::default()),
            None => (ForceInput::Missing, FrameBytes::default()),
        }
    }

    /// Whether measurements came since the last cycle, and all of them failed their check.
    pub(super) fn hears_only_bad(&self) -> bool {
        self.frames.bad && !self.frames.good
    }

    /// Whether no command was sent since arming.
    pub(super) fn is_new(&self) -> bool {
        self.cycle == 0
    }

    /// What was agreed with the rig: numbers, session code, limits.
    pub fn agreement(&self) -> Option<&Agreement> {
        self.armed.as_ref().map(|armed| &armed.agreement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use can_protocol::MeasurementFlags;
    use can_protocol::Pace;
    use can_protocol::arming::{Configuration, Limits};
    use core::num::{NonZeroU8, NonZeroU16};

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
        .encode_sealed(Profile::Classical, seal(counter));
        WireFrame::from(&frame)
    }

    fn seal(counter: u8) -> Seal {
        Seal { code: agreement().code(), cycle: u32::from(counter) }
    }

    fn agreement() -> Agreement {
        let limits = Limits {
            stroke_um: 100_000,
            velocity_um_per_s: 500_000,
            acceleration_mm_per_s2: 20_000,
            force_n: 100_000,
        };
        let configuration = Configuration {
            profile: Profile::Classical,
            pace: Pace::LockStep,
            period_us: NonZeroU16::MIN,
            slow_down: NonZeroU8::MIN,
            watchdog_cycles: 5,
            limits,
        };
        Agreement { host_number: 1, rig_number: 2, configuration }
    }

    /// A port of a rig that is armed.
    fn armed() -> (Port, PortState) {
        let port = Port::new(Node::ALL[0], 0, 0, Profile::Classical).unwrap();
        let mut state = PortState::default();
        port.arm(&mut state, agreement());
        (port, state)
    }

    #[test]
    fn of_several_measurements_the_newest_counts() {
        let (port, mut state) = armed();
        for counter in 0..3 {
            port.command(&mut state, &command::Command::default(), RunState::Run, 0);
            assert!(port.take_frame(&mut state, &measurement(counter, f64::from(counter) * 10.0)));
        }
        assert_eq!(port.take_input(&mut state).0, ForceInput::Fresh(20.0));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Missing);
        assert_eq!(port.counts(&state).no_new_data, 1);
    }

    #[test]
    fn a_rig_that_is_not_running_gives_no_force() {
        let (port, mut state) = armed();
        port.command(&mut state, &command::Command::default(), RunState::Run, 0);
        let (frame, _) = Measurement {
            state: RunState::Safe,
            ..Measurement::decode_sealed(0x201, measurement(0, 5.0).data(), seal(0)).unwrap()
        }
        .encode_sealed(Profile::Classical, seal(0));
        port.take_frame(&mut state, &WireFrame::from(&frame));
        assert_eq!(port.take_input(&mut state).0, ForceInput::Invalid);
        let (cause, _) = port.cause(&state).unwrap();
        assert_eq!((cause.signal, cause.value), (Signal::RigState, 6.0));
    }

    #[test]
    fn a_measurement_in_fault_was_forgotten_after_its_cycle() {
        let (port, mut state) = armed();
        for (counter, run) in [(0, RunState::Fault), (1, RunState::Run)] {
            port.command(&mut state, &command::Command::default(), RunState::Run, 0);
            let (whole, seal) = (measurement(counter, 5.0), seal(counter));
            let sound = Measurement::decode_sealed(0x201, whole.data(), seal).unwrap();
            let (frame, _) =
                Measurement { state: run, ..sound }.encode_sealed(Profile::Classical, seal);
            port.take_frame(&mut state, &WireFrame::from(&frame));
            port.take_input(&mut state);
        }
        assert_eq!(port.cause(&state).map(|(cause, _)| cause.value), Some(7.0));
    }

    #[test]
    fn the_echo_of_the_last_command_is_recognised() {
        let (port, mut state) = armed();
        assert!(!port.has_echo(&state));
        let command = command::Command::default();
        port.command(&mut state, &command, RunState::Run, 0);
        port.take_frame(&mut state, &measurement(0, 1.0));
        assert!(port.has_echo(&state));
        port.command(&mut state, &command, RunState::Run, 1000);
        assert!(!port.has_echo(&state));
    }
}
