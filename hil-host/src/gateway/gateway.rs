//! The bus itself: the host on one side, the rig's own messages on the other.
//!
//! In [`Bus::send`] a command of the host becomes one of the rig. In [`Bus::receive`] a measurement
//! of the rig becomes one for the host. A wait is a cycle that nobody commands: in it the rig is
//! prepared, and held until the first command comes.

use super::codec::{Decoder, Encoder, RigReading, RigState};
use super::front::{Front, Heard, Known};
use super::plan::GatewayPlan;
use super::preparation::{Offer, Order, Preparation, Unready};
use super::wire::Wire;
use crate::bus::{Bus, BusCounters, Sent, WireFrame};
use crate::draw::Draw;
use can_protocol::{FaultCode, Frame, MeasurementFlags, Node, Profile, RunState};
use firmware_core::command::Command;
use scenario::run::CYCLE_S;
use std::time::Duration;

/// Commands whose echo is still recognised.
const REMEMBERED: usize = 16;

/// Frames of the rig that one call of `receive` takes in before it returns.
const MOST_TAKEN: u32 = 64;

/// Hardest stop of a command that is brought to rest (m/s2).
const STOP_M_PER_S2: f64 = firmware_core::command::STOP_DECELERATION_M_PER_S2;

/// A rig that speaks its own messages, as a bus with a rig of ours on it.
#[derive(Debug)]
pub struct Gateway<W: Wire> {
    wire: W,
    plan: GatewayPlan,
    front: Front,
    decoder: Decoder,
    encoder: Encoder,
    preparation: Preparation,
    /// What the rig was sent last.
    reference: Command,
    is_enabled: bool,
    /// Whether the last command was cut to what its signals hold.
    is_cut: bool,
    /// Counters of the last commands: the rig's and the host's.
    sent: [Option<(u64, u8)>; REMEMBERED],
    next: usize,
    last_counter: Option<u64>,
    last: Option<RigReading>,
    repeated: u64,
}

impl<W: Wire> Gateway<W> {
    /// A gateway to a rig that the host knows by a node.
    pub fn new(plan: GatewayPlan, wire: W, node: Node, profile: Profile, draw: Draw) -> Self {
        Self {
            wire,
            front: Front::new(node, profile, draw),
            decoder: Decoder::default(),
            encoder: Encoder::new(&plan.command),
            plan,
            preparation: Preparation::Idle,
            reference: Command::default(),
            is_enabled: false,
            is_cut: false,
            sent: [None; REMEMBERED],
            next: 0,
            last_counter: None,
            last: None,
            repeated: 0,
        }
    }

    /// The side on which the rig is.
    pub fn wire(&self) -> &W {
        &self.wire
    }

    /// The same, for a test that changes it.
    pub fn wire_mut(&mut self) -> &mut W {
        &mut self.wire
    }

    /// The run state that the host sees.
    pub fn run_state(&self) -> RunState {
        self.front.run_state()
    }

    /// Why the rig was not ready to be armed, if so.
    pub fn unready(&self) -> Option<Unready> {
        match self.preparation {
            Preparation::Refused(why) => Some(why),
            _ => None,
        }
    }

    /// Measurements that repeated the counter of the one before, and were not believed.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    fn known(&self) -> Known {
        Known {
            limits: self.plan.rig_limits(),
            is_heard: self.last.is_some(),
            displacement_m: self.last.and_then(|reading| reading.displacement_m),
            force_n: self.last.and_then(|reading| reading.force_n),
            temperature_degc: self.decoder.temperature_degc,
            is_prepared: matches!(self.preparation, Preparation::Ready(_)),
            is_refused: matches!(self.preparation, Preparation::Refused(_)),
        }
    }

    /// Writes the reference to the rig.
    fn say(&mut self, host_counter: Option<u8>) -> Sent {
        let (counter, is_cut) =
            self.encoder.write(&self.plan.command, self.reference, self.is_enabled);
        self.is_cut |= is_cut;
        if let (Some(counter), Some(host_counter)) = (counter, host_counter) {
            self.next = (self.next + 1) % REMEMBERED;
            if let Some(place) = self.sent.get_mut(self.next) {
                *place = Some((counter, host_counter));
            }
        }
        let mut sent = Sent::Away;
        for frame in self.encoder.frames() {
            match self.wire.send(frame) {
                Sent::Away => {}
                other => sent = other,
            }
        }
        sent
    }

    /// What the host asks of the rig.
    fn act(&mut self, heard: Heard) -> Sent {
        let counter = match heard {
            Heard::Nothing => return Sent::Away,
            Heard::Prepare => {
                if self.preparation == Preparation::Idle {
                    self.preparation = Preparation::begin(self.offer());
                }
                return Sent::Away;
            }
            Heard::StopNow => {
                self.release();
                return Sent::Away;
            }
            Heard::Follow(reference, counter) => {
                (self.reference, self.is_enabled) = (reference, true);
                counter
            }
            Heard::Hold(counter) => {
                self.reference.velocity_m_per_s = 0.0;
                counter
            }
            Heard::Stop(counter) => {
                self.reference = self.reference.stopping(CYCLE_S, STOP_M_PER_S2);
                self.is_enabled = false;
                self.preparation = Preparation::Idle;
                counter
            }
        };
        let known = self.known();
        self.front.cycle(&known);
        self.say(Some(counter))
    }

    /// Stops a rig that is enabled, and forgets that it was ready.
    fn release(&mut self) {
        if !matches!(self.preparation, Preparation::Refused(_)) {
            self.preparation = Preparation::Idle;
        }
        if self.is_enabled {
            self.is_enabled = false;
            self.reference.velocity_m_per_s = 0.0;
            self.say(None);
        }
    }

    fn offer(&self) -> Offer {
        let displacement = &self.plan.measurement.displacement;
        let cycles = |time_s: f64| (time_s / CYCLE_S).ceil() as u32;
        Offer {
            time_out_cycles: self.plan.time_out_s.map(cycles),
            has_state: self.plan.state.is_some(),
            resolution_m: displacement.signal.resolution() * displacement.scale.abs(),
        }
    }

    /// A cycle that nobody commands.
    fn idle(&mut self) {
        let known = self.known();
        if self.front.cycle(&known) {
            self.release();
        }
        let was_going = matches!(self.preparation, Preparation::Going(_));
        if let Order::Say(reference, is_enabled) =
            self.preparation.cycle(self.decoder.state, self.wire.time())
        {
            (self.reference, self.is_enabled) = (reference, is_enabled);
            self.say(None);
        }
        if let (true, Preparation::Refused(why)) = (was_going, self.preparation) {
            files::say!("the rig is not ready: {why}");
        }
    }

    /// Takes in a measurement of the rig.
    fn measured(&mut self, reading: RigReading) {
        let Some(lost) = self.lost_before(&reading) else {
            self.repeated += 1;
            return;
        };
        self.last = Some(reading);
        let known = self.known();
        self.front.agree(&known);
        if let Some(displacement_m) = reading.displacement_m {
            self.preparation.measured(displacement_m);
        }
        let is_sound = reading.is_sound;
        let (force_n, displacement_m) = (reading.force_n, reading.displacement_m);
        let mut flags = MeasurementFlags::empty();
        flags.set(MeasurementFlags::SENSOR_INVALID, !is_sound || force_n.is_none());
        flags.set(MeasurementFlags::LIMIT_REACHED, std::mem::take(&mut self.is_cut));
        let values = if is_sound { (force_n, displacement_m) } else { (None, None) };
        let echo = self.echo(&reading);
        self.front.measure(lost, echo, flags, values);
    }

    /// Measurements that did not come before this one; `None` for one that repeats the last.
    fn lost_before(&mut self, reading: &RigReading) -> Option<u32> {
        let Some(placed) = self.plan.measurement.counter else { return Some(0) };
        // A frame without its counter is none.
        let counter = reading.counter?;
        let modulus = placed.signal.modulus();
        let Some(last) = self.last_counter.replace(counter) else { return Some(0) };
        let steps =
            if counter >= last { counter - last } else { modulus.max(last) - last + counter };
        u32::try_from(steps.checked_sub(1)?).ok()
    }

    /// The host's counter of the command that a measurement answers.
    fn echo(&self, reading: &RigReading) -> Option<u8> {
        if self.plan.measurement.echo.is_none() {
            // Its age is unknown: it counts as the answer to the newest command.
            return self.front.echo();
        }
        let echo = reading.echo?;
        let newest_first = (0..REMEMBERED).map(|back| (self.next + REMEMBERED - back) % REMEMBERED);
        let mut known = newest_first.filter_map(|place| self.sent.get(place).copied().flatten());
        known.find(|(counter, _)| *counter == echo).map(|(_, host_counter)| host_counter)
    }

    /// Somebody else commands the rig. The bus does not give back the frames of this host.
    fn second_sender(&mut self) {
        if self.front.is_armed() {
            self.front.stop(FaultCode::Protection, 1);
        } else if matches!(self.preparation, Preparation::Going(_) | Preparation::Ready(_)) {
            self.preparation = Preparation::Refused(Unready::SecondSender);
            files::say!("the rig is not ready: {}", Unready::SecondSender);
            self.release();
        }
    }

    /// Acts on what the rig says of itself.
    fn judge_state(&mut self) {
        if !self.front.is_armed() {
            return;
        }
        match self.decoder.state {
            Some(RigState::Fault) => self.front.fail(FaultCode::Actuator, 0),
            Some(RigState::Other(state)) => self.front.stop(FaultCode::StateMismatch, state),
            Some(RigState::Running) | None => {}
        }
    }
}

impl<W: Wire> Bus for Gateway<W> {
    fn send(&mut self, frame: &Frame) -> Sent {
        let known = self.known();
        let heard = self.front.hear(&WireFrame::from(frame), &known);
        self.act(heard)
    }

    fn receive(&mut self) -> Option<WireFrame> {
        for _ in 0..MOST_TAKEN {
            if let Some(frame) = self.front.take_frame() {
                return Some(WireFrame::from(&frame));
            }
            let frame = self.wire.receive()?;
            if self.plan.is_command(frame.id()) {
                self.second_sender();
                continue;
            }
            let reading = self.decoder.take(&self.plan, &frame);
            self.judge_state();
            if let Some(reading) = reading {
                self.measured(reading);
            }
        }
        None
    }

    fn wait(&mut self, timeout: Duration) -> bool {
        let has_come = self.wire.wait(timeout);
        if !self.front.is_commanded() {
            self.idle();
        }
        has_come
    }

    fn has_own_time(&self) -> bool {
        self.wire.has_own_time()
    }

    fn counters(&self) -> BusCounters {
        self.wire.counters()
    }
}

/// A rig is not left enabled by a host that goes.
impl<W: Wire> Drop for Gateway<W> {
    fn drop(&mut self) {
        self.release();
    }
}
