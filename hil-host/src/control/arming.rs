//! Arming: the exchange with every rig, and the sealed commands until every ram is known.

use super::cycle::{HEARTBEAT_S, SYNC_S};
use super::no_answer::NoAnswer;
use super::port::{Port, PortState};
use super::requests::Requests;
use super::session::{Session, SessionState};
use crate::bus::{Bus, WireFrame};
use crate::clock::Pacer;
use crate::rig::WATCHDOG_CYCLES;
use can_protocol::arming::{
    Agreement, Configuration, HostArming, HostOutcome, HostPlan, Limits, Patience, Refusal,
};
use can_protocol::{ArmItem, ArmMessage, Pace, RunState, SessionHistory};
use firmware_core::command::Command;
use firmware_core::line::Slot;
use firmware_core::supervision::{CommandLimits, Event};
use firmware_core::vehicle::DAMPER_SLOTS;
use nodes::locomotive::limits;
use std::time::Duration;

/// Cycles in which an armed rig has to measure its displacement.
const MEASURES_WITHIN_CYCLES: u64 = 500;

impl Session<'_> {
    /// Arms every rig and couples it: the next cycle is the first of `RAMP_IN`. From here on no
    /// cycle may be left out.
    ///
    /// # Errors
    /// A rig that refuses or is refused, does not measure or stands too far away, or a stop. Rigs
    /// that were armed are disarmed.
    pub fn arm<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<(), NoAnswer> {
        let armed = self.exchange(state, buses, requests);
        let coupled = armed.and_then(|rams_m| self.couple(state, rams_m));
        coupled.inspect_err(|_| self.disarm(state, buses))
    }

    /// Couples the rigs, all of which are armed, where their rams stand, by slot (m).
    ///
    /// # Errors
    /// A ram that stands too far away.
    pub(crate) fn couple(
        &self,
        state: &mut SessionState,
        rams_m: [f64; DAMPER_SLOTS],
    ) -> Result<(), NoAnswer> {
        state.line.on(Event::Arm);
        self.line.couple(&mut state.line, rams_m).map_err(|far| {
            let port = self.ports.iter().find(|port| port.slot == far.slot);
            let node = port.map_or(0, |port| port.node.number());
            NoAnswer::TooFar { node, ram_m: far.ram_m }
        })?;
        self.begin_ports(state);
        Ok(())
    }

    /// Begins to command the rams, which stand still.
    pub(super) fn begin_ports(&self, state: &mut SessionState) {
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            port.begin(memory, state.line.slots[port.slot].command);
        }
    }

    /// Begins the sealed session of a rig that has answered with its number and its limits.
    pub(crate) fn begin_sealed(
        &self,
        state: &mut SessionState,
        number: usize,
        rig_number: u32,
        answered: Limits,
    ) {
        let Some(port) = self.ports.get(number) else { return };
        let HostPlan { number: host_number, asked, configuration, .. } = self.plan(port);
        let configuration = Configuration { limits: asked.tighter(answered), ..configuration };
        self.begin_agreed(state, number, Agreement { host_number, rig_number, configuration });
    }

    /// Begins the sealed session of a rig with what was agreed.
    fn begin_agreed(&self, state: &mut SessionState, number: usize, agreement: Agreement) {
        let (Some(port), Some(memory)) = (self.ports.get(number), state.ports.get_mut(number))
        else {
            return;
        };
        port.arm(memory, agreement);
        let agreed = limits::tighter(agreement.configuration.limits, self.asked(port));
        let slot = &mut state.line.slots[port.slot];
        slot.limits = slot.limits.tighter(agreed);
    }

    /// One cycle after the other, until every rig is armed and has measured; where the rams stand,
    /// by slot (m).
    pub(super) fn exchange<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        requests: &Requests,
    ) -> Result<[f64; DAMPER_SLOTS], NoAnswer> {
        let plans = self.ports.iter().map(|port| self.plan(port));
        let history = SessionHistory::default();
        let mut exchanges: Vec<_> = plans.map(|plan| HostArming::new(plan, history)).collect();
        // Missed ticks are skipped: a rig that stood still with its host gets time to answer.
        let mut pacer = Pacer::every(self.arming.cycle);
        let mut armed_cycles = 0;
        for cycle in 0_u64.. {
            if requests.is_ending() {
                return Err(NoAnswer::Interrupted);
            }
            self.listen(state, buses, &mut exchanges);
            state.quiet.iter_mut().for_each(can_protocol::arming::Quiet::cycle);
            self.take_outcomes(state, buses, &mut exchanges)?;
            if exchanges.iter().all(is_armed) {
                let rams_m = self.rams_m(state);
                armed_cycles += 1;
                let is_known = rams_m.is_ok() && self.has_every_echo(state);
                if is_known || armed_cycles > MEASURES_WITHIN_CYCLES {
                    return rams_m;
                }
            }
            self.say(state, buses, &mut exchanges, cycle);
            pacer.wait();
            for bus in buses.iter_mut() {
                bus.wait(Duration::ZERO);
            }
        }
        unreachable!("no host waits for 2^64 cycles")
    }

    /// What the host asks of a rig.
    fn plan(&self, port: &Port) -> HostPlan {
        let asked = self.asked(port);
        HostPlan {
            node: port.node,
            number: self.arming.number,
            asked,
            needed: self.needed(asked),
            requirements: self.arming.requirements,
            configuration: Configuration {
                profile: self.profile,
                pace: self.pace,
                period_us: self.period_us(),
                slow_down: self.slow_down,
                watchdog_cycles: WATCHDOG_CYCLES as u16,
                limits: asked,
            },
            patience: Patience::default(),
        }
    }

    /// The least limits with which the host can do its work. Of the force only a little is needed.
    fn needed(&self, asked: Limits) -> Limits {
        let least = limits::needed(asked);
        if self.arming.needs_what_it_asks {
            return Limits { force_n: least.force_n, ..asked };
        }
        least
    }

    /// The limits that the host asks for: those of `[motion]` and the force limit of its checks.
    fn asked(&self, port: &Port) -> Limits {
        let limits = match self.line.slots.get(port.slot) {
            Some(Slot::Rig(rig)) => rig.limits,
            _ => CommandLimits::default(),
        };
        limits::asked(&limits, port.force_limit_n())
    }

    /// Takes in what has arrived.
    fn listen<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        exchanges: &mut [HostArming],
    ) {
        for (number, bus) in buses.iter_mut().enumerate() {
            while let Some(frame) = bus.receive() {
                if let Some(quiet) = state.quiet.get_mut(number) {
                    quiet.hear(frame.id(), frame.data());
                }
                let ports = self.ports.iter().zip(&mut state.ports).zip(&mut *exchanges);
                for ((port, memory), exchange) in ports.filter(|((port, _), _)| port.bus == number)
                {
                    port.hear_state(memory, &frame);
                    answered(exchange, port, &frame);
                    if memory.is_armed() {
                        port.take_frame(memory, &frame);
                    }
                }
            }
        }
    }

    /// Begins the sessions of rigs that have just been armed.
    fn take_outcomes<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        exchanges: &mut [HostArming],
    ) -> Result<(), NoAnswer> {
        for (number, (port, exchange)) in self.ports.iter().zip(exchanges).enumerate() {
            let is_armed = state.ports.get(number).is_some_and(PortState::is_armed);
            match exchange.outcome() {
                HostOutcome::Armed(agreement) if !is_armed => {
                    self.begin_agreed(state, number, agreement);
                }
                HostOutcome::Refused(refusal) => {
                    // The rig is sent that its exchange is over.
                    if let (Some(quiet), Some(bus)) =
                        (state.quiet.get(port.bus), buses.get_mut(port.bus))
                        && let Some(last) = exchange.cycle(quiet)
                    {
                        bus.send(&last.encode().0);
                    }
                    let says = state.ports.get(number).and_then(|memory| memory.says);
                    return Err(refused(port.node.number(), refusal, says));
                }
                HostOutcome::Armed(_) | HostOutcome::Pending(_) | HostOutcome::Reset => {}
            }
        }
        Ok(())
    }

    /// Whether no answer is still to come, where every command has one.
    fn has_every_echo(&self, state: &SessionState) -> bool {
        let mut ports = self.ports.iter().zip(&state.ports);
        self.pace == Pace::Clock || ports.all(|(port, memory)| port.has_echo(memory))
    }

    /// Where the rams stand, by slot (m).
    pub(crate) fn rams_m(&self, state: &SessionState) -> Result<[f64; DAMPER_SLOTS], NoAnswer> {
        let (mut rams_m, mut missing) = ([0.0; DAMPER_SLOTS], Vec::new());
        for (port, memory) in self.ports.iter().zip(&state.ports) {
            match port.displacement_m(memory) {
                Some(ram_m) => rams_m[port.slot] = ram_m,
                None => missing.push(port.node.number()),
            }
        }
        if missing.is_empty() { Ok(rams_m) } else { Err(NoAnswer::NoDisplacement(missing)) }
    }

    /// Sends what is due in a cycle: the next question, or a command that holds an armed rig.
    fn say<B: Bus>(
        &self,
        state: &mut SessionState,
        buses: &mut [B],
        exchanges: &mut [HostArming],
        cycle: u64,
    ) {
        if cycle.is_multiple_of(self.cycles(HEARTBEAT_S)) {
            let heartbeat = self.heartbeat(state);
            for bus in buses.iter_mut() {
                bus.send(&heartbeat);
            }
        }
        let sync_cycles = self.cycles(SYNC_S);
        if cycle % sync_cycles == sync_cycles - 1 {
            let sync = self.sync(state);
            for bus in buses.iter_mut() {
                bus.send(&sync);
            }
        }
        let ports = self.ports.iter().zip(&mut state.ports).zip(exchanges);
        for ((port, memory), exchange) in ports {
            let (Some(quiet), Some(bus)) = (state.quiet.get(port.bus), buses.get_mut(port.bus))
            else {
                continue;
            };
            if memory.is_armed() {
                // In lock-step the next command waits for the answer to the last.
                if self.pace == Pace::Clock || port.has_echo(memory) || memory.is_new() {
                    bus.send(&port.command(memory, &Command::default(), RunState::Armed, 0));
                }
            } else if let Some(question) = exchange.cycle(quiet) {
                bus.send(&question.encode().0);
            }
        }
    }

    /// Ends the sessions of the rigs that are armed.
    pub(super) fn disarm<B: Bus>(&self, state: &mut SessionState, buses: &mut [B]) {
        for (port, memory) in self.ports.iter().zip(&mut state.ports) {
            if memory.is_armed()
                && let Some(bus) = buses.get_mut(port.bus)
            {
                bus.send(&port.command(memory, &Command::default(), RunState::Standby, 0));
                port.disarm(memory);
            }
        }
    }
}

/// Hands the answer of a rig to its exchange.
fn answered(exchange: &mut HostArming, port: &Port, frame: &WireFrame) {
    if let Ok(answer) = ArmMessage::decode(frame.id(), frame.data())
        && answer.node == port.node
    {
        exchange.receive(&answer);
    }
}

/// Why a rig was not armed that has said in which state it is.
fn refused(node: u8, refusal: Refusal, says: Option<RunState>) -> NoAnswer {
    let is_commanded = |state: &RunState| {
        matches!(
            state,
            RunState::Armed
                | RunState::OpenLoop
                | RunState::RampIn
                | RunState::Run
                | RunState::RampOut
        )
    };
    match (refusal, says.filter(is_commanded)) {
        (Refusal::ByRig(ArmItem::State), Some(state)) => NoAnswer::Commanded { node, state },
        _ => NoAnswer::Refused { node, refusal },
    }
}

const fn is_armed(exchange: &HostArming) -> bool {
    matches!(exchange.outcome(), HostOutcome::Armed(_))
}
