//! The locomotive's end of its rig: what goes out to it, and what has come back.

use super::{limits, news};
use crate::WireFrame;
use can_protocol::arming::Agreement;
use can_protocol::{
    Command, Heartbeat, Measurement, MeasurementFlags, MessageId, Mode, Node, Profile, Receiver,
    ReceiverState, RunState, Seal, Sender, SessionCode, Status,
};
use firmware_core::command;
use firmware_core::compensation::Answer;
use firmware_core::guard::ForceInput;
use firmware_core::supervision::{
    Action, Arrival, Belief, Cause, Checks, Frames, Measured, SecondSender, Signal,
};

/// Lost frames in a row that a measurement may stand for; below half the 4-bit counter.
pub const MAX_DELTA: u8 = 5;

/// One rig, as its locomotive knows it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RigEnd {
    node: Node,
    profile: Profile,
    receiver: Receiver<Measurement>,
    received: ReceiverState,
    checks: Checks,
    /// The code that seals the session of an armed rig; none before and after.
    code: Option<SessionCode>,
    belief: Belief,
    /// Where the ram stood in the first measurement after arming (m).
    stands_m: Option<f64>,
    /// Number of the next command since arming.
    cycle: u32,
    /// Counter of the last command.
    sent: Option<u8>,
    /// Newest measurement since the last cycle.
    newest: Option<Measurement>,
    /// Measurement that the last cycle used.
    used: Option<Measurement>,
    frames: Frames,
    second_sender: SecondSender,
    news: Option<Cause>,
    temperature_degc: Option<f64>,
}

impl RigEnd {
    /// That of a rig that has not been heard yet; none where the receiver cannot be.
    pub(super) fn new(node: Node, profile: Profile, checks: Checks) -> Option<Self> {
        Some(Self {
            node,
            profile,
            receiver: Receiver::new(profile, node, MAX_DELTA).ok()?,
            received: ReceiverState::default(),
            checks,
            code: None,
            belief: Belief::default(),
            stands_m: None,
            cycle: 0,
            sent: None,
            newest: None,
            used: None,
            frames: Frames::default(),
            second_sender: SecondSender::default(),
            news: None,
            temperature_degc: None,
        })
    }

    /// The heartbeat in a frame of this rig, or why it cannot be read.
    pub(super) fn heartbeat(
        &self,
        frame: &WireFrame,
    ) -> Option<Result<Heartbeat, can_protocol::Error>> {
        let id = MessageId::Heartbeat(Sender::Rig(self.node)).raw();
        (frame.id() == id).then(|| Heartbeat::decode(frame.id(), frame.data()))
    }

    /// Takes in a frame, if it is this rig's measurement or something that it says of itself.
    pub(super) fn take_frame(&mut self, frame: &WireFrame) -> bool {
        let reception = self.receiver.accept(&mut self.received, frame.id(), frame.data());
        let Some(reception) = reception else {
            if let Some(telemetry) = news::telemetry(self.node, frame) {
                self.temperature_degc = telemetry.temperature_degc;
            }
            let heard = news::cause(self.node, frame);
            self.news = self.news.or(heard);
            return heard.is_some();
        };
        self.frames.conflict |= reception.status == Status::Conflict;
        self.frames.foreign |= reception.plain;
        self.frames.bad |= reception.status == Status::WrongCrc;
        if let Some(measurement) = reception.data {
            self.frames.good = true;
            self.stands_m = self.stands_m.or(measurement.displacement_m);
            self.newest = Some(measurement);
        }
        true
    }

    /// What the cycle gets: the newest measurement since the last one, or why there is none.
    pub(super) fn take_input(&mut self) -> ForceInput {
        let frames = core::mem::take(&mut self.frames);
        if self.second_sender.take(frames) {
            let value = f64::from(MessageId::Measurement(self.profile, self.node).raw());
            self.news = self.news.or(Some(Cause::fact(Signal::SecondSender, value)));
        }
        if let Some(temperature_degc) = self.temperature_degc {
            self.belief.temperature(&self.checks, temperature_degc);
        }
        let arrival = if let Some(measurement) = self.newest.take() {
            self.used = Some(measurement);
            self.news = self.news.or(news::of_state(measurement.state));
            Arrival::Frame(measured(&measurement))
        } else {
            self.receiver.no_frame(&mut self.received);
            if frames.bad { Arrival::Damaged } else { Arrival::Nothing }
        };
        self.belief.take(&self.checks, arrival, self.sent)
    }

    /// The displacement that came with a force that is believed.
    pub(super) fn answer(&self, force: ForceInput) -> Option<Answer> {
        answer(force, self.used.as_ref())
    }

    /// Judges the force of a cycle against that of the slot's model (N).
    pub(super) fn judge_residual(&mut self, input: ForceInput, model_n: f64) {
        if let ForceInput::Fresh(force_n) = input {
            self.belief.residual(&self.checks, force_n - model_n);
        }
    }

    /// Judges whether the compensator of the rig has run away.
    pub(super) fn judge_compensation(&mut self, has_run_away: bool) {
        self.belief.compensation(&self.checks, has_run_away);
    }

    /// The first cause to end the run, and the strongest action that was asked for.
    pub(super) fn cause(&self) -> Option<(Cause, Action)> {
        let cause = self.news.or(self.belief.cause())?;
        let action = self.belief.action().map_or(cause.action, |own| own.max(cause.action));
        Some((cause, action))
    }

    /// Lets cycles pass that were missed here, and in which the rig went on.
    pub(super) fn skip(&mut self, cycles: u32) {
        self.belief.skip(cycles);
    }

    /// Begins the sealed session of a rig that is armed: both sides count from cycle 0.
    pub(super) fn arm(&mut self, agreement: &Agreement) {
        let agreed = agreement.configuration.limits;
        let stroke_m = f64::from(agreed.stroke_um) * 1e-6;
        self.checks = self.checks.within(f64::from(agreed.force_n), stroke_m);
        let code = agreement.code();
        (self.code, self.receiver) = (Some(code), self.receiver.clone().sealed(code));
        self.received = ReceiverState::default();
        (self.cycle, self.sent, self.stands_m) = (0, None, None);
    }

    /// Begins to command a ram that stands still: what came before belongs to no cycle.
    pub(super) fn begin(&mut self, ram: command::Command) {
        (self.newest, self.frames) = (None, Frames::default());
        self.belief.begin(ram);
    }

    /// The next command, sealed; none to a rig that is not armed.
    pub(super) fn command(
        &mut self,
        command: &command::Command,
        run: RunState,
        time_us: u32,
    ) -> Option<can_protocol::Frame> {
        let seal = Seal { code: self.code?, cycle: self.cycle };
        self.cycle = self.cycle.saturating_add(1);
        let counter = seal.counter(self.profile);
        let message = Command {
            counter,
            echo: self.received.echo(),
            ..command_message(self.node, command, run, time_us)
        };
        self.sent = Some(counter);
        self.belief.sent(*command);
        Some(message.encode_sealed(self.profile, seal).0)
    }

    /// Whether the rig has answered the last command.
    pub(super) fn has_echo(&self) -> bool {
        let newest = self.newest.as_ref();
        newest.is_some_and(|measurement| measurement.echo == self.sent && self.sent.is_some())
    }

    /// Whether frames came since the last cycle, and all of them failed their check.
    pub(super) fn hears_only_bad(&self) -> bool {
        self.frames.bad && !self.frames.good
    }

    /// Whether the rig is armed.
    pub(super) fn is_armed(&self) -> bool {
        self.code.is_some()
    }

    /// Whether no command was sent since arming.
    pub(super) fn is_new(&self) -> bool {
        self.cycle == 0
    }

    /// Where the ram stood in the first measurement after arming (m).
    pub(super) fn stands_m(&self) -> Option<f64> {
        self.stands_m
    }

    /// The limits that the locomotive asks for.
    pub(super) fn asked(
        &self,
        limits: &firmware_core::supervision::CommandLimits,
    ) -> can_protocol::arming::Limits {
        limits::asked(limits, self.checks.force.limit)
    }
}

/// The displacement that came with a force that is believed. It is paired with the command of the
/// cycle in which it arrives, so that a compensator learns the way on the bus too.
pub fn answer(force: ForceInput, used: Option<&Measurement>) -> Option<Answer> {
    let ForceInput::Fresh(force_n) = force else { return None };
    let displacement_m = used.and_then(|used| used.displacement_m)?;
    Some(Answer { displacement_m, force_n, age_cycles: 0 })
}

/// A measurement, as the checks take it.
pub fn measured(measurement: &Measurement) -> Measured {
    Measured {
        counter: measurement.counter,
        echo: measurement.echo,
        displacement_m: measurement.displacement_m,
        force_n: measurement.force_n,
        is_valid: !measurement.flags.contains(MeasurementFlags::SENSOR_INVALID),
        runs: measurement.state.moves(),
    }
}

/// A command as a message, still without counter and echo.
pub fn command_message(
    node: Node,
    command: &command::Command,
    run: RunState,
    time_us: u32,
) -> Command {
    Command {
        node,
        counter: 0,
        state: run,
        mode: if run.moves() { Mode::FollowWithVelocity } else { Mode::Hold },
        echo: None,
        displacement_m: Some(command.displacement_m),
        velocity_m_per_s: Some(command.velocity_m_per_s),
        time_us: Some(time_us),
    }
}
